"""What a run looks like: plots, replays, films, sketches, reports and summaries."""
