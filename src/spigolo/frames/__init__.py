"""The input: a frame with its camera, read, checked and owned once."""
