"""How measured numbers are written for people: to significant figures, for any unit and size."""

import math
from collections.abc import Iterable

SIGNIFICANT_FIGURES = 3
MIN_FIXED_POWER = -3  # power of ten; smaller numbers are written with an exponent
MAX_FIXED_POWER = 5  # power of ten; numbers of at least this size are written with an exponent
MAX_EXTRA_DECIMALS = 2  # decimals that small values add to a column beyond what its largest value needs
MAX_FIXED_DECIMALS = 6
NO_VALUE = "–"  # text in place of a number that is not finite


def format_significant(value: float) -> str:
    """Write a number to three significant figures: ``0.00320``, ``2.35``, ``12345``, ``1.23e-07``.

    The sign is the ASCII hyphen, so that the text can be printed anywhere and read back with ``float``.

    Args:
        value: Any number; zero of either sign gives ``0``, and a number that is not finite ``–``.
    """
    if not math.isfinite(value):
        return NO_VALUE
    if value == 0:
        return "0"
    power = _power_of_ten(value)
    return f"{value:.{SIGNIFICANT_FIGURES - 1}e}" if _needs_exponent(power) else f"{value:.{_count_decimals(power)}f}"


def format_significant_column(values: Iterable[float]) -> list[str]:
    """Write the numbers of a column with the same number of decimals, so that their points align.

    A number that would lose significant figures that way, or a column that is too large or too small for decimals, is
    written as ``format_significant`` does.
    """
    numbers = list(values)
    powers = [_power_of_ten(number) for number in numbers if math.isfinite(number) and number != 0]
    if not powers or _needs_exponent(max(powers)):
        return list(map(format_significant, numbers))
    decimals = min(_count_decimals(min(powers)), _count_decimals(max(powers)) + MAX_EXTRA_DECIMALS)
    fits = [
        number == 0 or (math.isfinite(number) and _count_decimals(_power_of_ten(number)) <= decimals)
        for number in numbers
    ]
    return [
        f"{number + 0.0:.{decimals}f}" if fit else format_significant(number)  # adding 0.0 makes -0.0 positive
        for number, fit in zip(numbers, fits, strict=True)
    ]


def format_fixed_column(values: Iterable[float], decimals: int) -> list[str]:
    """Write the numbers of a column of known scale with fixed decimals, or more, if the largest number needs more.

    Small numbers may be written as zero; where that must not happen, use ``format_significant_column``.

    Args:
        values: Any numbers.
        decimals: Number of decimals.
    """
    numbers = list(values)
    largest = max((abs(number) for number in numbers if math.isfinite(number)), default=0.0)
    if largest:
        decimals = min(max(decimals, _count_decimals(_power_of_ten(largest))), MAX_FIXED_DECIMALS)
    return [f"{number:z.{decimals}f}" if math.isfinite(number) else NO_VALUE for number in numbers]


def with_unit(value: float, unit: str) -> str:
    """Write a number to three significant figures, with its unit if it has one."""
    return f"{format_significant(value)} {unit}".rstrip()


def _power_of_ten(value: float) -> int:
    """Return the power of ten of a number once it is rounded."""
    return int(f"{value:.{SIGNIFICANT_FIGURES - 1}e}".partition("e")[2])


def _needs_exponent(power: int) -> bool:
    return not MIN_FIXED_POWER <= power < MAX_FIXED_POWER


def _count_decimals(power: int) -> int:
    """Return how many decimals three significant figures of this power of ten require."""
    return max(0, SIGNIFICANT_FIGURES - 1 - power)
