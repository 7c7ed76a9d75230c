"""Base class of errors that users can fix: a notebook shows the message without walkerlab's own traceback."""

from traceback import extract_tb

CELL_FILE_PATTERNS = ("ipykernel_", "<ipython-input")  # parts of the file names that IPython gives to cells


class WalkerlabError(Exception):
    """An error that the user can fix; the message explains how."""

    def _render_traceback_(self) -> list[str]:
        """Return the lines that IPython prints instead of a traceback: the cell's line, the message and the notes."""
        cell_lines = [
            f"In line {frame.lineno} of the cell: {frame.line}"
            for frame in extract_tb(self.__traceback__)
            if any(pattern in frame.filename for pattern in CELL_FILE_PATTERNS)
        ]
        return [*cell_lines, f"{type(self).__name__}: {self}", *getattr(self, "__notes__", [])]
