"""Claims are measured for each seed, stored, and printed with whether they hold."""

import json
import math
import sys
from concurrent.futures import ThreadPoolExecutor

import pytest

import walkerlab as wl
from benchmarks.claims import __main__ as claims
from benchmarks.claims.claim import Claim, evolve_here
from walkerlab.lessons.exercises import lesson_numbers

HOLDS = Claim("99.a", "Four seeds of five agree.", lambda seed: seed - 0.5, unit="m")
FAILS = Claim("99.b", "Three seeds of five agree.", lambda seed: seed - 1.5)
RAISES = Claim("99.c", "The measure raises an error.", lambda seed: 1 / 0)


@pytest.fixture
def executor():
    with ThreadPoolExecutor(1) as one:
        yield one


def test_a_claim_holds_if_enough_seeds_agree(executor, capsys):
    figures = claims.measure_claims([HOLDS, FAILS, RAISES], range(5), executor)
    table = claims.to_table([HOLDS, FAILS, RAISES], figures)
    assert list(table.agree) == ["4 of 5", "3 of 5", "0 of 5"]
    assert list(table.holds) == [True, False, False]
    assert table.figures[0] == "-0.5 0.5 1.5 2.5 3.5 m"
    assert math.isnan(figures["99.c", 0])
    claims.print_table(table)
    printed = capsys.readouterr()
    assert "99.b  DOES NOT HOLD  Three seeds of five agree." in printed.out
    assert printed.out.endswith("1 of 3 claims hold\n")
    assert "99.c, seed 4: ZeroDivisionError: division by zero" in printed.err


@pytest.mark.parametrize(("n_seeds", "n_needed"), [(1, 1), (2, 2), (5, 4), (10, 8)])
def test_the_number_of_seeds_needed_is_proportional(n_seeds, n_needed):
    for n_agree in range(n_seeds + 1):
        figures = {("99.a", seed): float(seed < n_agree) for seed in range(n_seeds)}
        assert claims.to_table([HOLDS], figures).holds[0] == (n_agree >= n_needed)


def test_stored_figures_are_not_measured_again(executor, tmp_path):
    measured = []
    claim = Claim("99.d", "It is measured once.", lambda seed: measured.append(seed) or 1.0)
    for _ in range(2):
        assert claims.measure_claims([claim], [3], executor, tmp_path) == {("99.d", 3): 1.0}
    assert measured == [3]
    [file] = tmp_path.iterdir()
    assert json.loads(file.read_text()) == 1.0


def test_the_command_measures_a_lesson_and_exits_with_1_if_a_claim_fails(monkeypatch, capsys):
    monkeypatch.setattr(claims, "find_claims", lambda lessons: [HOLDS, FAILS] if lessons == ["99"] else [HOLDS])
    monkeypatch.setattr(claims, "ProcessPoolExecutor", ThreadPoolExecutor)
    for lessons, code in {"99": 1, "98": 0}.items():
        monkeypatch.setattr(sys, "argv", ["claims", "--lessons", lessons, "--jobs", "1"])
        assert claims.main() == code
    assert "2 claims hold" in capsys.readouterr().out


def test_claims_of_all_lessons_are_found_and_unique():
    found = claims.find_claims()
    assert len({claim.id for claim in found}) == len(found)
    assert {claim.id.partition(".")[0] for claim in found} <= {*lesson_numbers()}
    assert all(0 < claim.needed <= claims.SEEDS_OF_NEEDED and claim.text.endswith(".") for claim in found)
    with pytest.raises(SystemExit, match="no claims of lesson 98"):
        claims.find_claims(["03", "98"])


def test_a_run_is_evolved_once_for_several_claims():
    settings = wl.Settings().with_(population_size=4, generations=1, duration=1)
    assert evolve_here(settings) is evolve_here(settings.with_())
