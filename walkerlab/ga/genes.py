"""The gene table: name, unit, kind and range of each number of a genome. It does not depend on the robot."""

from dataclasses import dataclass
from functools import cached_property
from typing import Literal, TypeAlias, get_args

import numpy as np
from numpy.typing import NDArray

from walkerlab.system.readonly import ReadOnlyArrays

Floats: TypeAlias = NDArray[np.float64]
Indices: TypeAlias = NDArray[np.intp]
GeneKind = Literal["real", "count", "cyclic"]


@dataclass(frozen=True, eq=False)
class Genes(ReadOnlyArrays):
    """Gene table: the columns of a genome, first the genes of the whole body, then the same genes for each part.

    A genome contains every part that a body *may* have. The gene at ``count`` gives how many of them, from the front,
    are expressed. The others are unexpressed, but are inherited and mutated too.

        whole body        part 1          part 2          part 3
        count frequency | length mass … | length mass … | length mass …

    Attributes:
        names: Name of each gene, such as ``"frequency"`` or ``"seg2.mass"`` (``part.feature``); n_genes of them.
        units: Unit of each gene.
        kinds: Kind of each gene: ``real``; ``count``, a whole number; or ``cyclic``, where ``high`` means the same as
            ``low``.
        meanings: Short description of each gene.
        low: Minimum of each gene, shape (n_genes,).
        high: Maximum of each gene, shape (n_genes,); not below ``low``.
        n_parts: Number of parts that follow the genes of the whole body; may be 0.
        n_whole: Number of genes of the whole body.
        count: Index of the gene that counts the expressed parts; None if all parts are expressed.
    """

    names: tuple[str, ...]
    units: tuple[str, ...]
    kinds: tuple[GeneKind, ...]
    meanings: tuple[str, ...]
    low: Floats
    high: Floats
    n_parts: int = 0
    n_whole: int = 0
    count: int | None = None

    def __post_init__(self) -> None:
        """Check that the columns have the same length and the parts the same size; make the arrays read-only."""
        columns = (self.names, self.units, self.kinds, self.meanings, self.low, self.high)
        assert len({len(column) for column in columns}) == 1, "the columns of a gene table differ in length"
        assert set(self.kinds) <= set(get_args(GeneKind))
        assert np.all(self.low <= self.high)
        if self.n_parts:
            assert (len(self) - self.n_whole) % self.n_parts == 0
        super().__post_init__()

    def __len__(self) -> int:
        """Return the number of genes of a genome."""
        return len(self.names)

    @cached_property
    def is_count(self) -> NDArray[np.bool_]:
        """Whether each gene is a whole number, shape (n_genes,)."""
        return self._of_kind("count")

    @cached_property
    def is_cyclic(self) -> NDArray[np.bool_]:
        """Whether each gene is cyclic, such as an angle, shape (n_genes,)."""
        return self._of_kind("cyclic")

    def _of_kind(self, wanted: GeneKind) -> NDArray[np.bool_]:
        mask = np.array([kind == wanted for kind in self.kinds])
        mask.setflags(write=False)
        return mask

    def parts(self, genomes: Floats) -> Floats:
        """Return a view of the parts of (n, n_genes) genomes, shape (n, n_parts, genes of one part)."""
        return genomes[:, self.n_whole :].reshape(
            len(genomes), self.n_parts, (len(self) - self.n_whole) // self.n_parts
        )

    def n_expressed(self, genomes: Floats) -> Indices:
        """Return the number of expressed parts of each of (n, n_genes) genomes, shape (n,), from 0 to ``n_parts``."""
        if self.count is None:
            return np.full(len(genomes), self.n_parts)
        return np.clip(np.rint(genomes[:, self.count]), 0, self.n_parts).astype(np.intp)

    def find(self, name: str) -> Indices:
        """Return the indices of one gene, or of a feature in every part.

        Args:
            name: Name of a gene, or of a feature: ``"mass"`` finds every ``segN.mass``.

        Raises:
            ValueError: If there is no gene of this name; the message lists the features.
        """
        found = [i for i, gene in enumerate(self.names) if name in (gene, gene.partition(".")[2])]
        if not found:
            features = list(dict.fromkeys(gene.rpartition(".")[2] for gene in self.names))
            raise ValueError(f"there is no gene {name!r}; the genes are {', '.join(features)}")
        return np.array(found, dtype=np.intp)
