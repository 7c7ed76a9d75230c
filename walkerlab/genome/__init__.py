"""Genomes as numbers, text and tables, their limits, and the robot that a genome expresses."""
