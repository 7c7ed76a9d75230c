"""Evolve a run, store it, resume it, and write its output files."""
