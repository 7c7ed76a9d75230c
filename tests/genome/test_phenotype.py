"""The robot that a genome expresses: genes with an effect, repeated legs and their lag, and the course of a stride."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import settings as hypothesis_settings
from hypothesis import strategies as st

from tests.genome.test_genome import densities, in_range, obeys_every_limit
from tests.strategies import finite, robots, tables
from walkerlab.genome.features import DUTY_RANGE, build_genes, is_expressed
from walkerlab.genome.genome import Genome
from walkerlab.genome.phenotype import express, stride_angle
from walkerlab.genome.repair import repair
from walkerlab.settings.proportions import DENSITY_RANGE
from walkerlab.settings.robot import Robot

CHANGE = 0.125  # of a gene, in its unit

FOUR_PAIRS = Robot(segments=(4, 4), legs=(8, 8))


@st.composite
def limits_and_genomes(draw):
    """Return limits and the genes of a robot within them."""
    robot = draw(robots())
    return robot, repair(draw(tables(robot, n=1)), robot)[0]


def expressed_genes(values):
    return is_expressed(values[np.newaxis])[0]


def random_values(robot, seed):
    return Genome.random(robot, rng=np.random.default_rng(seed)).values.copy()


# ---------------------------------------------------------------------------------------------- genes with an effect


@hypothesis_settings(max_examples=60)
@given(limits_and_genomes(), st.lists(finite, min_size=1))
def test_changing_unexpressed_genes_never_changes_the_robot(drawn, noise):
    robot, values = drawn
    changed = np.where(expressed_genes(values), values, np.resize(noise, len(values)))
    assert express(Genome(changed)) == express(Genome(values))
    assert express(Genome(changed).within(robot)) == express(Genome(values))


@hypothesis_settings(max_examples=60)
@given(limits_and_genomes())
def test_changing_any_expressed_gene_changes_the_robot(drawn):
    robot, values = drawn
    genes = build_genes(robot)
    body = express(Genome(values))
    for index in np.flatnonzero(expressed_genes(values) & ~genes.is_count):
        changed = values.copy()
        changed[index] += CHANGE
        assert express(Genome(changed)) != body, genes.names[index]
    for index in np.intersect1d(np.flatnonzero(expressed_genes(values)), genes.find("legs")):
        changed = values.copy()
        changed[index] = 1 - changed[index]
        assert express(Genome(changed)).plan != body.plan


def test_the_genes_of_any_numbers_are_expressed_as_those_of_the_nearest_counts():
    values = random_values(FOUR_PAIRS, 0)
    for wanted, n_segments in ((-3, 0), (0, 0), (1.4, 1), (2.6, 3), (1e300, 4)):
        values[0] = wanted
        assert len(express(Genome(values)).segments) == n_segments
        assert expressed_genes(values)[build_genes(FOUR_PAIRS).find("length")].sum() == n_segments


# ------------------------------------------------------------------------------------------------------ repeated legs


@hypothesis_settings(max_examples=40)
@given(st.integers(0, 2**32 - 1), st.lists(st.booleans(), min_size=4, max_size=4))
def test_repeated_legs_are_those_in_front_with_a_lag_for_each_segment_between(seed, repeats):
    genes = build_genes(FOUR_PAIRS)
    values = random_values(FOUR_PAIRS, seed)
    values[genes.find("repeat")] = repeats
    (lag,) = values[genes.find("lag")]
    legs = [segment.legs for segment in express(Genome(values)).segments]
    for number in range(1, 4):
        if repeats[number]:
            in_front = legs[number - 1]
            assert legs[number] == replace(in_front, phase=legs[number].phase)
            assert legs[number].phase == pytest.approx(in_front.phase - lag)
        else:
            own = {name: values[genes.find(name)][number] for name in ("leg_length", "leg_force", "stride")}
            assert (legs[number].length, legs[number].force, legs[number].stride) == tuple(own.values())
            assert legs[number].phase == pytest.approx(values[genes.find("hip_phase")][number] - number * lag)


@given(st.integers(0, 2**32 - 1), st.integers(0, 3))
def test_the_first_legs_have_nothing_to_repeat(seed, n_without_legs):
    robot = Robot(segments=(4, 4), legs=(2, 8))
    genes = build_genes(robot)
    values = random_values(robot, seed)
    values[genes.find("legs")] = np.arange(4) >= n_without_legs
    bodies = []
    for repeat in (0, 1):
        values[genes.find("repeat")[n_without_legs]] = repeat
        assert not expressed_genes(values)[genes.find("repeat")[n_without_legs]]
        bodies.append(express(Genome(values)))
    assert bodies[0] == bodies[1]


@pytest.mark.parametrize("own_end", ["low", "high"])
@pytest.mark.parametrize("front_end", ["low", "high"])
@pytest.mark.parametrize("mass_end", ["low", "high"])
def test_mass_limits_of_repeated_legs_are_those_of_the_legs_that_they_repeat(own_end, front_end, mass_end):
    robot = Robot(weight=(0.5, 60.0), segments=(4, 4), legs=(8, 8))
    genes = build_genes(robot)
    values = random_values(robot, 0)
    values[genes.find("repeat")] = 1
    leg_length = genes.find("leg_length")
    values[leg_length] = getattr(genes, own_end)[leg_length]
    values[leg_length[0]] = getattr(genes, front_end)[leg_length[0]]
    values[genes.find("mass")] = getattr(genes, mass_end)[genes.find("mass")]
    repaired = repair(values[np.newaxis], robot)[0]
    body = express(Genome(repaired))
    assert obeys_every_limit(repaired, robot)
    assert [segment.legs.length for segment in body.segments] == [values[leg_length[0]]] * 4
    assert all(in_range(density, DENSITY_RANGE) for segment in body.segments for density in densities(segment))


# ---------------------------------------------------------------------------------------------- the course of a stride

duties = st.sampled_from([*DUTY_RANGE, 0.5]) | st.floats(*DUTY_RANGE)
STRIDES = np.arange(-2000, 2000) / 1000 + 0.0003


@given(duties)
def test_the_angle_of_a_stride_increases_continuously_by_a_full_turn(duty):
    angles = stride_angle(STRIDES, duty)
    steps = np.mod(np.diff(angles), math.tau)
    fastest = math.pi / min(duty, 1 - duty)  # rad per stride
    assert (steps > 0).all()
    assert (steps <= fastest / 1000 + 1e-9).all()
    assert np.unwrap(angles)[1000::1000] - np.unwrap(angles)[:-1000:1000] == pytest.approx(math.tau)
    assert stride_angle(STRIDES[1000:], duty) == pytest.approx(angles[:-1000])


@given(duties)
def test_the_thigh_swings_backward_in_the_share_of_the_stride_given_by_the_duty(duty):
    hips = np.sin(stride_angle(STRIDES, duty))
    assert np.mean(np.diff(hips) < 0) == pytest.approx(duty, abs=0.002)


@given(st.lists(st.floats(-1000, 1000), min_size=1))
def test_with_a_duty_of_half_the_joints_move_in_a_sine(strides):
    angles = stride_angle(np.array(strides), 0.5)
    expected = math.tau * np.array(strides)
    assert np.sin(angles) == pytest.approx(np.sin(expected), abs=1e-9)
    assert np.cos(angles) == pytest.approx(np.cos(expected), abs=1e-9)
