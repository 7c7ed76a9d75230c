"""A replay shows what was simulated, plays offline in any browser, and releases its widgets and WebGL contexts.

Its test in JupyterLab also contains a playground, because both share a maximum number of open pages.
"""

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
from walkerlab.commands.worlds import WALKER_GENOME as GENOME
from walkerlab.settings.choices import Camera
from walkerlab.simulation.footfalls import find_footfalls
from walkerlab.view.replay.animation import build_animation, lateral_extent
from walkerlab.view.replay.footprints import make_footprints
from walkerlab.view.replay.meshes import DISC_CORNERS
from walkerlab.view.replay.page import Frame
from walkerlab.view.replay.preview import AXES_SIZE, LABEL_HEIGHT, _row_heights
from walkerlab.view.replay.shadows import SHADOW_SHIFT, bone_ends, shadow_transforms
from walkerlab.view.replay.tracks import frame_times, pack_channels, track_bodies
from walkerlab.view.replay.walkers import _racer_colour
from walkerlab.world.geometry import body_placements, n_valid_poses, rope_ends, rotate, surface_points
from walkerlab.world.heights import ARENA_WIDTH
from walkerlab.world.scene import compile_scene

SHORT = wl.Settings().with_(duration=2)
CROWDED = wl.Settings().with_(
    obstacle="ball", obstacle_density=20 / 90, obstacle_size=0.2, carry_weight=2, drag_weight=2
)


def unpack(packed, resolution):
    raw = zlib.decompress(packed)
    count = len(resolution)
    first_values = np.frombuffer(raw[: 8 * count], "<f8")[:, None]
    differences = np.frombuffer(raw[8 * count :], "<i4").reshape(count, -1)
    sums = np.concatenate([np.zeros((count, 1)), differences.cumsum(axis=1)], axis=1)
    return first_values + sums * resolution[:, None]


def test_packed_channels_are_decoded_within_half_a_unit():
    rng = np.random.default_rng(0)
    channels = rng.normal(size=(40, 401)).cumsum(axis=1)
    resolution = rng.uniform(1e-3, 1e-2, 40)
    error = np.abs(unpack(pack_channels(channels, resolution), resolution) - channels).max(axis=1)
    assert error == pytest.approx(resolution / 2, rel=0.1)


def test_a_walk_is_shown_until_its_physics_breaks_down():
    scene = compile_scene(GENOME, SHORT)
    rollout = wl.simulate(GENOME, SHORT)
    assert n_valid_poses(scene, rollout.poses) == len(rollout.poses)
    for i, bad in ((20, np.nan), (30, np.inf), (40, 1e9)):
        broken = rollout.poses.copy()
        broken[i:, 0] = bad
        assert n_valid_poses(scene, broken) == i
        tracks = track_bodies(scene, replace(rollout, poses=broken))
        assert np.isfinite(tracks.transforms).all()
        assert tracks.transforms.shape[1] == len(tracks.com) == i
    assert n_valid_poses(scene, np.full_like(rollout.poses, np.nan)) == 0


@pytest.mark.parametrize("timestep", [0.0013, 0.003, 0.005, 0.009])
def test_the_frame_times_do_not_depend_on_the_timestep(timestep):
    settings = SHORT.with_(timestep=timestep)
    scene = compile_scene(GENOME, settings)
    rollout = wl.simulate(GENOME, settings)
    tracks = track_bodies(scene, rollout)
    time = frame_times(rollout.time[-1])
    animation = build_animation(list(wl.replay(GENOME, settings).walks), "")
    assert animation.duration == pytest.approx(rollout.time[-1], abs=1e-9)
    for axis in range(3):
        assert np.allclose(tracks.com[:, axis], np.interp(time, rollout.time, rollout.com[:, axis]), atol=1e-9)
        position = np.interp(time, rollout.time, rollout.poses[:, axis])
        assert np.allclose(tracks.transforms[0, :, axis], position, atol=1e-9)
    assert np.allclose(np.linalg.norm(tracks.transforms[:, :, 3:7], axis=2), 1)


@pytest.mark.parametrize("changes", [{"wind": (10, 0, 0)}, {"structure": "incline", "incline": -30}])
def test_fast_rolling_balls_are_shown_within_the_resolution(changes):
    settings = wl.Settings().with_(obstacle="ball", obstacle_size=0.05, **changes)
    replay = wl.replay(GENOME, settings)
    animation = build_animation(list(replay.walks), "")
    decoded = unpack(pack_channels(animation.channels, animation.resolution), animation.resolution)
    error = np.abs(decoded - animation.channels).max(axis=1)
    assert (error <= 0.51 * animation.resolution).all()


def test_the_rope_reaches_from_end_to_end():
    settings = SHORT.with_(drag_weight=2)
    scene = compile_scene(GENOME, settings)
    rollout = wl.simulate(GENOME, settings)
    tracks = track_bodies(scene, rollout)
    for rod, ends in zip(tracks.rope, rope_ends(scene, body_placements(scene, rollout.poses)), strict=True):
        half = rod[7] / 2 * rotate(rod[np.newaxis, 3:7], np.array([0, 0, 1.0]))[0]
        assert np.allclose([rod[:3] - half, rod[:3] + half], ends, atol=1e-9)


@pytest.mark.parametrize("incline", [-30, 0, 20])
def test_a_shadow_lies_flat_on_the_ground_from_end_to_end_of_its_bone(incline):
    settings = SHORT.with_(structure="incline", incline=incline)
    scene = compile_scene(GENOME, settings)
    tracks = track_bodies(scene, wl.simulate(GENOME, settings))
    slope = math.tan(math.radians(incline))
    bones = dict(bone_ends(scene, tracks))
    assert len(bones) == 3 + 6 * 2
    for geom, ends in bones.items():
        shadow = shadow_transforms(scene, ends, geom)
        along = rotate(shadow[:, 3:7], np.array([0, 0, 1.0]))
        assert np.allclose(along[:, 2], slope * along[:, 0], atol=0.02), "parallel to the slope"
        assert np.allclose(shadow[:, 2], slope * shadow[:, 0], atol=0.01), "on the ground"
        half = shadow[:, 7:] / 2 - scene.model.geom_size[geom, 0]
        height = ends[1, :, 2] - slope * ends[1, :, 0]
        expected = ends[1, :, :2] + height[:, np.newaxis] * SHADOW_SHIFT
        if not incline:
            assert np.allclose((shadow[:, :3] + half * along)[:, :2], expected, atol=1e-6)
        changes = np.abs(np.diff(shadow[:, 3:7], axis=0)).max()
        assert changes < 0.9, "quaternions do not change their sign from frame to frame"


def test_a_footprint_appears_where_and_when_a_foot_touches_down():
    scene = compile_scene(GENOME, SHORT)
    rollout = wl.simulate(GENOME, SHORT)
    prints = make_footprints(scene, rollout, 0.5, None)
    footfalls = find_footfalls(scene, rollout.poses)
    touchdowns = rollout.time[np.flatnonzero((np.diff(footfalls.astype(int), axis=0, prepend=0) > 0).any(axis=1))]
    assert len(prints.times)
    assert np.isin(prints.times, touchdowns).all()
    assert (np.diff(prints.times) >= 0).all()
    vertices = prints.mesh.vertices.reshape(len(prints.times), -1, 3)
    assert len(prints.mesh.indices.reshape(-1, 3)) == DISC_CORNERS * len(prints.times)
    feet = vertices[:, 0] - (0, 0.5, 0)
    assert np.abs(feet[:, 2]).max() < 0.01
    assert np.abs(feet[:, 0] - np.interp(prints.times, rollout.time, rollout.com[:, 0])).max() < 0.8
    prints.mesh.close()


def test_every_walk_and_its_centre_of_mass_are_shown_in_its_lane():
    race = wl.replay({"a": GENOME, "b": GENOME}, SHORT)
    animation = build_animation(list(race.walks), "")
    for number, walk in enumerate(race.walks):
        path = animation.channels[len(animation.channels) - 6 + 3 * number :][:3].T
        assert np.allclose(path, walk.rollout.com + np.array([0, walk.lane, 0]), atol=1e-9)
    n_meshes = len(animation.mesh_ids)
    transforms = animation.channels[: 8 * n_meshes].reshape(n_meshes, 8, -1)
    assert np.allclose(transforms[n_meshes // 2, 1] - transforms[0, 1], race.walks[1].lane - race.walks[0].lane)


def test_obstacles_are_shown_as_the_farthest_robot_moved_them():
    other = GENOME.replace("frequency=1.2", "frequency=0.4")
    race = wl.replay({"a": GENOME, "b": other, "c": GENOME}, SHORT.with_(obstacle="box"))
    distances = [walk.rollout.distance for walk in race.walks]
    shows_obstacles = [walk.shows_obstacles for walk in race.walks]
    assert distances[0] != distances[1]
    assert sum(shows_obstacles) == 1
    assert shows_obstacles[int(np.argmax(distances))]


class TestWalkers:
    def labels(self, walkers, settings=SHORT):
        return [walk.label for walk in wl.replay(walkers, settings).walks]

    def test_genomes_may_be_given_in_every_form(self):
        genome = wl.Genome.parse(GENOME)
        assert self.labels(genome) == self.labels(GENOME) == self.labels(genome.values) == ["robot"]
        assert self.labels([genome, GENOME]) == ["robot 1", "robot 2"]
        assert self.labels({"Ada": genome, "Bob": GENOME}) == ["Ada", "Bob"]

    def test_equal_labels_are_numbered(self):
        assert self.labels({1: GENOME, "1": GENOME}) == ["1", "1 (2)"]

    def test_a_large_race_fits_on_the_stairs(self):
        race = wl.replay([GENOME] * 30, SHORT.with_(structure="stairs", duration=1))
        right, left = lateral_extent(list(race.walks))
        assert -ARENA_WIDTH / 2 - 0.5 < right < left < ARENA_WIDTH / 2 + 0.5
        assert len({walk.colour for walk in race.walks}) == 30

    def test_wrong_arguments_raise_an_error_with_a_clear_message(self):
        with pytest.raises(ValueError, match="no robot to replay"):
            wl.replay([], SHORT)
        with pytest.raises(wl.GenomeError):
            wl.replay("no gene", SHORT)
        with pytest.raises(wl.SettingsError, match="camera"):
            wl.replay(GENOME, SHORT, camera="below")

    def test_racers_differ_in_colour_and_do_not_touch(self):
        race = wl.replay({"a": GENOME, "b": GENOME, "c": GENOME}, SHORT)
        assert len({walk.colour for walk in race.walks}) == 3
        skins_y = [
            np.concatenate([skin[:, 1] + walk.lane for skin, _ in surface_points(walk.scene, walk.scene.start)])
            for walk in race.walks
        ]
        for left, right in pairwise(skins_y):
            assert left.min() > right.max()

    @pytest.mark.parametrize("uneven", [{"structure": "rough"}, {"obstacle": "box"}, {"texture_density": 0.1}])
    def test_all_walk_in_the_middle_if_the_ground_varies_sideways(self, uneven):
        race = wl.replay([GENOME, GENOME], SHORT.with_(**uneven))
        assert [walk.lane for walk in race.walks] == [0, 0]
        assert sum(walk.shows_obstacles for walk in race.walks) == 1


def test_a_run_shows_its_champion_or_a_race_of_champions_of_generations():
    run = wl.evolve(SHORT.with_(population_size=4, generations=3), progress=False)
    assert [walk.label for walk in run.replay().walks] == [f"robot {run.champion.individual}"]
    race = run.replay(0, 2, camera="top")
    assert [walk.label for walk in race.walks] == ["generation 0", "generation 2"]
    assert race.camera == Camera.top
    best = run.records[run.records.generation == 0].sort_values("fitness").genome.iloc[-1]
    assert str(race.walks[0].scene.genome) == best
    with pytest.raises(ValueError, match="no generation 3; this run has 0 to 2"):
        run.replay(0, 3)


def test_a_loaded_run_with_a_user_fitness_can_be_replayed(tmp_path):
    path = tmp_path / "run.walk"
    settings = SHORT.with_(population_size=4, generations=1, fitness=lambda rollout: rollout.distance)
    with ThreadPoolExecutor(1) as thread:
        wl.evolve(settings, path, executor=thread, progress=False)
    assert "distance forward" in wl.load(path).replay().page


def test_of_several_starts_the_poorest_walk_is_shown_which_determines_the_fitness():
    settings = SHORT.with_(n_starts=4)
    [evaluation] = wl.evaluate([GENOME], settings)
    [walk] = wl.replay(GENOME, settings).walks
    assert walk.rollout.distance == evaluation.distance


def test_making_a_page_leaves_no_widgets_in_memory():
    registry = ipywidgets.widgets.widget._instances
    counts = [len(registry) for _ in range(3) if wl.replay(GENOME, SHORT).page]
    assert counts[2] == counts[0]


class Links(HTMLParser):
    """The addresses that a page would load, and the number of its scripts."""

    def __init__(self, text):
        super().__init__()
        self.loads = []
        self.scripts = 0
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        self.scripts += tag == "script"
        self.loads += [value for name, value in attrs if name in ("src", "href")]


class TestThePage:
    def test_it_loads_nothing(self):
        assert Links(wl.replay(GENOME, SHORT).page).loads == []

    def test_labels_with_html_stay_text(self):
        hostile = "</script><script>alert(1)</script><img src=x onerror=alert(1)>"
        plain, attacked = (Links(wl.replay({name: GENOME}, SHORT).page) for name in ("Ada", hostile))
        assert attacked.scripts == plain.scripts
        assert attacked.loads == []

    def test_a_page_with_twenty_obstacles_is_below_3_megabytes(self, tmp_path):
        replay = wl.replay(GENOME, CROWDED)
        model = replay.walks[0].scene.model
        assert sum("obstacle" in model.body(i).name for i in range(model.nbody)) == 20
        assert replay.to_html(tmp_path / "replay.html").stat().st_size < 3e6

    def test_a_walk_that_breaks_down_at_once_is_shown(self):
        unstable = wl.Settings().with_(gravity=(-30, 12, -30), duration=2, timestep=0.01, texture_size=0.2)
        unstable = unstable.with_(robot=wl.Robot(leg_force=(500, 500), weight=(0.1, 0.1), carry_weight=60))
        assert wl.simulate(GENOME, unstable).verdict == "unstable", "the test requires an unstable walk"
        assert "Does not count: unstable" in wl.replay(GENOME, unstable).page

    def test_the_snapshot_is_the_preview_image(self):
        [picture] = assert_harmless(wl.replay({"<b>Ada</b>": GENOME}, SHORT).widget.snapshot()).all("img")
        assert picture["src"].startswith("data:image/png;base64,")
        assert "<b>Ada</b>" in picture["alt"]
        assert len(picture["src"]) < 100_000

    def test_each_row_of_a_race_has_room_for_its_label(self):
        flat_bodies = [[(np.array([[0, 0, 0], [distance, 0, 0.2]]), np.zeros(4))] for distance in range(-3, 5)]
        rows = _row_heights(flat_bodies)
        inches_per_metre = AXES_SIZE / max(sum(rows), 7)
        assert min(rows) * inches_per_metre >= LABEL_HEIGHT * 0.99

    def test_a_page_made_after_another_offer_is_discarded(self):
        class Slow:
            @property
            def page(self):
                frame.set_replay(lambda: self, "new", "the new robot")
                return "old"

        frame = Frame()
        frame.set_replay(Slow, "old", "the old robot")
        frame._handle_custom_msg({"request": "page", "number": frame.number}, [])
        assert (frame.page, frame.alt) == (b"", "the new robot")

    def test_a_press_on_a_picture_that_is_replaced_plays_the_new_replay(self, monkeypatch):
        sent = []
        monkeypatch.setattr(Frame, "send", lambda _, message: sent.append(message))
        frame = Frame()
        frame.set_replay(lambda: pytest.fail("the old page was created"), "old", "the old robot")
        pressed = {"request": "page", "number": frame.number}
        frame.set_replay(lambda: pytest.fail("made without a request"), "new", "the new robot")
        frame._handle_custom_msg(pressed, [])
        assert sent == [{"play": True, "reveal": False}]
        assert frame.is_watched

    def test_a_late_report_that_an_earlier_replay_was_opened_does_not_end_the_opening_of_the_next(self):
        frame = Frame()
        frame.set_replay(lambda: pytest.fail("made without a request"), "new", "the new robot")
        frame.play()
        frame.is_open = True  # of the replay before
        frame.is_open = False
        assert frame.is_watched
        frame.page = b"page"
        frame.is_open = True
        frame.is_open = False
        assert not frame.is_watched

    def test_an_offer_removes_the_page_of_the_previous_replay(self):
        frame = Frame()
        frame.page = b"previous"
        frame.set_replay(lambda: pytest.fail("made without a request"), "new", "the new robot")
        assert frame.page == b""


# ---------------------------------------------------------------------------------------------- in a browser


def open_file(page, path):
    page.context.set_offline(True)
    page.goto(path.as_uri())
    page.wait_for_function("window.walkerlab")


TWO_FRAMES = "() => new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))"


def take_picture(page, time, camera):
    page.evaluate(f"walkerlab.pause(); walkerlab.state.camera = '{camera}'; walkerlab.seek({time})")
    page.evaluate(TWO_FRAMES)  # what was drawn in the first is visible in the second
    return page.locator("#canvasTarget").screenshot()


def pixels(picture):
    return np.asarray(Image.open(io.BytesIO(picture)).convert("RGB"), dtype=int)


def assert_it_plays(page):
    page.wait_for_function("walkerlab.state.time > 0.05", timeout=30_000)
    first = page.locator("#canvasTarget").screenshot()
    now = page.evaluate("walkerlab.state.time")
    page.wait_for_function(f"Math.abs(walkerlab.state.time - {now}) > 0.3")
    assert (pixels(first) != pixels(page.locator("#canvasTarget").screenshot())).any(axis=2).mean() > 0.003


def assert_every_camera_shows_the_robot(page, time, later):
    pictures = set()
    for camera in Camera:
        picture = take_picture(page, time, camera.name)
        pictures.add(picture)
        red, green, blue = pixels(picture).transpose(2, 0, 1)
        trunk = (red > 1.25 * green) & (green > 2 * blue) & (red > 120)
        limbs = (blue > 1.25 * green) & (green > 1.2 * red)
        for part in (trunk, limbs):
            assert part.sum() > 200, camera
        rows, columns = np.nonzero(trunk)
        assert 20 < rows.mean() < red.shape[0] - 20, camera
        assert 20 < columns.mean() < red.shape[1] - 20, camera
        take_picture(page, later, camera.name)
        assert take_picture(page, time, camera.name) == picture, camera
    assert len(pictures) == len(Camera), "each camera has another view"


MESH_MATRICES = """() => {
    const world = walkerlab.K3D.getWorld(), matrices = {};
    for (const [id, mesh] of Object.entries(world.ObjectsById)) {
        mesh.updateMatrixWorld(true);
        const name = world.ObjectsListJson[id].name;
        if (name) matrices[name] = mesh.matrixWorld.elements;
    }
    return matrices;
}"""


def assert_bodies_are_within_a_millimetre_and_a_degree_of_the_rollout(page):
    scene = compile_scene(GENOME, CROWDED)
    rollout = wl.simulate(GENOME, CROWDED)
    data = mujoco.MjData(scene.model)
    bodies = [i for i in range(1, scene.model.nbody) if scene.model.body_geomnum[i]]
    for row in np.linspace(0, len(rollout.time) - 1, 10).astype(int):
        page.evaluate(f"walkerlab.seek({rollout.time[row]})")
        page.evaluate(TWO_FRAMES)
        shown = page.evaluate(MESH_MATRICES)
        data.qpos[:] = rollout.poses[row]
        mujoco.mj_kinematics(scene.model, data)
        for i in bodies:
            matrix = np.array(shown[f"robot: {scene.model.body(i).name}"]).reshape(4, 4).T
            assert np.linalg.norm(matrix[:3, 3] - data.xpos[i]) < 1e-3
            rotation = matrix[:3, :3].T @ data.xmat[i].reshape(3, 3)
            assert np.degrees(np.arccos(np.clip((np.trace(rotation) - 1) / 2, -1, 1))) < 1


def assert_controls_change_the_state_of_the_player(page):
    assert page.evaluate("walkerlab.state.playing")
    page.get_by_role("button", name="Pause (space)").click()
    assert not page.evaluate("walkerlab.state.playing")
    page.get_by_label("Time in seconds").fill("4")
    assert page.evaluate("walkerlab.state.time") == pytest.approx(4, abs=0.02)
    assert "4.00 s" in page.locator(".clock").inner_text()
    page.get_by_label("Camera").select_option("top")
    page.get_by_label("Speed").select_option("0.5")
    assert page.evaluate("[walkerlab.state.camera, walkerlab.state.speed]") == ["top", 0.5]
    page.get_by_label("loop").uncheck()
    page.evaluate("walkerlab.seek(7.95)")
    page.get_by_role("button", name="Play (space)").click()
    page.wait_for_function("!walkerlab.state.playing")
    assert page.evaluate("walkerlab.state.time") == 8
    page.locator("canvas").first.hover(position={"x": 300, "y": 200})
    page.mouse.down()
    page.mouse.move(350, 220)
    page.mouse.up()
    assert page.evaluate("walkerlab.state.camera") == "free"


def test_a_file_plays_shows_the_rollout_from_every_camera_and_obeys_its_controls(page, tmp_path):
    open_file(page, wl.replay(GENOME, CROWDED).to_html(tmp_path / "replay.html"))
    assert_it_plays(page)
    assert_controls_change_the_state_of_the_player(page)
    assert_every_camera_shows_the_robot(page, 3, 5.5)
    assert_bodies_are_within_a_millimetre_and_a_degree_of_the_rollout(page)


# ------------------------------------------------------------------------------------------- in JupyterLab

REPLAYS = """
import walkerlab as wl
from walkerlab.commands.worlds import WALKER_GENOME as GENOME
s = wl.Settings().with_(duration=2)
"""
MAX_OPEN_PAGES = 4  # as in frame.js and playground.js
OPEN_OTHERS = f"""() => {{ // stands for open replays of other cells, which take seconds to open
    window.nClosed = 0;
    const close = () => {{ window.nClosed += 1; walkerlabOpenPages.shift(); }};
    for (let i = 1; i < {MAX_OPEN_PAGES}; i++) walkerlabOpenPages.push({{ close, pause() {{}} }});
}}"""


def play_in_cell(page, number):
    """Play the replay of a cell; return its page, which is checked."""
    cell = page.locator(f'.jp-Cell[data-windowed-list-index="{number}"]')
    cell.scroll_into_view_if_needed(timeout=60_000)
    cell.locator('button[title="Play"]').click(timeout=60_000)
    frame = cell.locator("iframe").element_handle(timeout=30_000).content_frame()
    frame.wait_for_function("window.walkerlab && walkerlab.state.time > 0.1", timeout=30_000)
    assert f"walk {number}" in frame.locator(".walks").inner_text()
    assert not frame.evaluate("walkerlab.K3D.getWorld().renderer.getContext().isContextLost()")
    return frame


PLAYGROUND = (
    f"live = wl.playground({GENOME!r}, s)\nlive",
    "print('frequency', live.genome.values[1])",
    f"live.gene_text = {GENOME.replace('frequency=1.2', 'frequency=0.9')!r}",
)


BUTTONS_ARE_IN_SIGHT = """() => { // the close button is the lowest
    const button = document.querySelector(".wl-playground .close").getBoundingClientRect();
    return document.elementFromPoint(button.x + 5, button.bottom - 5)?.className === "close";
}"""


def assert_a_playground_and_python_change_the_same_genome(page, first_cell):
    """Check the playground whose cells begin with this one."""
    page.locator('.wl-playground button[title="Walk live"]').click(timeout=60_000)
    frame = page.locator(".wl-playground iframe").element_handle(timeout=30_000).content_frame()
    frame.wait_for_function("window.walkerlab && walkerlab.walks[0].time > 0.1", timeout=60_000)
    page.wait_for_function(BUTTONS_ARE_IN_SIGHT)
    frame.wait_for_function("walkerlab.listeners.length === 1 && walkerlab.genome.includes('frequency=0.9')")
    frame.get_by_label("frequency").fill("1.7")
    page.locator(f'.jp-Cell[data-windowed-list-index="{first_cell + 1}"]').click()
    page.keyboard.press("Control+Enter")
    page.get_by_text("frequency 1.7").wait_for()
    page.get_by_role("button", name="Close", exact=True).click()
    assert page.locator(".wl-playground iframe").count() == 0
    page.get_by_text("Walk live, with your changes").wait_for()
    page.get_by_role("button", name="Undo your changes").click()
    page.get_by_text("Walk live", exact=True).wait_for()


def test_the_oldest_of_many_open_pages_is_closed_and_can_be_played_again(page, jupyter):
    external_requests = []

    def allow_local(route):
        if route.request.url.startswith((jupyter.address, "data:", "blob:")):
            route.continue_()
        else:
            external_requests.append(route.request.url)
            route.abort()

    page.route("**/*", allow_local)
    page.set_viewport_size({"width": 1280, "height": 900})
    replays = [f"wl.replay({{'walk {i}': GENOME}}, s)" for i in (1, 2)]
    open_notebook(page, jupyter.put(book(REPLAYS, *replays, *PLAYGROUND)))
    start_all(page)
    assert_it_plays(play_in_cell(page, 1))
    page.evaluate(OPEN_OTHERS)
    play_in_cell(page, 2)
    assert page.locator("iframe").count() == 1, "the first is closed, so that its WebGL context is free"
    play_in_cell(page, 1)
    assert (page.locator("iframe").count(), page.evaluate("window.nClosed")) == (2, 1)
    page.locator('button[title="Close the replay"]').last.click()
    assert page.locator("iframe").count() == 1
    assert_a_playground_and_python_change_the_same_genome(page, 3)
    assert external_requests == []


def test_the_racers_of_a_large_class_have_different_colours():
    colours = np.array([_racer_colour(number) for number in range(36)])
    differences = np.abs(colours[:, np.newaxis] - colours).max(axis=2)
    assert (differences + np.eye(36) > 0.08).all()
