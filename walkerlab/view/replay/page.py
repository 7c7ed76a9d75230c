"""The replay: recorded walks as one HTML page that plays offline, in a notebook or as a file.

The page is K3D's snapshot of the plot with the player (player.js), which receives the recording as JSON:

    meshes, walks, cameras, marks     moving meshes, facts about each walk, camera names, distance marks on the ground
    channels, resolution, duration    positions over time, encoded by ``tracks.pack_channels``
    shadows                           meshes that must not darken each other
    footprints, footprint_indices     a mesh for each walk with the times of its prints; number of indices per print
    camera                            camera at the start

Because browsers limit the number of WebGL contexts, a notebook shows a preview image first; a click replaces it with
the page, and closing the page restores the image.
"""

import base64
import json
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import anywidget
import numpy as np
import traitlets

from walkerlab.runfile.opening import RunFileError
from walkerlab.settings.arguments import require_settings
from walkerlab.settings.choices import Camera
from walkerlab.settings.settings import Settings
from walkerlab.settings.values import pluralize
from walkerlab.simulation.fitness import name_and_unit, score
from walkerlab.simulation.validity import UNSTABLE, VERDICTS
from walkerlab.text.html import data_url
from walkerlab.text.numbers import with_unit
from walkerlab.text.templates import Markup, render
from walkerlab.view.pages import CANVAS, complete_snapshot, write_page
from walkerlab.view.replay.animation import Animation, Walk, build_animation
from walkerlab.view.replay.meshes import DISC_CORNERS
from walkerlab.view.replay.preview import draw_preview
from walkerlab.view.replay.tracks import pack_channels
from walkerlab.view.replay.walkers import simulate_walks
from walkerlab.view.sketch.svg import hex_colour
from walkerlab.view.snapshots import LIVE_STYLE, HasSnapshot

REPLAY_FOLDER = Path(__file__).parent
PLAY_HINT = " Press to play."  # last sentence of the alternative text of a preview image
TRUNK_COLOUR = "#e69f00"


@dataclass(frozen=True, eq=False)
class Replay:
    """Replay of recorded walks in 3D; displayed when it is the last expression in a notebook cell.

    Attributes:
        walks: Recorded walks, at least one.
        settings: Settings of the world.
        camera: Camera at the start.
    """

    walks: tuple[Walk, ...]
    settings: Settings
    camera: Camera

    def __repr__(self) -> str:
        """Return the labels of the walks and how to show the replay."""
        names = ", ".join(walk.label for walk in self.walks)
        return f"Replay({names}; camera {self.camera.name}; show it in a notebook, or save it with .to_html(path))"

    def to_html(self, path: str | Path) -> Path:
        """Save the replay as one file that plays offline in any browser with WebGL 2, on a computer or a phone.

        Args:
            path: File to write, whose name ends in ``.html``; an existing file is replaced.

        Returns:
            The path of the file.

        Raises:
            ValueError: If the name does not end in ``.html``.
            OSError: If the file cannot be written.
        """
        return write_page(lambda: self.page, path)

    @cached_property
    def page(self) -> str:
        """The complete page, as HTML."""
        animation = build_animation(list(self.walks), self._title)
        player = (REPLAY_FOLDER / "player.js").read_text(encoding="utf-8")
        # "<" is escaped so that no text in the recording can close the script element
        recording = json.dumps(self._recording(animation)).replace("<", "\\u003c")
        code = f"({player.strip()})(K3DInstance, {recording});"
        snapshot: str = animation.plot.get_snapshot(additional_js_code=code)
        animation.close()
        head = render("view/replay/head.html", title=self._title)
        unavailable = (REPLAY_FOLDER / "unavailable.html").read_text(encoding="utf-8")
        return complete_snapshot(snapshot, head, f"{CANVAS}\n{unavailable}")

    @property
    def widget(self) -> "Frame":
        """A new widget that shows the replay in a notebook, at first as its preview image."""
        return Frame(self)

    def _ipython_display_(self, **_: Any) -> None:
        self.widget._ipython_display_()

    @property
    def _title(self) -> str:
        return self.walks[0].label if len(self.walks) == 1 else f"Race of {len(self.walks)} robots"

    def _recording(self, animation: Animation) -> dict[str, Any]:
        """Return what player.js requires, as JSON data."""
        packed = pack_channels(animation.channels, animation.resolution)
        return {
            "meshes": animation.mesh_ids,
            "channels": base64.b64encode(packed).decode("ascii"),
            "resolution": animation.resolution.tolist(),
            "duration": animation.duration,
            "camera": self.camera.name,
            "cameras": [{"name": camera.name, "up": animation.up_directions[camera]} for camera in Camera],
            "walks": [self._walk_facts(walk) for walk in self.walks],
            "marks": [{"position": mark, "text": f"{mark[0]:g} m"} for mark in animation.marks.tolist()],
            "shadows": animation.shadow_ids,
            "footprints": [
                {"mesh": found.mesh.id, "times": found.times.round(3).tolist()} for found in animation.footprints
            ],
            "footprint_indices": 3 * DISC_CORNERS,
        }

    def _walk_facts(self, walk: Walk) -> dict[str, Any]:
        """Return the facts about a walk that the player shows in its list."""
        rollout = walk.rollout
        body = rollout.phenotype
        is_finite = rollout.verdict != UNSTABLE
        facts = [
            ("distance forward", with_unit(rollout.distance, "m") if is_finite else "–"),
            ("speed", with_unit(rollout.velocity, "m/s") if is_finite else "–"),
        ]
        name, unit = name_and_unit(self.settings.algorithm.fitness)
        if name not in ("distance", "velocity") and rollout.counts:
            with suppress(RunFileError):  # a loaded run contains only the name of a user function
                fitness = score(rollout, self.settings.algorithm.fitness)
                facts.append((name, with_unit(fitness, unit) if rollout.counts else "does not count"))
        facts += [
            ("body", f"{pluralize(len(body.segments), 'segment')}, {pluralize(body.n_legs, 'leg')}"),
            ("length", with_unit(body.body_length, "m")),
            ("weight", with_unit(body.weight, "kg")),
        ]
        rejection = f"Does not count: {rollout.verdict}, {rollout.reason}."
        return {
            "label": walk.label,
            "colour": hex_colour(walk.colour) if walk.colour else TRUNK_COLOUR,
            "counts": rollout.counts,
            "verdict": VERDICTS["ok"] if rollout.counts else rejection,
            "facts": facts,
            "start": float(np.nan_to_num(rollout.com[0, 0])),
        }


def replay(walkers: Any, settings: Settings | None = None, *, camera: Camera | str | int | None = None) -> Replay:
    """Simulate one robot or several and show their walks in 3D.

    OpenGL is not required, but the browser must support WebGL 2. Several robots are shown as a race, each in its own
    colour. They run side by side if the ground does not vary sideways. Otherwise they start at the same place and pass
    through each other, because each was simulated alone. In a race, loose obstacles move as in the simulation of the
    robot that got furthest.

    Args:
        walkers: Genome, its text, an individual, or a run (its champion); or several of these, as a list, or as a dict
            with labels as keys.
        settings: Settings of terrain, robot and simulation; the defaults if None.
        camera: Camera at the start: side, front, top, chase or orbit; if None, the camera in the settings.

    Raises:
        GenomeError: If a string is not a valid genome.
        SettingsError: If the camera does not exist.
        TypeError: If ``walkers`` contains something else.
        ValueError: If there are no robots.
    """
    settings = Settings() if settings is None or isinstance(walkers, Settings) else require_settings(settings)
    if camera is not None:
        settings = settings.with_(camera=camera)
    return Replay(simulate_walks(walkers, settings), settings, settings.simulation.camera)


# ---------------------------------------------------------------------------------------------- in a notebook


class Frame(HasSnapshot, anywidget.AnyWidget):
    """Widget that shows the preview image of a replay; a click opens the page, and closing it restores the image.

    The widget of a replay contains the page from the start, so that the replay can be played even while the kernel is
    busy or stopped. A notebook keeps every widget in memory; therefore a frame has no references to the walks.
    """

    title = "replay"
    _esm = REPLAY_FOLDER / "frame.js"
    _css = LIVE_STYLE
    preview = traitlets.Unicode("").tag(sync=True)  # data URL of the preview image
    alt = traitlets.Unicode("").tag(sync=True)  # alternative text of the preview image
    page = traitlets.Bytes(b"").tag(sync=True)  # page of the replay; empty until it is created
    is_open = traitlets.Bool(False).tag(sync=True)  # whether the page is displayed
    number = traitlets.Int(0).tag(sync=True)  # number of the replay, which changes when another one is set
    is_busy = traitlets.Bool(False).tag(sync=True)  # whether an animated preview image must not take computing time

    def __init__(self, shown: Replay | None = None) -> None:
        """Show a replay, or nothing if None."""
        super().__init__()
        self._make: Callable[[], Replay] | None = None
        self._is_opening = False
        self.observe(self._opened, "is_open")
        self.on_msg(self._handle_message)
        if shown:
            walks = "; ".join(f"{walk.label}, {with_unit(walk.rollout.distance, 'm')} forward" for walk in shown.walks)
            self.alt = f"Replay of {walks}.{PLAY_HINT}"
            self.page = shown.page.encode("utf-8")
            self.preview = data_url("image/png", draw_preview(shown.walks, shown.settings))

    def set_replay(self, make: Callable[[], Replay], picture: str, alt: str) -> None:
        """Show the preview image of another replay, which is created when it is first played.

        Args:
            make: Function that creates the replay.
            picture: Data URL of its preview image.
            alt: Alternative text of the image.
        """
        with self.hold_sync():
            self._make = make
            self._is_opening = False
            self.number += 1
            self.page = b""
            self.alt = alt
            self.preview = picture

    def __repr__(self) -> str:
        """Return the alternative text of the preview image."""
        return f"<{self.alt or 'A replay without a walk'}>"

    def snapshot(self) -> Markup:
        """Return the preview image as static HTML."""
        return render("view/replay/frame.html", url=self.preview, alt=self.alt.removesuffix(PLAY_HINT))

    @property
    def is_watched(self) -> bool:
        """Whether the page is displayed, or is being created to be displayed."""
        return bool(self.is_open) or self._is_opening

    def play(self, *, reveal: bool = False) -> None:
        """Open the page and play it.

        Args:
            reveal: Whether to scroll to the page if it is outside the window.
        """
        self._is_opening = True
        self.send({"play": True, "reveal": reveal})

    def stop(self) -> None:
        """Close the page, if it is displayed or being created; the preview image is shown again."""
        self._is_opening = False
        self.send({"stop": True})

    def _opened(self, change: Any) -> None:
        if change.new and self.page:  # without a page, the browser reports that an earlier replay was opened
            self._is_opening = False

    def _handle_message(self, _widget: object, message: Any, _buffers: object) -> None:
        """Create the page that the browser requests.

        If another replay was set before the request arrived, that one is played, because the user sees its picture.
        """
        make = self._make
        match message:
            case {"request": "page", "number": int(number)} if make:
                if number != self.number:
                    self.play()
                    return
                self._is_opening = True
                try:
                    page = make().page.encode("utf-8")
                except Exception:
                    self._is_opening = False
                    raise
                if make is self._make:  # no other replay was set in the meantime
                    self.page = page
            case _:
                pass
