"""Bring numbers that have left their range back into it: wrapped around (cyclic), or reflected at its end."""

import numpy as np

from walkerlab.ga.genes import Floats


def wrap(values: Floats, low: Floats, high: Floats) -> Floats:
    """Wrap values into [low, high): a value that leaves the range at one end enters it at the other.

    Values inside the range are returned unchanged, bit for bit.

    Args:
        values: Any values, shape (n, n_genes).
        low: Minimum of each gene, shape (n_genes,).
        high: End of each range, shape (n_genes,), equivalent to ``low``; an empty range gives ``low``.

    Returns:
        Wrapped values, shape (n, n_genes).
    """
    wrapped = low + np.mod(values - low, _range_width(low, high))
    inside = np.where(wrapped < high, wrapped, low)  # rounding may give high, which is equivalent to low
    return np.where((values >= low) & (values < high), values, inside)


def reflect(values: Floats, low: Floats, high: Floats) -> Floats:
    """Reflect values at the ends of their range into [low, high], so that they do not accumulate at an end.

    Values inside the range are returned unchanged, bit for bit.

    Args:
        values: Any values, shape (n, n_genes).
        low: Minimum of each gene, shape (n_genes,).
        high: Maximum of each gene, shape (n_genes,).

    Returns:
        Reflected values, shape (n, n_genes).
    """
    period = 2 * _range_width(low, high)
    offset = np.mod(values - low, period)
    inside = np.clip(low + np.minimum(offset, period - offset), low, high)
    return np.where((values >= low) & (values <= high), values, inside)


def _range_width(low: Floats, high: Floats) -> Floats:
    return np.where(high > low, high - low, 1.0)  # 1 for an empty range: any divisor other than 0
