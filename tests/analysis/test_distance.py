"""The aligned distance compares bodies of different size segment by segment."""

import numpy as np
import pytest

import walkerlab as wl
from walkerlab.genome.features import build_genes


@pytest.fixture(scope="module")
def genomes():
    return [wl.Genome(values) for values in wl.generate_robot_population(wl.Robot(), 30, seed=2)]


def test_it_is_a_distance_between_0_and_1(genomes):
    distances = wl.analysis.aligned_distances(genomes)
    assert distances.shape == (30, 30)
    assert np.allclose(distances, distances.T)
    assert (np.diag(distances) == 0).all()
    assert (distances[~np.eye(30, dtype=bool)] > 0).all()
    assert distances.max() <= 1
    sides = distances[:, :, None] + distances[None, :, :]  # from i over j to k
    assert (sides.swapaxes(0, 1).min(axis=0) >= distances - 1e-12).all()


def test_genes_without_effect_do_not_count(genomes):
    genes = build_genes(wl.Robot())
    for genome in genomes[:8]:
        n_expressed = round(genome.values[genes.count])
        hidden = genome.values.copy()
        hidden[genes.n_whole + n_expressed * 13 :] = genes.low[genes.n_whole + n_expressed * 13 :]
        assert wl.analysis.aligned_distances([genome, wl.Genome(hidden)])[0, 1] == 0


def test_an_unmatched_segment_counts_fully_and_its_values_do_not_matter(genomes):
    genes = build_genes(wl.Robot())
    genome = next(each for each in genomes if 2 <= each.values[genes.count] < genes.n_parts)
    shorter = genome.values.copy()
    shorter[genes.count] -= 1
    longer = [genome.values.copy() for _ in range(2)]
    last = genes.n_whole + 13 * (round(genome.values[genes.count]) - 1)
    longer[1][last] = genes.high[last]  # length of the segment that the shorter body lacks
    near, far = (wl.analysis.aligned_distances([wl.Genome(shorter), wl.Genome(each)])[0, 1] for each in longer)
    assert near == far
    assert near > 0.1


def test_genomes_with_room_for_more_segments_can_be_compared(genomes):
    larger = [wl.Genome(values) for values in wl.generate_robot_population(wl.Robot(segments=(1, 8)), 3, seed=1)]
    distances = wl.analysis.aligned_distances([*genomes[:3], *larger])
    assert np.isfinite(distances).all()
    assert np.allclose(distances[:3, :3], wl.analysis.aligned_distances(genomes[:3]), atol=0.05)  # other ranges


def test_a_difference_is_a_fraction_of_the_gene_table(genomes):
    genes = build_genes(wl.Robot())
    frequency = genes.names.index("frequency")
    lowest, highest = genomes[0].values.copy(), genomes[0].values.copy()
    lowest[frequency], highest[frequency] = genes.low[frequency], genes.high[frequency]
    whole = wl.analysis.aligned_distances([wl.Genome(lowest), wl.Genome(highest)])[0, 1]
    middle = wl.Genome(np.round((lowest + highest) / 2, 3))
    assert wl.analysis.aligned_distances([wl.Genome(lowest), middle])[0, 1] == pytest.approx(whole / 2, rel=1e-3)


def test_clones_have_no_diversity(genomes):
    assert wl.analysis.aligned_diversity([genomes[0]] * 5) == 0
    assert wl.analysis.aligned_diversity(genomes[:1]) == 0
    assert 0.3 < wl.analysis.aligned_diversity(genomes) < 1
    table = np.array([genome.values for genome in genomes])
    assert wl.analysis.aligned_diversity(table) == wl.analysis.aligned_diversity(list(map(str, genomes)))
