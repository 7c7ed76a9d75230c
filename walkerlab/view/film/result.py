"""A film file and its display in a notebook."""

import base64
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import quote

from walkerlab.system.files import display_path
from walkerlab.text.html import Html, join, tag

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
        if not self.path.is_file():
            return tag("p", repr(self))
        if self.path.stat().st_size > MAX_EMBEDDED_BYTES:
            return tag("p", "Too large to embed in the notebook: ", self._download_link(), f". {self.about}.")
        media_type = MEDIA_TYPES[self.path.suffix.lower()]
        source = f"data:{media_type};base64,{base64.b64encode(self.path.read_bytes()).decode()}"
        width, height = self.size
        style = "max-width:100%;height:auto;border-radius:6px"
        if media_type.startswith("image"):
            return tag("img", src=source, alt=self.about, width=width, height=height, style=style)
        fallback = join("This browser cannot play this video format: ", self._download_link())
        return tag(
            "video", fallback, src=source, aria_label=self.about, title=self.about, width=width, height=height,
            style=style, controls="", loop="", muted="", playsinline="",
        )  # fmt: skip

    def _download_link(self) -> Html:
        return tag("a", display_path(self.path), href=quote(Path(display_path(self.path)).as_posix()))
