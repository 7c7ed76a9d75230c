"""The replay: recorded walks as one HTML page that plays offline, in a notebook or on its own.

The page is K3D's own snapshot of the stage, with the player (player.js) added. The player is handed the *reel*:

    things, walks, cameras, marks    what moves, who walks, from where it is seen, what is written on the ground
    channels, finest, seconds        all positions over time, packed by ``tracks.pack``

In a notebook a picture comes first; pressed, it becomes the page, and a picture again when that is closed, for
browsers keep few WebGL contexts.
"""

import base64
import json
import re
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import anywidget
import numpy as np
import traitlets
from matplotlib.colors import to_hex

from walkerlab.runfile.store import RunFileError
from walkerlab.settings.arguments import require_settings
from walkerlab.settings.choices import Camera
from walkerlab.settings.settings import Settings
from walkerlab.settings.values import count
from walkerlab.simulation.fitness import label, score
from walkerlab.simulation.validity import UNSTABLE, VERDICTS
from walkerlab.system.files import file_path, replacing
from walkerlab.text.html import Html, join, tag
from walkerlab.text.numbers import with_unit
from walkerlab.view.replay.animation import Stage, Walk, set_up
from walkerlab.view.replay.preview import poster
from walkerlab.view.replay.tracks import pack
from walkerlab.view.replay.walkers import line_up
from walkerlab.view.snapshots import LIVE_STYLE, WHITE, HasSnapshot

HERE = Path(__file__).parent
PRESS = " Press to play."
NATURAL = "#e69f00"  # the colour of a trunk


@dataclass(frozen=True, eq=False)
class Replay:
    """Recorded walks, to be watched from any side. Shown in a notebook if it stands last in a cell.

    Attributes:
        walks: who walks.
        settings: of the world in which they do.
        camera: from where they are seen at first.
    """

    walks: tuple[Walk, ...]
    settings: Settings
    camera: Camera

    def __repr__(self) -> str:
        """Name the walks."""
        names = ", ".join(walk.label for walk in self.walks)
        return f"Replay({names}; camera {self.camera.name}; show it in a notebook, or save it with .to_html(path))"

    def to_html(self, path: str | Path) -> Path:
        """Save it as one file that plays offline in any browser with WebGL, on a computer or a phone.

        Args:
            path: of the file to be written; what was there is replaced.

        Raises:
            ValueError: if it is not named ``.html``.
            OSError: if it cannot be written.
        """
        path = file_path(path)
        if path.suffix.lower() not in (".html", ".htm"):
            raise ValueError(f"path is {str(path)!r}; it must end in .html: a page, which a browser opens")
        with replacing(path) as part:
            part.write_text(self.page, encoding="utf-8")
        return path

    @cached_property
    def page(self) -> str:
        """The whole page, as HTML."""
        stage = set_up(list(self.walks), self._title)
        player = (HERE / "player.js").read_text(encoding="utf-8")
        style = (HERE / "player.css").read_text(encoding="utf-8")
        reel = json.dumps(self._reel(stage)).replace("<", "\\u003c")  # so that no text can end the script that it is in
        page: str = stage.plot.get_snapshot(additional_js_code=f"({player.strip()})(K3DInstance, {reel});")
        stage.strike()
        head = join(tag("meta", name="viewport", content="width=device-width"), tag("title", self._title))
        head += tag("style", Html(style))
        page = re.sub(r"<title>.*?</title>", lambda _: head, page, count=1, flags=re.DOTALL)
        excuse = (HERE / "unavailable.html").read_text(encoding="utf-8")
        page = page.replace('<div id="canvasTarget"></div>', f'<div id="canvasTarget"></div>\n{excuse}', 1)
        return page.replace("<html>", '<html lang="en">', 1)

    @property
    def widget(self) -> "Frame":
        """A new widget that shows it in a notebook: a picture first."""
        return Frame(self)

    def _ipython_display_(self, **_: Any) -> None:
        self.widget._ipython_display_()

    @property
    def _title(self) -> str:
        return self.walks[0].label if len(self.walks) == 1 else f"A race of {len(self.walks)}"

    def _reel(self, stage: Stage) -> dict[str, Any]:
        return {
            "things": stage.things,
            "channels": base64.b64encode(pack(stage.channels, stage.finest)).decode("ascii"),
            "finest": stage.finest.tolist(),
            "seconds": stage.seconds,
            "camera": self.camera.name,
            "cameras": [{"name": view.name, "up": stage.ups[view]} for view in Camera],
            "walks": [self._facts(walk) for walk in self.walks],
            "marks": [{"at": spot, "text": f"{spot[0]:g} m"} for spot in stage.marks.tolist()],
        }

    def _facts(self, walk: Walk) -> dict[str, Any]:
        """What the board says of a walk."""
        rollout, body = walk.rollout, walk.rollout.phenotype
        whole = rollout.verdict != UNSTABLE  # or its last numbers are nonsense
        facts = [
            ("way forward", with_unit(rollout.distance, "m") if whole else "–"),
            ("speed", with_unit(rollout.velocity, "m/s") if whole else "–"),
        ]
        name, unit = label(self.settings.algorithm.fitness)
        if name not in ("distance", "velocity") and rollout.counts:
            with suppress(RunFileError):  # of a fitness of the user's own, a run file knows the name only
                fitness = score(rollout, self.settings.algorithm.fitness)
                facts.append((name, with_unit(fitness, unit) if rollout.counts else "does not count"))
        facts += [
            ("body", f"{count(len(body.segments), 'segment')}, {count(body.n_legs, 'leg')}"),
            ("length", with_unit(body.body_length, "m")),
            ("weight", with_unit(body.weight, "kg")),
        ]
        void = f"Does not count: {rollout.verdict}, {rollout.reason}."
        return {
            "label": walk.label,
            "colour": to_hex(walk.colour) if walk.colour else NATURAL,
            "counts": rollout.counts,
            "verdict": VERDICTS["ok"] if rollout.counts else void,
            "facts": facts,
            "start": float(np.nan_to_num(rollout.com[0, 0])),
        }


def replay(walkers: Any, settings: Settings | None = None, *, camera: Camera | str | int | None = None) -> Replay:
    """Let one robot or several walk, and show it in 3D; needs no GL where Python runs, and WebGL where it is seen.

    Several are a race: each in a colour of its own, side by side where the ground is the same across the way, and
    otherwise through one another, for each walked alone; what lies about is then shown as the one that came farthest
    moved it.

    Args:
        walkers: a genome, its text, an individual, or a run for its champion; or several, as a list, or by label.
        settings: of terrain, robot and simulation; the defaults if None.
        camera: side, front, top, chase or orbit; that of the settings if None.

    Raises:
        GenomeError: if a text is no genome.
        SettingsError: if there is no such camera.
        ValueError: if there is nobody to walk.
    """
    settings = Settings() if settings is None or isinstance(walkers, Settings) else require_settings(settings)
    if camera is not None:
        settings = settings.with_(camera=camera)
    return Replay(line_up(walkers, settings), settings, settings.simulation.camera)


# ---------------------------------------------------------------------------------------------- in a notebook


class Frame(HasSnapshot, anywidget.AnyWidget):
    """A picture in a notebook; pressed, it becomes the page, and closed it is a picture again.

    Of a replay it has the page from the start, so that it plays while the kernel is busy, or gone. A notebook keeps
    every widget: this one holds nothing else of the walks.
    """

    title = "replay"
    _esm = HERE / "frame.js"
    _css = LIVE_STYLE
    poster = traitlets.Unicode("").tag(sync=True)
    alt = traitlets.Unicode("").tag(sync=True)
    page = traitlets.Bytes(b"").tag(sync=True)
    is_open = traitlets.Bool(False).tag(sync=True)  # whether the page is to be seen

    def __init__(self, shown: Replay | None = None) -> None:
        """Show a replay, or nothing yet."""
        super().__init__()
        self._make: Callable[[], Replay] | None = None
        self.on_msg(self._hear)
        if shown:
            picture = base64.b64encode(poster(shown.walks, shown.settings)).decode("ascii")
            walks = "; ".join(f"{walk.label}, {with_unit(walk.rollout.distance, 'm')} forward" for walk in shown.walks)
            self.alt, self.page = f"Replay of {walks}.{PRESS}", shown.page.encode("utf-8")
            self.poster = f"data:image/png;base64,{picture}"

    def offer(self, make: Callable[[], Replay], picture: str, alt: str) -> None:
        """Offer another replay, which is made when somebody wants to see it.

        Args:
            make: makes it.
            picture: its poster, as a URL of data.
            alt: what it shows, in words.
        """
        with self.hold_sync():
            self._make, self.page, self.alt, self.poster = make, b"", alt, picture

    def __repr__(self) -> str:
        """Name the walks."""
        return f"<{self.alt or 'A replay: nothing to be shown yet'}>"

    def snapshot(self) -> Html:
        """Write the picture as static HTML."""
        if not self.poster:
            return tag("p", "No walk was offered yet.")
        return tag("img", src=self.poster, alt=self.alt.removesuffix(PRESS), style=WHITE)

    def play(self) -> None:
        """Press it."""
        self.send({"play": True})

    def _hear(self, _widget: object, message: Any, _buffers: object) -> None:
        make = self._make
        if make and message == {"want": "page"}:
            page = make().page.encode("utf-8")
            if make is self._make:  # and no other walk was offered meanwhile
                self.page = page
