"""Stages of the paper's method (eqs. 2-23), without our additions."""
