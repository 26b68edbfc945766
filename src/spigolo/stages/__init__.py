"""Stages of the paper's method (equations 2-23), without our additions."""
