"""The gene table: what each number of a genome is. It knows numbers and names, and no robot."""

from dataclasses import dataclass
from functools import cached_property
from typing import Literal, TypeAlias, get_args

import numpy as np
from numpy.typing import NDArray

from walkerlab.readonly import ReadOnlyArrays

Floats: TypeAlias = NDArray[np.float64]
Indices: TypeAlias = NDArray[np.intp]
Kind = Literal["real", "count", "cyclic"]


@dataclass(frozen=True, eq=False)
class Genes(ReadOnlyArrays):
    """The columns of a genome: a few genes of the whole body, then the same genes once more for each part.

    A genome holds every part that a body *may* have; the gene at ``count`` says how many of them, from the
    front, are grown. The rest are unexpressed: inherited and mutated all the same.

        whole body        part 1          part 2          part 3
        count frequency | length mass … | length mass … | length mass …

    Attributes:
        names: (n_genes,) e.g. ``"frequency"``, ``"seg2.mass"``; a part's gene is ``part.feature``.
        units: (n_genes,) of ``low``, ``high`` and the values.
        kinds: (n_genes,) ``real``; ``count``, a whole number; ``cyclic``, where high meets low again.
        meanings: (n_genes,) a few words each.
        low: (n_genes,) least value.
        high: (n_genes,) greatest value, never under ``low``.
        n_parts: how many parts follow the whole-body genes; 0 if there are none.
        n_whole: how many whole-body genes come first.
        count: the index of the gene that counts the grown parts, or None: then all are grown.
    """

    names: tuple[str, ...]
    units: tuple[str, ...]
    kinds: tuple[Kind, ...]
    meanings: tuple[str, ...]
    low: Floats
    high: Floats
    n_parts: int = 0
    n_whole: int = 0
    count: int | None = None

    def __post_init__(self) -> None:
        """Check that the columns are of one length, the parts of one size, and nothing can be changed by mistake."""
        columns = (self.names, self.units, self.kinds, self.meanings, self.low, self.high)
        assert len({len(column) for column in columns}) == 1, "the columns of a gene table differ in length"
        assert set(self.kinds) <= set(get_args(Kind))
        assert np.all(self.low <= self.high)
        if self.n_parts:
            assert (len(self) - self.n_whole) % self.n_parts == 0
        super().__post_init__()

    def __len__(self) -> int:
        """Say how many genes a genome has."""
        return len(self.names)

    @cached_property
    def is_count(self) -> NDArray[np.bool_]:
        """(n_genes,) whole numbers."""
        return self._of_kind("count")

    @cached_property
    def is_cyclic(self) -> NDArray[np.bool_]:
        """(n_genes,) angles and the like."""
        return self._of_kind("cyclic")

    def _of_kind(self, wanted: Kind) -> NDArray[np.bool_]:
        chosen = np.array([kind == wanted for kind in self.kinds])
        chosen.setflags(write=False)
        return chosen

    def parts(self, genomes: Floats) -> Floats:
        """View (n, n_genes) genomes as (n, n_parts, genes of one part)."""
        return genomes[:, self.n_whole :].reshape(
            len(genomes), self.n_parts, (len(self) - self.n_whole) // self.n_parts
        )

    def n_grown(self, genomes: Floats) -> Indices:
        """Count the grown parts of (n, n_genes) genomes: (n,) integers from 0 to ``n_parts``."""
        if self.count is None:
            return np.full(len(genomes), self.n_parts)
        return np.clip(np.rint(genomes[:, self.count]), 0, self.n_parts).astype(np.intp)

    def find(self, name: str) -> Indices:
        """Return the indices of one gene, or of one feature in every part (``"mass"``: every ``segN.mass``).

        Raises:
            ValueError: if no gene is called so; the message lists the features there are.
        """
        found = [i for i, gene in enumerate(self.names) if name in (gene, gene.partition(".")[2])]
        if not found:
            features = list(dict.fromkeys(gene.rpartition(".")[2] for gene in self.names))
            raise ValueError(f"no gene is called {name!r}; there are {', '.join(features)}")
        return np.array(found, dtype=np.intp)
