"""Measure whether the statements of the lessons hold: ``python -m benchmarks.claims``."""
