"""The replay: recorded walks as one HTML page that plays offline, in a notebook or on its own.

The page is K3D's own snapshot of the stage, with the player (player.js) added. The player is handed the *reel*:

    things, walks, cameras, marks    what moves, who walks, from where it is seen, what is written on the ground
    channels, finest, seconds        all positions over time, packed by ``tracks.pack``

In a notebook a picture comes first; the page is fetched from the kernel when it is clicked, and thrown away when it is
closed, for browsers keep few WebGL contexts.
"""

import base64
import html
import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import anywidget
import numpy as np
import traitlets
from matplotlib.colors import to_hex, to_rgb

from walkerlab.choices import Camera, Structure
from walkerlab.fitness import distance, label, score, velocity
from walkerlab.genome import Genome
from walkerlab.ground import height
from walkerlab.judge import VERDICTS
from walkerlab.plots.style import RUNS
from walkerlab.rollout import simulate
from walkerlab.scene import compile_scene
from walkerlab.settings import Settings, Terrain
from walkerlab.shapes import skins
from walkerlab.viewer.meshes import BESIDE
from walkerlab.viewer.poster import poster
from walkerlab.viewer.stage import MARKS, Stage, Walk, set_up
from walkerlab.viewer.tracks import pack

HERE = Path(__file__).parent
NATURAL = "#e69f00"  # the colour of a trunk
GAP = 0.35  # m between the lanes of a race


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
        path = Path(path)
        if path.suffix.lower() not in (".html", ".htm"):
            raise ValueError(f"path is {str(path)!r}; it must end in .html: a page, which a browser opens")
        if not path.parent.is_dir():
            raise FileNotFoundError(f"there is no folder {path.parent}; make it first. It is where {path.name} goes.")
        path.write_text(self.page, encoding="utf-8")
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
        head = (
            f'<meta name="viewport" content="width=device-width">\n<title>{html.escape(self._title)}</title>\n'
            f"<style>{style}</style>"
        )
        page = re.sub(r"<title>.*?</title>", lambda _: head, page, count=1, flags=re.DOTALL)
        excuse = (HERE / "excuse.html").read_text(encoding="utf-8")
        page = page.replace('<div id="canvasTarget"></div>', f'<div id="canvasTarget"></div>\n{excuse}', 1)
        return page.replace("<html>", '<html lang="en">', 1)

    @property
    def widget(self) -> "Frame":
        """A new widget that shows it in a notebook: a picture first."""
        return Frame(self)

    def _repr_mimebundle_(self, **_: Any) -> Any:
        frame = self.widget
        bundle, *more = frame._repr_mimebundle_()  # type: ignore[misc]
        picture = f'<img src="{frame.poster}" alt="{html.escape(frame.alt)}" style="max-width: 100%">'
        return {**bundle, "text/plain": repr(self), "text/html": picture}, *more

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
            "marks": _marks(self.settings.terrain, self.walks),
        }

    def _facts(self, walk: Walk) -> dict[str, Any]:
        """What the board says of a walk."""
        rollout, body = walk.rollout, walk.rollout.phenotype
        name, unit = label(self.settings.algorithm.fitness)
        facts = [("way forward", f"{distance(rollout):.2f} m"), ("speed", f"{velocity(rollout):.2f} m/s")]
        if name not in ("distance", "velocity") and rollout.counts:
            facts.append((name, f"{score(rollout, self.settings.algorithm.fitness):.3g} {unit}".strip()))
        n_legs = sum(2 for segment in body.segments if segment.legs)
        facts += [
            ("body", f"{len(body.segments)} segment{'s' * (len(body.segments) > 1)}, {n_legs} legs"),
            ("length", f"{body.body_length:.2f} m"),
            ("weight", f"{body.weight:.1f} kg"),
        ]
        void = f"Does not count: {rollout.verdict}, {rollout.reason}."
        return {
            "label": walk.label,
            "colour": to_hex(walk.colour) if walk.colour else NATURAL,
            "counts": rollout.counts,
            "verdict": VERDICTS["ok"] if rollout.counts else void,
            "facts": [fact for fact in facts if "nan" not in fact[1]],
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
    settings = Settings() if settings is None else settings
    if camera is not None:
        settings = settings.with_(camera=camera)
    named = _named(walkers)
    if not named:
        raise ValueError("there is nobody to walk: give replay a genome, or several")
    scenes = [compile_scene(genome, settings, scenery=True) for genome in named.values()]
    rollouts = [simulate(genome, settings) for genome in named.values()]
    first = int(np.argmax([np.nan_to_num(distance(rollout), nan=-np.inf) for rollout in rollouts]))
    race = len(named) > 1
    lanes = _lanes(scenes, settings.terrain) if race else [0.0]
    walks = [
        Walk(name, scene, rollout, to_rgb(RUNS[i % len(RUNS)]) if race else None, lanes[i], loose=i == first)
        for i, (name, scene, rollout) in enumerate(zip(named, scenes, rollouts, strict=True))
    ]
    return Replay(tuple(walks), settings, settings.simulation.camera)


def _named(walkers: Any) -> dict[str, Genome]:
    """Give every walker a name."""
    if isinstance(walkers, Settings):
        raise TypeError("first comes who walks, and then the settings: wl.replay(genome, settings)")
    walkers = getattr(walkers, "champion", walkers)  # of a run
    if isinstance(walkers, Mapping):
        return {str(name): Genome.of(getattr(one, "genome", one)) for name, one in walkers.items()}
    if isinstance(walkers, str | Genome) or hasattr(walkers, "genome") or getattr(walkers, "ndim", 0) == 1:
        walkers = [walkers]
    several = list[Any](walkers)
    names = [
        f"robot {one.individual}" if hasattr(one, "individual") else f"robot {number}" if len(several) > 1 else "robot"
        for number, one in enumerate(several, start=1)
    ]
    return _named(dict(zip(names, several, strict=True)))


def _lanes(scenes: Sequence[Any], terrain: Terrain) -> list[float]:
    """Return how far to the left each walks: side by side if the ground is the same everywhere across the way."""
    if terrain.structure == Structure.rough or terrain.n_pieces or terrain.obstacle:
        return [0.0] * len(scenes)
    widths = [2 * max(np.abs(skin[:, 1]).max() for skin, _ in skins(scene, scene.start)) + GAP for scene in scenes]
    middles = np.cumsum(widths) - np.array(widths) / 2
    return (middles[::-1] - middles.mean()).tolist()


def _marks(terrain: Terrain, walks: Sequence[Walk]) -> list[dict[str, Any]]:
    """Number the metres along the way, on the near side of all lanes."""
    x, y = np.arange(MARKS + 1.0), min(walk.lane for walk in walks) - BESIDE
    z = height(terrain, x, np.full_like(x, y)) + 0.02
    return [{"at": [along, y, up], "text": f"{along:g} m"} for along, up in zip(x.tolist(), z.tolist(), strict=True)]


# ---------------------------------------------------------------------------------------------- in a notebook


class Frame(anywidget.AnyWidget):
    """A picture in a notebook; clicked, it becomes the page, and closed it is a picture again."""

    _esm = HERE / "frame.js"
    poster = traitlets.Unicode("").tag(sync=True)
    alt = traitlets.Unicode("").tag(sync=True)

    def __init__(self, shown: Replay) -> None:
        super().__init__(
            poster=f"data:image/png;base64,{base64.b64encode(poster(shown.walks, shown.settings)).decode('ascii')}"
        )
        walks = "; ".join(f"{walk.label}, {distance(walk.rollout):.2f} m forward" for walk in shown.walks)
        self.alt = f"Replay of {walks}. Press to play."
        self._shown = shown
        self.on_msg(self._answer)

    def _answer(self, _: Any, message: Any, __: Any) -> None:
        if message == "open":
            self.send("page", buffers=[self._shown.page.encode("utf-8")])
