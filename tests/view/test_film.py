"""Films show the walks that evolution judges, in correct colours and at the correct speed, and never leave debris."""

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

from tests.text.test_html import Seen
from walkerlab.commands.worlds import WALKER_GENOME as GENOME
from walkerlab.evolution.run import Run
from walkerlab.runfile import records
from walkerlab.settings.choices import Camera
from walkerlab.settings.settings import Settings
from walkerlab.simulation.fitness import distance, poorest_walk
from walkerlab.simulation.rollout import simulate
from walkerlab.view import opengl
from walkerlab.view.film import Film, FilmError, film, process, timelapse
from walkerlab.view.film.captions import CaptionOverlay
from walkerlab.view.film.encoding import encode
from walkerlab.view.film.job import Clip, Job
from walkerlab.view.film.rendering import (
    HIDDEN_GROUP,
    VISIBLE_GROUP,
    TexturePieces,
    cameras_at,
    freeze_when_diverged,
    interpolate_pose,
    render_frames,
)
from walkerlab.world.scene import compile_scene, control_steps

SHORT = Settings().with_(duration=1)
SMALL = {"size": (128, 96), "fps": 10, "progress": False}
JOB = Job((Clip("", 1.0),), SHORT, (128, 96), 10, ".mp4")
SUFFIXES = [".mp4", ".webm", ".gif"]
TRUNK_BODY = 1
POSITION, QUATERNION = slice(0, 3), slice(3, 7)  # of the trunk, in a pose


def skip_or_fail(requirement):
    """Skip a test whose requirement is missing; fail in CI, where everything must be installed."""
    (pytest.fail if os.environ.get("CI") else pytest.skip)(f"needs {requirement}")


@pytest.fixture(scope="session")
def backend():
    if not (found := opengl.find_backend()):
        skip_or_fail(f"off-screen OpenGL: {opengl.how_to_fix()}")
    return found[0]


@pytest.fixture(scope="module")
def rendered_film(backend, tmp_path_factory):
    return film(GENOME, SHORT, tmp_path_factory.mktemp("films") / "walk.mp4", **SMALL)


def decode(path):
    """Return the frames of a film, shape (n, height, width, 3)."""
    with av.open(str(path)) as file:
        return np.array([frame.to_ndarray(format="rgb24") for frame in file.decode(video=0)]).astype(int)


def is_robot(picture):
    """Return for each pixel whether it has the orange of the trunk or a blue of the limbs, shape (height, width)."""
    red, green, blue = np.moveaxis(np.asarray(picture).astype(int), -1, 0)
    return ((red > 2 * blue + 40) & (red > green + 20)) | ((blue > 2 * red + 10) & (blue > 1.15 * green))


# ---------------------------------------------------------------------------------------------------- rendered films


def test_a_film_has_the_requested_size_frames_and_duration(rendered_film):
    with av.open(str(rendered_film.path)) as file:
        stream = file.streams.video[0]
        assert (stream.width, stream.height) == rendered_film.size == (128, 96)
        assert stream.codec_context.name == "h264"
        assert stream.pix_fmt == "yuv420p"
        assert float(stream.duration * stream.time_base) == pytest.approx(1.0)
        assert rendered_film.seconds == 1.0
    assert len(decode(rendered_film.path)) == rendered_film.n_frames == 10
    content = rendered_film.path.read_bytes()
    assert content.index(b"moov") < content.index(b"mdat")  # so that it plays while it downloads


def test_each_frame_differs_from_the_last_and_shows_the_robot(rendered_film):
    frames = decode(rendered_film.path)
    is_still = np.abs(np.diff(frames, axis=0)).max(axis=(1, 2, 3)) < 30
    assert not is_still.any()
    assert is_robot(frames[-1]).mean() > 0.01


RENDER_WORLDS = """
import json, sys
import numpy as np
from walkerlab.view.film.job import Clip, Job
from walkerlab.view.film.rendering import render_frames
from walkerlab.settings.settings import Settings
genome, worlds, path = json.loads(sys.argv[1])
rendered = {}
for name, world in worlds.items():
    settings = Settings().with_(duration=1, **world)
    job = Job((Clip(genome, 2.0),), settings, (160, 120), 1, ".mp4")
    rendered[name] = np.array(list(render_frames(job, software=True)))
np.savez(path, **rendered)
"""


def test_every_camera_shows_the_whole_robot_at_a_reasonable_size(backend, tmp_path):
    worlds = {camera.name: {"camera": camera.name} for camera in Camera}
    arguments = json.dumps([GENOME, worlds, str(tmp_path / "rendered.npz")])
    environment = {**os.environ, **opengl.backend_environment(backend)}
    subprocess.run([sys.executable, "-c", RENDER_WORLDS, arguments], check=True, env=environment)
    with np.load(tmp_path / "rendered.npz") as rendered:
        for camera, pictures in rendered.items():
            for picture in pictures:
                rows, columns = np.nonzero(is_robot(picture))
                assert 0.005 < len(rows) / picture[..., 0].size < 0.25, camera
                assert rows.min() > 8, camera
                assert rows.max() < 112, camera
                assert columns.min() > 8, camera
                assert columns.max() < 152, camera
                assert max(np.ptp(rows), np.ptp(columns)) > 24, camera


# ------------------------------------------------------------------------------------------------- poses and cameras


@pytest.mark.parametrize(
    "changes", [{}, {"carry_weight": 2, "drag_weight": 3, "obstacle": "rock"}, {"wind": (5, 1, 0)}]
)
def test_scenery_does_not_change_the_bodies_joints_and_geoms_of_a_model(changes):
    settings = SHORT.with_(**changes)
    bare, with_scenery = compile_scene(GENOME, settings).model, compile_scene(GENOME, settings, scenery=True).model
    for name in ("nq", "nv", "nbody", "ngeom", "njnt", "ntendon"):
        assert getattr(bare, name) == getattr(with_scenery, name)
    for name in ("jnt_type", "jnt_qposadr", "body_parentid", "geom_type", "geom_bodyid"):
        np.testing.assert_array_equal(getattr(bare, name), getattr(with_scenery, name))
    for name in ("body_pos", "body_quat", "geom_pos", "geom_size", "jnt_pos", "jnt_axis"):
        np.testing.assert_allclose(getattr(bare, name), getattr(with_scenery, name), atol=1e-9)


def test_at_25_frames_per_second_every_second_recorded_pose_is_shown_unchanged():
    scene = compile_scene(GENOME, SHORT)
    rollout = simulate(GENOME, SHORT)
    shown = [interpolate_pose(scene.model, rollout.time, rollout.poses, k / 25) for k in range(25)]
    np.testing.assert_array_equal(shown, rollout.poses[:50:2])


def test_poses_between_two_recorded_ones_are_interpolated():
    scene = compile_scene(GENOME, SHORT)
    rollout = simulate(GENOME, SHORT)
    first, second = rollout.poses[20:22]
    for share in (0.25, 0.5):
        pose = interpolate_pose(scene.model, rollout.time, rollout.poses, rollout.time[20] + 0.02 * share)
        linear = first + share * (second - first)
        np.testing.assert_allclose(np.delete(pose, QUATERNION), np.delete(linear, QUATERNION))
        assert np.linalg.norm(pose[QUATERNION]) == pytest.approx(1)
        np.testing.assert_allclose(pose[QUATERNION], linear[QUATERNION], atol=1e-4)
    last = interpolate_pose(scene.model, rollout.time, rollout.poses, 99.0)
    np.testing.assert_array_equal(last, rollout.poses[-1])


@pytest.fixture
def rendered_states(monkeypatch):
    """Replace the renderer, and record the pose, the robot's centre of mass and the camera of each frame."""
    states = []

    class Renderer:
        def __init__(self, model, height, width):
            self._picture = np.zeros((height, width, 3), dtype=np.uint8)

        def __enter__(self):
            return self

        def __exit__(self, *_):
            return None

        def update_scene(self, data, camera):
            states.append((data.qpos.copy(), data.subtree_com[TRUNK_BODY].copy(), camera))

        def render(self):
            return self._picture

    monkeypatch.setattr(mujoco, "Renderer", Renderer)
    return states


def render_walk(genome, settings, *, fps=10, seconds=1.0):
    """Render all frames of a film of one walk."""
    for _ in render_frames(Job((Clip(genome, seconds),), settings, (128, 96), fps, ".mp4"), software=True):
        pass


@pytest.mark.parametrize("fps", [10, 24, 25, 50, 60])
def test_at_any_frame_rate_a_frame_shows_the_robot_at_its_time(rendered_states, fps):
    render_walk(GENOME, SHORT, fps=fps)
    rollout = simulate(GENOME, SHORT)
    assert len(rendered_states) == fps
    recorded = [np.interp(np.arange(fps) / fps, rollout.time, column) for column in rollout.com.T]
    np.testing.assert_allclose([com for _, com, _ in rendered_states], np.transpose(recorded), atol=2e-3)
    assert np.linalg.norm(rendered_states[-1][1] - rendered_states[0][1]) > 0.02  # far more than the tolerance


@pytest.mark.parametrize("seconds", [0.5, 2.0])
def test_a_film_shows_the_poorest_walk_of_several_starts(rendered_states, seconds):
    settings = SHORT.with_(n_starts=4, duration=2, wind=(3, 1, 0))
    poorest = poorest_walk(GENOME, settings)
    assert distance(poorest) < distance(simulate(GENOME, settings)) - 1e-6  # it differs from that of the first start
    render_walk(GENOME, settings, seconds=seconds)
    np.testing.assert_array_equal([pose for pose, _, _ in rendered_states], poorest.poses[: int(50 * seconds) : 5])


def diverge(rollout, index, value):
    """Return a rollout whose positions along x have a bad value from an index on."""
    poses = rollout.poses.copy()
    com = rollout.com.copy()
    load = rollout.load.copy()
    poses[index:, 0] = value
    com[index:, 0] = value
    if len(load):
        load[index:, 0] = value
    return replace(rollout, poses=poses, com=com, load=load)


@pytest.mark.parametrize("value", [np.nan, np.inf, 1e9])
@pytest.mark.parametrize("loads", [{}, {"drag_weight": 3}])
def test_a_diverged_walk_is_frozen_at_its_last_valid_pose(value, loads):
    scene = compile_scene(GENOME, SHORT.with_(**loads))
    rollout = simulate(GENOME, SHORT.with_(**loads))
    assert freeze_when_diverged(scene, rollout) is rollout
    frozen = freeze_when_diverged(scene, diverge(rollout, 20, value))
    for name in ("poses", "com", *(["load"] if loads else [])):
        shown, recorded = getattr(frozen, name), getattr(rollout, name)
        np.testing.assert_array_equal(shown[:20], recorded[:20])
        np.testing.assert_array_equal(shown[20:], np.tile(recorded[19], (len(recorded) - 20, 1)))
    assert len(frozen.load) == len(rollout.load)


@pytest.mark.parametrize("loads", [{}, {"drag_weight": 3}])
def test_a_walk_without_valid_poses_is_frozen_at_its_start(loads):
    settings = SHORT.with_(**loads)
    scene = compile_scene(GENOME, settings)
    rollout = simulate(GENOME, settings)
    frozen = freeze_when_diverged(scene, diverge(rollout, 0, np.nan))
    assert (frozen.poses == scene.start).all()
    for name in ("com", *(["load"] if loads else [])):
        shown = getattr(frozen, name)
        assert not np.ptp(shown, axis=0).any()
        np.testing.assert_allclose(shown[0], getattr(rollout, name)[0], atol=0.2)  # recorded once settled


def test_robot_and_camera_stay_close_when_a_walk_diverges(rendered_states, monkeypatch):
    def diverging_walk(*arguments):
        return diverge(poorest_walk(*arguments), 20, 1e9)

    monkeypatch.setattr("walkerlab.view.film.rendering.poorest_walk", diverging_walk)
    render_walk(GENOME, SHORT)
    for pose, _, camera in rendered_states:
        assert np.abs(pose[POSITION]).max() < 5
        assert np.abs(camera.lookat).max() < 5
        assert 1 < camera.distance < 10


@pytest.mark.parametrize("timestep", [0.0005, 0.0013, 0.003, 0.007, 0.009, 0.01])
def test_the_camera_does_not_depend_on_the_timestep(timestep):
    scene = compile_scene(GENOME, SHORT)
    rollout = simulate(GENOME, SHORT)
    frame_times = np.arange(0, 2, 0.04)

    def camera_path(step):
        """Return the camera's parameters for a robot that moves along a curve, recorded as in a simulation."""
        n_steps = round(2 / step) + 1
        recorded = np.union1d(control_steps(n_steps, step)[0], n_steps - 1) * step
        com = np.stack([0.5 * recorded, 0.1 * np.sin(3 * recorded), 0.3 + 0.02 * np.sin(12 * recorded)], axis=1)
        cameras = cameras_at(frame_times, scene, replace(rollout, time=recorded, com=com), 4 / 3)
        return np.array([[*camera.lookat, camera.distance, camera.azimuth, camera.elevation] for camera in cameras])

    np.testing.assert_allclose(camera_path(timestep), camera_path(0.005), atol=3e-3)


def test_the_camera_shows_the_sledge_and_is_farther_away_for_narrow_pictures():
    with_sledge = SHORT.with_(drag_weight=3)

    def first_camera(settings, aspect_ratio):
        scene = compile_scene(GENOME, settings)
        rollout = simulate(GENOME, settings)
        return cameras_at(np.array([0.0, 0.5]), scene, rollout, aspect_ratio)[0]

    alone = first_camera(SHORT, 4 / 3)
    assert first_camera(with_sledge, 4 / 3).distance > alone.distance + 0.5
    assert first_camera(with_sledge, 4 / 3).lookat[0] < alone.lookat[0] - 0.3
    assert first_camera(SHORT, 2 / 3).distance == pytest.approx(2 * alone.distance)
    assert first_camera(SHORT, 2).distance == alone.distance


def test_visible_texture_pieces_are_drawn_and_those_behind_the_camera_are_hidden():
    settings = SHORT.with_(texture="gravel", texture_density=0.1, texture_size=0.1, camera="side")
    scene = compile_scene(GENOME, settings)
    rollout = simulate(GENOME, settings)
    [camera] = cameras_at(np.array([0.5]), scene, rollout, 4 / 3)
    pieces = TexturePieces(scene, 4 / 3, software=True)
    assert len(pieces) > 100
    pieces.hide_outside(camera)
    camera_y = camera.lookat[1] - camera.distance * np.cos(np.radians(camera.elevation))
    visible = scene.model.geom_pos[scene.model.geom_group == VISIBLE_GROUP]
    hidden = scene.model.geom_pos[scene.model.geom_group == HIDDEN_GROUP]
    assert len(hidden) > 100
    assert visible[1:, 1].min() > camera_y  # the first geom is the ground
    distances = np.linalg.norm(hidden[:, :2] - camera.lookat[:2], axis=1)
    assert distances.min() > 0.8


# ---------------------------------------------------------------------------------------------------------- encoding


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_every_format_preserves_frames_and_colours(tmp_path, suffix):
    colours = [(240, 150, 0), (20, 110, 180), (190, 190, 175), (60, 60, 60)]
    pictures = [np.full((96, 128, 3), colour, dtype=np.uint8) for colour in colours]
    pictures[0][48:] = colours[1]
    encode(iter(pictures), tmp_path / "film", suffix, (128, 96), 10)
    decoded = decode(tmp_path / "film")
    assert decoded.shape == (4, 96, 128, 3)
    inside = np.s_[8:40, 8:120]
    for frame, picture in zip(decoded, pictures, strict=True):
        np.testing.assert_allclose(frame[inside].mean(axis=(0, 1)), picture[inside].mean(axis=(0, 1)), atol=8)


def test_still_areas_of_a_gif_do_not_flicker(tmp_path):
    background = np.random.default_rng(0).integers(0, 255, (96, 128, 3), dtype=np.uint8)  # more colours than a palette
    pictures = [background.copy() for _ in range(5)]
    for number, picture in enumerate(pictures):
        picture[40:60, 20 * number : 20 * number + 20] = 250, 0, 0
    encode(iter(pictures), tmp_path / "film", ".gif", (128, 96), 10)
    assert not np.ptp(decode(tmp_path / "film")[:, :40], axis=0).any()


@pytest.mark.parametrize("fps", [10, 25, 50])
@pytest.mark.parametrize("suffix", SUFFIXES)
def test_every_format_plays_at_the_requested_frame_rate(tmp_path, suffix, fps):
    pictures = np.random.default_rng(0).integers(0, 255, (fps // 2, 96, 128, 3), dtype=np.uint8)
    encode(iter(pictures), tmp_path / "film", suffix, (128, 96), fps)
    with av.open(str(tmp_path / "film")) as file:
        times = [frame.time for frame in file.decode(video=0)]
    np.testing.assert_allclose(times, np.arange(fps // 2) / fps, atol=2e-3)


# ---------------------------------------------------------------------------------------------- captions and timeline


def test_caption_and_timeline_are_legible_and_leave_the_middle_of_the_picture_free():
    clip = Clip("", 1, "generation 3 · 2.10 m", 3)
    job = replace(JOB, clips=(clip,), size=(480, 360), generation_range=(0, 12))
    snow = np.full((360, 480, 3), 230, dtype=np.uint8)
    captioned = CaptionOverlay(clip, job).draw_on(snow).astype(int)
    changed_rows = np.nonzero(np.abs(captioned - 230).max(axis=(1, 2)) > 5)[0]
    assert changed_rows.min() < 30
    assert changed_rows.max() > 330
    assert not np.any((changed_rows > 40) & (changed_rows < 320))
    caption = captioned[10:30, 10:150]
    assert caption.max() - np.median(caption) > 100  # white on dark, also on a bright picture
    np.testing.assert_array_equal(CaptionOverlay(JOB.clips[0], JOB).draw_on(snow), snow)


def test_the_timeline_marks_the_generation():
    def marked_column(generation):
        clip = Clip("", 1, "", generation)
        job = replace(JOB, clips=(clip,), size=(480, 360), generation_range=(0, 10))
        picture = CaptionOverlay(clip, job).draw_on(np.zeros((360, 480, 3), dtype=np.uint8))
        brightness = picture[330:355, 40:440].astype(int).sum(axis=(0, 2))
        return int(np.argmax(np.convolve(brightness, np.ones(9), "same")))

    columns = [marked_column(generation) for generation in (1, 5, 9)]
    assert columns == sorted(columns)
    assert columns[2] - columns[1] == pytest.approx(columns[1] - columns[0], abs=3)


def test_a_long_caption_is_shortened_to_fit():
    clip = Clip("", 1, "a very long caption\non two lines " * 9)
    captioned = CaptionOverlay(clip, JOB).draw_on(np.full((96, 128, 3), 230, dtype=np.uint8))
    assert (captioned[:, -4:] == 230).all()


# --------------------------------------------------------------------------------------------------------- time-lapse


def run_with_champions(champions, settings=SHORT):
    """Make a run in which generation i has the i-th champion and a poorer individual."""
    rows = [
        {"generation": i, "individual": number, "born": 0, "parents": "", "operators": "random", "fitness": fitness,
         "verdict": "ok", "reason": "", "distance": 0, "velocity": 0, "n_segments": 3, "n_legs": 6, "weight": 6,
         "body_length": 0.8, "genome": GENOME}
        for i, champion in enumerate(champions)
        for number, fitness in ((champion, 1.0 + champion), (10_000 + i, 0.5))
    ]  # fmt: skip
    return Run(settings, records.tidy_table(pd.DataFrame(rows)))


@pytest.fixture
def jobs(monkeypatch):
    """Record the requested films instead of rendering them."""
    requested = []
    monkeypatch.setattr("walkerlab.view.film.render_film", lambda job, path, *, progress: requested.append(job))
    return requested


def test_a_time_lapse_shows_each_champion_once_with_its_generations(jobs):
    made = timelapse(run_with_champions([1, 2, 2, 2, 3]), "lapse.mp4", seconds=0.5, fps=10)
    [job] = jobs
    assert [clip.caption for clip in job.clips] == [
        "generation 0 · robot 1 · 2.00 m",
        "generations 1–3 · robot 2 · 3.00 m",
        "generation 4 · robot 3 · 4.00 m",
    ]
    assert job.generation_range == (0, 4)
    assert made.n_frames == 15


@pytest.mark.parametrize(("n", "at_most"), [(50, 7), (50, 2), (3, 20), (1, 2)])
def test_a_selection_of_champions_is_even_and_has_the_first_and_the_last(jobs, n, at_most):
    timelapse(run_with_champions(range(n)), "lapse.mp4", at_most=at_most)
    shown = [clip.generation for clip in jobs[0].clips]
    assert len(shown) == min(n, at_most)
    assert (shown[0], shown[-1]) == (0, n - 1)
    assert np.ptp(np.diff(shown)) <= 1 if len(shown) > 1 else shown == [0]


def test_a_champion_is_shown_no_longer_than_its_walk(jobs):
    timelapse(run_with_champions([1, 2]), "lapse.mp4", seconds=30)
    assert [clip.seconds for clip in jobs[0].clips] == [1.0, 1.0]


def test_the_caption_of_a_disqualified_walk_says_so(jobs):
    run = run_with_champions([1])
    table = run.records.assign(verdict="fell")
    timelapse(Run(run.settings, table), "lapse.mp4")
    assert jobs[0].clips[0].caption.endswith("does not count: fell")


def test_a_time_lapse_is_rendered(backend, tmp_path):
    made = timelapse(run_with_champions([1, 2]), tmp_path / "lapse.mp4", seconds=0.3, **SMALL)
    assert len(decode(made.path)) == made.n_frames == 6


# ------------------------------------------------------------------------------------------------------------- errors


@pytest.mark.parametrize(
    ("arguments", "phrases"),
    [
        ({"size": (481, 360)}, ["size is (481, 360)", "even", "between 64 and 4096 pixels", "width and height"]),
        ({"size": (480, 10_000)}, ["size is (480, 10000)"]),
        ({"size": 480}, ["size is 480", "two even whole numbers"]),
        ({"fps": 0}, ["fps is 0", "between 1 and 60", "frames"]),
        ({"fps": 12.5}, ["fps is 12.5", "whole"]),
        ({"fps": True}, ["fps is True", "whole"]),
        ({"size": (128.0, 96.0)}, ["size is (128.0, 96.0)", "two even whole numbers"]),
        ({"camera": "sid"}, ["Simulation.camera is 'sid'", "side"]),
        ({"path": "walk.avi"}, ["'.avi'", ".mp4", ".webm", ".gif"]),
        ({"path": "walk"}, ["path ends in ''"]),
    ],
)
def test_invalid_arguments_of_a_film_are_rejected_before_rendering(jobs, arguments, phrases):
    with pytest.raises(ValueError) as error:  # noqa: PT011
        film(GENOME, SHORT, **{"path": "walk.mp4", **arguments})
    assert all(phrase in str(error.value) for phrase in phrases)
    assert not jobs


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"seconds": 0}, "seconds is 0; it must be a number above 0"),
        ({"seconds": "2"}, "seconds is '2'; it must be a number above 0"),
        ({"seconds": None}, "seconds is None; it must be a number above 0"),
        ({"seconds": float("nan")}, "seconds is nan; it must be a number above 0"),
        ({"at_most": 1}, "at_most is 1; it must be a whole number between 2 and 1000"),
        ({"at_most": 2.5}, "at_most is 2.5; it must be a whole number between 2 and 1000"),
        ({"at_most": "7"}, "at_most is '7'; it must be a whole number between 2 and 1000"),
    ],
)
def test_invalid_arguments_of_a_time_lapse_are_rejected(jobs, arguments, message):
    with pytest.raises(ValueError, match=message):
        timelapse(run_with_champions([1]), "lapse.mp4", **arguments)
    assert not jobs


def test_a_time_lapse_of_an_empty_run_is_rejected():
    with pytest.raises(ValueError, match="no robot has walked"):
        timelapse(Run(SHORT, records.concatenate_tables([])), "lapse.mp4")


def test_numpy_numbers_are_accepted(jobs):
    size = (np.int64(128), np.int32(96))
    fps = np.int16(10)
    film(GENOME, SHORT, "walk.mp4", size=size, fps=fps)
    run = run_with_champions([1, 2])
    timelapse(run, "lapse.mp4", size=size, fps=fps, seconds=np.float32(0.5), at_most=np.int64(2))
    for job in jobs:
        assert Job.from_json(job.to_json(Path("film.mp4")))[0] == job
        assert (job.size, job.fps) == ((128, 96), 10)


def test_an_individual_is_accepted_in_place_of_its_genome(jobs):
    run = run_with_champions([1])
    film(run.champion, SHORT, "walk.mp4")
    film(GENOME, SHORT, "walk.mp4")
    assert jobs[0].clips == jobs[1].clips
    with pytest.raises(TypeError, match=r"pass run\.champion"):
        film(run, SHORT, "walk.mp4")
    with pytest.raises(TypeError, match="its column genome"):
        film(run.records, SHORT, "walk.mp4")


def test_a_file_name_of_maximum_length_is_accepted_and_a_longer_one_rejected(monkeypatch, tmp_path):
    def write_film(job, path, on_frame):
        path.write_bytes(b"film")

    monkeypatch.setattr(process, "_render_with_first_backend", write_film)
    for length in (244, 255):
        made = film(GENOME, SHORT, tmp_path / f"{'w' * (length - 4)}.mp4", progress=False)
        assert made.path.read_bytes() == b"film"
    assert len(list(tmp_path.iterdir())) == 2
    monkeypatch.setattr(process, "_render_with_first_backend", None)
    with pytest.raises(FilmError, match="cannot be written to"):
        film(GENOME, SHORT, tmp_path / f"{'w' * 252}.mp4", progress=False)
    assert len(list(tmp_path.iterdir())) == 2


def test_a_path_that_is_not_writable_is_rejected_before_rendering(monkeypatch, tmp_path):
    monkeypatch.setattr(process, "_render_with_first_backend", None)
    with pytest.raises(FilmError, match=r"there is no folder .*missing for the file walk\.mp4; create it first"):
        film(GENOME, SHORT, tmp_path / "missing" / "walk.mp4")
    (tmp_path / "folder.mp4").mkdir()
    with pytest.raises(FilmError, match="is a folder"):
        film(GENOME, SHORT, tmp_path / "folder.mp4")
    with pytest.raises(FilmError, match="cannot be written to"):
        film(GENOME, SHORT, tmp_path / f"{'long' * 80}.mp4")


@pytest.fixture
def existing_film(tmp_path):
    path = tmp_path / "walk.mp4"
    path.write_bytes(b"existing")
    return path


def assert_only_unchanged_film(path):
    assert path.read_bytes() == b"existing"
    assert list(path.parent.iterdir()) == [path]


@pytest.mark.parametrize("chosen", ["disabled", "no such backend"])
def test_without_opengl_the_error_explains_the_fix_and_an_existing_film_is_kept(monkeypatch, existing_film, chosen):
    monkeypatch.setenv("MUJOCO_GL", chosen)
    with pytest.raises(FilmError) as error:
        film(GENOME, SHORT, existing_film, progress=False)
    for phrase in (f"OpenGL is not available with MUJOCO_GL={chosen}", "wl.replay", opengl.how_to_fix()):
        assert phrase in str(error.value)
    assert_only_unchanged_film(existing_film)


def test_a_crash_while_rendering_is_an_error_and_an_existing_film_is_kept(monkeypatch, existing_film):
    crashing = "print('gl x', flush=True); input(); print('frame', flush=True); 1 / 0"
    monkeypatch.setattr(process, "CHILD_PROGRAM", crashing)
    with pytest.raises(FilmError, match="could not be rendered: ZeroDivisionError"):
        film(GENOME, SHORT, existing_film, progress=False)
    assert_only_unchanged_film(existing_film)


def test_ctrl_c_leaves_no_process_and_no_file(monkeypatch, tmp_path):
    started = []
    popen = subprocess.Popen

    def recording_popen(*args, **kwargs):
        started.append(popen(*args, **kwargs))
        return started[-1]

    monkeypatch.setattr(process.subprocess, "Popen", recording_popen)
    hanging = "import time; print('gl x', flush=True); print('frame', flush=True); time.sleep(99)"
    monkeypatch.setattr(process, "CHILD_PROGRAM", hanging)
    main_thread = threading.main_thread().ident
    monkeypatch.setattr(
        process, "tqdm", lambda **_: _InterruptingBar(lambda: signal.pthread_kill(main_thread, signal.SIGINT))
    )
    with pytest.raises(KeyboardInterrupt):
        film(GENOME, SHORT, tmp_path / "walk.mp4", progress=False)
    assert started[0].poll() is not None
    assert not list(tmp_path.iterdir())


class _InterruptingBar:
    """Progress bar that sends Ctrl-C at its first update."""

    def __init__(self, press_ctrl_c):
        self.update = lambda _: press_ctrl_c()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        return None


@pytest.mark.skipif(os.name == "nt", reason="kills a process as on POSIX")
def test_when_the_kernel_is_killed_rendering_ends_and_the_temporary_file_is_removed(backend, tmp_path):
    code = (
        "from walkerlab.view.film import film; from walkerlab.settings.settings import Settings; "
        "from walkerlab.commands.worlds import WALKER_GENOME as GENOME; "
        f"film(GENOME, Settings(), {str(tmp_path / 'walk.mp4')!r}, size=(128, 96), fps=60)"
    )
    with subprocess.Popen([sys.executable, "-c", code], stderr=subprocess.PIPE, text=True) as kernel:
        is_rendering = any(character in "▏▎▍▌▋▊▉█" for character in iter(lambda: kernel.stderr.read(1), ""))
        files_while_rendering = list(tmp_path.iterdir())
        kernel.kill()
    assert is_rendering
    assert len(files_while_rendering) == 1
    deadline = time.monotonic() + 20
    while list(tmp_path.iterdir()) and time.monotonic() < deadline:
        time.sleep(0.05)
    assert not list(tmp_path.iterdir())


def test_user_functions_in_the_settings_are_not_sent_to_the_child():
    settings = SHORT.with_(fitness=lambda rollout: 0.0)
    job, path = Job.from_json(replace(JOB, settings=settings).to_json(Path("walk.mp4")))
    assert path == Path("walk.mp4")
    assert job == JOB


# ---------------------------------------------------------------------------------------------- display in a notebook


def test_a_film_plays_in_a_notebook_and_has_a_description(tmp_path):
    path = tmp_path / "a <b> & c.mp4"
    path.write_bytes(b"film")
    shown = Film(path, 'A "walk"', (480, 360), 25, 200)
    html = shown._repr_html_()
    assert html.startswith('<video src="data:video/mp4;base64,ZmlsbQ=="')
    assert Seen(html).all("video")[0]["aria-label"] == 'A "walk"'
    for text in ('width="480"', "controls", "loop", "muted", "a &lt;b&gt; &amp; c"):
        assert text in html
    assert repr(shown) == f"Film({path}: 8.0 s, 480 × 360, 0 kB)"
    path.unlink()
    assert "file not found" in repr(shown)
    assert "file not found" in shown._repr_html_()


def test_a_gif_is_embedded_as_an_image_and_a_large_film_is_linked(tmp_path, monkeypatch):
    path = tmp_path / "walk.gif"
    path.write_bytes(b"film")
    shown = Film(path, "A walk", (480, 360), 25, 200)
    assert '<img src="data:image/gif;base64' in shown._repr_html_()
    monkeypatch.setattr("walkerlab.view.film.result.MAX_EMBEDDED_BYTES", 1)
    assert "base64" not in shown._repr_html_()
    assert f'href="{path.as_posix()}"' in shown._repr_html_()


def test_a_film_plays_to_its_end_in_a_browser(rendered_film, page, tmp_path):
    page.set_default_timeout(120_000)  # ms; the machine may be busy
    page_file = tmp_path / "film.html"
    page_file.write_text(f"<!doctype html><meta charset=utf-8>{rendered_film._repr_html_()}", encoding="utf-8")
    page.goto(page_file.as_uri())
    page.evaluate(PLAY)
    assert page.wait_for_function("window.playResult").json_value() == "ended"
    state = page.evaluate("(v => [v.currentTime, v.videoWidth, v.videoHeight])(document.querySelector('video'))")
    assert state == [pytest.approx(1.0, abs=0.05), 128, 96]


PLAY = """() => {
    const video = document.querySelector("video");
    const fail = (error) => { window.playResult ??= String(error?.message ?? video.error?.message ?? error); };
    video.loop = false;
    video.addEventListener("ended", () => { window.playResult ??= "ended"; });
    video.addEventListener("error", () => fail(video.error));
    if (video.error) fail(video.error);
    video.play().catch(fail);
}"""
"""Starts the video and returns at once; sets ``playResult`` to "ended" or to an error message."""
