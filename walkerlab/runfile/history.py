"""History in a run file, besides settings and table: genomes given for generation 0, and settings of earlier stages."""

import json
from dataclasses import asdict, dataclass
from typing import Any, Self

from walkerlab.text import strict_json


@dataclass(frozen=True)
class Founder:
    """Genome given for generation 0.

    Attributes:
        genome: Its text form.
        origin: Where it comes from, as in the column ``operators`` of the table: ``given``, ``given: robot 7``.
    """

    genome: str
    origin: str


@dataclass(frozen=True)
class EarlierStage:
    """Stage of a run that ended because its settings were changed.

    Attributes:
        first: Number of its first generation.
        settings: Settings of its generations, as plain data.
    """

    first: int
    settings: dict[str, Any]


@dataclass(frozen=True)
class History:
    """Facts about a run that its settings and its table do not contain.

    Attributes:
        founders: Genomes given for generation 0, in the order of its first individuals.
        earlier: Earlier stages, in their order; the settings of the run are those of its last stage.
        last_first: Number of the first generation of the last stage.
    """

    founders: tuple[Founder, ...] = ()
    earlier: tuple[EarlierStage, ...] = ()
    last_first: int = 0

    def to_json(self) -> str:
        """Return the history as JSON; "" if there is nothing to record."""
        return json.dumps(asdict(self)) if self.founders or self.earlier else ""

    @classmethod
    def from_json(cls, text: str) -> Self:
        """Read a history that ``to_json`` wrote.

        Raises:
            ValueError: If the text is not a history.
        """
        if not text:
            return cls()
        match strict_json.loads(text):
            case {"founders": list(founders), "earlier": list(earlier), "last_first": int(last_first)}:
                history = cls(
                    tuple(read_founder(item) for item in list[Any](founders)),
                    tuple(_read_stage(item) for item in list[Any](earlier)),
                    last_first,
                )
            case _:
                raise ValueError("its history has an unknown form")
        firsts = [stage.first for stage in history.earlier] + [history.last_first]
        if firsts[0] != 0 or firsts != sorted(set(firsts)):
            raise ValueError("its stages are not in order")
        return history


def read_founder(item: Any) -> Founder:
    """Read a founder from plain data.

    Raises:
        ValueError: If the data has an unknown form.
    """
    match item:
        case {"genome": str(genome), "origin": str(origin)} if origin.isprintable():
            return Founder(genome, origin)
        case _:
            raise ValueError("its history has a founder of an unknown form")


def _read_stage(item: Any) -> EarlierStage:
    match item:
        case {"first": int(first), "settings": dict(settings)}:
            return EarlierStage(first, settings)
        case _:
            raise ValueError("its history has a stage of an unknown form")
