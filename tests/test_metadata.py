"""What other tools read about the package: how to cite it, and that it is typed."""

import tomllib
from pathlib import Path

import yaml

import walkerlab

ROOT = Path(__file__).parents[1]
PYPROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))


def test_the_citation_agrees_with_the_package():
    citation = yaml.safe_load((ROOT / "CITATION.cff").read_text(encoding="utf-8"))
    project = PYPROJECT["project"]
    assert citation["title"] == project["name"]
    assert citation["abstract"] == project["description"]
    for key in ("version", "license", "keywords", "authors"):
        assert citation[key] == project[key]


def test_the_package_is_typed_and_the_code_of_a_user_is_checked():
    assert (Path(walkerlab.__file__).parent / "py.typed").exists()
    assert (ROOT / "tests" / "consumer.py").relative_to(ROOT).as_posix() in PYPROJECT["tool"]["pyright"]["include"]
