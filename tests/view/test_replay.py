"""A replay shows what was simulated, anywhere, and gives back what it takes."""

import io
import math
import zlib
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from html.parser import HTMLParser
from itertools import pairwise

import ipywidgets
import mujoco
import numpy as np
import pytest
from PIL import Image

import walkerlab as wl
from tests.frontends import book, open_notebook, start_all
from tests.text.test_html import assert_harmless
from walkerlab.commands.worlds import GENOME
from walkerlab.settings.choices import Camera
from walkerlab.view.replay.animation import below, edges_of, set_up
from walkerlab.view.replay.page import Frame
from walkerlab.view.replay.tracks import follow, moments, pack
from walkerlab.world.geometry import n_valid_poses, placements, rope_ends, rotate, skins
from walkerlab.world.heights import ARENA_WIDTH
from walkerlab.world.scene import compile_scene

SHORT = wl.Settings().with_(duration=2)
CROWDED = wl.Settings().with_(
    obstacle="ball", obstacle_density=20 / 90, obstacle_size=0.2, carry_weight=2, drag_weight=2
)


def unpack(packed, finest):
    raw, count = zlib.decompress(packed), len(finest)
    firsts = np.frombuffer(raw[: 8 * count], "<f8")
    steps = np.frombuffer(raw[8 * count :], "<i4").reshape(count, -1)
    return firsts[:, None] + np.concatenate([np.zeros((count, 1)), steps.cumsum(axis=1)], axis=1) * finest[:, None]


def test_what_is_packed_comes_out_within_half_a_unit():
    rng = np.random.default_rng(0)
    channels = rng.normal(size=(40, 401)).cumsum(axis=1)
    finest = rng.uniform(1e-3, 1e-2, 40)
    assert np.abs(unpack(pack(channels, finest), finest) - channels).max(axis=1) == pytest.approx(finest / 2, rel=0.1)


def test_a_walk_is_shown_until_it_breaks():
    scene, rollout = compile_scene(GENOME, SHORT), wl.simulate(GENOME, SHORT)
    assert n_valid_poses(scene, rollout.poses) == len(rollout.poses)
    for i, bad in ((20, np.nan), (30, np.inf), (40, 1e9)):
        broken = rollout.poses.copy()
        broken[i:, 0] = bad
        assert n_valid_poses(scene, broken) == i
        tracks = follow(scene, replace(rollout, poses=broken))
        assert np.isfinite(tracks.places).all()
        assert tracks.places.shape[1] == len(tracks.com) == i
    assert n_valid_poses(scene, np.full_like(rollout.poses, np.nan)) == 0


@pytest.mark.parametrize("timestep", [0.0013, 0.003, 0.005, 0.009])
def test_the_clock_is_right_whatever_the_timestep(timestep):
    settings = SHORT.with_(timestep=timestep)
    scene, rollout = compile_scene(GENOME, settings), wl.simulate(GENOME, settings)
    tracks, time = follow(scene, rollout), moments(rollout.time[-1])
    assert set_up(list(wl.replay(GENOME, settings).walks), "").seconds == pytest.approx(rollout.time[-1], abs=1e-9)
    for axis in range(3):
        assert np.allclose(tracks.com[:, axis], np.interp(time, rollout.time, rollout.com[:, axis]), atol=1e-9)
        place = np.interp(time, rollout.time, rollout.poses[:, axis])
        assert np.allclose(tracks.places[0, :, axis], place, atol=1e-9)
    assert np.allclose(np.linalg.norm(tracks.places[:, :, 3:7], axis=2), 1)


@pytest.mark.parametrize("wild", [{"wind": (10, 0, 0)}, {"structure": "incline", "incline": -30}])
def test_whatever_rolls_can_be_shown(wild):
    settings = wl.Settings().with_(obstacle="ball", obstacle_size=0.05, **wild)
    replay = wl.replay(GENOME, settings)
    stage = set_up(list(replay.walks), "")
    error = np.abs(unpack(pack(stage.channels, stage.finest), stage.finest) - stage.channels).max(axis=1)
    assert (error <= 0.51 * stage.finest).all()


def test_a_rope_hangs_from_end_to_end():
    settings = SHORT.with_(drag_weight=2)
    scene, rollout = compile_scene(GENOME, settings), wl.simulate(GENOME, settings)
    tracks = follow(scene, rollout)
    for rod, ends in zip(tracks.rope, rope_ends(scene, placements(scene, rollout.poses)), strict=True):
        half = rod[7] / 2 * rotate(rod[np.newaxis, 3:7], np.array([0, 0, 1.0]))[0]
        assert np.allclose([rod[:3] - half, rod[:3] + half], ends, atol=1e-9)


@pytest.mark.parametrize("yaw", [0, 45, 90, 180, 250])
@pytest.mark.parametrize("incline", [-30, 0, 20])
def test_a_shadow_lies_flat_on_the_ground_below_its_segment(yaw, incline):
    settings = SHORT.with_(structure="incline", incline=incline)
    scene, turn = compile_scene(GENOME, settings), math.radians(yaw)
    place = np.array([[1.0, 0.2, 2.0, math.cos(turn / 2), 0, 0, math.sin(turn / 2), 1]])
    spot = below(scene, place, 0.4)[0]
    slope = math.tan(math.radians(incline))
    middle = place[0, :2] - 0.2 * np.array([math.cos(turn), math.sin(turn)])
    assert np.allclose(spot[:2], middle)
    assert spot[2] == pytest.approx(middle[0] * slope, abs=0.01)
    up, ahead = (rotate(spot[np.newaxis, 3:7], way)[0] for way in (np.array([0, 0, 1.0]), np.array([1.0, 0, 0])))
    assert np.allclose(up, np.array([-slope, 0, 1]) / math.hypot(slope, 1), atol=1e-9)
    assert math.atan2(ahead[1], ahead[0]) == pytest.approx(math.atan2(math.sin(turn), math.cos(turn)), abs=0.2)


def test_every_walk_is_followed_where_it_is_shown():
    race = wl.replay({"a": GENOME, "b": GENOME}, SHORT)
    stage = set_up(list(race.walks), "")
    for number, walk in enumerate(race.walks):
        path = stage.channels[len(stage.channels) - 6 + 3 * number :][:3].T
        assert np.allclose(path, walk.rollout.com + np.array([0, walk.lane, 0]), atol=1e-9)
    trunks = stage.channels[: 8 * len(stage.things)].reshape(len(stage.things), 8, -1)
    half = len(stage.things) // 2
    assert np.allclose(trunks[half, 1] - trunks[0, 1], race.walks[1].lane - race.walks[0].lane)


def test_what_lies_about_is_shown_as_the_farthest_moved_it():
    ahead, behind = GENOME.replace("frequency=1.2", "frequency=0.4"), GENOME
    race = wl.replay({"a": behind, "b": ahead, "c": behind}, SHORT.with_(obstacle="box"))
    way = [walk.rollout.distance for walk in race.walks]
    assert [walk.loose for walk in race.walks] == [distance == max(way) for distance in way] or way[0] == way[2]
    assert sum(walk.loose for walk in race.walks) == 1
    assert race.walks[int(np.argmax(way))].loose


class TestWhoWalks:
    def names(self, walkers, settings=SHORT):
        return [walk.label for walk in wl.replay(walkers, settings).walks]

    def test_one_or_several_however_they_are_given(self):
        genome = wl.Genome.parse(GENOME)
        assert self.names(genome) == self.names(GENOME) == self.names(genome.values) == ["robot"]
        assert self.names([genome, GENOME]) == ["robot 1", "robot 2"]
        assert self.names({"Ada": genome, "Bob": GENOME}) == ["Ada", "Bob"]

    def test_two_with_the_same_name_are_two(self):
        assert self.names({1: GENOME, "1": GENOME}) == ["1", "1 (2)"]

    def test_a_large_race_fits_on_the_stairs(self):
        race = wl.replay([GENOME] * 30, SHORT.with_(structure="stairs", duration=1))
        edges = edges_of(list(race.walks))
        assert -ARENA_WIDTH / 2 - 0.5 < edges[0] < edges[1] < ARENA_WIDTH / 2 + 0.5
        assert len({walk.colour for walk in race.walks}) == 18

    def test_nobody_and_nonsense_are_refused_in_words(self):
        with pytest.raises(ValueError, match="nobody to walk"):
            wl.replay([], SHORT)
        with pytest.raises(wl.GenomeError):
            wl.replay("no gene", SHORT)
        with pytest.raises(wl.SettingsError, match="camera"):
            wl.replay(GENOME, SHORT, camera="below")

    def test_racers_are_told_apart_and_do_not_touch(self):
        race = wl.replay({"a": GENOME, "b": GENOME, "c": GENOME}, SHORT)
        assert len({walk.colour for walk in race.walks}) == 3
        reach = [
            np.concatenate([skin[:, 1] + walk.lane for skin, _ in skins(walk.scene, walk.scene.start)])
            for walk in race.walks
        ]
        for one, next_to_it in pairwise(reach):
            assert one.min() > next_to_it.max()

    @pytest.mark.parametrize("uneven", [{"structure": "rough"}, {"obstacle": "box"}, {"texture_density": 0.1}])
    def test_where_the_ground_differs_across_the_way_all_walk_on_the_same(self, uneven):
        race = wl.replay([GENOME, GENOME], SHORT.with_(**uneven))
        assert [walk.lane for walk in race.walks] == [0, 0]
        assert sum(walk.loose for walk in race.walks) == 1


def test_a_run_shows_its_champion_or_a_race_through_its_generations():
    run = wl.evolve(SHORT.with_(population_size=4, generations=3), progress=False)
    assert [walk.label for walk in run.replay().walks] == [f"robot {run.champion.individual}"]
    race = run.replay(0, 2, camera="top")
    assert [walk.label for walk in race.walks] == ["generation 0", "generation 2"]
    assert race.camera == Camera.top
    best = run.records[run.records.generation == 0].sort_values("fitness").genome.iloc[-1]
    assert str(race.walks[0].scene.genome) == best
    with pytest.raises(ValueError, match="no generation 3: this run has 0 to 2"):
        run.replay(0, 3)


def test_a_loaded_run_of_somebodys_own_fitness_can_be_watched(tmp_path):
    path = tmp_path / "run.walk"
    settings = SHORT.with_(population_size=4, generations=1, fitness=lambda rollout: rollout.distance)
    with ThreadPoolExecutor(1) as thread:
        wl.evolve(settings, path, executor=thread, progress=False)
    assert "way forward" in wl.load(path).replay().page


def test_of_several_starts_the_poorest_is_shown_for_it_counted():
    settings = SHORT.with_(n_starts=4)
    [evaluation] = wl.evaluate([GENOME], settings)
    [walk] = wl.replay(GENOME, settings).walks
    assert walk.rollout.distance == evaluation.distance


def test_a_page_leaves_no_widgets_behind():
    registry = ipywidgets.widgets.widget._instances
    counts = [len(registry) for _ in range(3) if wl.replay(GENOME, SHORT).page]
    assert counts[2] == counts[0]


class Links(HTMLParser):
    """Everything that a page would load, and what runs in it."""

    def __init__(self, text):
        super().__init__()
        self.loads, self.scripts = [], 0
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        self.scripts += tag == "script"
        self.loads += [value for name, value in attrs if name in ("src", "href")]


class TestThePage:
    def test_it_needs_nothing_from_elsewhere(self):
        assert Links(wl.replay(GENOME, SHORT).page).loads == []

    def test_labels_are_text_whatever_they_say(self):
        evil = "</script><script>alert(1)</script><img src=x onerror=alert(1)>"
        plain, attacked = (Links(wl.replay({name: GENOME}, SHORT).page) for name in ("Ada", evil))
        assert attacked.scripts == plain.scripts
        assert attacked.loads == []

    def test_eight_seconds_among_twenty_obstacles_are_small(self, tmp_path):
        replay = wl.replay(GENOME, CROWDED)
        model = replay.walks[0].scene.model
        assert sum("obstacle" in model.body(i).name for i in range(model.nbody)) == 20
        assert replay.to_html(tmp_path / "replay.html").stat().st_size < 3e6

    def test_a_world_that_breaks_down_is_shown_as_far_as_it_goes(self):
        torn = wl.Settings().with_(gravity=(-30, 12, -30), duration=2, timestep=0.01, texture_size=0.2)
        torn = torn.with_(robot=wl.Robot(leg_force=(500, 500), weight=(0.1, 0.1), carry_weight=60))
        assert wl.simulate(GENOME, torn).verdict == "unstable", "or this shows nothing"
        assert "Does not count: unstable" in wl.replay(GENOME, torn).page

    def test_in_a_notebook_it_is_a_picture_first(self):
        [picture] = assert_harmless(wl.replay({"<b>Ada</b>": GENOME}, SHORT).widget.snapshot()).all("img")
        assert picture["src"].startswith("data:image/png;base64,")
        assert "<b>Ada</b>" in picture["alt"]
        assert len(picture["src"]) < 100_000

    def test_a_page_that_comes_too_late_is_not_shown_under_another_picture(self):
        class Slow:
            @property
            def page(self):
                frame.offer(lambda: self, "new", "the new robot")
                return "old"

        frame = Frame()
        frame.offer(Slow, "old", "the old robot")
        frame._handle_custom_msg({"want": "page"}, [])
        assert (frame.page, frame.alt) == (b"", "the new robot")

    def test_another_walk_that_is_offered_takes_the_page_of_the_last_away(self):
        frame = Frame()
        frame.page = b"of another"
        frame.offer(lambda: pytest.fail("made for nobody"), "new", "the new robot")
        assert frame.page == b""


# ---------------------------------------------------------------------------------------------- in a browser


def open_file(page, path):
    page.context.set_offline(True)
    page.goto(path.as_uri())
    page.wait_for_function("window.walkerlab")


def look(page, time, camera):
    page.evaluate(f"walkerlab.pause(); walkerlab.state.camera = '{camera}'; walkerlab.seek({time})")
    page.wait_for_timeout(300)
    return page.locator("#canvasTarget").screenshot()


def pixels(picture):
    return np.asarray(Image.open(io.BytesIO(picture)).convert("RGB"), dtype=int)


@pytest.fixture(scope="module")
def crowded(tmp_path_factory):
    return wl.replay(GENOME, CROWDED).to_html(tmp_path_factory.mktemp("replay") / "replay.html")


def assert_it_plays(page):
    page.wait_for_function("walkerlab.state.time > 0.05", timeout=30_000)
    first = page.locator("#canvasTarget").screenshot()
    now = page.evaluate("walkerlab.state.time")
    page.wait_for_function(f"Math.abs(walkerlab.state.time - {now}) > 0.3")
    assert (pixels(first) != pixels(page.locator("#canvasTarget").screenshot())).any(axis=2).mean() > 0.01


def assert_every_camera_shows_the_walker(page, time, later):
    for camera in Camera:
        picture = look(page, time, camera.name)
        red, green, blue = pixels(picture).transpose(2, 0, 1)
        trunk = (red > 1.25 * green) & (green > 2 * blue) & (red > 120)
        limbs = (blue > 1.25 * green) & (green > 1.2 * red)
        for part in (trunk, limbs):
            assert part.sum() > 200, camera
        rows, columns = np.nonzero(trunk)
        assert 20 < rows.mean() < red.shape[0] - 20, camera
        assert 20 < columns.mean() < red.shape[1] - 20, camera
        look(page, later, camera.name)
        assert look(page, time, camera.name) == picture, camera


def test_it_plays_from_a_file_and_scrubs_and_every_camera_shows_the_walker(page, crowded):
    open_file(page, crowded)
    assert_it_plays(page)
    assert_every_camera_shows_the_walker(page, 3, 5.5)


PLACES = """() => {
    const world = walkerlab.K3D.getWorld(), found = {};
    for (const [id, mesh] of Object.entries(world.ObjectsById)) {
        mesh.updateMatrixWorld(true);
        const name = world.ObjectsListJson[id].name;
        if (name) found[name] = mesh.matrixWorld.elements;
    }
    return found;
}"""


def test_bodies_are_where_they_were_within_a_millimetre_and_a_degree(page, crowded):
    open_file(page, crowded)
    scene, rollout = compile_scene(GENOME, CROWDED), wl.simulate(GENOME, CROWDED)
    data = mujoco.MjData(scene.model)
    bodies = [i for i in range(1, scene.model.nbody) if scene.model.body_geomnum[i]]
    for moment in np.linspace(0, len(rollout.time) - 1, 10).astype(int):
        look(page, rollout.time[moment], "side")
        shown = page.evaluate(PLACES)
        data.qpos[:] = rollout.poses[moment]
        mujoco.mj_kinematics(scene.model, data)
        for i in bodies:
            matrix = np.array(shown[f"robot: {scene.model.body(i).name}"]).reshape(4, 4).T
            assert np.linalg.norm(matrix[:3, 3] - data.xpos[i]) < 1e-3
            between = matrix[:3, :3].T @ data.xmat[i].reshape(3, 3)
            assert np.degrees(np.arccos(np.clip((np.trace(between) - 1) / 2, -1, 1))) < 1


def test_buttons_keys_and_choices_do_what_they_say(page, crowded):
    open_file(page, crowded)
    playing = lambda: page.evaluate("walkerlab.state.playing")  # noqa: E731
    assert playing()
    page.get_by_role("button", name="pause").click()
    assert not playing()
    page.get_by_label("time in seconds").fill("4")
    assert page.evaluate("walkerlab.state.time") == pytest.approx(4, abs=0.02)
    assert "4.00 s" in page.locator(".clock").inner_text()
    page.get_by_label("camera").select_option("top")
    page.get_by_label("speed").select_option("0.5")
    assert page.evaluate("[walkerlab.state.camera, walkerlab.state.speed]") == ["top", 0.5]
    page.get_by_label("loop").uncheck()
    page.evaluate("walkerlab.seek(7.95)")
    page.get_by_role("button", name="play").click()
    page.wait_for_function("!walkerlab.state.playing")
    assert page.evaluate("walkerlab.state.time") == 8
    page.locator("canvas").first.hover(position={"x": 300, "y": 200})
    page.mouse.down()
    page.mouse.move(350, 220)
    page.mouse.up()
    assert page.evaluate("walkerlab.state.camera") == "free"


# ------------------------------------------------------------------------------------------- in JupyterLab

N_REPLAYS = 20


def many_replays():
    setting = (
        "import walkerlab as wl\nfrom walkerlab.commands.worlds import GENOME\ns = wl.Settings().with_(duration=2)"
    )
    return book(setting, *(f"wl.replay({{'walk {i}': GENOME}}, s)" for i in range(N_REPLAYS)))


def test_twenty_replays_in_one_notebook_play_one_after_the_other(page, jupyter):
    abroad = []

    def at_home(route):
        if route.request.url.startswith((jupyter.address, "data:", "blob:")):
            route.continue_()
        else:
            abroad.append(route.request.url)
            route.abort()

    page.route("**/*", at_home)
    page.set_viewport_size({"width": 1280, "height": 900})
    open_notebook(page, jupyter.put(many_replays()))
    start_all(page)
    for number in range(N_REPLAYS):
        cell = page.locator(f'.jp-Cell[data-windowed-list-index="{number + 1}"]')
        play = cell.locator('button[title="Play"]')
        cell.scroll_into_view_if_needed(timeout=60_000)
        play.wait_for(timeout=60_000)
        play.click()
        frame = cell.locator("iframe").element_handle(timeout=20_000).content_frame()
        frame.wait_for_function("window.walkerlab && walkerlab.state.time > 0.1", timeout=30_000)
        assert f"walk {number}" in frame.locator(".board").inner_text()
        assert not frame.evaluate("walkerlab.K3D.getWorld().renderer.getContext().isContextLost()")
        assert page.locator("iframe").count() <= 4
        if number == 0:
            assert_it_plays(frame)
            assert_every_camera_shows_the_walker(frame, 1, 1.7)
    page.locator('button[title^="close the replay"]').last.click()
    assert abroad == []
