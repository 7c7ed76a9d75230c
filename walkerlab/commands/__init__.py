"""Commands of the command line, their parser, and scripts that draw the pictures of README."""
