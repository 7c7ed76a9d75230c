"""Fixtures for the tests of several components: an executor, and a finished run."""

from concurrent.futures import ThreadPoolExecutor

import pytest

import walkerlab as wl


@pytest.fixture(scope="module")
def pool():
    with ThreadPoolExecutor(2) as workers:
        yield workers


@pytest.fixture(scope="session")
def done():
    settings = wl.Settings().with_(population_size=6, generations=4, duration=1)
    with ThreadPoolExecutor(2) as workers:
        return wl.evolve(settings, executor=workers, progress=False)
