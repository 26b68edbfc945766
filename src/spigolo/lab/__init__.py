"""The laboratory: data sets, evaluation, experiments, fitting, benchmarks, rendered scenes.

Only the command line imports it: `segment` needs none of it.
"""
