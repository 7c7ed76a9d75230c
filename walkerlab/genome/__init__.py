"""Genomes as numbers, text and tables, the limits that they obey, and the robot that a genome expresses."""
