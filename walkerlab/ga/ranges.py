"""How a number that has left its range comes back into it."""

import numpy as np

from walkerlab.ga.genes import Floats


def wrap(values: Floats, low: Floats, high: Floats) -> Floats:
    """Go round: what leaves at one end enters at the other, so that the result is in [low, high).

    What has not left stays as it is, to the last bit; so does it in ``reflect``.

    Args:
        values: (n, n_genes) wherever they are.
        low: (n_genes,) least value.
        high: (n_genes,) where the range meets ``low`` again; ``low`` itself if there is no room.

    Returns:
        (n, n_genes)
    """
    wrapped = low + np.mod(values - low, _span(low, high))
    inside = np.where(wrapped < high, wrapped, low)  # rounding may land on high, which is low
    return np.where((values >= low) & (values < high), values, inside)


def reflect(values: Floats, low: Floats, high: Floats) -> Floats:
    """Bounce off the ends as off mirrors, so that the result is in [low, high] and does not pile up at an end.

    Args:
        values: (n, n_genes) wherever they are.
        low: (n_genes,) least value.
        high: (n_genes,) greatest value.

    Returns:
        (n, n_genes)
    """
    there_and_back = 2 * _span(low, high)
    gone = np.mod(values - low, there_and_back)
    inside = np.clip(low + np.minimum(gone, there_and_back - gone), low, high)
    return np.where((values >= low) & (values <= high), values, inside)


def _span(low: Floats, high: Floats) -> Floats:
    return np.where(high > low, high - low, 1.0)  # 1: any number that can be divided by
