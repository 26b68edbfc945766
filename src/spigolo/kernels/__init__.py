"""Compiled loops: pure functions over arrays, serial, without the GIL.

H, W = rows and columns of the image. P = planes of the grid (2 or 4). E = P H W edges. R = regions. Every kernel has a
slow twin in tests/naive.py with equal results. Kernels do not validate arguments, as their callers do this.
"""
