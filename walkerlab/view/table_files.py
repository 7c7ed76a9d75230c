"""Tables of runs as files for spreadsheets and other programs."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any, Literal

import pandas as pd
from pandas.api.types import is_numeric_dtype

from walkerlab.runfile.records import RECORD_COLUMNS
from walkerlab.settings.values import short_repr
from walkerlab.simulation.descriptors import DESCRIPTORS
from walkerlab.system.files import file_path, replace_atomically
from walkerlab.text.escape import escape_cell

ENDINGS = (".xlsx", ".csv")
MAX_EXCEL_ROWS = 1_048_575  # of a sheet, without the row of the column names
SEPARATORS: Mapping[str, str] = {".": ",", ",": ";"}
"""Separator of the columns of a CSV file, by its decimal mark."""

MEANINGS: Mapping[str, tuple[str, str]] = {
    **{name: (one.unit, one.about) for name, one in DESCRIPTORS.items()},
    **{name: (unit, about) for name, (_, unit, about) in RECORD_COLUMNS.items()},
    "condition": ("", "condition of the experiment"),
    "seed": ("", "seed of the evolution"),
}
"""Unit and meaning of columns, by name."""


def save_table(records: Any, path: str | Path, *, decimal: Literal[".", ","] = ".") -> Path:
    """Write the table of a run for a spreadsheet.

    A workbook (``.xlsx``) opens with the right numbers in every country; its second sheet explains the columns. It
    requires openpyxl, which rounds numbers to 16 digits. A text file (``.csv``) has decimal points and commas between
    the columns. With ``decimal=","``, it has decimal commas and semicolons, which spreadsheets expect where numbers are
    written with a comma, as in German and French. Texts that a spreadsheet would execute as formulas begin with an
    apostrophe.

    Args:
        records: Run, experiment or problem, or a table from one of them.
        path: File to write, which ends in ``.xlsx`` or ``.csv``; an existing file is replaced.
        decimal: Decimal mark of a text file.

    Returns:
        Path of the file.

    Raises:
        ModuleNotFoundError: If the file is a workbook, and openpyxl is not installed.
        OSError: If the file cannot be written.
        TypeError: If ``records`` contains no table.
        ValueError: If the path has another ending, the decimal mark is another, or the table has too many rows for a
            workbook.
    """
    table = getattr(records, "records", records)
    if not isinstance(table, pd.DataFrame):
        raise TypeError(f"records must be a run or its table, run.records; got a {type(records).__name__}")
    file = file_path(path)
    ending = file.suffix.lower()
    if ending not in ENDINGS:
        raise ValueError(
            f"path is {short_repr(str(path))}; it must end in {' or '.join(ENDINGS)}. For other formats, use pandas: "
            'run.records.to_parquet("robots.parquet")'
        )
    if decimal not in SEPARATORS:
        raise ValueError(f"decimal is {short_repr(decimal)}; it must be '.' or ','")
    if ending == ".xlsx":
        _require_workbooks(len(table))
    escaped = escape_formulas(table)
    with replace_atomically(file) as part:
        if ending == ".csv":
            signature = "utf-8" if decimal == "." else "utf-8-sig"  # Excel reads others in the encoding of the country
            escaped.to_csv(part, index=False, decimal=decimal, sep=SEPARATORS[decimal], encoding=signature)
        else:
            _write_workbook(escaped, part)
    return file


def escape_formulas(table: pd.DataFrame) -> pd.DataFrame:
    """Escape all strings that a spreadsheet would execute as formulas; the table may come from another person."""
    texts = [name for name in table if not is_numeric_dtype(table[name])]
    return table.assign(**{name: table[name].map(_escape, na_action="ignore") for name in texts})


def _escape(value: Any) -> Any:
    return escape_cell(value) if isinstance(value, str) else value


def _require_workbooks(n_rows: int) -> None:
    """Check that a workbook can be written.

    Raises:
        ModuleNotFoundError: If openpyxl is not installed.
        ValueError: If there are too many rows.
    """
    if n_rows > MAX_EXCEL_ROWS:
        raise ValueError(
            f"the table has {n_rows:,} rows; a sheet of Excel has at most {MAX_EXCEL_ROWS:,}. Write a file that ends "
            "in .csv, or fewer rows: wl.save_table(run.records[run.records.generation >= 900], path)"
        )
    try:
        import openpyxl as openpyxl
    except ModuleNotFoundError:
        raise ModuleNotFoundError(
            "a workbook (.xlsx) requires openpyxl, which is not installed. Install it with: python -m pip install "
            "openpyxl. Or write a file that ends in .csv; with decimal=',' it opens in a German or French Excel"
        ) from None


def _write_workbook(table: pd.DataFrame, path: Path) -> None:
    """Write a table and the meaning of its columns as two sheets."""
    described = [(name, *MEANINGS.get(str(name), ("", ""))) for name in table]
    with pd.ExcelWriter(path, engine="openpyxl") as writer:
        table.to_excel(writer, sheet_name="robots", index=False, freeze_panes=(1, 0))
        pd.DataFrame(described, columns=["column", "unit", "meaning"]).to_excel(
            writer, sheet_name="columns", index=False, freeze_panes=(1, 0)
        )
        sheets: Any = writer.sheets
        for column in "ABC":
            sheets["columns"].column_dimensions[column].width = 80 if column == "C" else 16
