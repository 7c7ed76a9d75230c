"""What a robot inherits: its genes as numbers and as text, the limits, and the robot that a genome expresses."""
