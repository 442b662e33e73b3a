"""Scenes in, Datasets out: one scene, or a sweep of many."""
