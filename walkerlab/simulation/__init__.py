"""Simulation: recorded walks, their verdicts and fitness, and the evaluation of populations on any executor."""
