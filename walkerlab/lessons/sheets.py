"""Script that prints the sheets of the lessons as PDF, one page of A4 each.

    python -m walkerlab.lessons.sheets FOLDER [SHEET.md ...]

It requires Playwright and Chromium. Without names, all sheets in ``notebooks/teacher/sheets`` are printed.
"""

import argparse
import shutil
import sys
from collections.abc import Generator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from walkerlab.lessons.exercises import LessonError
from walkerlab.system.package_files import find_package_file
from walkerlab.text.templates import render

SHEETS = "notebooks/teacher/sheets"


def print_sheets(sources: Sequence[Path], folder: Path) -> list[Path]:
    """Print sheets as PDF; return the files written.

    Args:
        sources: Sheets in Markdown.
        folder: Folder of the PDF files; created if it is missing.

    Raises:
        LessonError: If Playwright or Chromium is missing, or there is no sheet.
    """
    if not sources:
        raise LessonError("there is no sheet to print; write the path of a Markdown file.")
    folder.mkdir(parents=True, exist_ok=True)
    with _open_page() as page:
        return [_print_sheet(page, source, folder / f"{source.stem}.pdf") for source in sources]


@contextmanager
def _open_page() -> Generator[Any]:
    """Open a page in a new Chromium without a window."""
    try:
        from playwright.sync_api import Error, sync_playwright
    except ImportError:
        raise LessonError(f'Playwright is missing. Install it: "{sys.executable}" -m pip install playwright') from None
    with sync_playwright() as playwright:
        try:
            browser = playwright.chromium.launch(executable_path=shutil.which("chromium"), args=["--no-sandbox"])
        except Error:
            raise LessonError(
                f'Chromium is missing. Install it: "{sys.executable}" -m playwright install chromium'
            ) from None
        yield browser.new_page()
        browser.close()


def _print_sheet(page: Any, source: Path, file: Path) -> Path:
    from nbconvert.filters.markdown import markdown2html  # slow to import

    page.set_content(render("lessons/sheet.html", title=source.stem))
    content = markdown2html(source.read_text(encoding="utf-8"))
    page.locator("main").evaluate("(main, content) => { main.innerHTML = content; }", content)
    page.pdf(path=str(file), prefer_css_page_size=True, print_background=True)
    return file


def main() -> None:
    """Parse the arguments, print the sheets and print the paths of the PDF files."""
    parser = argparse.ArgumentParser(
        description="Print the sheets of the lessons as PDF, one page of A4 each. Requires Playwright and Chromium."
    )
    parser.add_argument(
        "folder",
        nargs="?",
        type=Path,
        default=Path("sheets"),
        help="folder of the PDF files; created if it is missing [sheets]",
    )
    parser.add_argument("sheets", nargs="*", type=Path, metavar="SHEET.md", help=f"sheets to print [all in {SHEETS}]")
    arguments = parser.parse_args()
    try:
        for printed in print_sheets(
            arguments.sheets or sorted(find_package_file(SHEETS).glob("*.md")), arguments.folder
        ):
            print(printed)
    except LessonError as error:
        sys.exit(f"Error: {error}")


if __name__ == "__main__":
    main()
