"""Synthetic RGB-D frames: a depth-camera model, and the bundled demo scene that MuJoCo renders."""
