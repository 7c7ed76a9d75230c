"""Measure the cost of walkerlab as ratios: ``python -m benchmarks``."""
