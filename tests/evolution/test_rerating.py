"""Resumed runs: they never mix the ratings of two fitness functions, and their files record the functions."""

from concurrent.futures import ThreadPoolExecutor
from functools import partial

import numpy as np
import pandas as pd
import pytest

import walkerlab as wl
from walkerlab.runfile import provenance, store
from walkerlab.runfile.provenance import source_digest
from walkerlab.settings.values import number_text

SETTINGS = wl.Settings().with_(duration=1, population_size=4, generations=2, n_elites=1, seed=1, mutation_rate=0.5)
same = partial(pd.testing.assert_frame_equal, check_exact=True)
FACTOR = 1.0


@pytest.fixture(scope="module")
def threads():
    with ThreadPoolExecutor(1) as pool:
        yield pool


def times(factor):
    def f(walk):
        return factor * walk.distance

    return f


def another_f():
    def f(walk):
        return 100 * walk.distance

    return f


class Scorer:
    def __init__(self, factor):
        self.factor = factor

    def __call__(self, walk):
        return self.factor * walk.distance

    def rate(self, walk):
        return self.factor * walk.distance


def by_global(walk):
    return FACTOR * walk.distance


@pytest.fixture
def begin(threads, tmp_path):
    """Return a function that evolves two generations with a fitness, and returns one that resumes them to a third."""
    path = tmp_path / "m.walk"

    def begun(fitness, **changes):
        wl.evolve(SETTINGS.with_(fitness=fitness, **changes), path, threads, progress=False)
        return partial(wl.resume, path, 3, threads, progress=False)

    return begun


@pytest.mark.parametrize(("first", "second"), [
    (times(1), another_f()), (times(1), times(100)), (Scorer(1), Scorer(100)), (Scorer(1).rate, Scorer(100).rate),
    (lambda walk: walk.distance, lambda walk: 100 * walk.distance),
], ids=["source", "closure", "object", "method", "lambda"])  # fmt: skip
def test_a_changed_fitness_raises_and_the_file_is_unchanged(first, second, begin, tmp_path):
    resume = begin(first)
    path = tmp_path / "m.walk"
    before = path.read_bytes()
    run = wl.load(path)
    with pytest.raises(
        wl.RunFileError, match="is not resumed, because its fitness function may have changed"
    ) as caught:
        resume(fitness=second)
    last = run.records[run.records.generation == 1]
    best = last.loc[last.fitness.idxmax()]
    stored, now = number_text(float(best.fitness)), number_text(float(100 * best.fitness))
    assert f"Robot {best.individual} of generation 1 has fitness {stored} in the file, and {now} with" in str(
        caught.value
    )
    assert "rerate=True)" in str(caught.value)
    assert "wl.evolve(wl.load(" in str(caught.value)
    assert path.read_bytes() == before


def test_a_changed_global_of_a_fitness_is_detected_by_the_ratings(begin, monkeypatch):
    resume = begin(by_global)
    monkeypatch.setattr(f"{__name__}.FACTOR", 2.0)
    with pytest.raises(wl.RunFileError, match="may have changed"):
        resume(fitness=by_global)


@pytest.mark.parametrize("fitness", [times(1), Scorer(3.0), by_global, lambda walk: walk.distance])
def test_an_unchanged_fitness_resumes_to_the_uninterrupted_table(fitness, begin, threads):
    resumed = begin(fitness)(fitness=fitness)
    whole = wl.evolve(SETTINGS.with_(fitness=fitness, generations=3), executor=threads, progress=False)
    same(resumed.records, whole.records)
    assert resumed.records.attrs == whole.records.attrs


def test_a_new_source_with_the_same_ratings_resumes_and_is_recorded(begin, tmp_path):
    def f(walk):
        return walk.distance if walk.counts else 0.0

    begin(times(1))(fitness=f)
    made_with = store.read_facts(tmp_path / "m.walk")[1]
    assert made_with["fitness function"] == f"f (source {source_digest(f)})"
    assert source_digest(f) != source_digest(times(1))


def test_after_rerating_no_generation_mixes_ratings_and_no_old_rating_is_reused(begin, threads, tmp_path):
    path = tmp_path / "m.walk"
    copies = {"mutation_rate": 0.0, "crossover": "none"}  # children that have walked before
    begin(times(100), **copies)(fitness=times(1), rerate=True)
    run = wl.load(path)
    table = run.records
    counts = table.verdict == "ok"
    factors = (table.fitness / table.distance)[counts].round(9)
    assert factors.groupby(table.generation).unique().map(list).to_dict() == {0: [100.0], 1: [100.0], 2: [1.0]}
    assert run.rated_since == 2
    assert run.champion.fitness == table.fitness[table.generation == 2].max() < table.fitness.max()
    assert store.read_facts(path)[1][provenance.RATED_SINCE] == "2"
    longer = wl.resume(path, 4, threads, progress=False, fitness=times(1))
    last = longer.records[longer.records.generation == 3]
    np.testing.assert_allclose(last.fitness[last.verdict == "ok"], last.distance[last.verdict == "ok"])
    assert longer.rated_since == 2
    assert wl.load(path).champion == longer.champion


def test_rerating_without_a_difference_equals_the_uninterrupted_run(begin, threads):
    run = begin(times(1))(fitness=times(1), rerate=True)
    same(run.records, wl.evolve(SETTINGS.with_(fitness=times(1), generations=3), None, threads, progress=False).records)
    assert run.rated_since == 0


def test_an_error_while_rerating_names_the_robot_and_leaves_the_file_unchanged(begin, tmp_path):
    def f(walk):
        return walk.distance if len(walk.time) > 100 else 1 / 0  # as in the walk that checks the function

    resume = begin(times(1))
    with pytest.raises(wl.OperatorError, match=r"for individual \d+ of generation 1, rated again"):
        resume(fitness=f)
    assert wl.load(tmp_path / "m.walk").n_generations == 2


@pytest.mark.filterwarnings("ignore:.* was made with mujoco")
def test_with_other_versions_the_recorded_source_decides(begin, monkeypatch):
    resume = begin(times(1))
    here = provenance.current_facts()
    monkeypatch.setattr(provenance, "current_facts", lambda: {**here, "mujoco": "9.9"})
    with pytest.raises(wl.RunFileError, match="other versions or on another processor"):
        resume(fitness=times(2))
    assert resume(fitness=times(1)).n_generations == 3


def test_a_changed_operator_warns_and_is_recorded(begin, tmp_path):
    def make(step):
        def nudge(genomes, genes, *, rng):
            return genomes + step * rng.normal(size=genomes.shape)

        return nudge

    resume = begin("distance", mutation=make(0.01))
    with pytest.warns(UserWarning, match="different code for its mutation"):
        resume(mutation=make(0.02))
    assert source_digest(make(0.02)) in store.read_facts(tmp_path / "m.walk")[1]["mutation function"]


def test_a_built_in_function_does_not_replace_a_user_function_of_the_same_name(begin):
    def distance(walk):
        return 100 * walk.distance

    resume = begin(distance)
    for other in ("distance", wl.fitness.distance):
        with pytest.raises(wl.RunFileError, match="was made with user functions"):
            resume(fitness=other)


def test_a_digest_depends_on_the_code_and_the_values_of_a_function():
    def f(walk, k=1):
        return k * walk.distance

    first = f

    def f(walk, k=1):  # a comment
        return k * walk.distance  # and another

    assert source_digest(first) == source_digest(f)

    def f(walk, k=2):
        return k * walk.distance

    digests = [source_digest(one) for one in (first, f, times(1), times(2), Scorer(1), Scorer(2), Scorer(1).rate)]
    assert len(set(digests)) == len(digests)
    assert None not in digests
    assert source_digest(partial(f, 3)) == source_digest(f)
    assert source_digest(times(times(1))) not in (None, source_digest(times(times(2))))
    assert source_digest(times(object())) is source_digest(max) is None
    names = {}
    exec("def g(walk): return 1.0", names)
    assert source_digest(names["g"]) is None
    one, other = lambda walk: 1, lambda walk: 2
    assert source_digest(one) is None or source_digest(one) != source_digest(other)
