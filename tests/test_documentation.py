"""The guide to operators agrees with the code, and broken links of the built site are found."""

import re
import runpy
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

import walkerlab as wl
from walkerlab.genome.breeding import check_user_operators
from walkerlab.genome.features import build_genes

DOCS = Path(__file__).parents[1] / "docs"
GUIDE = (DOCS / "operators.md").read_text(encoding="utf-8")
OPERATORS = {
    "selection": "def operator(fitness, n_parents, *, {}): return rng.integers(len(fitness), size=n_parents)",
    "crossover": "def operator(parents, fitness, n_children, *, {}):\n"
    "    chosen = rng.integers(len(parents), size=n_children)\n"
    "    return parents[chosen], chosen[:, None]",
    "mutation": "def operator(genomes, genes, *, {}): return genomes + rng.random() * 1e-6",
}
"""An operator for each slot; the keywords are to be filled in."""


def keyword_table():
    """Return whether the guide says that an operator receives a keyword, by slot and keyword."""
    rows = re.findall(r"^\| `(\w+)` \| ([^|]*)\| ([^|]*)\| ([^|]*)\| [^|]+ \|$", GUIDE, re.MULTILINE)
    return {
        (slot, keyword): cell.strip() in ("yes", "always")
        for keyword, *cells in rows
        for slot, cell in zip(OPERATORS, cells, strict=True)
        if "argument" not in cell
    }


def test_operators_receive_the_keywords_that_the_guide_lists_and_no_others():
    table = keyword_table()
    assert {keyword for _, keyword in table} >= {"rng", "generation", "genomes", "genes", "rate", "favored"}
    for (slot, keyword), is_received in table.items():
        namespace = {}
        exec(OPERATORS[slot].format(", ".join({"rng", keyword})), namespace)
        algorithm = wl.Algorithm(**{slot: namespace["operator"]})
        if is_received:
            check_user_operators(algorithm, build_genes(wl.Robot()))
        else:
            with pytest.raises(wl.OperatorError, match=keyword):
                check_user_operators(algorithm, build_genes(wl.Robot()))


def test_the_code_of_the_guide_evolves():
    namespace = {}
    for block in re.findall(r"^```python\n(.*?)^```", GUIDE, re.MULTILINE | re.DOTALL):
        exec(block, namespace)
    settings = namespace["settings"].with_(population_size=4, generations=3, n_elites=1, duration=1)
    with ThreadPoolExecutor(1) as executor:
        run = wl.evolve(settings, executor=executor, progress=False)
    assert run.n_generations == 3
    assert settings.algorithm.mutation is namespace["fading"]


def test_broken_links_and_files_from_the_network_are_found(tmp_path):
    (tmp_path / "b.html").write_text('<h1 id="top">B</h1>')
    (tmp_path / "a.html").write_text(
        '<a href="b.html#top">1</a> <a href="b.html#x">2</a> <a href="c.html">3</a> <a href="https://d/e#f">4</a>'
        '<a href="#here" id="here">5</a> <img src="g.png"> <script src="https://cdn/h.js"></script>'
    )
    found = list(runpy.run_path(str(DOCS / "check_links.py"))["find_errors"](tmp_path))
    assert sorted(re.findall(r"(?:links to|loads) (\S+?)(?:;| )", " ".join(found))) == [
        "b.html#x",
        "c.html",
        "g.png",
        "https://cdn/h.js",
    ]
