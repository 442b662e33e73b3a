"""The model: the scene, its pre-stress and friction, what is recorded, and the stable time step.

This package imports no other package of the project.
"""
