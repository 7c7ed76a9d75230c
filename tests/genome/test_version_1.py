"""Genomes of version 0.1: their texts are read, and express the same robots."""

import math
import re
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import walkerlab as wl
from walkerlab.genome.features import build_genes
from walkerlab.genome.genome import Genome
from walkerlab.genome.phenotype import Legs, Segment, Swing, express
from walkerlab.genome.text import is_of_version_1
from walkerlab.settings.robot import Robot
from walkerlab.world.scene import CONTROL_RATE, RAMP_TIME

TEXTS = sorted(set(pd.read_csv(Path(__file__).parents[1] / "kept" / "records.csv").genome))
SETTINGS = wl.Settings().with_(segments=(1, 4), legs=(2, 8), timestep=0.005)


def numbers(part):
    """Return the numbers in a part of a text, in order."""
    return [float(number) for number in re.findall(r"=(\S+)", part)]


def split_parts(text):
    """Split a text of version 1 into its head, its segments, its gait and its steps, without ``Genome``."""
    parts = text.split(" | ")
    n_segments = sum(part.startswith("seg ") for part in parts)
    assert len(parts) == 2 + 2 * n_segments
    return parts[0], parts[1 : 1 + n_segments], parts[1 + n_segments], parts[2 + n_segments :]


def expected_segment(segment, step):
    length, mass, leg_length, force = numbers(segment)
    hip_amplitude, hip_phase, hip_offset, knee_amplitude, knee_phase, knee_offset, stride = numbers(step)
    hip = Swing(hip_amplitude, 0.0, hip_offset)
    knee = Swing(knee_amplitude, knee_phase, knee_offset)
    legs = Legs(leg_length, force, hip_phase, stride, hip, knee)
    return Segment(length, mass, legs if " legs " in segment else None)


def test_the_texts_are_of_several_sizes():
    assert len(TEXTS) > 10
    assert {text.split()[1] for text in TEXTS} == {f"segments={n}" for n in (1, 2, 3, 4)}
    assert all(is_of_version_1(text) for text in (*TEXTS, f"\n  {TEXTS[0]}"))


@pytest.mark.parametrize("text", TEXTS)
def test_a_robot_of_version_1_has_its_own_legs_and_no_lag_and_a_duty_of_half(text):
    head, segments, gait, steps = split_parts(text)
    body = express(text)
    n_expressed = int(head.removeprefix("wl1 segments="))
    assert body.segments == tuple(map(expected_segment, segments[:n_expressed], steps))
    assert [body.frequency] == numbers(gait)
    assert body.duty == 0.5


@pytest.mark.parametrize("text", TEXTS)
def test_a_genome_of_version_1_survives_the_text_form_of_version_2(text):
    genome = Genome.parse(text)
    assert str(genome).startswith("wl2 ")
    assert Genome.parse(str(genome)) == genome
    assert not is_of_version_1(str(genome))
    assert Genome.parse(text.replace(" ", "\n ")) == genome
    genes = build_genes(Robot())
    for feature, value in (("lag", 0.0), ("duty", 0.5), ("repeat", 0.0)):
        assert (genome.values[genes.find(feature)] == value).all()


@pytest.mark.parametrize("text", TEXTS[::3])
def test_joints_of_a_robot_of_version_1_move_in_a_sine(text):
    head, segments, gait, steps = split_parts(text)
    n_expressed = int(head.removeprefix("wl1 segments="))
    (frequency,) = numbers(gait)
    n_steps = 300
    time = np.floor(np.arange(n_steps) * SETTINGS.simulation.timestep * CONTROL_RATE + 1e-9) / CONTROL_RATE
    ramp = np.minimum(time / RAMP_TIME, 1.0)
    expected = []
    for segment, step in zip(segments[:n_expressed], steps, strict=False):
        if " legs " in segment:
            hip_amplitude, hip_phase, hip_offset, knee_amplitude, knee_phase, knee_offset, stride = numbers(step)
            for behind in (0.0, stride):
                angle = math.tau * frequency * time + hip_phase - behind
                expected += [hip_offset + ramp * hip_amplitude * np.sin(angle)]
                expected += [knee_offset + ramp * knee_amplitude * np.sin(angle + knee_phase)]
    controls = wl.compile_scene(text, SETTINGS).controls(n_steps)
    assert controls == pytest.approx(np.array(expected).T, abs=1e-9)


@pytest.mark.parametrize("word", ["lag=0", "duty=0.5"])
def test_words_of_version_2_are_rejected_in_a_text_of_version_1(word):
    text = re.sub(r"(frequency=\S+)", rf"\1 {word}", TEXTS[0])
    with pytest.raises(wl.GenomeError, match=rf"at character {text.index(word) + 1} expected '\|', got '{word}'"):
        Genome.parse(text)
    repeated = TEXTS[0].replace("legs length", "legs own length", 1)
    with pytest.raises(wl.GenomeError, match=r"expected 'length=' and a number, .* got 'own'"):
        Genome.parse(repeated)
