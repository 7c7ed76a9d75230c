"""Settings of a run: terrain, robot, algorithm and simulation, each setting declared once."""
