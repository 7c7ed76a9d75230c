"""The picture of a walking robot at the top of the panel: the best robot so far, which can also be played in 3D."""

import threading
from dataclasses import dataclass

import ipywidgets
import traitlets

from walkerlab.genome.genome import Genome
from walkerlab.settings.settings import Settings
from walkerlab.simulation.rollout import simulate_walk
from walkerlab.text.html import data_url
from walkerlab.text.templates import Markup, render
from walkerlab.view.replay import Replay, replay
from walkerlab.view.replay.page import PLAY_HINT, Frame
from walkerlab.view.sketch.walks import draw_walk
from walkerlab.view.snapshots import HasSnapshot
from walkerlab.widgets.component import Component, answer_on_requested_thread, load_script, load_style
from walkerlab.world.scene import compile_scene


@dataclass(frozen=True)
class ShownWalker:
    """A robot in the picture.

    Attributes:
        genome: Its genome.
        settings: Settings of the world in which it walks.
        name: Name of the robot, in the alternative text and in the 3D replay.
        words: Text of the caption.
    """

    genome: Genome
    settings: Settings
    name: str
    words: str


class WalkerCaption(Component):
    """The caption of the picture, with a button that stops the motion.

    Attributes:
        words: Text of the caption.
        moves: Whether the picture moves.
        news: Text about a better robot that was found while the replay of another one is open; otherwise empty.
    """

    title = "caption"
    _esm = load_script("panel/walker_view")
    _css = load_style("panel/walker_view")
    words = traitlets.Unicode("").tag(sync=True)
    moves = traitlets.Bool(True).tag(sync=True)
    news = traitlets.Unicode("").tag(sync=True)

    def snapshot(self) -> Markup:
        """Return the caption as static HTML."""
        return render("widgets/panel/walker_view.html", words=self.words, url="", alt="")


class WalkerView(HasSnapshot, ipywidgets.Box):
    """A moving side view of one robot's walk; a click plays the walk in 3D.

    Attributes:
        caption: Caption, with a button that stops the motion.
        frame: Picture and replay.
    """

    title = "walking robot"

    def __init__(self) -> None:
        """Create the view without a robot."""
        self.caption = WalkerCaption()
        self.frame = Frame()
        self._shown: ShownWalker | None = None
        self._wanted: ShownWalker | None = None
        self._lock = threading.RLock()
        self._still = ""  # SVG without motion, for the snapshot
        super().__init__([self.caption, self.frame])
        self.add_class("wl-walker")
        self.frame.add_class("wl-frame")
        answer_on_requested_thread(self.frame)
        self.frame.observe(self._is_open_changed, "is_open")
        self.caption.observe(self._motion_changed, "moves")
        self.caption.on_msg(self._handle_message)

    def show(self, walker: ShownWalker) -> None:
        """Show a robot, after an open replay is closed; this can be called from any thread."""
        with self._lock:
            self._wanted = walker
            is_new = walker != self._shown
            self.caption.news = walker.words if is_new and self.frame.is_open else ""
            if is_new and not self.frame.is_watched:
                self._shown = walker
                self._draw()

    def snapshot(self) -> Markup:
        """Return the caption and a picture without motion as static HTML."""
        url = data_url("image/svg+xml", self._still.encode()) if self._still else ""
        return render("widgets/panel/walker_view.html", words=self.caption.words, url=url, alt=str(self.frame.alt))

    def _is_open_changed(self, _change: object) -> None:
        if self._wanted:
            self.show(self._wanted)

    def _handle_message(self, _widget: object, message: object, _buffers: object) -> None:
        """Play the new robot if the user requests it."""
        if message == "play" and self._wanted:
            self.frame.stop()
            with self._lock:
                self._shown = self._wanted
                self.caption.news = ""
                self._draw()
            self.frame.play()

    def _motion_changed(self, _change: object) -> None:
        with self._lock:
            self._draw()

    def _draw(self) -> None:
        """Simulate the walk and draw it."""
        if not (walker := self._shown):
            return
        scene = compile_scene(walker.genome, walker.settings)
        walk = simulate_walk(scene)
        self._still = draw_walk(scene, walk, moves=False)
        picture = draw_walk(scene, walk) if self.caption.moves else self._still

        def make_replay() -> Replay:
            return replay({walker.name: walker.genome}, walker.settings)

        self.caption.words = walker.words
        url = data_url("image/svg+xml", picture.encode())
        self.frame.set_replay(make_replay, url, f"{walker.name}, walking.{PLAY_HINT}")

    def close(self) -> None:
        """Close the view and its parts."""
        self.frame.unobserve_all()
        super().close()
