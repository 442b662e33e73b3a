"""Simulation of scenes: one scene, or a sweep of many, returned as an xarray Dataset."""
