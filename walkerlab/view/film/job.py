"""Specification of a film: the walks to show, and the size, frame rate and format of the file."""

import json
import math
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Self

import numpy as np

from walkerlab.settings.settings import Settings

SIDE_RANGE = (64, 4096)  # pixels
FPS_RANGE = (1, 60)
FILM_FORMATS = {".mp4": "plays everywhere", ".webm": "plays in every browser", ".gif": "for slides and chats; large"}
"""Use of each format, keyed by the suffix of the file."""


class FilmError(RuntimeError):
    """A film cannot be rendered or written: OpenGL is not available, or the path is not writable."""


@dataclass(frozen=True)
class Clip:
    """One walk, shown from its start.

    Attributes:
        genome: Genome of the robot, as text.
        seconds: How long the walk is shown.
        caption: Text above the picture; "" for no caption.
        generation: Generation that the timeline marks, if the film has one.
    """

    genome: str
    seconds: float
    caption: str = ""
    generation: int = 0


@dataclass(frozen=True)
class Job:
    """A film to render.

    Attributes:
        clips: Clips in the order in which they are shown.
        settings: Settings of terrain, robot and simulation, including the camera; the algorithm is ignored.
        size: Width and height [pixels].
        fps: Frames per second.
        suffix: Suffix of the file; a key of ``FILM_FORMATS``.
        generation_range: First and last generation of the timeline; None for a film without a timeline.
    """

    clips: tuple[Clip, ...]
    settings: Settings
    size: tuple[int, int]
    fps: int
    suffix: str
    generation_range: tuple[int, int] | None = None

    def __post_init__(self) -> None:
        """Check size, frame rate and format.

        Raises:
            ValueError: If one of them is not allowed; the message gives the value and the allowed range.
        """
        low, high = SIDE_RANGE
        is_pair = isinstance(self.size, tuple | list) and len(self.size) == 2 and all(map(is_integer, self.size))  # pyright: ignore[reportUnnecessaryIsInstance]
        if not is_pair or any(side % 2 or not low <= side <= high for side in self.size):
            raise ValueError(
                f"size is {self.size!r}; it must be two even whole numbers between {low} and {high} pixels, as in "
                "(480, 360). It is the width and height of the film; video formats require even numbers."
            )
        low, high = FPS_RANGE
        if not (is_integer(self.fps) and low <= self.fps <= high):
            raise ValueError(
                f"fps is {self.fps!r}; it must be a whole number between {low} and {high}. "
                "It is the number of frames per second."
            )
        object.__setattr__(self, "size", tuple(map(int, self.size)))  # NumPy integers cannot be written as JSON
        object.__setattr__(self, "fps", int(self.fps))
        if self.suffix not in FILM_FORMATS:
            raise ValueError(
                f"path ends in {self.suffix!r}; it must end in {', '.join(FILM_FORMATS)}. The suffix selects the "
                f"format: {'; '.join(f'{suffix} {about}' for suffix, about in FILM_FORMATS.items())}."
            )

    def count_frames(self, clip: Clip) -> int:
        """Return the number of frames of a clip, at least 1."""
        return max(1, math.floor(clip.seconds * self.fps + 0.5))

    @property
    def n_frames(self) -> int:
        """Number of frames of the film."""
        return sum(map(self.count_frames, self.clips))

    @property
    def seconds(self) -> float:
        """Duration of the film [s]."""
        return self.n_frames / self.fps

    def to_json(self, path: Path) -> str:
        """Write the job and the path of the file to render as one line of JSON."""
        settings = self.settings.model_dump(exclude={"algorithm"})  # the algorithm may contain functions
        clips = list(map(asdict, self.clips))
        return json.dumps({**vars(self), "clips": clips, "settings": settings, "path": str(path)})

    @classmethod
    def from_json(cls, text: str) -> tuple[Self, Path]:
        """Read a job and its path from the text that ``to_json`` returns."""
        values: dict[str, Any] = json.loads(text)
        path = Path(values.pop("path"))
        clips = tuple(Clip(**clip) for clip in values.pop("clips"))
        settings = Settings(**values.pop("settings"))
        size = tuple(values.pop("size"))
        generation_range = tuple(values.pop("generation_range") or ()) or None
        return cls(clips=clips, settings=settings, size=size, generation_range=generation_range, **values), path


def is_integer(value: object) -> bool:
    """Return whether a value is a Python or NumPy integer; booleans are not."""
    return isinstance(value, int | np.integer) and not isinstance(value, bool)
