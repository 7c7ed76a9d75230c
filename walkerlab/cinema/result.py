"""A film that was made: where it is, and how a notebook plays it."""

import base64
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import quote

from walkerlab.files import shown
from walkerlab.markup import Html, join, tag

MOST = 20e6  # bytes of a film that is put into the notebook; a larger one is linked to
MEDIA = {".mp4": "video/mp4", ".webm": "video/webm", ".gif": "image/gif"}


@dataclass(frozen=True)
class Film:
    """A film that was made.

    Attributes:
        path: where it is.
        about: what it shows, in words.
        size: width and height, in pixels.
        fps: frames a second.
        n_frames: how many it has.
    """

    path: Path
    about: str
    size: tuple[int, int]
    fps: int
    n_frames: int

    @property
    def seconds(self) -> float:
        """How long it is."""
        return self.n_frames / self.fps

    def __repr__(self) -> str:
        """Say in a line where it is, how long, and how large."""
        kilobytes = f"{self.path.stat().st_size / 1e3:,.0f} kB" if self.path.is_file() else "no longer there"
        width, height = self.size
        return f"Film({shown(self.path)}: {self.seconds:.1f} s, {width} × {height}, {kilobytes})"

    def _repr_html_(self) -> str:
        """Play it below the cell: the film itself is in the notebook, so that it travels with it."""
        if not self.path.is_file():
            return tag("p", repr(self))
        if self.path.stat().st_size > MOST:
            return tag("p", "Too large to be put into a notebook: ", self._link(), f". {self.about}.")
        media = MEDIA[self.path.suffix.lower()]
        source = f"data:{media};base64,{base64.b64encode(self.path.read_bytes()).decode()}"
        width, height = self.size
        style = "max-width:100%;height:auto;border-radius:6px"
        if media.startswith("image"):
            return tag("img", src=source, alt=self.about, width=width, height=height, style=style)
        instead = join("This browser plays no film of this kind: ", self._link())
        return tag(
            "video", instead, src=source, aria_label=self.about, title=self.about, width=width, height=height,
            style=style, controls="", loop="", muted="", playsinline="",
        )  # fmt: skip

    def _link(self) -> Html:
        return tag("a", shown(self.path), href=quote(Path(shown(self.path)).as_posix()))
