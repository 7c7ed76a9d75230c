"""Escaping of text from files and users for terminals and spreadsheets."""


def printable(text: object, *, keep: str = "") -> str:
    """Replace all characters that are not printable, such as control characters, with their escape sequences.

    Args:
        text: Text from a file or a user.
        keep: Characters that are not replaced, such as line ends.
    """
    string = str(text)
    if string.isprintable():
        return string
    return "".join(letter if letter.isprintable() or letter in keep else ascii(letter)[1:-1] for letter in string)


def escape_cell(text: str) -> str:
    """Escape the text of a spreadsheet's cell: a leading apostrophe prevents it from being executed as a formula."""
    escaped = printable(text, keep="\n")
    return f"'{escaped}" if escaped.startswith(("=", "+", "-", "@")) else escaped
