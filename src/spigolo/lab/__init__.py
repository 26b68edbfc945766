"""Tools for development: data sets, evaluation, experiments, parameter fitting, benchmarks and rendered scenes.

Only the command line imports the subpackage `spigolo.lab`. The function `spigolo.segment` works without `spigolo.lab`.
"""
