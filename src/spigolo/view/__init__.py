"""Pictures, charts and viewers of results."""
