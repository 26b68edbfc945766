"""Compiled loops over arrays. The compiled loops, called kernels, run on one thread and release Python's global
interpreter lock.

H, W = image rows and columns. P = number of directions in which edges are stored: 2 for 4-connectivity, 4 for
8-connectivity. E = P H W = number of edges. R = number of regions. A plane is an array (H, W) with one value for each
edge of one direction. For every kernel, tests/naive.py has a slow reference version that returns equal results. Kernels
do not validate their arguments.
"""
