"""What the command line's words do, a file for each; ``walkerlab.__main__`` is its grammar."""
