"""Input: a frame with its camera, read, validated and copied once."""
