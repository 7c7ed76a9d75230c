"""What is drawn is to scale, all of it in sight, and in words as well."""

import re
import threading
from xml.etree import ElementTree

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import walkerlab as wl
from tests.strategies import robots, terrains
from tests.test_markup import HOSTILE, Seen
from walkerlab import sketch
from walkerlab.choices import Obstacle, Texture
from walkerlab.commands.worlds import GENOME, WORLDS
from walkerlab.entities.walker import TRUNK_COLOUR
from walkerlab.genome import GenomeError
from walkerlab.ground import height
from walkerlab.layout import compute_layout
from walkerlab.phenotype import express
from walkerlab.sketch.pen import hue
from walkerlab.sketch.words import in_words

ORANGE = hue(np.float32(TRUNK_COLOUR))  # as MuJoCo has it
SVG = "{http://www.w3.org/2000/svg}"
few = settings(max_examples=15)


def read(drawing):
    """Read a drawing as the XML that it must be."""
    root = ElementTree.fromstring(drawing)
    assert root.tag == f"{SVG}svg"
    assert root.get("role") == "img"
    assert root.get("aria-label")
    assert not re.search(r"nan|inf[^o]|<script|href|url\(", drawing)
    return root


def points(element):
    """Return the corners of a path, (n, 2) pixels."""
    return np.array(re.findall(r"(-?[\d.]+),(-?[\d.]+)", element.get("d")), dtype=float)


def robot_of(root):
    """Return the corners of all parts of the robot, and of its trunk only."""
    (group,) = (one for one in root.iter(f"{SVG}g") if one.get("class") == "robot")
    parts = list(group.iter(f"{SVG}path"))
    trunk = [points(part) for part in parts if part.get("fill") == ORANGE]
    return np.concatenate([points(part) for part in parts]), np.concatenate(trunk)


def cut_of(root):
    """Return the near edge of the ground, from left to right."""
    (cut,) = (one for one in root.iter(f"{SVG}path") if one.get("class") == "cut")
    return points(cut)[:-2]


@st.composite
def genes(draw):
    robot = draw(robots())
    return wl.Genome.random(robot, rng=np.random.default_rng(draw(st.integers(0, 2**32 - 1)))), robot


@few
@given(genes(), st.sampled_from([(110, 80), (300, 190), (60, 200)]), st.sampled_from([None, 0.5, 3.0]))
def test_all_of_a_body_is_in_its_picture_and_to_scale(gene, size, span):
    genome, robot = gene
    root = read(sketch.body(genome, robot, size=size, span=span))
    whole, trunk = robot_of(root)
    assert (whole >= -0.1).all()
    assert (whole <= np.add(size, 0.1)).all()
    length = express(genome).body_length
    scale = np.ptp(trunk[:, 0]) / length
    assert span is None or scale <= size[0] / span * 1.05 + 0.2 / length
    for segment in express(genome).segments:
        assert any(abs(np.ptp(points(part)[:, 0]) - scale * segment.length) < 0.35 + 0.01 * scale * segment.length
                   for part in root.iter(f"{SVG}path") if part.get("fill") == ORANGE)  # fmt: skip


def test_bodies_of_one_span_are_of_one_scale():
    short, long = (GENOME.replace("seg length=0.26", f"seg length={length}") for length in (0.2, 0.4))
    widths = [np.ptp(robot_of(read(sketch.body(one, span=2.0)))[1][:, 0]) for one in (short, long)]
    assert widths[1] / widths[0] == pytest.approx(2, rel=0.01)
    assert widths[0] == pytest.approx(0.6 * 110 / 2, abs=0.3)


def test_a_body_is_brought_within_the_limits_and_wears_its_pack_and_no_sledge():
    limits = wl.Robot(segments=(1, 1), legs=(2, 2), carry_weight=2, drag_weight=2)
    root = read(sketch.body(GENOME, limits))
    assert root.get("aria-label") == "A robot: 1 segment, 2 legs, 3 kg, 0.4 m long."
    assert sketch.body(GENOME, limits) != sketch.body(GENOME, limits.model_copy(update={"carry_weight": 0.0}))
    assert sketch.body(GENOME, limits) == sketch.body(GENOME, limits.model_copy(update={"drag_weight": 0.0}))
    assert read(sketch.body(GENOME)).get("aria-label") == "A robot: 3 segments, 6 legs, 6 kg, 0.78 m long."


@few
@given(genes(), terrains, st.sampled_from([0, 5, 100]), st.sampled_from([0, 5, 100]))
def test_all_of_the_robot_is_in_sight_in_every_world(gene, terrain, carried, dragged):
    genome, robot = gene
    robot = wl.Robot(**dict(robot) | {"carry_weight": carried, "drag_weight": dragged})
    root = read(sketch.world(wl.Settings(terrain=terrain, robot=robot), genome, size=(720, 300)))
    whole, _ = robot_of(root)
    assert (whole >= 0).all()
    assert (whole <= (720, 278)).all()


@few
@given(terrains)
def test_the_ground_is_drawn_to_scale(terrain):
    wanted = wl.Settings(terrain=terrain)
    root = read(sketch.world(wanted, width_m=6.0))
    edge, scale = cut_of(root), 720 / 6
    along = np.linspace(edge[0, 0] + 1, edge[-1, 0] - 1, 60)
    marks = {one.text: float(one.get("x")) for one in root.iter(f"{SVG}text")}
    x = (along - marks["start"]) / scale - 0.24 * 0.13 * 6  # the near edge is drawn aside
    rises = -(np.interp(along, *edge.T) - np.interp(marks["start"] + 0.24 * 0.13 * 6 * scale, *edge.T)) / scale
    true = height(terrain, x, -0.13 * 6) - height(terrain, np.zeros(1), -0.13 * 6)
    near_an_edge = np.abs(height(terrain, x - 0.02, -0.78) - height(terrain, x + 0.02, -0.78)) > 0.03
    tolerance = 0.01 + (0.25 * terrain.hill_height if terrain.structure.name == "rough" else 0)  # which has few corners
    assert np.abs(rises - true)[~near_an_edge].max(initial=0) < tolerance
    metres = sorted(
        (float(words.split()[0].replace("−", "-")), x) for words, x in marks.items() if words.endswith(" m")
    )
    assert np.diff([x for _, x in metres]) / np.diff([metre for metre, _ in metres]) == pytest.approx(scale, abs=0.2)


@pytest.mark.parametrize("caption", WORLDS)
def test_every_world_is_drawn_with_and_without_a_robot(caption):
    wanted = wl.Settings().with_(**WORLDS[caption])
    with_one, without = sketch.world(wanted, GENOME), sketch.world(wanted)
    assert read(with_one).get("aria-label") == in_words(wanted, express(wl.Genome.parse(GENOME)))
    assert "robot" not in read(without).get("aria-label")
    assert len(Seen(with_one).elements) < 1500
    assert len(with_one) < 80_000


@pytest.mark.parametrize("obstacle", [kind for kind in Obstacle if kind])
def test_whatever_lies_about_in_sight_is_drawn(obstacle):
    strewn = wl.Settings().with_(obstacle=obstacle, obstacle_size=0.2, obstacle_density=1.0)
    bare = len(Seen(sketch.world(strewn.with_(obstacle_density=0.0), width_m=8)).all("g"))
    x, y, _ = compute_layout(strewn.terrain).obstacles.T
    surely = ((y > -0.9) & (y < 2.7) & (x < 5)).sum()
    assert len(Seen(sketch.world(strewn, width_m=8)).all("g")) - bare >= 2 * surely > 8


@pytest.mark.parametrize("texture", Texture)
def test_every_texture_looks_different(texture):
    drawings = {sketch.world(wl.Settings().with_(texture=one)) for one in Texture}
    assert len(drawings) == len(Texture)
    assert texture.name in read(sketch.world(wl.Settings().with_(texture=texture))).get("aria-label")


WORDS = {
    "Level ground of rubber.": {},
    "The ground of rubber goes uphill at 10°.": {"structure": "incline"},
    "The ground of rubber goes downhill at 5°.": {"structure": "incline", "incline": -5},
    "stairs begin, each 0.08 m high and 0.4 m deep": {"structure": "stairs"},
    "hills begin, up to 0.12 m high and about 1.5 m apart": {"structure": "rough"},
    "trenches begin, each 0.1 m wide, with 0.8 m between": {"structure": "gaps"},
    "Pieces 0.1 m wide cover 20% of it.": {"texture_density": 0.2, "texture_size": 0.1},
    "Balls about 0.1 m wide lie about, 0.25 on each m².": {"obstacle": "ball"},
    "Gravity of the moon, 1.62 m/s² down.": {"gravity": "moon"},
    "Gravity, 9.43 m/s² forward and down.": {"gravity": (5, 0, -8)},
    "No gravity: nothing is held down.": {"gravity": (0, 0, 0)},
    "Wind, 5 m/s backward and to the left.": {"wind": (-3, 4, 0)},
    "It carries a pack of 2 kg and drags a sledge of 3 kg.": {"carry_weight": 2, "drag_weight": 3},
}


@pytest.mark.parametrize("sentence", WORDS)
def test_what_is_seen_is_said(sentence):
    assert sentence in read(sketch.world(wl.Settings().with_(**WORDS[sentence]), GENOME)).get("aria-label")


def test_pull_and_wind_are_written_beside_their_arrows_unless_they_are_as_on_a_calm_day_on_earth():
    def said(**changes):
        root = read(sketch.world(wl.Settings().with_(**changes)))
        return [one.text for one in root.iter(f"{SVG}text") if not re.search(r"\d m$|start", one.text)]

    assert said() == []
    assert said(gravity="mars", wind=(6, 0, 0)) == ["gravity of Mars, 3.71 m/s² down", "wind, 6 m/s forward"]


def test_what_is_no_genome_is_refused_at_its_place():
    for draw in (sketch.body, lambda text: sketch.world(wl.Settings(), text)):
        with pytest.raises(GenomeError, match="at character 1 expected 'wl1'"):
            draw(HOSTILE)


def test_many_threads_draw_the_same():
    wanted = [wl.Settings().with_(step_height=0.01 * (1 + i), structure="stairs") for i in range(6)]
    drawn = {}
    threads = [
        threading.Thread(target=lambda i=i: drawn.setdefault(i, sketch.world(wanted[i], GENOME))) for i in range(6)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert [drawn[i] for i in range(6)] == [sketch.world(one, GENOME) for one in wanted]
