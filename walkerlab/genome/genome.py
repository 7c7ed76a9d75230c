"""Genomes: the gene values of one individual, read from text, arrays or individuals."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any, Protocol, Self, cast

import numpy as np
from numpy.random import Generator
from numpy.typing import ArrayLike

from walkerlab.ga.genes import Floats
from walkerlab.genome.display import genome_html
from walkerlab.genome.features import BODY_FEATURES, MAX_SEGMENTS, SEGMENT_FEATURES, build_genes
from walkerlab.genome.initial import draw_genes
from walkerlab.genome.repair import draw_sizes, repair
from walkerlab.genome.text import count_segments, format_text, parse_text
from walkerlab.settings.arguments import require_generator
from walkerlab.settings.robot import Robot
from walkerlab.settings.settings import Settings
from walkerlab.settings.values import short_repr
from walkerlab.system.readonly import ReadOnlyArrays
from walkerlab.text.templates import render


class HasGenome(Protocol):
    """An object accepted in place of its genome, such as an ``Individual`` or an ``Evaluation``."""

    @property
    def genome(self) -> "Genome | str":
        """Genome, or its text form."""
        ...


@dataclass(frozen=True, eq=False)
class Genome(ReadOnlyArrays):
    """Gene values of one individual.

    Attributes:
        values: Gene values in physical units, shape (n_genes,), read-only; columns as in ``gene_table``. The length
            determines the number of segments, expressed or not.

    Raises:
        ValueError: If the values are not a row of finite numbers with the length of a genome.
    """

    values: Floats

    def __post_init__(self) -> None:
        """Check the values, and replace them with a read-only copy."""
        try:
            values = np.asarray(self.values, dtype=np.float64)
        except (TypeError, ValueError, OverflowError):
            raise ValueError(f"a genome's values must be a row of numbers; got {short_repr(self.values)}") from None
        n_segments, remainder = divmod(values.size - len(BODY_FEATURES), len(SEGMENT_FEATURES))
        if values.ndim != 1 or remainder or not 1 <= n_segments <= MAX_SEGMENTS:
            got = f"an array of shape {values.shape}" if values.ndim else short_repr(self.values)
            raise ValueError(
                f"a genome is a row of {len(BODY_FEATURES)} genes plus {len(SEGMENT_FEATURES)} for each of its 1 to "
                f"{MAX_SEGMENTS} segments; got {got}"
            )
        if not np.isfinite(values).all():
            raise ValueError(f"gene {int(np.argmin(np.isfinite(values)))} of the genome is not a finite number")
        values = values + 0.0  # copies, and makes -0.0 positive, so that equal genomes are equal bit for bit
        object.__setattr__(self, "values", values)
        super().__post_init__()

    @classmethod
    def random(cls, robot: Robot, *, rng: Generator) -> Self:
        """Return a random genome within the limits, as in the first generation; most robots stand on their feet.

        Args:
            robot: Limits of the robot.
            rng: Random number generator.

        Raises:
            ValueError: If ``robot`` is not a ``Robot``.
            TypeError: If ``rng`` is not a numpy random Generator.
        """
        build_genes(robot)  # checks the argument
        rng = require_generator(rng)
        drawn = repair(draw_genes(robot, rng)[np.newaxis], robot)
        return cls(draw_sizes(drawn, robot, rng)[0])

    @classmethod
    def of(cls, given: "Genome | str | ArrayLike | HasGenome") -> "Genome":
        """Convert a genome, its text form, its values or an object with a genome to a ``Genome``.

        Args:
            given: Genome, text form, values of shape (n_genes,), or object with an attribute ``genome``.

        Raises:
            GenomeError: If a string is not a valid genome.
            ValueError: If the values are not a valid genome.
            TypeError: If the object, such as a run, a table or settings, does not have exactly one genome.
        """
        if isinstance(given, Genome):
            return given
        if isinstance(given, str):
            return cls.parse(given)
        _check_has_one_genome(given)
        return cls.of(given.genome) if hasattr(given, "genome") else cls(given)  # type: ignore[arg-type,union-attr]

    @classmethod
    def parse(cls, text: str) -> Self:
        """Parse the text form of a genome, which may have been edited.

        Raises:
            GenomeError: If the text is not a valid genome; the message gives the position, and what was expected there.
        """
        return cls(np.array(parse_text(text)))

    def __str__(self) -> str:
        """Return the text form, from which ``parse`` reads exactly the same numbers."""
        return format_text(self.values.tolist())

    def __repr__(self) -> str:
        """Return an expression that creates this genome."""
        return f"Genome.parse({str(self)!r})"

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Genome) and np.array_equal(self.values, other.values)

    def __hash__(self) -> int:
        return hash(self.values.tobytes())

    def _repr_html_(self) -> str:
        return render("text/output.html", content=[genome_html(self.values)])

    @property
    def n_parts(self) -> int:
        """Number of segments that the genome describes, expressed or not."""
        return count_segments(self.values.size)

    def within(self, robot: Robot) -> Self:
        """Return the nearest genome that is within these limits.

        Segments beyond the number that the limits allow are dropped. If the genome has fewer, copies of its last
        segment are appended; they are expressed if the segment count includes them.

        Args:
            robot: Limits of the robot.

        Raises:
            ValueError: If ``robot`` is not a ``Robot``.
        """
        build_genes(robot)  # checks the argument
        whole = self.values[: len(BODY_FEATURES)]
        parts = self.values[len(BODY_FEATURES) :].reshape(self.n_parts, -1)
        parts = parts[np.minimum(np.arange(robot.segments[1]), self.n_parts - 1)]
        return type(self)(repair(np.concatenate([whole, parts.ravel()])[np.newaxis], robot)[0])


def _check_has_one_genome(given: Any) -> None:
    """Reject kinds of values that are often passed by mistake instead of a genome.

    Raises:
        TypeError: If the value is of such a kind; the message explains what to pass instead.
    """
    if hasattr(given, "columns"):  # before the check for an attribute genome, which a table has as a column
        raise TypeError("this is a table, but a genome is expected; pass a cell of its column genome: table.genome[0]")
    if hasattr(given, "champion"):
        raise TypeError("this is a run, but the genome of one robot is expected; pass run.champion")
    if hasattr(given, "phenotype"):
        raise TypeError("this is a walk or a scene, but a genome is expected; pass the genome of the robot")
    if given is None:
        raise TypeError("a genome is expected: a Genome, its text, its values or an individual; got None")
    if (
        isinstance(given, list | tuple)
        and not hasattr(given, "genome")
        and any(isinstance(item, Genome | str) for item in cast(Iterable[Any], given))
    ):
        raise TypeError("one genome is expected, but this is a list of several; pass one of them: genomes[0]")
    if isinstance(given, Settings):
        raise TypeError("these are settings, but a genome is expected; pass the genome first, then the settings")


def read_genomes(given: Iterable[Genome | str | ArrayLike | HasGenome]) -> list[Genome]:
    """Return several genomes, each given as for ``Genome.of``.

    Raises:
        GenomeError: If a string is not a valid genome.
        ValueError: If the values are not a valid genome, or a single genome is given.
        TypeError: If it is something other than a list of genomes, such as a run, a table or settings.
    """
    is_row = isinstance(given, np.ndarray) and given.ndim == 1 and given.dtype.kind in "fiu" and given.size
    if hasattr(given, "champion") or hasattr(given, "columns"):
        source = "run.records.genome" if hasattr(given, "champion") else "table.genome"
        raise TypeError(f"several genomes are expected, as a list; the genomes of a run or its table are {source}")
    if isinstance(given, Mapping):
        raise TypeError("several genomes are expected, as a list; got a dict; pass list(genomes.values())")
    if given is not None and not isinstance(given, list | tuple):  # pyright: ignore[reportUnnecessaryComparison]
        _check_has_one_genome(given)
    if not isinstance(given, Iterable | Genome) and not hasattr(given, "genome"):  # pyright: ignore[reportUnnecessaryIsInstance]
        raise TypeError(f"several genomes are expected, as a list; got {short_repr(given)}")
    if is_row or isinstance(given, Genome | str) or hasattr(given, "genome"):
        raise ValueError("several genomes are expected, but this is a single one; put it in a list: [genome]")
    return [Genome.of(item) for item in given]
