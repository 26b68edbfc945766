"""Synthetic RGB-D frames: rendered scenes, and a model of a depth camera."""
