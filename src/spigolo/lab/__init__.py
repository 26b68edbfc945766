"""Tools for development: data sets, evaluation, experiments, parameter fitting, benchmarks and rendered scenes.

Only the command line imports this subpackage. `spigolo.segment` does not need it.
"""
