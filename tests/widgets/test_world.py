"""The world is drawn once for each change, on any thread."""

import threading

import pytest

import walkerlab as wl
from walkerlab.commands.worlds import WALKER_GENOME as GENOME
from walkerlab.view import sketch
from walkerlab.widgets.world import PICTURE_SIZE, World


@pytest.fixture
def drawings(monkeypatch):
    """Record settings and genome of each drawing."""
    drawings = []
    draw = sketch.draw_world

    def world(settings, genome, size):
        drawings.append((settings, genome))
        return draw(settings, genome, size=size)

    monkeypatch.setattr(sketch, "draw_world", world)
    return drawings


def test_it_shows_its_settings_and_its_genome(drawings):
    settings = wl.Settings().with_(gravity="moon")
    world = World(settings, GENOME)
    assert drawings == [(settings, wl.Genome.parse(GENOME))]
    assert world.picture == sketch.draw_world(settings, GENOME, size=PICTURE_SIZE)


def test_random_robots_are_those_of_generation_0(drawings):
    settings = wl.Settings().with_(seed=3, population_size=4)
    begin = wl.generate_robot_population(settings.robot, 4, seed=3)
    World(settings)._handle_custom_msg("another", [])
    assert [genome.values.tolist() for _, genome in drawings] == begin[:2].tolist()


def test_a_robot_that_falls_over_before_its_walk_is_explained():
    legends = [World(wl.Settings().with_(structure="incline", incline=incline)).legend for incline in (-10, -30)]
    assert ["falls over" in legend for legend in legends] == [False, True]


def test_it_is_drawn_once_for_each_change(drawings):
    world = World()
    stairs = wl.Settings().with_(structure="stairs")
    world.settings = stairs
    world.genome = wl.Genome.parse(GENOME)
    world.draw(wl.Settings())
    assert [settings == stairs for settings, _ in drawings] == [False, True, True, False]
    world.draw(wl.Settings())
    assert len(drawings) == 4


def test_the_button_shows_the_next_random_robot(drawings):
    world = World()
    for _ in range(2):
        world._handle_custom_msg("another", [])
    assert len({genome for _, genome in drawings}) == 3
    assert world.by_chance


def test_a_given_robot_stays(drawings):
    world = World(genome=GENOME)
    world._handle_custom_msg("another", [])
    assert not world.by_chance
    assert len(drawings) == 1


def test_without_settings_the_drawing_stays(drawings):
    world = World()
    before = world.picture
    world.settings = None
    assert world.picture == before
    world.settings = wl.Settings().with_(structure="stairs")
    assert world.picture != before


@pytest.mark.parametrize("message", [None, {}, {"another": 1}, ["another"], 7, "another "])
def test_invalid_messages_are_ignored(message, drawings):
    world = World()
    world._handle_custom_msg(message, [])
    assert len(drawings) == 1


def test_another_thread_can_drive_it():
    world = World()
    wanted = [wl.Settings().with_(step_height=0.05 + 0.01 * i, structure="stairs") for i in range(5)]
    thread = threading.Thread(target=lambda: [world.draw(one) for one in wanted])
    thread.start()
    for _ in range(5):
        world._handle_custom_msg("another", [])
    thread.join()
    world.draw(wanted[0], wl.Genome.parse(GENOME))
    assert world.picture == sketch.draw_world(wanted[0], GENOME, size=PICTURE_SIZE)
