"""Views of a run: plots, replays, films, sketches, reports and summaries."""
