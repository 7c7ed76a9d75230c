"""What the operating system provides: signals, time limits for calls, and files that are replaced in one step."""
