"""The paper, equations 2 to 23, and nothing else. A stage takes arrays and values and returns them."""
