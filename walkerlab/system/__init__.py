"""Foundations: the base class of errors, random generators, signals, time limits, and files replaced in one step."""
