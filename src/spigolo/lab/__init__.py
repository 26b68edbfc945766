"""Laboratory: data sets, evaluation, experiments, fitting, benchmarks, rendered scenes.

Only the command line imports it. `segment` does not need it.
"""
