"""A notebook shows errors as a short message; a script shows Python's traceback."""

import pytest

import walkerlab as wl
from walkerlab.system.errors import WalkerlabError

PUBLIC_ERRORS = (wl.SettingsError, wl.GenomeError, wl.RunFileError, wl.OperatorError)
CELL = """
def my_mutation(genomes, genes, *, rng):
    return genomes[0]

s = wl.Settings().with_(mutation=my_mutation)
run = wl.evolve(s)
"""


def test_all_public_value_errors_have_the_short_display():
    assert all(issubclass(error, WalkerlabError) and issubclass(error, ValueError) for error in PUBLIC_ERRORS)


def test_a_notebook_shows_the_line_of_the_cell_the_message_and_the_notes():
    with pytest.raises(wl.OperatorError) as caught:
        exec(compile(CELL, "/tmp/ipykernel_1/2.py", "exec"), {"wl": wl})
    caught.value.add_note("A note.")
    cell_line, message, note = caught.value._render_traceback_()
    assert cell_line.startswith("In line 6 of the cell")
    assert message.startswith("OperatorError: mutation 'my_mutation' must return genomes")
    assert note == "A note."
