"""Measurements of a finished run: its fronts, pulses, transition and regime, and their accuracy.

`table.measure_run` collects all numbers of a run. This package neither simulates nor draws.
"""
