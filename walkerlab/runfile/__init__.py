"""The table of a run, and the SQLite file that stores it."""
