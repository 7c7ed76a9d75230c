"""The algorithm needs at least one child in each generation."""

from tests.settings.cases import (
    error_message,
)
from walkerlab.settings.algorithm import Algorithm


def test_elites_must_be_fewer_than_the_population():
    message = error_message(Algorithm, population_size=10, n_elites=10)
    assert "Algorithm.n_elites is 10" in message
    assert "Algorithm.population_size" in message
    assert Algorithm(population_size=10, n_elites=9).n_elites == 9
