"""The microscope shows the birth that the operators make, on bodies and in the text of the genome."""

import numpy as np
import pytest

import walkerlab as wl
from walkerlab.analysis.mating import mate
from walkerlab.settings.choices import Crossover, Mutation
from walkerlab.system.randomness import random_stream
from walkerlab.widgets.genome_words import genome_lines
from walkerlab.widgets.microscope import Microscope

SETTINGS = wl.Settings()
GENOMES = [wl.Genome(values) for values in wl.generate_robot_population(SETTINGS.robot, 3, seed=1)]


def words_of(birth):
    return [word for line in genome_lines(birth) for word in line]


def test_the_words_of_a_genome_are_its_text_and_contain_every_gene():
    birth = mate(*GENOMES[:2], SETTINGS, rng=np.random.default_rng(0), mutates=True)
    words = words_of(birth)
    assert [word["text"] for word in words] == str(birth.genome).replace(" |", "").split()
    assert sorted(word["gene"] for word in words if word["gene"]) == sorted(birth.genes.names)
    table = birth.table.set_index("gene")
    for word in words:
        if word["gene"]:
            row = table.loc[word["gene"]]
            assert bool(word["change"]) == (row.change != 0)
            assert word["sign"].startswith("=" if row.origin == "same" else row.origin)
            assert word["faint"] == (not row.expressed)


def test_every_operator_can_be_chosen_and_applied_again():
    microscope = Microscope(GENOMES)
    seen = set()
    for mode, names in {"cross": [one.name for one in Crossover], "mutate": [one.name for one in Mutation]}.items():
        microscope.mode = mode
        for name in names:
            setattr(microscope, "crossover" if mode == "cross" else "mutation", name)
            assert not microscope.fault
            assert microscope.birth.operators == (name,)
            seen.add(str(microscope.birth.genome))
    assert len(seen) > len(Crossover)
    microscope.rate = 0.3
    before = microscope.birth.genome
    microscope._handle_custom_msg("again", [])
    assert microscope.birth.genome != before
    expected = wl.analysis.mutate(
        GENOMES[0],
        SETTINGS.with_(mutation=microscope.mutation, mutation_rate=0.3),
        rng=random_stream(1, "analysis", 0),
    )
    assert microscope.birth.genome == expected.genome


def test_a_function_of_the_settings_is_offered_first_and_its_error_is_shown():
    def broken(genomes, genes, *, rng):
        return genomes[0]

    microscope = Microscope(GENOMES, SETTINGS.with_(mutation=broken))
    microscope.mode = "mutate"
    assert microscope.choices["mutations"][0] == microscope.mutation == "broken"
    assert "broken" in microscope.fault
    assert microscope.birth is None
    assert "broken" in microscope.snapshot()
    microscope.mutation = "gaussian"
    assert not microscope.fault


def test_a_run_offers_the_robots_of_a_generation_and_explains_births(done):
    microscope = Microscope(done)
    microscope.set_state({"generation": 1})
    listed = {robot["value"] for robot in microscope.choices["robots"]}
    assert listed == set(done.records.query("generation == 1").individual)
    assert {microscope.first, microscope.second} <= listed
    microscope.mode = "explain"
    child = done.records.query("parents != ''").individual.iloc[-1]
    microscope.robot = int(child)
    assert str(microscope.birth.genome) == done.records.query("individual == @child").genome.iloc[0]
    microscope.robot = 0
    assert "robot 0 has no parents" in microscope.fault


def test_one_genome_is_too_few():
    with pytest.raises(ValueError, match="source must contain at least two genomes"):
        Microscope(GENOMES[:1])
