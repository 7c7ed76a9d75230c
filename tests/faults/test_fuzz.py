"""Genes and settings from strangers: each gives a value, or our own error in a few printable words, and soon."""

import json
import re
import sys
import warnings
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from time import process_time

import numpy as np
import pytest
from hypothesis import given
from hypothesis import settings as hypothesis_settings
from hypothesis import strategies as st

from tests.faults import mutants, number
from tests.genome.test_genome import obeys_every_limit
from tests.strategies import all_settings
from walkerlab.genome.genome import Genome
from walkerlab.genome.text import GenomeError
from walkerlab.settings.model import SettingsError
from walkerlab.settings.robot import Robot
from walkerlab.settings.settings import Settings

ROBOTS = [
    Robot(),
    *mutants.WIDE_LIMITS,
    Robot(weight=(0.1, 0.1), body_length=(0.05, 0.05), segments=(1, 8), segment_length=(0.05, 2.0), legs=(2, 8)),
    Robot(weight=(200, 200), body_length=(8, 8), segments=(1, 8), segment_length=(0.05, 2.0), legs=(16, 16)),
    Robot(weight=(1.23456789, 1.23456789), body_length=(1 / 3, 2 / 3), segment_length=(0.1, 1 / 7)),
]


# ------------------------------------------------------------------------------------------------------- the laws


def is_brief(message):
    """It ends soon, few words of it are the stranger's, and none does things to a terminal."""
    lines = message.split("\n")
    assert len(lines) <= 150
    assert all(line.isprintable() and len(line) <= 500 for line in lines), ascii(message)
    return True


def points_at_its_place(message, text):
    """The number and the caret name the same place, and what stands over the caret is what stands there."""
    head, shown, caret = message.split("\n")
    place = int(re.search(r"at character (\d+) expected", head).group(1)) - 1
    before, seen = shown[: caret.index("^")], shown[caret.index("^") :]
    assert caret.strip() == "^"
    assert before.isascii(), "or the caret would stand elsewhere on the screen"
    assert len(seen) == len(text[place : place + 30])
    around = zip(before[4:] + seen, text[max(0, place - 30) :], strict=False)
    assert all(sign in (there, " ", "�") for sign, there in around)
    return True


def gene_is_read_or_refused(text, rng):
    """Return whether a text is a genome, of which all holds that must."""
    try:
        genome = Genome.parse(text)
    except GenomeError as error:
        message = str(error)
        return not (is_brief(message) and ("\n" not in message or points_at_its_place(message, text)))
    assert Genome.parse(str(genome)) == genome
    for robot in (Robot(), ROBOTS[rng.integers(len(ROBOTS))]):
        fitted = genome.within(robot)
        assert np.isfinite(fitted.values).all()
        assert obeys_every_limit(fitted.values, robot)
        assert fitted.within(robot) == fitted
    assert genome._repr_html_().endswith("</div>")
    return True


def settings_or_refusal(make, *args, **values):
    """Return the settings that were made, of which all holds that must, or None."""
    try:
        made = make(*args, **values)
    except SettingsError as error:
        message = str(error)
        return None if is_brief(message) else error
    assert isinstance(made, Settings)
    assert Settings.model_validate_json(made.model_dump_json()) == made
    assert eval(repr(made), vars(sys.modules["walkerlab.settings.settings"])) == made
    assert made._repr_html_().endswith("</div>")
    return made


def settings_are_the_same_every_way(text, _=None):
    """Return whether a text is settings, read as JSON, and as what Python makes of it."""
    as_json = settings_or_refusal(Settings.model_validate_json, text)
    assert as_json == settings_or_refusal(Settings.model_validate_json, text.encode(errors="surrogatepass"))
    try:
        plain = json.loads(text)
    except (ValueError, RecursionError):
        assert as_json is None
        return False
    as_python = settings_or_refusal(Settings.model_validate, plain)
    if isinstance(plain, dict):
        assert settings_or_refusal(Settings, **plain) == as_python
    assert as_json is None or as_json == as_python
    return as_python is not None


# ------------------------------------------------------------------------------- many, in a process of their own


def genes(case, rng):
    text = mutants.genome_text(rng)
    other = mutants.genome_text(rng)
    if case % 1000:
        return mutants.mutated(text, other, rng)
    return mutants.with_long_piece(text, mutants.HUGE if case % 25_000 else mutants.VAST, rng)


def settings_texts(case, rng):
    plain = mutants.settings(rng)
    if case % 1000 == 0:
        return mutants.with_long_piece(json.dumps(plain), mutants.HUGE if case % 5000 else mutants.VAST, rng)
    if rng.random() < 0.6:
        plain = mutants.with_wrong_values(plain, rng)
    text = json.dumps(plain, ensure_ascii=bool(rng.integers(2)))
    return text if rng.random() < 0.5 else mutants.mutated(text, json.dumps(mutants.settings(rng)), rng)


def ordeal(make, holds, n):
    """Send that many; say how many were accepted, the longest that one took [s], which, and how memory grew [MB]."""
    warnings.simplefilter("error")
    accepted = 0
    slowest = (0.0, 0)
    before = _peak()
    for case in range(n):
        rng = np.random.default_rng([7, case])
        text = make(case, rng)
        begun = process_time()
        try:
            accepted += holds(text, rng)
        except BaseException as error:
            error.add_note(f"case {case}: {text[:3000]!a}")
            raise
        slowest = max(slowest, (process_time() - begun, case))
    return {"sent": n, "accepted": accepted, "slowest": slowest, "growth": _peak() - before}


def _peak():
    """The most memory that this process ever had [MB]; 0 where there is no telling."""
    status = Path("/proc/self/status")  # ru_maxrss would count the parent from which it was forked
    return int(re.search(r"VmHWM:\s*(\d+)", status.read_text()).group(1)) / 1e3 if status.exists() else 0.0


@pytest.mark.parametrize(
    ("make", "holds", "n"),
    [
        (genes, gene_is_read_or_refused, number(1200, 100_000)),
        (settings_texts, settings_are_the_same_every_way, number(400, 20_000)),
    ],
    ids=["genes", "settings"],
)
def test_whatever_a_stranger_sends_is_read_or_refused_in_words_and_soon(make, holds, n):
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as process:
        found = process.submit(ordeal, make, holds, n).result()
    print(found)
    assert 0.05 * n < found["accepted"] < 0.95 * n, "both are to be tried"
    assert found["slowest"][0] < 1.0, "s of its own time"
    assert found["growth"] < 200, "MB"


# ------------------------------------------------------------------------------------- by structure, and one by one


NAMES = st.sampled_from(
    ["terrain", "robot", "algorithm", "simulation", *Settings.field_locations(), "function", "with"]
)
PLAIN = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=9) | st.sampled_from(["rank", "moon"]),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(NAMES | st.text(max_size=9), inner, max_size=4),
    max_leaves=8,
)


@given(PLAIN)
def test_any_json_is_settings_or_refused(plain):
    settings_are_the_same_every_way(json.dumps(plain))


@hypothesis_settings(max_examples=60)
@given(all_settings, st.sampled_from(list(Settings.field_locations().values())), PLAIN)
def test_anything_in_place_of_one_setting_is_taken_or_refused(made, place, value):
    domain, name = place
    plain = made.model_dump()
    plain[domain][name] = value
    settings_are_the_same_every_way(json.dumps(plain))


@given(st.text(max_size=40))
def test_settings_that_are_no_json_are_refused(text):
    settings_are_the_same_every_way(text)


@given(st.binary(max_size=40))
def test_settings_may_be_any_bytes(data):
    settings_or_refusal(Settings.model_validate_json, data)


@given(st.text(max_size=20), st.integers(0, 60))
def test_any_signs_within_a_gene_are_read_or_refused(signs, place):
    text = mutants.genome_text(np.random.default_rng(place))
    gene_is_read_or_refused(text[:place] + signs + text[place:], np.random.default_rng(0))


def test_a_text_too_long_to_be_one_is_not_even_read():
    gene = mutants.genome_text(np.random.default_rng(0))
    with pytest.raises(GenomeError, match=r"has at most 20000 characters; this one has 20001"):
        Genome.parse(gene.ljust(20_001))
    assert Genome.parse(gene.ljust(20_000)) == Genome.parse(gene)
    fill = " " * 100_000
    for text in (fill + "{}", "[" * 10**6, b"x" * 10**6):
        with pytest.raises(SettingsError, match=rf"have at most 100000 characters; this text has {len(text)}"):
            Settings.model_validate_json(text)
    assert Settings.model_validate_json(fill[2:] + "{}") == Settings()


@pytest.mark.parametrize("huge", ["A" * 10**6, b"A" * 10**6, [0] * 10**6, 10**5000, -(10**5000)], ids=type)
def test_a_huge_value_is_not_quoted_whole(huge):
    nested = huge
    for _ in range(10**5):
        nested = [nested]
    for bad in (huge, [huge], [huge] * 2, [huge] * 3, nested):
        for domain, name in Settings.field_locations().values():
            assert settings_or_refusal(Settings, **{domain: {name: bad}}) is None
        for domain in Settings.model_fields:
            assert settings_or_refusal(Settings, **{domain: [bad]}) is None
        assert settings_or_refusal(Settings.model_validate, [bad]) is None
        for make in (Genome, Genome.of, Genome.parse):
            with pytest.raises((ValueError, TypeError), match="genome") as caught:
                make(bad)
            assert is_brief(str(caught.value))


def test_of_a_list_no_more_is_read_than_there_can_be():
    def endless():
        yield from (0.0, 0.0, 0.0, 0.0)
        raise RuntimeError("asked for a fifth")

    with pytest.raises(SettingsError, match="must be 3 numbers"):
        Settings(terrain={"gravity": endless()})
    with pytest.raises(SettingsError, match="a list of 101 items; it must have at most 100"):
        Settings(algorithm={"mutation": ["macro"] * 101})
    assert len(Settings(algorithm={"mutation": ["macro"] * 100}).algorithm.mutation) == 100


def test_many_faults_are_told_as_some_and_their_number():
    with pytest.raises(SettingsError, match=r"\n… and 2900 more\.$") as caught:
        Settings(**{f"x{i}": 1 for i in range(3000)})
    assert is_brief(str(caught.value))
