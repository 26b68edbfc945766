"""Output: measured regions, verdicts with reasons, and the result."""
