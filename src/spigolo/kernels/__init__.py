"""Compiled loops over arrays. The loops run on one thread and release Python's global interpreter lock.

H, W = image rows and columns. P = number of directions from a pixel to its neighbours, 2 or 4. E = P H W = number of
edges. R = number of regions. The edges of all pixels in one direction are called a plane. Every kernel has a slow
reference version with equal results in tests/naive.py. Kernels do not validate their arguments.
"""
