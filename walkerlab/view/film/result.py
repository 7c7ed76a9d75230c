"""A film file and its display in a notebook."""

from dataclasses import dataclass
from pathlib import Path
from urllib.parse import quote

from walkerlab.system.files import display_path
from walkerlab.text.html import data_url
from walkerlab.text.templates import render

MAX_EMBEDDED_BYTES = 20e6  # larger films are linked instead of embedded in the notebook
MEDIA_TYPES = {".mp4": "video/mp4", ".webm": "video/webm", ".gif": "image/gif"}


@dataclass(frozen=True)
class Film:
    """A film file; a notebook plays it.

    Attributes:
        path: Path of the file.
        about: Description of the content.
        size: Width and height [pixels].
        fps: Frames per second.
        n_frames: Number of frames.
    """

    path: Path
    about: str
    size: tuple[int, int]
    fps: int
    n_frames: int

    @property
    def seconds(self) -> float:
        """Duration [s]."""
        return self.n_frames / self.fps

    def __repr__(self) -> str:
        """Return path, duration and sizes in one line."""
        kilobytes = f"{self.path.stat().st_size / 1e3:,.0f} kB" if self.path.is_file() else "file not found"
        width, height = self.size
        return f"Film({display_path(self.path)}: {self.seconds:.1f} s, {width} × {height}, {kilobytes})"

    def _repr_html_(self) -> str:
        """Return a player with the embedded film, which stays in the notebook if the file is moved."""
        kind = self._display_kind()
        source = ""
        if kind in ("image", "video"):
            source = data_url(MEDIA_TYPES[self.path.suffix.lower()], self.path.read_bytes())
        return render(
            "view/film/film.html",
            kind=kind,
            source=source,
            about=repr(self) if kind == "missing" else self.about,
            size=self.size,
            name=display_path(self.path),
            address=quote(Path(display_path(self.path)).as_posix()),
        )

    def _display_kind(self) -> str:
        """Return how a notebook displays the film: missing, large, image or video."""
        if not self.path.is_file():
            return "missing"
        if self.path.stat().st_size > MAX_EMBEDDED_BYTES:
            return "large"
        return MEDIA_TYPES[self.path.suffix.lower()].partition("/")[0]
