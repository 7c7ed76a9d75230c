"""From settings to generation after generation, and the run that results."""
