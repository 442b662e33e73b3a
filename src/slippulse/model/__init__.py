"""The model: the scene, its pre-stress, what is recorded, and the allowed step.

This package imports no other.
"""
