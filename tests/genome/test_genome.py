import math
import random
import re
import time
from collections import Counter
from itertools import pairwise

import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import settings as hypothesis_settings
from hypothesis import strategies as st

from tests.strategies import count_genes, finite, genomes, robots, tables
from walkerlab.evolution.run import Run
from walkerlab.genome.breeding import crossover_population, generate_robot_population, mutate_population
from walkerlab.genome.features import build_genes, gene_table
from walkerlab.genome.genome import Genome, read_genomes
from walkerlab.genome.phenotype import express
from walkerlab.genome.repair import repair
from walkerlab.genome.text import GenomeError
from walkerlab.runfile import records
from walkerlab.settings.algorithm import Algorithm
from walkerlab.settings.choices import Crossover, Feature, Mutation
from walkerlab.settings.proportions import (
    DENSITY,
    DENSITY_RANGE,
    SHANK_RADIUS_RATIO,
    compute_legs_mass,
    compute_thigh_radius,
    compute_thigh_share,
    compute_trunk_radius,
)
from walkerlab.settings.robot import Robot
from walkerlab.settings.settings import Settings
from walkerlab.simulation.evaluation import Evaluation
from walkerlab.simulation.rollout import simulate

TOLERANCE = 1e-9


def rng(*seed):
    return np.random.default_rng(seed)


def in_range(value, limits):
    low, high = limits
    return low - TOLERANCE * abs(low) <= value <= high + TOLERANCE * abs(high)


def obeys_every_limit(values, robot):
    """Assert that the robot that (n_genes,) values express obeys every limit."""
    body = express(Genome(values))
    assert robot.segments[0] <= len(body.segments) <= robot.segments[1]
    assert robot.legs[0] <= body.n_legs <= robot.legs[1]
    assert in_range(sum(segment.mass for segment in body.segments), robot.weight)
    assert in_range(sum(segment.length for segment in body.segments), robot.body_length)
    assert all(in_range(segment.length, robot.segment_length) for segment in body.segments)
    legs = [segment.legs for segment in body.segments if segment.legs]
    assert all(in_range(one.force, robot.leg_force) for one in legs)
    assert 2 * len(legs) == body.n_legs == 2 * sum(body.plan)
    assert all(in_range(density, DENSITY_RANGE) for segment in body.segments for density in densities(segment))
    assert (body.weight, body.body_length) == pytest.approx(
        (sum(segment.mass for segment in body.segments), sum(segment.length for segment in body.segments))
    )
    return True


def densities(segment):
    """Return the density of the trunk of a segment and, if there are legs, that of a leg, in kg/m³."""
    legs = compute_legs_mass(segment.mass, segment.length, segment.legs.length) if segment.legs else 0.0
    trunk_radius = compute_trunk_radius(segment.mass - legs, segment.length)
    found = [(segment.mass - legs) / capsule_volume(trunk_radius, segment.length - 2 * trunk_radius)]
    if segment.legs:
        bone_length, radius = segment.legs.length / 2, compute_thigh_radius(legs / 2, segment.legs.length)
        bones = (capsule_volume(radius, bone_length), capsule_volume(SHANK_RADIUS_RATIO * radius, bone_length))
        assert compute_thigh_share(radius, segment.legs.length) == pytest.approx(bones[0] / sum(bones))
        found.append(legs / 2 / sum(bones))
    return found


def capsule_volume(radius, axis_length):
    return math.pi * radius**2 * (axis_length + 4 / 3 * radius)


def is_in_its_ranges(population, robot):
    """Assert that all genes of (n, n_genes) genomes, grown or not, are in their ranges."""
    table = gene_table(robot)
    is_count, is_cyclic = (table.kind == "count").to_numpy(), (table.kind == "cyclic").to_numpy()
    assert population.shape[1] == len(table)
    assert np.all((table.low.to_numpy() <= population) & (population <= table.high.to_numpy()))
    assert np.all(population[:, is_count] == np.rint(population[:, is_count]))
    assert np.all(population[:, is_cyclic] < table.high.to_numpy()[is_cyclic])
    return True


# ------------------------------------------------------------------------------------------------ the gene table


@hypothesis_settings(max_examples=40)
@given(robots())
def test_the_gene_table_has_a_row_for_each_gene_and_its_ranges_are_the_limits(robot):
    table = gene_table(robot).set_index("gene", drop=False)
    assert list(table.columns) == ["gene", "unit", "low", "high", "kind", "meaning"]
    assert len(table) == len(build_genes(robot)) == 4 + 13 * robot.segments[1]
    assert table.index.is_unique
    assert set(table.kind) <= {"real", "count", "cyclic"}
    assert (table.low <= table.high).all()
    for part in range(1, robot.segments[1] + 1):
        assert tuple(table.loc[f"seg{part}.length", ["low", "high"]]) == robot.segment_length
        assert tuple(table.loc[f"seg{part}.leg_force", ["low", "high"]]) == robot.leg_force
        assert tuple(table.loc[f"seg{part}.legs", ["low", "high"]]) == (0, 1)
    assert robot.segments[0] <= table.low["segments"] <= table.high["segments"] <= robot.segments[1]


def test_a_gene_table_requires_limits():
    for make in (gene_table, build_genes, lambda robot: generate_robot_population(robot, 2, seed=0)):
        with pytest.raises(ValueError, match=r"must be a Robot such as settings\.robot; got a Settings"):
            make(Settings())


def test_every_feature_can_be_favored():
    for feature in Feature:
        found = [build_genes(Robot()).names[i] for i in build_genes(Robot()).find(feature.name)]
        assert found
        assert {name.rpartition(".")[2] for name in found} == {feature.name}


# ------------------------------------------------------------------------------------------------------ genomes


def test_a_genome_is_read_only_and_independent_of_the_array_given():
    given_values = Genome.random(Robot(), rng=rng(0)).values.copy()
    genome = Genome(given_values)
    given_values[0] = 99
    assert genome.values[0] != 99
    with pytest.raises(ValueError, match="read-only"):
        genome.values[0] = 99
    with pytest.raises(AttributeError):
        genome.values = given_values


@given(genomes(), genomes())
def test_genomes_are_equal_when_their_values_are(one, other):
    same = one.values.tolist() == other.values.tolist()
    assert (one == other) == same
    assert (len({one, other}) == 1) == same
    assert one == Genome(one.values.tolist())
    assert hash(one) == hash(Genome(one.values.tolist()))
    assert one != str(one)


def test_zero_and_minus_zero_are_the_same_gene():
    plus, minus = Genome(np.zeros(17)), Genome(-np.zeros(17))
    assert plus == minus
    assert (hash(plus), str(plus)) == (hash(minus), str(minus))


def test_values_that_are_not_a_genome_are_rejected():
    good = Genome.random(Robot(), rng=rng(0)).values
    for bad in (good[:-1], good[:2], [], good[np.newaxis], np.zeros(count_genes(9)), 3.0):
        with pytest.raises(ValueError, match="a genome is a row of 4 genes plus 13 for each of its 1 to 8 segments"):
            Genome(bad)
    for bad in (np.nan, np.inf, -np.inf):
        with pytest.raises(ValueError, match=r"gene 3 .* not a finite number"):
            Genome(np.where(np.arange(len(good)) == 3, bad, good))


@given(genomes())
def test_a_genome_is_the_same_as_its_text_and_its_values(genome):
    assert Genome.of(genome) is genome
    for given_one in (str(genome), genome.values, genome.values.tolist(), tuple(genome.values)):
        assert Genome.of(given_one) == genome
    several = [genome, str(genome), genome.values]
    assert read_genomes(several) == read_genomes(np.tile(genome.values, (3, 1))) == [genome] * 3
    assert read_genomes(np.array([str(genome)], dtype=object)) == [genome]


def test_objects_that_are_not_numbers_are_rejected_with_an_explanation():
    for bad in ({}, object(), b"wl2", [None], "wl2".split, [[1], [2, 3]], [10**400] * 17):
        with pytest.raises(ValueError, match=r"must be a row of numbers|a genome is a row of 4 genes|finite number"):
            Genome.of(bad)
    for bad in (None, 3, b"wl2", Genome.random(Robot(), rng=rng(0))):
        with pytest.raises(GenomeError, match="a genome's text must be a str; got "):
            Genome.parse(bad)


def test_an_individual_is_accepted_in_place_of_its_genome():
    genome = Genome.random(Robot(), rng=rng(0))
    run = run_of_one(genome)
    evaluation = evaluation_of(genome)
    for one in (run.champion, evaluation, run.records.iloc[0], *run.records.itertuples()):
        assert Genome.of(one) == genome
    assert read_genomes([run.champion, evaluation]) == [genome, genome]
    assert read_genomes(run.records.genome) == [genome]
    settings = Settings().with_(duration=1)
    assert simulate(run.champion, settings).distance == simulate(genome, settings).distance


@pytest.mark.parametrize("read", [Genome.of, read_genomes])
def test_a_common_mistake_in_place_of_a_genome_is_explained(read):
    run = run_of_one(Genome.random(Robot(), rng=rng(0)))
    one = read == Genome.of
    for wrong, message in (
        (run, r"^this is a run, .*; pass run\.champion$" if one else r"several genomes.* run\.records\.genome$"),
        (
            run.records,
            r"^this is a table, .*; pass a cell of its column genome: table\.genome\[0\]$"
            if one
            else r"several genomes.* table\.genome$",
        ),
        (run.records[["fitness"]], "^this is a table" if one else "several genomes"),
        (Settings(), "^these are settings, .*pass the genome first"),
    ):
        with pytest.raises(TypeError, match=message):
            read(wrong)


def evaluation_of(genome):
    return Evaluation(
        genome=genome, fitness=1.0, verdict="ok", reason="", distance=1.0, velocity=0.1, n_segments=2, n_legs=2,
        weight=5.0, body_length=0.6,
    )  # fmt: skip


def run_of_one(genome):
    """Return a run of one robot."""
    row = {"generation": 0, "individual": 1, "born": 0, "parents": "", "operators": "random"}
    table = pd.DataFrame([{**row, **vars(evaluation_of(genome)), "genome": str(genome)}])
    return Run(Settings(), records.tidy_table(table))


def test_a_single_genome_is_rejected_where_several_are_expected():
    genome = Genome.random(Robot(), rng=rng(0))
    for single in (genome, str(genome), genome.values, run_of_one(genome).champion):
        with pytest.raises(ValueError, match="put it in a list"):
            read_genomes(single)
    for empty in ([], (), np.array([]), np.empty((0, 56))):
        assert read_genomes(empty) == []


@given(robots(), st.integers(0, 2**32 - 1))
def test_a_random_genome_depends_on_rng_only_and_obeys_the_limits(robot, seed):
    state = random.getstate()
    numpys = np.random.get_state()[1].tolist()  # noqa: NPY002
    genome = Genome.random(robot, rng=rng(seed))
    assert genome == Genome.random(robot, rng=rng(seed))
    assert (random.getstate(), np.random.get_state()[1].tolist()) == (state, numpys)  # noqa: NPY002
    assert obeys_every_limit(genome.values, robot)
    assert is_in_its_ranges(genome.values[np.newaxis], robot)
    assert np.array_equal(repair(genome.values[np.newaxis], robot)[0], genome.values)


def test_random_genomes_differ_and_reach_every_body_plan():
    drawn = generate_robot_population(Robot(), 3000, seed=1)
    assert len(np.unique(drawn, axis=0)) == 3000
    plans = {express(Genome(values)).plan for values in drawn}
    for n in range(2, 5):
        assert sum(len(plan) == n for plan in plans) == 2**n - 1 - n  # all but those with less than two pairs of legs


def test_weights_and_lengths_of_random_robots_fill_their_range():
    robot = Robot()
    bodies = [express(Genome(values)) for values in generate_robot_population(robot, 1000, seed=0)]
    weights = [body.weight for body in bodies]
    for found in (weights, [body.body_length for body in bodies]):
        assert Counter(np.round(found, 3)).most_common(1)[0][1] <= 50
    assert np.min(np.histogram(weights, bins=10, range=robot.weight)[0]) > 50
    for n in range(2, 5):
        lengths = [body.body_length for body in bodies if len(body.segments) == n]
        low, high = max(0.4, 0.2 * n), min(1.2, 0.5 * n)
        assert np.min(np.histogram(lengths, bins=4, range=(low - 1e-9, high + 1e-9))[0]) > 0.15 * len(lengths)


def test_random_robots_have_the_nominal_density_wherever_their_girth_allows_it():
    drawn = generate_robot_population(Robot(), 1000, seed=1)
    found = np.concatenate([densities(segment) for values in drawn for segment in express(Genome(values)).segments])
    assert found.min() >= 300
    assert found.max() <= 3000
    assert np.mean(np.isclose(found, DENSITY)) > 0.9


# ----------------------------------------------------------------------------------------------------- the text


VARIED = [
    Robot(),
    Robot(segments=(1, 8), body_length=(0.3, 3.0)),
    Robot(segments=(1, 1), legs=(2, 2), segment_length=(0.4, 0.5)),
    Robot(weight=(1.23456789, 1.23456789), body_length=(1 / 3, 2 / 3), segment_length=(0.1, 1 / 7)),
    Robot(leg_force=(0.1, 500.0), weight=(0.1, 200.0), segments=(3, 6), body_length=(0.7, 2.0)),
]


def test_ten_thousand_random_genomes_survive_the_text_form():
    for robot in VARIED:
        genes = build_genes(robot)
        drawn = rng(len(genes)).uniform(genes.low, genes.high, (2000, len(genes)))
        repaired = repair(drawn[:1000], robot)
        for values in (*repaired, *drawn[1000:]):
            assert Genome.parse(str(Genome(values))).values.tobytes() == (values + 0.0).tobytes()


@given(genomes())
def test_any_finite_numbers_survive_the_text_form(genome):
    assert Genome.parse(str(genome)) == genome
    word_by_word = str(genome).replace(" | ", "|\n")
    assert Genome.parse(word_by_word) == genome


def test_numbers_of_repaired_genomes_have_at_most_three_decimals():
    for values in generate_robot_population(Robot(), 50, seed=3):
        assert all(len(number) <= 3 for number in re.findall(r"\.(\d+)", str(Genome(values))))


def test_the_text_follows_the_order_of_the_body():
    text = str(Genome.random(Robot(segments=(2, 2)), rng=rng(0)))
    number = r"-?\d+(\.\d+)?"
    segment = rf"\| seg length={number} mass={number} (no)?legs (own|repeat) length={number} force={number}"
    swing = rf"amplitude={number} phase={number} offset={number}"
    step = rf"\| step hip {swing} knee {swing} stride={number}"
    gait = rf"\| gait frequency={number} lag={number} duty={number}"
    assert re.fullmatch(rf"wl2 segments=2 {segment} {segment} {gait} {step} {step}", text)


def test_a_text_may_be_edited():
    text = str(Genome.random(Robot(), rng=rng(0)))
    genome = Genome.parse(text)
    assert Genome.parse(text.replace(" ", "\n\t  ")) == genome
    assert Genome.parse(text.replace(" | ", "|")) == genome
    assert Genome.parse(f"  {text}\n") == genome
    edited = Genome.parse(re.sub(r"frequency=\S+", "frequency=+1.50e0", text))
    assert edited.values[1] == 1.5
    assert np.count_nonzero(edited.values != genome.values) <= 1


def error_message(text):
    with pytest.raises(GenomeError) as caught:
        Genome.parse(text)
    return str(caught.value)


def points_at(text, place):
    """Assert that a text is rejected with a number and a caret at this position; return the first line."""
    message = error_message(text)
    head, shown, caret = message.split("\n")
    assert int(re.search(r"at character (\d+) expected", head).group(1)) == place + 1
    assert caret.strip() == "^"
    assert shown[caret.index("^") :] == re.sub(r"[\0\x1b\u202e]", "�", re.sub(r"\s", " ", text[place : place + 30]))
    return head


SHORT = str(Genome.random(Robot(segments=(2, 2)), rng=rng(4)))
SHORT_OF_VERSION_1 = (
    "wl1 segments=2 | seg length=0.34 mass=3.59 legs length=0.441 force=3.4 "
    "| seg length=0.331 mass=8.41 nolegs length=0.399 force=2.753 | gait frequency=1.38 "
    "| step hip amplitude=0.733 phase=4.806 offset=0.391 knee amplitude=0.965 phase=1.66 offset=0.274 stride=4.078 "
    "| step hip amplitude=0.838 phase=0.135 offset=-0.794 knee amplitude=0.443 phase=4.351 offset=-0.108 stride=3.992"
)
both_versions = pytest.mark.parametrize("text", [SHORT, SHORT_OF_VERSION_1], ids=["version 2", "version 1"])


def starts(tokens):
    return [sum(len(token) + 1 for token in tokens[:i]) for i in range(len(tokens) + 1)]


@both_versions
def test_each_missing_word_is_pointed_at(text):
    tokens = text.split()
    for i, missing in enumerate(tokens):
        left = tokens[:i] + tokens[i + 1 :]
        at_end = i == len(left)
        head = points_at(" ".join(left), len(" ".join(left)) if at_end else starts(left)[i])
        assert f"got '{'the end of the text' if at_end else left[i]}'" in head
        if missing == "wl1":  # a text without a version has the current one
            assert "expected 'wl2'" in head
        elif missing != "seg":  # without its name a segment is taken for the gait
            assert f"'{missing.partition('=')[0]}" in head.partition(" expected ")[2].partition(", got ")[0]


@both_versions
def test_each_word_too_many_is_pointed_at(text):
    tokens = text.split()
    for i in range(len(tokens)):
        more = tokens[: i + 1] + tokens[i:]
        assert f"got '{tokens[i]}'" in points_at(" ".join(more), starts(more)[i + 1])


@both_versions
def test_each_two_words_in_the_wrong_order_are_pointed_at(text):
    tokens = text.split()
    for i, (one, other) in enumerate(pairwise(tokens)):
        swapped = [*tokens[:i], other, one, *tokens[i + 2 :]]
        assert f"got '{other}'" in points_at(" ".join(swapped), starts(swapped)[i])


@both_versions
def test_each_corrupt_word_is_pointed_at(text):
    tokens = text.split()
    for i, token in enumerate(tokens):
        key = token.partition("=")[0] if "=" in token else token
        bad = [f"{token}x", f"x{token}", token.upper(), "…", "0", "=", "\0", "\x1b[2J", "\u202e", "１"]
        bad += [
            f"{key}={number}"
            for number in ("", "nan", "inf", "1e999", "1e9999", "0x1", "1_0", "1,5", "--1", "1.2.3", "１", "١٢")
        ]
        for corrupt in bad:
            if "|" in corrupt:  # a bar is always a word by itself
                continue
            words = [*tokens[:i], corrupt, *tokens[i + 1 :]]
            assert f"got {corrupt!r}" in points_at(" ".join(words), starts(words)[i])


@both_versions
@pytest.mark.parametrize("blank", [" ", "\n", "\t", "\r\n", "  \n  ", "\v", "\u2028", "\u3000"])
def test_the_caret_points_at_the_position_for_any_white_space(blank, text):
    spaced = blank.join(text.replace("frequency", "freqency").split())
    assert "expected 'frequency=' and a number" in points_at(spaced, spaced.index("freqency"))


def test_too_many_segments_are_reported():
    most = str(Genome(np.zeros(count_genes(8))))
    one_more = most.replace("| gait", "| seg length=0 mass=0 nolegs own length=0 force=0 | gait")
    head = points_at(one_more, one_more.rindex("seg "))
    assert "after at most 8 segments" in head


@pytest.mark.parametrize(
    "text",
    [
        "x" * 10**6,
        "|" * 10**6,
        "|" * 19_999,
        " " * 10**6,
        "seg " * 4_999,
        "wl2 segments=" + "1" * 19_000 + "x",
        "wl2 segments=1." + "1" * 19_000 + "x",
        "wl2 segments=" + "1" * 19_000,
        "wl2 segments=2 | seg length=1e" + "9" * 19_000,
    ],
)
def test_huge_texts_are_rejected_quickly_with_a_short_message(text):
    begun = time.perf_counter()
    assert len(error_message(text)) < 400
    assert time.perf_counter() - begun < 0.5


def is_genome_or_rejected(text):
    try:
        genome = Genome.parse(text)
    except GenomeError as error:
        return "not a genome: at character " in str(error)
    return Genome.parse(str(genome)) == genome


@given(st.text())
def test_any_text_is_a_genome_or_rejected(text):
    assert is_genome_or_rejected(text)
    for version in (1, 2):
        assert is_genome_or_rejected(f"wl{version} segments={text}")


words = st.sampled_from([*dict.fromkeys(SHORT.split()), "legs=0.5", "length=-1", "length=.", "|seg", "12", "١٢", "²"])


edit_lists = st.lists(st.tuples(st.integers(0, len(SHORT)), st.integers(0, 9), st.text(max_size=4) | words), max_size=4)


@both_versions
@hypothesis_settings(max_examples=100)
@given(edits=edit_lists)
def test_a_mutated_text_is_a_genome_or_rejected(edits, text):
    for start, n_lost, new in edits:
        text = text[:start] + new + text[start + n_lost :]
    assert is_genome_or_rejected(text)


@given(st.lists(words, max_size=60))
def test_words_in_any_order_are_a_genome_or_rejected(several):
    assert is_genome_or_rejected(" ".join(["wl2", "segments=1", "|", *several]))


# --------------------------------------------------------------------------------------------------- the limits


@st.composite
def limits_and_tables(draw):
    robot = draw(robots())
    return robot, draw(tables(robot))


@hypothesis_settings(max_examples=200)
@given(limits_and_tables())
def test_repaired_genomes_obey_every_limit_and_are_not_changed_again(drawn):
    robot, anything = drawn
    before = anything.copy()
    repaired = repair(anything, robot)
    assert np.array_equal(anything, before)
    assert repaired is not anything
    assert is_in_its_ranges(repaired, robot)
    assert all(obeys_every_limit(values, robot) for values in repaired)
    assert repair(repaired, robot).tobytes() == repaired.tobytes()


@hypothesis_settings(max_examples=25)
@given(limits_and_tables())
def test_repair_treats_each_genome_separately(drawn):
    robot, anything = drawn
    alone = [repair(row[np.newaxis], robot)[0] for row in anything]
    assert np.array_equal(repair(anything, robot), alone)
    assert repair(anything[:0], robot).shape == (0, anything.shape[1])


@hypothesis_settings(max_examples=25)
@given(st.integers(0, 2**32 - 1))
def test_repair_changes_only_lengths_masses_and_legs_of_grown_segments(seed):
    robot = Robot()
    genes = build_genes(robot)
    inside = np.round(rng(seed).uniform(genes.low, genes.high, (20, len(genes))), 3)
    values = np.where(genes.is_count, np.rint(inside), np.where(inside < genes.high, inside, genes.low))
    repaired = repair(values, robot)
    free = [i for i, name in enumerate(genes.names) if name.rpartition(".")[2] not in ("length", "mass", "legs")]
    assert np.array_equal(repaired[:, free], values[:, free])
    unexpressed = np.arange(genes.n_parts) >= genes.n_expressed(values)[:, np.newaxis]
    assert np.array_equal(genes.parts(repaired)[unexpressed], genes.parts(values)[unexpressed])


def test_repair_rejects_other_shapes_and_infinite_values():
    robot = Robot()
    good = generate_robot_population(robot, 3, seed=0)
    for bad in (good[0], good[:, :-1], good[np.newaxis], np.zeros((3, 0))):
        with pytest.raises(
            ValueError, match=re.escape(f"must have the shape (n, 56) for these limits; got {bad.shape}")
        ):
            repair(bad, robot)
    for bad in (np.nan, np.inf, -np.inf):
        with pytest.raises(ValueError, match=f"genome 2: seg1.mass is {bad}; it must be a finite number"):
            repair(np.where((np.arange(3 * 56) == 2 * 56 + 5).reshape(3, 56), bad, good), robot)


def test_robots_at_the_lightest_and_heaviest_weight_have_plausible_densities():
    for robot in (
        Robot(weight=(0.1, 0.1)),
        Robot(weight=(200, 200)),
        Robot(weight=(40, 60)),
        Robot(weight=(170, 170), body_length=(1.2, 1.2), segments=(3, 3)),
    ):
        for values in generate_robot_population(robot, 100, seed=2):
            assert obeys_every_limit(values, robot)


@hypothesis_settings(max_examples=100)
@given(genomes(), robots())
def test_any_genome_can_be_brought_within_any_limits(genome, robot):
    fitted = genome.within(robot)
    assert obeys_every_limit(fitted.values, robot)
    assert is_in_its_ranges(fitted.values[np.newaxis], robot)
    assert fitted.within(robot) == fitted


@hypothesis_settings(max_examples=50)
@given(robots(), robots(), st.integers(0, 2**32 - 1))
def test_a_genome_within_wider_limits_keeps_its_robot(narrow, wide, seed):
    genome = Genome.random(narrow, rng=rng(seed))
    assert genome.within(narrow) == genome
    roomy = Robot(
        weight=(0.1, 200.0),
        body_length=(0.05, 8.0),
        segments=(1, 8),
        segment_length=(0.05, 2.0),
        legs=(2, 16),
        leg_force=(0.1, 500.0),
    )
    bodies = [express(one) for one in (genome, genome.within(roomy))]
    assert [one.plan for one in bodies] == [bodies[0].plan] * 2
    assert bodies[1].weight == pytest.approx(bodies[0].weight, abs=0.005)
    assert bodies[1].body_length == pytest.approx(bodies[0].body_length, abs=0.005)
    assert obeys_every_limit(genome.within(roomy).within(wide).values, wide)


@hypothesis_settings(max_examples=40)
@given(robots(), st.lists(finite, min_size=1))
def test_only_grown_segments_are_expressed(robot, noise):
    values = generate_robot_population(robot, 1, seed=len(noise))[0]
    n_expressed = int(values[0])
    other = np.where(np.arange(len(values)) < count_genes(n_expressed), values, np.resize(noise, len(values)))
    assert express(Genome(values)) == express(Genome(other))
    assert len(express(Genome(values)).segments) == n_expressed


@pytest.mark.parametrize("mutation", Mutation)
@pytest.mark.parametrize("crossover", Crossover)
@hypothesis_settings(max_examples=6)
@given(data=st.data())
def test_every_robot_obeys_every_limit_after_any_operator(crossover, mutation, data):
    robot = data.draw(robots())
    algorithm = Algorithm(
        crossover=[crossover, *data.draw(st.lists(st.sampled_from(Crossover), max_size=1))],
        mutation=[mutation, *data.draw(st.lists(st.sampled_from(Mutation), max_size=1))],
        mutation_rate=data.draw(st.sampled_from([0.08, 1.0]) | st.floats(0, 1)),
        mutation_scale=data.draw(st.sampled_from([0.2, 2.0]) | st.floats(0, 2)),
        favored_gene=data.draw(st.sampled_from(Feature)),
        seed=data.draw(st.integers(0, 2**31 - 1)),
    )
    fitness = np.array(data.draw(st.lists(st.floats(-1e6, 1e6), min_size=6, max_size=6)))
    population = generate_robot_population(robot, 6, seed=algorithm.seed)
    for generation in (1, 2):
        children = crossover_population(population, fitness, 6, robot, algorithm, generation=generation)
        population = mutate_population(children.genomes, robot, algorithm, generation=generation)
        assert is_in_its_ranges(population, robot)
        assert all(obeys_every_limit(values, robot) for values in population)
