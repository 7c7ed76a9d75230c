"""Drawings are to scale, show everything they should, and have a description."""

import re
import threading
from xml.etree import ElementTree

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

import walkerlab as wl
from tests.strategies import robots, terrains
from tests.text.test_html import HOSTILE, Seen
from walkerlab.commands.worlds import WALKER_GENOME as GENOME
from walkerlab.commands.worlds import WORLDS
from walkerlab.genome.phenotype import express
from walkerlab.genome.text import GenomeError
from walkerlab.settings.choices import Obstacle, Texture
from walkerlab.view import sketch
from walkerlab.view.sketch.bodies import GROUND_COLOUR
from walkerlab.view.sketch.description import describe_world
from walkerlab.view.sketch.standing import standing_pose
from walkerlab.view.sketch.svg import hex_colour
from walkerlab.world.entities.walker import TRUNK_COLOUR
from walkerlab.world.geometry import surface_points
from walkerlab.world.heights import ground_height
from walkerlab.world.placement import compute_layout

TRUNK_HEX = hex_colour(np.float32(TRUNK_COLOUR))  # MuJoCo stores colours as float32
SVG = "{http://www.w3.org/2000/svg}"
NEAR_SHARE = 0.13  # distance of the near edge of the ground from y = 0, over the visible width
SHIFT = 0.24  # horizontal shift in the drawing for each metre of depth
few_examples = settings(max_examples=15)


def parse_drawing(drawing):
    """Parse a drawing as XML and check what holds for every drawing."""
    root = ElementTree.fromstring(drawing)
    assert root.tag == f"{SVG}svg"
    assert root.get("role") == "img"
    assert root.get("aria-label")
    assert not re.search(r"nan|inf[^o]|<script|href|url\(", drawing)
    return root


def description(drawing):
    return parse_drawing(drawing).get("aria-label")


def path_corners(element):
    """Return the corners of a path [pixels], shape (n, 2)."""
    return np.array(re.findall(r"(-?[\d.]+),(-?[\d.]+)", element.get("d")), dtype=float)


def robot_corners(root):
    """Return the corners of all parts of the robot, and those of its trunk."""
    (group,) = (element for element in root.iter(f"{SVG}g") if element.get("class") == "robot")
    parts = list(group.iter(f"{SVG}path"))
    trunk = [path_corners(part) for part in parts if part.get("fill") == TRUNK_HEX]
    return np.concatenate([path_corners(part) for part in parts]), np.concatenate(trunk)


def near_edge(root):
    """Return the corners of the near edge of the ground, from left to right."""
    (section,) = (element for element in root.iter(f"{SVG}path") if element.get("class") == "section")
    return path_corners(section)[:-2]


@st.composite
def genomes_with_limits(draw):
    robot = draw(robots())
    return wl.Genome.random(robot, rng=np.random.default_rng(draw(st.integers(0, 2**32 - 1)))), robot


LONG_AND_FLAT = wl.Robot(body_length=(4, 4), segments=(1, 3), segment_length=(2, 2), legs=(2, 2), leg_force=(0.1, 0.1))


@settings(max_examples=8)
@example((wl.Genome.random(LONG_AND_FLAT, rng=np.random.default_rng(0)), LONG_AND_FLAT), (110, 80), None)
@given(genomes_with_limits(), st.sampled_from([(110, 80), (300, 190), (60, 200)]), st.sampled_from([None, 0.5, 3.0]))
def test_a_robot_fits_into_its_drawing_and_is_to_scale(genome_and_limits, size, span):
    genome, robot = genome_and_limits
    root = parse_drawing(sketch.draw_robot(genome, robot, size=size, span=span))
    whole, _ = robot_corners(root)
    assert (whole >= -0.1).all()
    assert (whole <= np.add(size, 0.1)).all()
    settings = wl.Settings(robot=robot).with_(duration=1, drag_weight=0)
    rollout = wl.simulate(genome, settings)
    parts = surface_points(wl.compile_scene(genome, settings), rollout.poses[0])
    corners = np.concatenate([points for points, _ in parts]) @ [(1, 0), (-SHIFT, 0), (0, 1)]
    extent = np.ptp(corners, axis=0)
    scale = (np.ptp(whole, axis=0) / extent)[extent.argmax()]  # a flat robot is only 1 px high, rounded to 0.1
    assert np.ptp(whole, axis=0) == pytest.approx(scale * extent, abs=0.3)
    assert span is None or scale <= size[0] / span * 1.01 + 0.2 / extent.max()
    (ground,) = (part for part in root.iter(f"{SVG}path") if part.get("stroke") == GROUND_COLOUR)
    assert whole[:, 1].max() == pytest.approx(path_corners(ground)[0, 1], abs=0.1)


@pytest.mark.parametrize("seed", range(5))
def test_a_caption_stands_above_the_robot(seed):
    limits = wl.Robot(
        segments=(1, 1), legs=(2, 2), segment_length=(0.2, 0.2), body_length=(0.2, 0.2)
    )  # higher than wide
    tall = wl.Genome.random(limits, rng=np.random.default_rng(seed))
    root = parse_drawing(sketch.draw_robot(tall, size=(640, 360), caption="robot 7 & others"))
    (caption,) = (text for text in root.iter(f"{SVG}text") if text.text == "robot 7 & others")
    assert float(caption.get("y")) < robot_corners(root)[0][:, 1].min()


def test_a_robot_stands_in_a_world_as_its_walk_begins():
    genome = wl.Genome.random(wl.Robot(), rng=np.random.default_rng(3)).within(wl.Robot())
    for world in (wl.Settings(), wl.Settings().with_(structure="incline", incline=10, duration=1)):
        assert (standing_pose(genome, world) == wl.simulate(genome, world).poses[0]).all()
    floating = wl.Settings().with_(gravity=(0, 0, 9))
    assert (standing_pose(genome, floating) == wl.compile_scene(genome, floating).start).all()


def test_left_legs_are_dark_and_the_front_is_marked_in_every_drawing():
    """The drawn shade of each leg is that of the simulated world, whatever the order of drawing."""
    scene = wl.compile_scene(GENOME, wl.Settings())
    root = parse_drawing(sketch.draw_robot(GENOME, size=(300, 190)))
    fills = [part.get("fill") for part in root.iter(f"{SVG}path")]
    left, right = (hex_colour(scene.model.geom(f"walker/{side}_thigh1").rgba) for side in ("left", "right"))
    assert max(i for i, fill in enumerate(fills) if fill == left) < min(
        i for i, fill in enumerate(fills) if fill == right
    )
    assert [element.text for element in root.iter(f"{SVG}text")] == ["1", "2", "3"]
    eye = float(next(root.iter(f"{SVG}circle")).get("cx"))
    numbers = [float(element.get("x")) for element in root.iter(f"{SVG}text")]
    assert eye > numbers[0] > numbers[1] > numbers[2]


def test_robots_drawn_with_the_same_span_have_the_same_scale():
    short, long = (GENOME.replace("seg length=0.26", f"seg length={length}") for length in (0.2, 0.4))
    widths = [
        np.ptp(robot_corners(parse_drawing(sketch.draw_robot(genome, span=2.0)))[1][:, 0]) for genome in (short, long)
    ]
    assert widths[1] / widths[0] == pytest.approx(2, rel=0.01)
    assert widths[0] == pytest.approx(0.6 * 110 / 2, abs=0.3)


def test_a_drawn_robot_is_repaired_and_carries_its_pack_but_drags_no_sledge():
    limits = wl.Robot(segments=(1, 1), legs=(2, 2), carry_weight=2, drag_weight=2)
    drawing = sketch.draw_robot(GENOME, limits)
    assert description(drawing) == "A robot: 1 segment, 2 legs, 3 kg, 0.4 m long."
    assert drawing != sketch.draw_robot(GENOME, limits.model_copy(update={"carry_weight": 0.0}))
    assert drawing == sketch.draw_robot(GENOME, limits.model_copy(update={"drag_weight": 0.0}))
    assert description(sketch.draw_robot(GENOME)) == "A robot: 3 segments, 6 legs, 6 kg, 0.78 m long."


@settings(max_examples=6)
@given(genomes_with_limits(), terrains, st.sampled_from([0, 5, 100]), st.sampled_from([0, 5, 100]))
def test_the_whole_robot_is_visible_in_every_world(genome_and_limits, terrain, carry_weight, drag_weight):
    genome, robot = genome_and_limits
    robot = wl.Robot(**dict(robot) | {"carry_weight": carry_weight, "drag_weight": drag_weight})
    drawing = sketch.draw_world(wl.Settings(terrain=terrain, robot=robot), genome, size=(720, 300))
    whole, _ = robot_corners(parse_drawing(drawing))
    assert (whole >= 0).all()
    assert (whole <= (720, 278)).all()


@few_examples
@given(terrains)
def test_the_ground_is_drawn_to_scale(terrain):
    width = 6.0
    near = -NEAR_SHARE * 6.0
    root = parse_drawing(sketch.draw_world(wl.Settings(terrain=terrain), width_m=width))
    edge = near_edge(root)
    scale = 720 / width
    labels = {element.text: float(element.get("x")) for element in root.iter(f"{SVG}text")}
    x_pixels = np.linspace(edge[0, 0] + 1, edge[-1, 0] - 1, 60)
    x = (x_pixels - labels["start"]) / scale + SHIFT * near
    start_pixels = labels["start"] - SHIFT * near * scale
    rises = -(np.interp(x_pixels, *edge.T) - np.interp(start_pixels, *edge.T)) / scale
    expected = ground_height(terrain, x, near) - ground_height(terrain, np.zeros(1), near)
    is_near_an_edge = np.abs(ground_height(terrain, x - 0.02, near) - ground_height(terrain, x + 0.02, near)) > 0.03
    tolerance = 0.01 + (
        0.25 * terrain.hill_height if terrain.structure.name == "rough" else 0
    )  # drawn with few corners
    assert np.abs(rises - expected)[~is_near_an_edge].max(initial=0) < tolerance
    ticks = sorted((float(text.split()[0].replace("−", "-")), x) for text, x in labels.items() if text.endswith(" m"))
    metres, pixels = np.transpose(ticks)
    assert np.diff(pixels) / np.diff(metres) == pytest.approx(scale, abs=0.2)


@pytest.mark.parametrize("caption", WORLDS)
def test_every_world_is_drawn_with_and_without_a_robot(caption):
    world = wl.Settings().with_(**WORLDS[caption])
    with_robot, without_robot = sketch.draw_world(world, GENOME), sketch.draw_world(world)
    assert description(with_robot) == describe_world(world, express(wl.Genome.parse(GENOME)))
    assert "robot" not in description(without_robot)
    assert len(Seen(with_robot).elements) < 1500
    assert len(with_robot) < 80_000


@pytest.mark.parametrize("obstacle", [kind for kind in Obstacle if kind])
def test_every_visible_obstacle_is_drawn(obstacle):
    world = wl.Settings().with_(obstacle=obstacle, obstacle_size=0.2, obstacle_density=1.0)
    n_without = len(Seen(sketch.draw_world(world.with_(obstacle_density=0.0), width_m=8)).all("g"))
    x, y, _ = compute_layout(world.terrain).obstacles.T
    n_certainly_visible = ((y > -0.9) & (y < 2.7) & (x < 5)).sum()
    assert len(Seen(sketch.draw_world(world, width_m=8)).all("g")) - n_without >= 2 * n_certainly_visible > 8


@pytest.mark.parametrize("texture", Texture)
def test_every_texture_looks_different(texture):
    drawings = {sketch.draw_world(wl.Settings().with_(texture=other)) for other in Texture}
    assert len(drawings) == len(Texture)
    assert texture.name in description(sketch.draw_world(wl.Settings().with_(texture=texture)))


SENTENCES = {
    "Level ground of rubber.": {},
    "The ground of rubber slopes uphill at 10°.": {"structure": "incline"},
    "The ground of rubber slopes downhill at 5°.": {"structure": "incline", "incline": -5},
    "stairs begin 1 m ahead, each 0.08 m high and 0.4 m deep": {"structure": "stairs"},
    "hills begin 1 m ahead, up to 0.12 m high and about 1.5 m apart": {"structure": "rough"},
    "gaps begin 1 m ahead, each 0.1 m wide, with 0.8 m between them": {"structure": "gaps"},
    "Pieces 0.1 m wide cover 20% of it.": {"texture_density": 0.2, "texture_size": 0.1},
    "Loose balls about 0.1 m wide, 0.25 per m².": {"obstacle": "ball"},
    "Gravity of the moon, 1.62 m/s² down.": {"gravity": "moon"},
    "Gravity, 9.43 m/s² forward and down.": {"gravity": (5, 0, -8)},
    "No gravity.": {"gravity": (0, 0, 0)},
    "Wind, 5 m/s backward and to the left.": {"wind": (-3, 4, 0)},
    "It carries a pack of 2 kg and drags a sledge of 3 kg.": {"carry_weight": 2, "drag_weight": 3},
}


@pytest.mark.parametrize("sentence", SENTENCES)
def test_the_description_states_each_setting(sentence):
    assert sentence in description(sketch.draw_world(wl.Settings().with_(**SENTENCES[sentence]), GENOME))


def test_only_unusual_gravity_and_wind_have_labelled_arrows():
    def labels(**changes):
        root = parse_drawing(sketch.draw_world(wl.Settings().with_(**changes)))
        texts = [element.text for element in root.iter(f"{SVG}text")]
        return [text for text in texts if not re.search(r"\d m$|start", text)]

    assert labels() == []
    assert labels(gravity="mars", wind=(6, 0, 0)) == ["gravity of Mars, 3.71 m/s² down", "wind, 6 m/s forward"]


def test_text_that_is_not_a_genome_is_rejected_with_the_position():
    for draw in (sketch.draw_robot, lambda text: sketch.draw_world(wl.Settings(), text)):
        with pytest.raises(GenomeError, match="at character 1 expected 'wl2'"):
            draw(HOSTILE)


def test_drawings_from_many_threads_equal_those_from_one():
    worlds = [wl.Settings().with_(step_height=0.01 * (1 + i), structure="stairs") for i in range(6)]
    drawn = {}
    threads = [
        threading.Thread(target=lambda i=i: drawn.setdefault(i, sketch.draw_world(worlds[i], GENOME))) for i in range(6)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert [drawn[i] for i in range(6)] == [sketch.draw_world(world, GENOME) for world in worlds]
