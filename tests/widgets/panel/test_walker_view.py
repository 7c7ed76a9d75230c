"""The walking robot at the top of the panel: a replay that is watched stays, and better robots are announced."""

import numpy as np

import walkerlab as wl
from walkerlab.widgets.panel.walker_view import ShownWalker, WalkerView

SETTINGS = wl.Settings().with_(duration=1)


def walkers():
    rng = np.random.default_rng(1)
    return [ShownWalker(wl.Genome.random(SETTINGS.robot, rng=rng), SETTINGS, name, f"Best: {name}.") for name in "ab"]


def test_a_better_robot_is_announced_while_a_replay_is_open_and_played_on_request():
    first, better = walkers()
    view = WalkerView()
    view.show(first)
    view.frame.is_open = True
    view.show(better)
    assert (view.caption.words, view.caption.news) == (first.words, better.words)
    view.caption._handle_custom_msg("play", [])
    assert (view.caption.words, view.caption.news) == (better.words, "")
    assert view.frame.is_watched
    view.frame.is_open = False
    view.frame.stop()
    view.show(first)
    assert (view.caption.words, view.caption.news) == (first.words, "")


def test_a_replay_that_is_being_created_is_not_replaced():
    first, better = walkers()
    view = WalkerView()
    view.show(first)
    make = view.frame._make

    def find_better():
        view.show(better)
        return make()

    view.frame._make = find_better
    view.frame._handle_message(None, {"request": "page", "number": view.frame.number}, [])
    assert view.frame.page, "the replay was created"
    assert view.caption.words == first.words
