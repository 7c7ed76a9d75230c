"""What is to be filmed: one walk, or several after one another, and on what film."""

import json
import math
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Self

import numpy as np

from walkerlab.settings import Settings

SIDES = (64, 4096)  # pixels that a film may be wide or high
RATES = (1, 60)  # frames a second
FORMATS = {".mp4": "plays everywhere", ".webm": "plays in every browser", ".gif": "for slides and chats; large"}
"""The kinds of film, by the ending of the file's name."""


class FilmError(RuntimeError):
    """A film that cannot be made here: there is no GL, or no place to write it."""


@dataclass(frozen=True)
class Act:
    """One walk, from its start.

    Attributes:
        genome: of the robot, as text.
        seconds: for which it is shown.
        caption: written above it; "" is none.
        generation: that the ruler below points at.
    """

    genome: str
    seconds: float
    caption: str = ""
    generation: int = 0


@dataclass(frozen=True)
class Job:
    """A film to be made.

    Attributes:
        acts: what it shows, one after the other.
        settings: of terrain, robot and simulation, whose camera is the film's; the algorithm does not matter.
        size: width and height, in pixels.
        fps: frames a second.
        suffix: a key of ``FORMATS``.
        ruler: the first and last generation on the ruler below, or None for none.
    """

    acts: tuple[Act, ...]
    settings: Settings
    size: tuple[int, int]
    fps: int
    suffix: str
    ruler: tuple[int, int] | None = None

    def __post_init__(self) -> None:
        """Refuse what no film can be.

        Raises:
            ValueError: naming what, its value, its range and what it is for.
        """
        low, high = SIDES
        wrong = not (isinstance(self.size, tuple | list) and len(self.size) == 2 and all(map(is_whole, self.size)))  # pyright: ignore[reportUnnecessaryIsInstance]
        if wrong or any(side % 2 or not low <= side <= high for side in self.size):
            raise ValueError(
                f"size is {self.size!r}; it must be two even whole numbers, {low} to {high} pixels, as in (480, 360). "
                "It is the width and height of the film; video knows no odd ones."
            )
        low, high = RATES
        if not (is_whole(self.fps) and low <= self.fps <= high):
            raise ValueError(
                f"fps is {self.fps!r}; it must be a whole number, {low} to {high}. "
                "It is how many frames the film has for each second."
            )
        object.__setattr__(self, "size", tuple(map(int, self.size)))  # numpy's numbers cannot be written as JSON
        object.__setattr__(self, "fps", int(self.fps))
        if self.suffix not in FORMATS:
            raise ValueError(
                f"path ends in {self.suffix!r}; it must end in {', '.join(FORMATS)}. It decides the kind of film: "
                f"{'; '.join(f'{suffix} {about}' for suffix, about in FORMATS.items())}."
            )

    def frames_of(self, act: Act) -> int:
        """Count the frames of an act: the first shows its start, and each its share of a second."""
        return max(1, math.floor(act.seconds * self.fps + 0.5))

    @property
    def n_frames(self) -> int:
        """How many frames the film has."""
        return sum(map(self.frames_of, self.acts))

    @property
    def seconds(self) -> float:
        """How long it is."""
        return self.n_frames / self.fps

    def to_json(self, path: Path) -> str:
        """Write it, and the path at which to make it, in one line for another process."""
        settings = self.settings.model_dump(exclude={"algorithm"})  # may hold the user's functions; nobody evolves here
        return json.dumps({**vars(self), "acts": list(map(asdict, self.acts)), "settings": settings, "path": str(path)})

    @classmethod
    def from_json(cls, text: str) -> tuple[Self, Path]:
        """Read what ``to_json`` wrote."""
        plain: dict[str, Any] = json.loads(text)
        path, acts = Path(plain.pop("path")), tuple(Act(**act) for act in plain.pop("acts"))
        size, settings = tuple(plain.pop("size")), Settings(**plain.pop("settings"))
        ruler = tuple(plain.pop("ruler") or ()) or None
        return cls(acts=acts, settings=settings, size=size, ruler=ruler, **plain), path


def is_whole(number: object) -> bool:
    """Say whether it is a whole number, Python's own or numpy's."""
    return isinstance(number, int | np.integer) and not isinstance(number, bool)
