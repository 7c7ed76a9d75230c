"""Every widget leaves a static picture in the notebook, which is self-contained, small and up to date."""

import importlib
import inspect
import pkgutil
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import ipywidgets
import nbclient
import nbformat
import pytest
from matplotlib.figure import Figure

import walkerlab as wl
from tests.frontends import book
from tests.text.test_html import Seen, assert_harmless
from walkerlab import widgets
from walkerlab.view import snapshots
from walkerlab.view.replay.page import Frame
from walkerlab.view.snapshots import HasSnapshot, snapshot_html
from walkerlab.widgets.clickable_plot import PlotPicture
from walkerlab.widgets.component import Component
from walkerlab.widgets.panel.card import Card, robot_card
from walkerlab.widgets.panel.drawer import Drawer
from walkerlab.widgets.panel.drawing_thread import DrawingThread
from walkerlab.widgets.panel.generation_slider import GenerationSlider
from walkerlab.widgets.panel.robot import RobotArea
from walkerlab.widgets.panel.run_folders import ListedRun
from walkerlab.widgets.panel.run_list import RunList
from walkerlab.widgets.panel.runs import RunsArea
from walkerlab.widgets.panel.transport import Transport
from walkerlab.widgets.panel.walker_view import ShownWalker, WalkerCaption, WalkerView
from walkerlab.widgets.playground import Playground
from walkerlab.widgets.questions import Item, Questions, Reply

MAX_SIZE = 200_000  # characters
EVIL = "</pre><script>alert(1)</script><img src=x onerror=alert(1)>"


@pytest.fixture(scope="module")
def done():
    settings = wl.Settings().with_(population_size=6, generations=4, duration=1)
    with ThreadPoolExecutor(2) as workers:
        return wl.evolve(settings, executor=workers, progress=False)


def ignore(*_):
    pass


def panel(run):
    lab = wl.Lab(run.settings, executor=ThreadPoolExecutor(1))
    lab.runs.add(ListedRun("a", run.settings, run), EVIL)
    return lab


def runs_area(run):
    area = RunsArea(Path("lab"), DrawingThread(lambda: False, ignore), ignore, ignore, ignore)
    area.run_list.add("a", name=EVIL)
    area.curve.draw({EVIL: run.records})
    return area


def robot_area(run):
    area = RobotArea(run.settings, ignore)
    area.show(run, -1)
    return area


def drawer(_run):
    made = Drawer(ignore, ignore, ignore, ignore)
    made.code = EVIL
    return made


def generation_slider(run):
    made = GenerationSlider()
    made.n_generations = run.n_generations
    return made


def card(run):
    shown = Card()
    shown.value = robot_card(run.records, run.champion.individual)
    return shown


def walker_caption(_run):
    made = WalkerCaption()
    made.words = EVIL
    return made


def walker_view(run):
    made = WalkerView()
    made.show(ShownWalker(run.champion.genome, run.settings, EVIL, EVIL))
    return made


def run_list(_run):
    made = RunList()
    made.add("a", name=EVIL, best="1 m")
    return made


def transport(_run):
    made = Transport(ignore)
    made.words = EVIL
    return made


def landscape(run):
    with ThreadPoolExecutor(1) as pool:
        table = wl.analysis.landscape(run.champion, run.settings, "frequency", n=2, executor=pool)
    return widgets.Landscape(table, run.settings)


def clickable_plot(champion):
    axes = Figure().add_subplot(title=EVIL, xlabel=EVIL)
    return widgets.ClickablePlot(axes, [(0, 0)], [champion], wl.Settings(), [EVIL])


def questions(_run):
    made = Questions([Item(EVIL, (EVIL, "no"))], lambda _, choice: Reply("right", choice), title="quiz")
    made.answers = [EVIL]
    return made


def print_height(step_height):
    print(EVIL, step_height)


MAKE = {
    widgets.Curve: lambda run: widgets.Curve({EVIL: run.records, "other": run.records}),
    widgets.Editor: lambda run: widgets.Editor(EVIL, run.settings),
    widgets.Form: lambda run: widgets.Form(run.settings),
    widgets.Interactive: lambda run: widgets.Interactive(print_height, ["step_height"]),
    widgets.Lab: panel,
    widgets.Landscape: landscape,
    PlotPicture: lambda run: landscape(run).plot,
    widgets.ClickablePlot: lambda run: clickable_plot(run.champion),
    widgets.Microscope: lambda run: widgets.Microscope(run),
    Playground: lambda run: Playground({EVIL: run.champion}, run.settings),
    widgets.Population: lambda run: widgets.Population(run),
    widgets.SelectionWheel: lambda run: widgets.SelectionWheel(run),
    widgets.World: lambda run: widgets.World(run.settings.with_(structure="rough")),
    Card: card,
    Drawer: drawer,
    GenerationSlider: generation_slider,
    Questions: questions,
    WalkerCaption: walker_caption,
    WalkerView: walker_view,
    Frame: lambda run: wl.replay({EVIL: run.champion}, run.settings).widget,
    RobotArea: robot_area,
    RunsArea: runs_area,
    RunList: run_list,
    Transport: transport,
}
"""Function that makes each widget, given a run to show."""


def widget_classes():
    """Return every class of walkerlab's that a notebook shows as a widget."""
    names = [
        "walkerlab.view.replay.page",
        *(one.name for one in pkgutil.walk_packages(widgets.__path__, "walkerlab.widgets.")),
    ]
    found = {
        member
        for module in map(importlib.import_module, names)
        for member in vars(module).values()
        if inspect.isclass(member) and issubclass(member, ipywidgets.DOMWidget) and member.__module__ == module.__name__
    }
    return found - {Component}


def test_every_widget_has_a_snapshot_and_is_tested():
    assert widget_classes() == set(MAKE)
    assert {one for name in widgets.__all__ if inspect.isclass(one := getattr(widgets, name))} <= set(MAKE)
    assert all(issubclass(kind, HasSnapshot) for kind in MAKE)


@pytest.mark.parametrize("kind", MAKE, ids=lambda kind: kind.__name__)
def test_a_snapshot_is_self_contained_named_and_small(kind, done, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    widget = MAKE[kind](done)
    html = snapshot_html(widget)
    seen = assert_harmless(html)
    assert f"Static picture of the {widget.title}. Run the cells again for the interactive version." in seen.text
    assert "could not be drawn" not in seen.text
    assert widget.snapshot()
    assert len(html) < MAX_SIZE
    if kind in (
        widgets.Curve,
        widgets.Lab,
        widgets.Microscope,
        Playground,
        widgets.Population,
        widgets.World,
        Frame,
        RobotArea,
        RunsArea,
        WalkerView,
    ):
        assert seen.all("img")
    widget.close()


@pytest.mark.parametrize(
    "kind", [widgets.Curve, widgets.Population, widgets.Editor, widgets.Form, widgets.World, widgets.SelectionWheel]
)
def test_a_widget_without_content_has_a_snapshot(kind):
    html = snapshot_html(kind())
    assert "could not be drawn" not in html
    assert Seen(html).all("img") or "No generation is complete yet." in html or "<table>" in html


def test_a_snapshot_of_a_population_shows_at_most_twelve_robots(done):
    robots = widgets.Population(done)
    robots.as_table = True
    assert "<td" in snapshot_html(robots)
    robots.as_table = False
    assert len(Seen(snapshot_html(robots)).all("img")) == min(done.settings.algorithm.population_size, 12)


def test_an_error_in_a_snapshot_is_shown_instead_of_the_picture(monkeypatch):
    world = widgets.World()
    monkeypatch.setattr(world, "snapshot", lambda: 1 / 0)
    assert "The picture could not be drawn. ZeroDivisionError" in snapshot_html(world)


def test_a_snapshot_is_sent_again_only_when_it_has_changed(monkeypatch):
    shell = Shell()
    sent = []
    monkeypatch.setattr("IPython.core.getipython.get_ipython", lambda: shell)
    monkeypatch.setattr("IPython.display.display", lambda bundle, **options: sent.append((bundle, options)))
    monkeypatch.setattr(snapshots, "QUIET_TIME", 60)
    world = widgets.World()
    view, _ = world._repr_mimebundle_()
    monkeypatch.setattr(world, "_repr_mimebundle_", lambda: (view, {"for": "Colab"}))
    world._ipython_display_()
    (view, view_options), (picture, options) = sent
    assert "application/vnd.jupyter.widget-view+json" in view
    assert view_options["metadata"] == {"for": "Colab"}
    assert view["text/html"] == ""
    assert options["display_id"]
    [on_cell_end] = shell.callbacks
    on_cell_end(None)
    assert len(sent) == 2
    world.number += 1
    on_cell_end(None)
    assert len(sent) == 3
    updated, update_options = sent[-1]
    assert update_options == options | {"update": True}
    assert updated["text/html"] != picture["text/html"]
    world.number += 1
    world.close()
    assert len(sent) == 4
    assert shell.callbacks == []


class Shell:
    """Substitute for the shell of a notebook."""

    kernel = object()

    def __init__(self):
        self.callbacks = []
        self.events = self

    def register(self, event, callback):
        assert event == "post_run_cell"
        self.callbacks.append(callback)

    def unregister(self, event, callback):
        self.callbacks.remove(callback)


SHOW = """
from threading import Thread
from IPython.display import clear_output
import walkerlab as wl
from walkerlab.widgets import Form, Interactive, World
form = Form(only=["terrain"])
quiz = wl.lessons.quiz("03")
def show(step_height):
    other = Thread(target=display, args=["of another thread"])
    other.start()
    other.join()
    print("old")
    clear_output()
    print("step", step_height)
    display("shown")
interactive = Interactive(show, ["step_height"])
display(form, World(), quiz, interactive)
wl.Lab(form.settings)
"""
CHANGE = """
form.settings = form.settings.with_(step_height=0.123, structure='stairs')
interactive.controls["step_height"].value = 0.2
quiz.answers = [next(iter(item["choices"])) for item in quiz.items]
"""


def test_an_executed_notebook_contains_the_last_state_of_the_widgets(tmp_path):
    """Nbclient and nbconvert run no JavaScript; their pages show the snapshots."""
    notebook = book(SHOW, CHANGE)
    nbclient.NotebookClient(notebook, timeout=60, resources={"metadata": {"path": str(tmp_path)}}).execute()
    nbformat.validate(notebook)
    other, *outputs = [output.data for output in notebook.cells[0].outputs]
    assert "of another thread" in other["text/plain"]
    assert [sorted(output) for output in outputs[::2]] == [sorted(VIEW)] * 5
    form, world, quiz, interactive, lab = (output["text/html"] for output in outputs[1::2])
    assert "0.123 m" in form
    assert Seen(world).all("img")
    assert "<pre>step 0.2" in interactive
    assert "shown" in interactive
    assert "of another thread" not in interactive
    assert quiz.count("●") == quiz.count("?</b>") > 0
    assert len(Seen(lab).all("img")) >= 2


VIEW = {"application/vnd.jupyter.widget-view+json", "text/html", "text/plain"}
