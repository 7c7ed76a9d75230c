"""Errors that say in words what is wrong: a notebook shows the words, and not the way through these rooms."""

from traceback import extract_tb

CELLS = ("ipykernel_", "<ipython-input")  # by which the names of cells, as files, are known


class Fault(Exception):
    """Something that whoever asked can mend; it says how."""

    def _render_traceback_(self) -> list[str]:
        """Show the line of the cell that asked, and the words: what IPython prints in place of a traceback."""
        asked = [step for step in extract_tb(self.__traceback__) if any(cell in step.filename for cell in CELLS)]
        lines = [f"In line {step.lineno} of the cell: {step.line}" for step in asked]
        return [*lines, f"{type(self).__name__}: {self}", *getattr(self, "__notes__", [])]
