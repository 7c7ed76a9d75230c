"""Tables written for spreadsheets contain the same values when they are read again."""

import sys
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pandas as pd
import pytest

import walkerlab as wl
from walkerlab.__main__ import main
from walkerlab.runfile.records import RECORD_COLUMNS
from walkerlab.view import table_files

SETTINGS = wl.Settings().with_(population_size=4, generations=2, duration=1)
TEXTS = [name for name, (kind, *_) in RECORD_COLUMNS.items() if kind is str]
SAME = {"check_dtype": False, "check_exact": True}


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    with ThreadPoolExecutor(1) as pool:
        path = tmp_path_factory.mktemp("table") / "run.walk"
        run = wl.evolve(SETTINGS, path, executor=pool, progress=False)
    run.records.attrs.clear()
    return run


def test_a_workbook_has_the_same_values_and_explains_each_column(run, tmp_path):
    pytest.importorskip("openpyxl", reason="openpyxl, of the extra spreadsheet, is not installed")
    records = run.records
    records.loc[0, ["fitness", "verdict"]] = [-np.inf, "fell"]
    path = wl.save_table(records, tmp_path / "robots.xlsx")
    again = pd.read_excel(path, sheet_name=None, keep_default_na=False, dtype=dict.fromkeys(TEXTS, str))
    pd.testing.assert_frame_equal(again["robots"], records, check_dtype=False, rtol=1e-15, atol=0)  # 16 digits
    assert again["columns"].column.tolist() == list(records)
    assert (again["columns"].meaning != "").all()


@pytest.mark.parametrize(("decimal", "separator"), [(".", ","), (",", ";")])
def test_a_text_file_has_the_same_values_with_either_decimal_mark(run, tmp_path, decimal, separator):
    path = tmp_path / "robots.csv"
    assert main(["table", str(run.path), str(path), "--decimal", decimal]) == 0
    again = pd.read_csv(path, decimal=decimal, sep=separator, keep_default_na=False)
    pd.testing.assert_frame_equal(again[TEXTS], run.records[TEXTS].astype(again[TEXTS].dtypes), **SAME)
    pd.testing.assert_frame_equal(again.drop(columns=TEXTS), run.records.drop(columns=TEXTS), **SAME)


@pytest.mark.parametrize("name", ["robots.csv", "robots.xlsx"])
def test_no_text_is_a_formula(run, tmp_path, name):
    if name.endswith("xlsx"):
        pytest.importorskip("openpyxl", reason="openpyxl, of the extra spreadsheet, is not installed")
    table = run.records.assign(reason="=1+1", condition="@SUM(A1)")
    path = wl.save_table(table, tmp_path / name)
    again = pd.read_csv(path) if name.endswith("csv") else pd.read_excel(path)
    assert set(again.reason) == {"'=1+1"}
    assert set(again.condition) == {"'@SUM(A1)"}


def test_a_missing_package_is_named_before_anything_is_written(run, tmp_path, monkeypatch, capsys):
    monkeypatch.setitem(sys.modules, "openpyxl", None)
    with pytest.raises(ModuleNotFoundError, match="pip install openpyxl"):
        wl.save_table(run, tmp_path / "robots.xlsx")
    with pytest.raises(SystemExit) as stopped:
        sys.exit(main(["table", str(run.path), str(tmp_path / "robots.xlsx")]))
    assert stopped.value.code
    assert "pip install openpyxl" in capsys.readouterr().err
    assert not list(tmp_path.iterdir())


def test_wrong_arguments_are_errors(run, tmp_path, monkeypatch):
    with pytest.raises(ValueError, match=r"must end in \.xlsx or \.csv.*to_parquet"):
        wl.save_table(run, tmp_path / "robots.ods")
    with pytest.raises(ValueError, match="decimal is ';'"):
        wl.save_table(run, tmp_path / "robots.csv", decimal=";")
    with pytest.raises(TypeError, match=r"run\.records"):
        wl.save_table(3, tmp_path / "robots.csv")
    monkeypatch.setattr(table_files, "MAX_EXCEL_ROWS", 5)
    with pytest.raises(ValueError, match=r"8 rows.*at most 5"):
        wl.save_table(run, tmp_path / "robots.xlsx")
