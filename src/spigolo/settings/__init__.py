"""The numbers of the method: one frozen model for each stage with unit, range and origin, and the presets."""
