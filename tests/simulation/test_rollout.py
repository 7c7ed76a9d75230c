"""A rollout records the walk exactly, and its verdict excludes invalid walks."""

import pickle
from concurrent.futures import ThreadPoolExecutor

import mujoco
import numpy as np
import pytest

import walkerlab as wl
from walkerlab.simulation import rollout as rollout_module
from walkerlab.simulation.rollout import simulate_walk, walk_from_every_start
from walkerlab.simulation.stepping import disable_step_timers
from walkerlab.system.randomness import random_stream

SETTINGS = wl.Settings().with_(duration=2.0)
RECORD = ("joint_angles", "joint_velocities", "orientation", "contact_forces")
GENOMES = [wl.Genome.random(wl.Robot(), rng=random_stream(2, "check", i)) for i in range(8)]


def test_the_recorded_walk_equals_a_loop_of_mj_step():
    scene = wl.compile_scene(GENOMES[0], SETTINGS.with_(record=RECORD))
    rollout = simulate_walk(scene)
    joints = [scene.model.joint(f"walker/{name}").dofadr.item() for name in rollout.joint_names]
    data = mujoco.MjData(scene.model)
    scene.place(data)
    data.ctrl[:] = scene.rest
    for _ in range(round(rollout.settled / 0.005)):
        mujoco.mj_step(scene.model, data)
    start = data.time
    for i, control in enumerate(scene.controls(401)):
        if i % 4 == 0:
            assert data.time - start == pytest.approx(rollout.time[i // 4], abs=1e-9)
            np.testing.assert_array_equal(data.qpos, rollout.poses[i // 4])
            np.testing.assert_array_equal(data.qvel[joints], rollout.joint_velocities[i // 4])
        data.ctrl[:] = control
        mujoco.mj_step(scene.model, data)
        if i % 4 == 0:
            np.testing.assert_array_equal(data.body("walker/").subtree_com, rollout.com[i // 4])


def test_a_walk_is_sampled_from_its_start_to_its_end():
    rollout = wl.simulate(GENOMES[0], SETTINGS)
    assert rollout.time[0] == 0
    assert rollout.time[-1] == pytest.approx(2.0)
    assert len(rollout.time) == len(rollout.com) == len(rollout.on_ground) == len(rollout.poses) == 101


def test_recording_poses_does_not_change_the_walk():
    with_poses, without = wl.simulate(GENOMES[1], SETTINGS), wl.simulate(GENOMES[1], SETTINGS, poses=False)
    np.testing.assert_array_equal(with_poses.com, without.com)
    assert without.poses.size == 0


def test_a_walk_without_step_timers_is_the_same():
    scene = wl.compile_scene(GENOMES[0], wl.Settings().with_(duration=1))
    timed, untimed = mujoco.MjData(scene.model), mujoco.MjData(scene.model)
    expected = simulate_walk(scene, timed)
    try:
        disable_step_timers()
        walk = simulate_walk(scene, untimed)
    finally:
        mujoco.set_mjcb_time(None)  # enables them again
    assert timed.timer[mujoco.mjtTimer.mjTIMER_STEP].duration > 0
    assert untimed.timer[mujoco.mjtTimer.mjTIMER_STEP].duration == 0
    np.testing.assert_array_equal(walk.poses, expected.poses)


def test_no_start_is_simulated_after_a_walk_that_does_not_count(monkeypatch):
    """No fitness is lower than that of a walk that does not count, and the first of equal ones is kept."""
    scene = wl.compile_scene(GENOMES[0], wl.Settings().with_(duration=1, n_starts=4))
    verdicts = iter([("ok", ""), ("fell", "it fell"), ("ok", ""), ("fell", "it fell again")])
    monkeypatch.setattr(rollout_module, "judge", lambda trace, settings: next(verdicts))
    walks = walk_from_every_start(scene, poses=False)
    assert [walk.verdict for walk in walks] == ["ok", "fell"]


def test_movement_while_settling_is_not_part_of_the_walk():
    """The walk starts once the body is at rest, so its first samples hardly move."""
    for genome in GENOMES:
        rollout = wl.simulate(genome, SETTINGS)
        if rollout.settled < 3:
            assert np.abs(np.diff(rollout.com[:3, 0])).max() < 0.02


@pytest.mark.parametrize("timestep", [0.005, 0.0075, 0.0095])
def test_the_airborne_time_does_not_depend_on_the_timestep(timestep):
    """With upward gravity a robot is airborne for the whole duration."""
    upward = wl.Settings(terrain=wl.Terrain(gravity=(0, 0, 0.5))).with_(
        duration=1.0, timestep=timestep, forgive=["restless", "too_high"]
    )
    assert wl.simulate(GENOMES[0], upward).time[-1] == pytest.approx(1.0, abs=timestep)
    assert wl.simulate(GENOMES[0], upward.with_(max_airborne=1.02)).verdict == "ok"
    assert wl.simulate(GENOMES[0], upward.with_(max_airborne=0.9)).verdict == "airborne"


def test_arrays_of_a_rollout_are_read_only():
    rollout = wl.simulate(GENOMES[0], SETTINGS)
    for array in (rollout.time, rollout.com, rollout.on_ground, rollout.sink, rollout.work, rollout.poses):
        with pytest.raises(ValueError, match="read-only"):
            array[:] = 0


def test_warnings_about_other_simulations_reach_the_previous_handler():
    received = []
    mujoco.set_mju_user_warning(received.append)
    with ThreadPoolExecutor(4) as threads:
        list(threads.map(lambda genome: wl.simulate(genome, SETTINGS), GENOMES))
    model = mujoco.MjModel.from_xml_string(
        "<mujoco><worldbody><body><freejoint/><geom size='1'/></body></worldbody></mujoco>"
    )
    data = mujoco.MjData(model)
    data.qvel[:] = np.inf
    mujoco.mj_step(model, data)
    assert received


def test_a_simulation_that_diverges_is_unstable_and_prints_nothing(capfd):
    scene = wl.compile_scene(GENOMES[0], SETTINGS)
    scene.model.dof_armature[:] = 0
    scene.model.actuator_gainprm[:, 0] *= 1e9
    scene.model.actuator_biasprm[:, 1] *= 1e9
    scene.model.actuator_forcelimited[:] = 0
    rollout = simulate_walk(scene)
    assert rollout.verdict == "unstable"
    assert not rollout.counts
    assert "".join(capfd.readouterr()) == ""


def test_robots_are_airborne_for_longer_on_the_moon():
    def hang_time(gravity):
        settings = wl.Settings(terrain=wl.Terrain(gravity=(0, 0, gravity)))
        return sum((~wl.simulate(genome, settings, poses=False).on_ground).mean() for genome in GENOMES)

    assert hang_time(-1.62) > 1.5 * hang_time(-9.81)


def test_work_hardly_depends_on_the_timestep():
    coarse, fine = (
        np.array([wl.simulate(genome, SETTINGS.with_(timestep=step), poses=False).work[-1] for genome in GENOMES])
        for step in (0.004, 0.001)
    )
    assert np.median(coarse / fine) == pytest.approx(1, abs=0.04)
    assert np.quantile(np.abs(coarse / fine - 1), 0.75) < 0.1, "some walks are chaotic"


# ---------------------------------------------------------------------------------------- recorded on request

LOADED = wl.Settings().with_(duration=1, structure="stairs", obstacle="ball", drag_weight=1, carry_weight=1)


@pytest.fixture(scope="module")
def recorded_walk():
    return wl.simulate(GENOMES[3], SETTINGS, record=RECORD)


@pytest.mark.parametrize("settings", [SETTINGS, LOADED])
def test_recording_more_does_not_change_the_walk(settings):
    plain, recorded = wl.simulate(GENOMES[0], settings), wl.simulate(GENOMES[0], settings, record=RECORD)
    for name in ("time", "com", "up", "on_ground", "sink", "work", "load", "rope", "poses"):
        np.testing.assert_array_equal(getattr(plain, name), getattr(recorded, name))
    assert plain.verdict == recorded.verdict
    assert not plain.recorded


def test_the_recorded_joints_are_those_of_the_model(recorded_walk):
    model = wl.compile_scene(GENOMES[3], SETTINGS).model
    assert recorded_walk.joint_names == tuple(model.joint(i).name.removeprefix("walker/") for i in range(1, model.njnt))
    addresses = [model.joint(f"walker/{name}").qposadr.item() for name in recorded_walk.joint_names]
    np.testing.assert_array_equal(recorded_walk.joint_angles, recorded_walk.poses[:, addresses])


def test_the_orientation_is_a_rotation_from_the_segment_to_the_world(recorded_walk):
    scene = wl.compile_scene(GENOMES[3], SETTINGS)
    data = mujoco.MjData(scene.model)
    for orientation, pose in zip(recorded_walk.orientation[::25], recorded_walk.poses[::25], strict=True):
        data.qpos[:] = pose
        mujoco.mj_kinematics(scene.model, data)
        np.testing.assert_allclose(orientation, data.body("walker/").xmat.reshape(3, 3), atol=1e-9)


def test_the_ground_carries_a_robot_that_stands_on_its_legs(recorded_walk):
    assert recorded_walk.contact_forces.shape == (101, len(recorded_walk.leg_names), 3)
    weight = recorded_walk.phenotype.weight * 9.81
    assert recorded_walk.contact_forces[0].sum(axis=0) == pytest.approx([0, 0, weight], abs=0.01 * weight)
    assert recorded_walk.contact_forces[:, :, 2].min() >= -1e-9


def test_recordings_are_read_only_even_after_pickling(recorded_walk):
    for walk in (recorded_walk, pickle.loads(pickle.dumps(recorded_walk))):
        for name in RECORD:
            with pytest.raises(ValueError, match="read-only"):
                getattr(walk, name)[:] = 0


def test_unknown_and_missing_recordings_are_errors_that_name_the_fix():
    with pytest.raises(wl.SettingsError, match=r"joint_angles \(1\).*contact_forces \(4\)"):
        wl.simulate(GENOMES[0], SETTINGS, record=["torques"])
    with pytest.raises(AttributeError, match=r"record=\['joint_angles'\]"):
        _ = wl.simulate(GENOMES[0], SETTINGS.with_(duration=1)).joint_angles


def test_scenes_with_scenery_record_the_same():
    settings = SETTINGS.with_(record=RECORD, duration=1)
    plain, displayed = (simulate_walk(wl.compile_scene(GENOMES[0], settings, scenery=s)) for s in (False, True))
    for name in RECORD:
        np.testing.assert_array_equal(getattr(plain, name), getattr(displayed, name))
