"""Stages of the paper, equations 2 to 23, without additions. Each stage takes arrays and parameters and returns
them.
"""
