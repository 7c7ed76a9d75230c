import json
import os
import signal
import subprocess
import sys
import threading
import time
from dataclasses import replace
from pathlib import Path

import av
import mujoco
import numpy as np
import pandas as pd
import pytest

from walkerlab import graphics, records
from walkerlab.choices import Camera
from walkerlab.cinema import Film, FilmError, crew, film, timelapse
from walkerlab.cinema.job import Act, Job
from walkerlab.cinema.reel import record
from walkerlab.cinema.studio import Pieces, cameras_at, frames, lasting, pose_at
from walkerlab.cinema.titles import Titles
from walkerlab.commands.worlds import GENOME
from walkerlab.fitness import distance, poorest_walk
from walkerlab.rollout import simulate
from walkerlab.run import Run
from walkerlab.scene import compile_scene, control_steps
from walkerlab.settings import Settings

SHORT = Settings().with_(duration=1)
SMALL = {"size": (128, 96), "fps": 10, "progress": False}
JOB = Job((Act("", 1.0),), SHORT, (128, 96), 10, ".mp4")


def missing(what):
    """Skip, or fail where nothing may be missing."""
    (pytest.fail if os.environ.get("CI") else pytest.skip)(f"needs {what}")


@pytest.fixture(scope="session")
def gl():
    if not (found := graphics.find_gl()):
        missing(f"a GL that draws without a screen: {graphics.mend()}")
    return found[0]


@pytest.fixture(scope="module")
def made(gl, tmp_path_factory):
    return film(GENOME, SHORT, tmp_path_factory.mktemp("films") / "walk.mp4", **SMALL)


def pictures(path):
    with av.open(str(path)) as file:
        return np.array([frame.to_ndarray(format="rgb24") for frame in file.decode(video=0)]).astype(int)


def is_of_the_robot(picture):
    """Say of each pixel whether it has the orange of the trunk or the blues of the limbs."""
    red, green, blue = np.moveaxis(np.asarray(picture).astype(int), -1, 0)
    return ((red > 2 * blue + 40) & (red > green + 20)) | ((blue > 2 * red + 10) & (blue > 1.15 * green))


# ----------------------------------------------------------------------------------------------- what is filmed


def test_a_film_has_its_size_its_frames_and_its_length(made):
    with av.open(str(made.path)) as file:
        stream = file.streams.video[0]
        assert (stream.width, stream.height) == made.size == (128, 96)
        assert stream.codec_context.name == "h264"
        assert stream.pix_fmt == "yuv420p"
        assert float(stream.duration * stream.time_base) == pytest.approx(1.0)
        assert made.seconds == 1.0
    assert len(pictures(made.path)) == made.n_frames == 10
    box = made.path.read_bytes()
    assert box.index(b"moov") < box.index(b"mdat")  # it plays before it is all there


def test_what_it_shows_moves(made):
    frames = pictures(made.path)
    still = np.abs(np.diff(frames, axis=0)).max(axis=(1, 2, 3)) < 30
    assert not still.any()
    assert is_of_the_robot(frames[-1]).mean() > 0.01


LOOK = """
import json, sys
import numpy as np
from walkerlab.cinema.job import Act, Job
from walkerlab.cinema.reel import record
from walkerlab.cinema.studio import frames
from walkerlab.settings import Settings
genome, worlds, path = json.loads(sys.argv[1])
shown = {}
for name, world in worlds.items():
    settings = Settings().with_(duration=1, **world)
    job = Job((Act(genome, 2.0),), settings, (160, 120), 1, ".mp4")
    shown[name] = np.array(list(frames(job, sketch=True)))
np.savez(path, **shown)
"""


def test_every_camera_has_the_whole_robot_in_the_picture_and_not_small(gl, tmp_path):
    worlds = {camera.name: {"camera": camera.name} for camera in Camera}
    order = json.dumps([GENOME, worlds, str(tmp_path / "shown.npz")])
    subprocess.run([sys.executable, "-c", LOOK, order], check=True, env={**os.environ, **graphics.variables(gl)})
    with np.load(tmp_path / "shown.npz") as shown:
        for camera, views in shown.items():
            for view in views:
                rows, columns = np.nonzero(is_of_the_robot(view))
                assert 0.005 < len(rows) / view[..., 0].size < 0.25, camera
                assert rows.min() > 8, camera
                assert rows.max() < 112, camera
                assert columns.min() > 8, camera
                assert columns.max() < 152, camera
                assert max(np.ptp(rows), np.ptp(columns)) > 24, camera


@pytest.mark.parametrize(
    "changes", [{}, {"carry_weight": 2, "drag_weight": 3, "obstacle": "rock"}, {"wind": (5, 1, 0)}]
)
def test_scenery_changes_nothing_that_a_pose_is_of(changes):
    settings = SHORT.with_(**changes)
    bare, dressed = compile_scene(GENOME, settings).model, compile_scene(GENOME, settings, scenery=True).model
    for of in ("nq", "nv", "nbody", "ngeom", "njnt", "ntendon"):
        assert getattr(bare, of) == getattr(dressed, of)
    for of in ("jnt_type", "jnt_qposadr", "body_parentid", "geom_type", "geom_bodyid"):
        np.testing.assert_array_equal(getattr(bare, of), getattr(dressed, of))
    for of in ("body_pos", "body_quat", "geom_pos", "geom_size", "jnt_pos", "jnt_axis"):
        np.testing.assert_allclose(getattr(bare, of), getattr(dressed, of), atol=1e-9)


def test_at_25_frames_a_second_every_second_recorded_pose_is_shown_as_it_was():
    scene, rollout = compile_scene(GENOME, SHORT), simulate(GENOME, SHORT)
    shown = [pose_at(scene.model, rollout.time, rollout.poses, k / 25) for k in range(25)]
    np.testing.assert_array_equal(shown, rollout.poses[:50:2])


def test_between_two_recorded_poses_things_are_on_their_way():
    scene, rollout = compile_scene(GENOME, SHORT), simulate(GENOME, SHORT)
    first, second = rollout.poses[20:22]
    for share in (0.25, 0.5):
        pose = pose_at(scene.model, rollout.time, rollout.poses, rollout.time[20] + 0.02 * share)
        np.testing.assert_allclose(
            np.delete(pose, range(3, 7)), np.delete(first + share * (second - first), range(3, 7))
        )
        assert np.linalg.norm(pose[3:7]) == pytest.approx(1)
        np.testing.assert_allclose(pose[3:7], first[3:7] + share * (second - first)[3:7], atol=1e-4)
    np.testing.assert_array_equal(pose_at(scene.model, rollout.time, rollout.poses, 99.0), rollout.poses[-1])


@pytest.fixture
def drawn(monkeypatch):
    """Have nothing drawn, but see what would be: the pose, and the camera, of each frame."""
    seen = []

    class Renderer:
        def __init__(self, model, height, width):
            self._picture = np.zeros((height, width, 3), dtype=np.uint8)

        def __enter__(self):
            return self

        def __exit__(self, *_):
            return None

        def update_scene(self, data, camera):
            seen.append((data.qpos.copy(), data.subtree_com[1].copy(), camera))

        def render(self):
            return self._picture

    monkeypatch.setattr(mujoco, "Renderer", Renderer)
    return seen


def draw(genome, settings, *, fps=10, seconds=1.0):
    """Go through the frames of a film of one walk."""
    for _ in frames(Job((Act(genome, seconds),), settings, (128, 96), fps, ".mp4"), sketch=True):
        pass


@pytest.mark.parametrize("fps", [10, 24, 25, 50, 60])
def test_at_any_rate_a_frame_shows_the_robot_where_it_was_at_its_moment(drawn, fps):
    draw(GENOME, SHORT, fps=fps)
    rollout = simulate(GENOME, SHORT)
    assert len(drawn) == fps
    recorded = [np.interp(np.arange(fps) / fps, rollout.time, column) for column in rollout.com.T]
    np.testing.assert_allclose([com for _, com, _ in drawn], np.transpose(recorded), atol=2e-3)
    assert np.linalg.norm(drawn[-1][1] - drawn[0][1]) > 0.02  # it went on, by much more than that


@pytest.mark.parametrize("seconds", [0.5, 2.0])
def test_a_film_shows_the_poorest_of_several_starts(drawn, seconds):
    settings = SHORT.with_(n_starts=4, duration=2, wind=(3, 1, 0))
    counted = poorest_walk(GENOME, settings)
    assert distance(counted) < distance(simulate(GENOME, settings)) - 1e-6  # it is another walk
    draw(GENOME, settings, seconds=seconds)
    np.testing.assert_array_equal([pose for pose, _, _ in drawn], counted.poses[: int(50 * seconds) : 5])


def broken(rollout, at, bad):
    """Have the numbers of a walk run away from a moment on."""
    poses, com, load = rollout.poses.copy(), rollout.com.copy(), rollout.load.copy()
    poses[at:, 0] = com[at:, 0] = bad
    if len(load):
        load[at:, 0] = bad
    return replace(rollout, poses=poses, com=com, load=load)


@pytest.mark.parametrize("bad", [np.nan, np.inf, 1e9])
@pytest.mark.parametrize("loads", [{}, {"drag_weight": 3}])
def test_a_walk_that_breaks_down_is_held_as_it_was_last_seen(bad, loads):
    scene, rollout = compile_scene(GENOME, SHORT.with_(**loads)), simulate(GENOME, SHORT.with_(**loads))
    assert lasting(scene, rollout) is rollout
    held = lasting(scene, broken(rollout, 20, bad))
    for of in ("poses", "com", *(["load"] if loads else [])):
        shown, recorded = getattr(held, of), getattr(rollout, of)
        np.testing.assert_array_equal(shown[:20], recorded[:20])
        np.testing.assert_array_equal(shown[20:], np.tile(recorded[19], (len(recorded) - 20, 1)))
    assert len(held.load) == len(rollout.load)


@pytest.mark.parametrize("loads", [{}, {"drag_weight": 3}])
def test_a_walk_that_never_held_is_its_start(loads):
    settings = SHORT.with_(**loads)
    scene, rollout = compile_scene(GENOME, settings), simulate(GENOME, settings)
    held = lasting(scene, broken(rollout, 0, np.nan))
    assert (held.poses == scene.start).all()
    for of in ("com", *(["load"] if loads else [])):
        shown = getattr(held, of)
        assert not np.ptp(shown, axis=0).any()
        np.testing.assert_allclose(shown[0], getattr(rollout, of)[0], atol=0.2)  # it has yet to settle


def test_neither_robot_nor_camera_leaves_when_the_numbers_run_away(drawn, monkeypatch):
    monkeypatch.setattr("walkerlab.cinema.studio.poorest_walk", lambda *given: broken(poorest_walk(*given), 20, 1e9))
    draw(GENOME, SHORT)
    for pose, _, camera in drawn:
        assert np.abs(pose[:3]).max() < 5
        assert np.abs(camera.lookat).max() < 5
        assert 1 < camera.distance < 10


@pytest.mark.parametrize("timestep", [0.0005, 0.0013, 0.003, 0.007, 0.009, 0.01])
def test_the_camera_is_the_same_at_any_timestep(timestep):
    scene, rollout = compile_scene(GENOME, SHORT), simulate(GENOME, SHORT)
    moments = np.arange(0, 2, 0.04)

    def cameras(step):
        """Film a robot that walks and bobs, recorded as ``walk`` does."""
        n_steps = round(2 / step) + 1
        time = np.union1d(control_steps(n_steps, step)[0], n_steps - 1) * step
        com = np.stack([0.5 * time, 0.1 * np.sin(3 * time), 0.3 + 0.02 * np.sin(12 * time)], axis=1)
        shot = cameras_at(moments, scene, replace(rollout, time=time, com=com), 4 / 3)
        return np.array([[*one.lookat, one.distance, one.azimuth, one.elevation] for one in shot])

    np.testing.assert_allclose(cameras(timestep), cameras(0.005), atol=3e-3)


def test_a_sledge_is_in_the_picture_and_a_narrow_picture_is_taken_from_farther_away():
    alone, loaded = SHORT, SHORT.with_(drag_weight=3)
    moments = np.array([0.0, 0.5])

    def cameras(settings, shape):
        return cameras_at(moments, compile_scene(GENOME, settings), simulate(GENOME, settings), shape)

    assert cameras(loaded, 4 / 3)[0].distance > cameras(alone, 4 / 3)[0].distance + 0.5
    assert cameras(loaded, 4 / 3)[0].lookat[0] < cameras(alone, 4 / 3)[0].lookat[0] - 0.3
    assert cameras(alone, 2 / 3)[0].distance == pytest.approx(2 * cameras(alone, 4 / 3)[0].distance)
    assert cameras(alone, 2)[0].distance == cameras(alone, 4 / 3)[0].distance


def test_pieces_in_the_picture_are_drawn_and_those_behind_are_not():
    settings = SHORT.with_(texture="gravel", texture_density=0.1, texture_size=0.1, camera="side")
    scene, rollout = compile_scene(GENOME, settings), simulate(GENOME, settings)
    (camera,), pieces = cameras_at(np.array([0.5]), scene, rollout, 4 / 3), Pieces(scene, 4 / 3, sketch=True)
    assert len(pieces) > 100
    pieces.show(camera)
    eye = camera.lookat[1] - camera.distance * np.cos(np.radians(camera.elevation))
    shown = scene.model.geom_pos[scene.model.geom_group == 0][:, 1]
    hidden = scene.model.geom_pos[scene.model.geom_group == 5]
    assert len(hidden) > 100
    assert shown[1:].min() > eye  # the first is the ground
    near = np.linalg.norm(hidden[:, :2] - camera.lookat[:2], axis=1)
    assert near.min() > 0.8


@pytest.mark.parametrize("suffix", [".mp4", ".webm", ".gif"])
def test_every_kind_of_film_has_all_its_frames_in_their_colours(tmp_path, suffix):
    colours = [(240, 150, 0), (20, 110, 180), (190, 190, 175), (60, 60, 60)]
    drawn = [np.full((96, 128, 3), colour, dtype=np.uint8) for colour in colours]
    drawn[0][48:] = colours[1]
    record(iter(drawn), tmp_path / "film", suffix, (128, 96), 10)
    shown = pictures(tmp_path / "film")
    assert shown.shape == (4, 96, 128, 3)
    for one, other in zip(shown, drawn, strict=True):
        np.testing.assert_allclose(one[8:40, 8:120].mean(axis=(0, 1)), other[8:40, 8:120].mean(axis=(0, 1)), atol=8)


def test_what_stands_still_in_a_gif_does_not_flicker(tmp_path):
    ground = np.random.default_rng(0).integers(0, 255, (96, 128, 3), dtype=np.uint8)  # more colours than it can have
    drawn = [ground.copy() for _ in range(5)]
    for number, picture in enumerate(drawn):
        picture[40:60, 20 * number : 20 * number + 20] = 250, 0, 0
    record(iter(drawn), tmp_path / "film", ".gif", (128, 96), 10)
    shown = pictures(tmp_path / "film")
    assert not np.ptp(shown[:, :40], axis=0).any()


@pytest.mark.parametrize("fps", [10, 25, 50])
@pytest.mark.parametrize("suffix", [".mp4", ".webm", ".gif"])
def test_every_kind_of_film_plays_at_its_speed(tmp_path, suffix, fps):
    drawn = np.random.default_rng(0).integers(0, 255, (fps // 2, 96, 128, 3), dtype=np.uint8)
    record(iter(drawn), tmp_path / "film", suffix, (128, 96), fps)
    with av.open(str(tmp_path / "film")) as file:
        shown = [frame.time for frame in file.decode(video=0)]
    np.testing.assert_allclose(shown, np.arange(fps // 2) / fps, atol=2e-3)


# -------------------------------------------------------------------------------------------------- what is written


def test_a_caption_and_a_ruler_can_be_read_and_leave_the_middle_alone():
    job = replace(JOB, acts=(Act("", 1, "generation 3 · 2.10 m", 3),), size=(480, 360), ruler=(0, 12))
    ground = np.full((360, 480, 3), 230, dtype=np.uint8)  # snow
    written = Titles(job.acts[0], job).over(ground).astype(int)
    changed = np.nonzero(np.abs(written - 230).max(axis=(1, 2)) > 5)[0]
    assert changed.min() < 30
    assert changed.max() > 330
    assert not np.any((changed > 40) & (changed < 320))
    plate = written[10:30, 10:150]
    assert plate.max() - np.median(plate) > 100  # white on dark, whatever the ground
    np.testing.assert_array_equal(Titles(JOB.acts[0], JOB).over(ground), ground)


def test_the_ruler_points_at_the_generation():
    def place(generation):
        act = Act("", 1, "", generation)
        job = replace(JOB, acts=(act,), size=(480, 360), ruler=(0, 10))
        row = (
            Titles(act, job).over(np.zeros((360, 480, 3), dtype=np.uint8))[330:355, 40:440].astype(int).sum(axis=(0, 2))
        )
        return int(np.argmax(np.convolve(row, np.ones(9), "same")))

    places = [place(generation) for generation in (1, 5, 9)]
    assert places == sorted(places)
    assert places[2] - places[1] == pytest.approx(places[1] - places[0], abs=3)


def test_a_caption_that_is_too_long_is_made_to_fit():
    act = Act("", 1, "ein sehr langer Titel\nin zwei Zeilen " * 9)
    written = Titles(act, JOB).over(np.full((96, 128, 3), 230, dtype=np.uint8))
    assert (written[:, -4:] == 230).all()


# ------------------------------------------------------------------------------------------------------ time-lapse


def run_of(champions, settings=SHORT):
    """Make a run whose generation i has this champion, and a poorer robot beside it."""
    rows = [
        {"generation": i, "individual": number, "born": 0, "parents": "", "operators": "random", "fitness": fitness,
         "verdict": "ok", "reason": "", "distance": 0, "velocity": 0, "n_segments": 3, "n_legs": 6, "weight": 6,
         "body_length": 0.8, "genome": GENOME}
        for i, best in enumerate(champions)
        for number, fitness in ((best, 1.0 + best), (10_000 + i, 0.5))
    ]  # fmt: skip
    return Run(settings, records.tidy(pd.DataFrame(rows)))


@pytest.fixture
def jobs(monkeypatch):
    """Have no film made, but see what was asked for."""
    asked = []
    monkeypatch.setattr("walkerlab.cinema.make", lambda job, path, *, progress: asked.append(job))
    return asked


def test_a_time_lapse_shows_each_champion_once_with_its_generations(jobs):
    made = timelapse(run_of([1, 2, 2, 2, 3]), "lapse.mp4", seconds=0.5, fps=10)
    (job,) = jobs
    said = [act.caption for act in job.acts]
    assert said == [
        "generation 0 · robot 1 · 2.00 m",
        "generations 1–3 · robot 2 · 3.00 m",
        "generation 4 · robot 3 · 4.00 m",
    ]
    assert job.ruler == (0, 4)
    assert made.n_frames == 15


@pytest.mark.parametrize(("n", "at_most"), [(50, 7), (50, 2), (3, 20), (1, 2)])
def test_a_thinned_time_lapse_keeps_the_first_and_the_last_and_is_even(jobs, n, at_most):
    timelapse(run_of(range(n)), "lapse.mp4", at_most=at_most)
    shown = [act.generation for act in jobs[0].acts]
    assert len(shown) == min(n, at_most)
    assert (shown[0], shown[-1]) == (0, n - 1)
    assert np.ptp(np.diff(shown)) <= 1 if len(shown) > 1 else shown == [0]


def test_a_champion_walks_no_longer_than_it_did(jobs):
    timelapse(run_of([1, 2]), "lapse.mp4", seconds=30)
    assert [act.seconds for act in jobs[0].acts] == [1.0, 1.0]


def test_a_walk_that_does_not_count_says_so(jobs):
    run = run_of([1])
    run.records["verdict"] = "fell"
    timelapse(run, "lapse.mp4")
    assert jobs[0].acts[0].caption.endswith("does not count: fell")


def test_a_time_lapse_is_made(gl, tmp_path):
    made = timelapse(run_of([1, 2]), tmp_path / "lapse.mp4", seconds=0.3, **SMALL)
    assert len(pictures(made.path)) == made.n_frames == 6


# -------------------------------------------------------------------------------------------------- what goes wrong


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        ({"size": (481, 360)}, ["size is (481, 360)", "even", "64 to 4096 pixels", "width and height"]),
        ({"size": (480, 10_000)}, ["size is (480, 10000)"]),
        ({"size": 480}, ["size is 480", "two even whole numbers"]),
        ({"fps": 0}, ["fps is 0", "1 to 60", "frames"]),
        ({"fps": 12.5}, ["fps is 12.5", "whole"]),
        ({"fps": True}, ["fps is True", "whole"]),
        ({"size": (128.0, 96.0)}, ["size is (128.0, 96.0)", "two even whole numbers"]),
        ({"camera": "sid"}, ["Simulation.camera is 'sid'", "side"]),
        ({"path": "walk.avi"}, ["'.avi'", ".mp4", ".webm", ".gif"]),
        ({"path": "walk"}, ["path ends in ''"]),
    ],
)
def test_what_no_film_can_be_is_refused_before_anything_starts(jobs, wrong, words):
    with pytest.raises(ValueError) as error:  # noqa: PT011
        film(GENOME, SHORT, **{"path": "walk.mp4", **wrong})
    assert all(word in str(error.value) for word in words)
    assert not jobs


@pytest.mark.parametrize(
    ("wrong", "word"),
    [
        ({"seconds": 0}, "seconds is 0; it must be a number over 0"),
        ({"seconds": "2"}, "seconds is '2'; it must be a number over 0"),
        ({"seconds": None}, "seconds is None; it must be a number over 0"),
        ({"seconds": float("nan")}, "seconds is nan; it must be a number over 0"),
        ({"at_most": 1}, "at_most is 1; it must be a whole number, 2 to 1000"),
        ({"at_most": 2.5}, "at_most is 2.5; it must be a whole number, 2 to 1000"),
        ({"at_most": "7"}, "at_most is '7'; it must be a whole number, 2 to 1000"),
    ],
)
def test_what_no_time_lapse_can_be_is_refused(jobs, wrong, word):
    with pytest.raises(ValueError, match=word):
        timelapse(run_of([1]), "lapse.mp4", **wrong)
    with pytest.raises(ValueError, match="no robot has walked"):
        timelapse(Run(SHORT, records.join([])), "lapse.mp4")


def test_numbers_of_numpy_are_numbers(jobs):
    size, fps = (np.int64(128), np.int32(96)), np.int16(10)
    film(GENOME, SHORT, "walk.mp4", size=size, fps=fps)
    timelapse(run_of([1, 2]), "lapse.mp4", size=size, fps=fps, seconds=np.float32(0.5), at_most=np.int64(2))
    for job in jobs:
        assert Job.from_json(job.to_json(Path("film.mp4")))[0] == job
        assert (job.size, job.fps) == ((128, 96), 10)


def test_a_champion_is_filmed_as_its_genome_is(jobs):
    run = run_of([1])
    film(run.champion, SHORT, "walk.mp4")
    film(GENOME, SHORT, "walk.mp4")
    assert jobs[0].acts == jobs[1].acts
    with pytest.raises(TypeError, match=r"give run\.champion"):
        film(run, SHORT, "walk.mp4")
    with pytest.raises(TypeError, match="its column genome"):
        film(run.records, SHORT, "walk.mp4")


def test_a_name_as_long_as_names_can_be_will_do_and_a_longer_one_is_refused_at_once(monkeypatch, tmp_path):
    monkeypatch.setattr(crew, "_draw", lambda job, part, on_frame: part.write_bytes(b"film"))
    for length in (244, 255):
        made = film(GENOME, SHORT, tmp_path / f"{'w' * (length - 4)}.mp4", progress=False)
        assert made.path.read_bytes() == b"film"
    assert len(list(tmp_path.iterdir())) == 2
    monkeypatch.setattr(crew, "_draw", None)
    with pytest.raises(FilmError, match="cannot be written to"):
        film(GENOME, SHORT, tmp_path / f"{'w' * 252}.mp4", progress=False)
    assert len(list(tmp_path.iterdir())) == 2


def test_a_place_where_nothing_can_be_written_is_refused_before_anything_starts(monkeypatch, tmp_path):
    monkeypatch.setattr(crew, "_draw", None)
    with pytest.raises(FilmError, match="there is no folder"):
        film(GENOME, SHORT, tmp_path / "missing" / "walk.mp4")
    (tmp_path / "folder.mp4").mkdir()
    with pytest.raises(FilmError, match="is a folder"):
        film(GENOME, SHORT, tmp_path / "folder.mp4")
    with pytest.raises(FilmError, match="cannot be written to"):
        film(GENOME, SHORT, tmp_path / f"{'long' * 80}.mp4")


@pytest.mark.parametrize("chosen", ["disabled", "no such backend"])
def test_without_a_gl_the_mend_is_named_and_an_older_film_survives(monkeypatch, tmp_path, chosen):
    older = tmp_path / "walk.mp4"
    older.write_bytes(b"older")
    monkeypatch.setenv("MUJOCO_GL", chosen)
    with pytest.raises(FilmError) as error:
        film(GENOME, SHORT, older, progress=False)
    for words in (f"no GL that draws without a screen with MUJOCO_GL={chosen}", "wl.replay", graphics.mend()):
        assert words in str(error.value)
    assert older.read_bytes() == b"older"
    assert list(tmp_path.iterdir()) == [older]


def test_a_crash_in_the_midst_is_an_error_and_an_older_film_survives(monkeypatch, tmp_path):
    older = tmp_path / "walk.mp4"
    older.write_bytes(b"older")
    monkeypatch.setattr(crew, "START", "print('gl x', flush=True); input(); print('frame', flush=True); 1 / 0")
    with pytest.raises(FilmError, match="could not be made: ZeroDivisionError"):
        film(GENOME, SHORT, older, progress=False)
    assert older.read_bytes() == b"older"
    assert list(tmp_path.iterdir()) == [older]


def test_ctrl_c_leaves_no_process_and_no_file(monkeypatch, tmp_path):
    started = []
    start = subprocess.Popen

    def watched(*args, **kwargs):
        started.append(start(*args, **kwargs))
        return started[-1]

    monkeypatch.setattr(crew.subprocess, "Popen", watched)
    monkeypatch.setattr(
        crew, "START", "import time; print('gl x', flush=True); print('frame', flush=True); time.sleep(99)"
    )
    main = threading.main_thread().ident
    monkeypatch.setattr(crew, "tqdm", lambda **_: _Interrupting(lambda: signal.pthread_kill(main, signal.SIGINT)))
    with pytest.raises(KeyboardInterrupt):
        film(GENOME, SHORT, tmp_path / "walk.mp4", progress=False)
    assert started[0].poll() is not None
    assert not list(tmp_path.iterdir())


class _Interrupting:
    """A bar at whose first step the user presses Ctrl-C."""

    def __init__(self, press):
        self.update = lambda _: press()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        return None


@pytest.mark.skipif(os.name == "nt", reason="kills as POSIX does")
def test_when_the_kernel_is_killed_its_film_is_given_up(gl, tmp_path):
    code = (
        "from walkerlab.cinema import film; from walkerlab.settings import Settings; from walkerlab.commands.worlds "
        f"import GENOME; film(GENOME, Settings(), {str(tmp_path / 'walk.mp4')!r}, size=(128, 96), fps=60)"
    )
    with subprocess.Popen([sys.executable, "-c", code], stderr=subprocess.PIPE, text=True) as kernel:
        started = any(sign in "▏▎▍▌▋▊▉█" for sign in iter(lambda: kernel.stderr.read(1), ""))
        left = list(tmp_path.iterdir())
        kernel.kill()
    assert started
    assert len(left) == 1
    patience = time.monotonic() + 20
    while list(tmp_path.iterdir()) and time.monotonic() < patience:
        time.sleep(0.05)
    assert not list(tmp_path.iterdir())


def test_functions_of_the_users_own_do_not_matter():
    settings = SHORT.with_(fitness=lambda rollout: 0.0)
    job, path = Job.from_json(replace(JOB, settings=settings).to_json(Path("walk.mp4")))
    assert path == Path("walk.mp4")
    assert job == JOB


# -------------------------------------------------------------------------------------------------------- the answer


def test_a_film_is_shown_in_a_notebook_with_words_for_those_who_cannot_see_it(tmp_path):
    path = tmp_path / "a <b> & c.mp4"
    path.write_bytes(b"film")
    shown = Film(path, 'A "walk"', (480, 360), 25, 200)
    html = shown._repr_html_()
    assert html.startswith('<video src="data:video/mp4;base64,ZmlsbQ=="')
    for part in ('aria-label="A &quot;walk&quot;"', 'width="480"', "controls", "loop", "muted", "a &lt;b&gt; &amp; c"):
        assert part in html
    assert repr(shown) == f"Film({path}: 8.0 s, 480 × 360, 0 kB)"
    path.unlink()
    assert "no longer there" in repr(shown)
    assert "no longer there" in shown._repr_html_()


def test_a_large_film_is_linked_to_and_a_gif_is_a_picture(tmp_path, monkeypatch):
    path = tmp_path / "walk.gif"
    path.write_bytes(b"film")
    shown = Film(path, "A walk", (480, 360), 25, 200)
    assert '<img src="data:image/gif;base64' in shown._repr_html_()
    monkeypatch.setattr("walkerlab.cinema.result.MOST", 1)
    assert "base64" not in shown._repr_html_()
    assert f'href="{path.as_posix()}"' in shown._repr_html_()


def test_it_plays_in_a_browser(made, page, tmp_path):
    page.set_default_timeout(120_000)  # ms: the machine may be busy
    page_file = tmp_path / "film.html"
    page_file.write_text(f"<!doctype html><meta charset=utf-8>{made._repr_html_()}", encoding="utf-8")
    page.goto(page_file.as_uri())
    page.evaluate(PLAY)
    assert page.wait_for_function("window.cameTo").json_value() == "its end"
    seen = page.evaluate("(v => [v.currentTime, v.videoWidth, v.videoHeight])(document.querySelector('video'))")
    assert seen == [pytest.approx(1.0, abs=0.05), 128, 96]


PLAY = """() => {
    const video = document.querySelector("video");
    const fail = (error) => { window.cameTo ??= String(error?.message ?? video.error?.message ?? error); };
    video.loop = false;
    video.addEventListener("ended", () => { window.cameTo ??= "its end"; });
    video.addEventListener("error", () => fail(video.error));
    if (video.error) fail(video.error);
    video.play().catch(fail);
}"""
"""Returns at once, and leaves in ``cameTo`` what it came to: nothing waits without a limit."""
