"""Each term has an explanation, which is found by the names of settings and columns."""

import re

import pytest

from walkerlab.settings.terms import TERMS, explain_term


@pytest.mark.parametrize("term", TERMS)
def test_a_term_is_explained_without_repeating_it(term):
    assert TERMS[term].endswith(".")
    assert TERMS[term][0].isupper()
    assert not re.match(rf"(an? )?{term}\b", TERMS[term], re.IGNORECASE)


@pytest.mark.parametrize(
    ("name", "term"), [("n_elites", "elite"), ("generations", "generation"), ("fitness", "fitness"), ("N·m", "N·m")]
)
def test_terms_are_found_by_the_names_of_settings_and_units(name, term):
    assert explain_term(name) == TERMS[term]


def test_other_names_have_no_explanation():
    assert explain_term("step_height") == explain_term("") == ""
