"""In a notebook, what is wrong is said in a few words; in a script, Python's own traceback stands."""

import pytest

import walkerlab as wl
from walkerlab.faults import Fault

FAULTS = (wl.SettingsError, wl.GenomeError, wl.RunFileError, wl.OperatorError)
CELL = """
def my_mutation(genomes, genes, *, rng):
    return genomes[0]

s = wl.Settings().with_(mutation=my_mutation)
run = wl.evolve(s)
"""


def test_all_of_ours_speak_in_words():
    assert all(issubclass(fault, Fault) and issubclass(fault, ValueError) for fault in FAULTS)


def test_a_notebook_shows_the_line_that_asked_and_the_words():
    names = {"wl": wl}
    with pytest.raises(wl.OperatorError) as caught:
        exec(compile(CELL, "/tmp/ipykernel_1/2.py", "exec"), names)
    caught.value.add_note("So it goes on.")
    asked, words, note = caught.value._render_traceback_()
    assert asked.startswith("In line 6 of the cell")
    assert words.startswith("OperatorError: mutation 'my_mutation' must return genomes")
    assert note == "So it goes on."
