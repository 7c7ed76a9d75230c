"""Experiments: several conditions, each run with several seeds, and the statistics that compare them."""
