"""One evaluated generation, as an evolution yields it."""

from dataclasses import dataclass

import pandas as pd

from walkerlab.runfile import records
from walkerlab.runfile.records import Individual


@dataclass(frozen=True, eq=False)
class Generation:
    """One evaluated generation.

    Attributes:
        number: Number of the generation; 0 is the first.
    """

    number: int
    _table: pd.DataFrame

    @property
    def records(self) -> pd.DataFrame:
        """Copy of the rows of this generation in the tidy table."""
        return records.copy_table(self._table)

    @property
    def champion(self) -> Individual:
        """Fittest robot of this generation."""
        return records.find_champion(self._table)
