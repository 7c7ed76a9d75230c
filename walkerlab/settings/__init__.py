"""What a class can set: terrain, robot, algorithm and simulation, each setting declared once."""
