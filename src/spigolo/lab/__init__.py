"""The laboratory: data sets, evaluation, experiments, fitting, benchmarks, rendered scenes. `segment` needs none of it."""
