"""What walkerlab costs, measured as ratios: python -m benchmarks."""
