"""The output: measured regions, verdicts with their reasons, and the answer."""
