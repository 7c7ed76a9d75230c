"""A rollout records what happened, and its verdict names what should not count."""

from concurrent.futures import ThreadPoolExecutor

import mujoco
import numpy as np
import pytest

import walkerlab as wl
from walkerlab.randomness import stream
from walkerlab.rollout import walk

SETTINGS = wl.Settings().with_(duration=2.0)
GENOMES = [wl.Genome.random(wl.Robot(), rng=stream(2, "check", i)) for i in range(8)]


def test_the_record_is_what_plain_mujoco_computes():
    """One step of Python at a time gives the very same walk as the loop in C."""
    scene = wl.compile_scene(GENOMES[0], SETTINGS)
    rollout = walk(scene)
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
        data.ctrl[:] = control
        mujoco.mj_step(scene.model, data)
        if i % 4 == 0:
            np.testing.assert_array_equal(data.body("walker/").subtree_com, rollout.com[i // 4])


def test_a_walk_is_sampled_from_its_start_to_its_end():
    rollout = wl.simulate(GENOMES[0], SETTINGS)
    assert rollout.time[0] == 0
    assert rollout.time[-1] == pytest.approx(2.0)
    assert len(rollout.time) == len(rollout.com) == len(rollout.on_ground) == len(rollout.poses) == 101


def test_the_same_walk_is_the_same_to_the_last_bit_with_or_without_poses():
    with_poses, without = wl.simulate(GENOMES[1], SETTINGS), wl.simulate(GENOMES[1], SETTINGS, poses=False)
    np.testing.assert_array_equal(with_poses.com, without.com)
    assert without.poses.size == 0


def test_falling_over_while_settling_is_not_travel():
    """The walk starts once the body is still, so its first samples hardly move."""
    for genome in GENOMES:
        rollout = wl.simulate(genome, SETTINGS)
        if rollout.settled < 3:
            assert np.abs(np.diff(rollout.com[:3, 0])).max() < 0.02


@pytest.mark.parametrize("timestep", [0.005, 0.0075, 0.0095])
def test_a_flight_lasts_as_long_at_any_timestep(timestep):
    """Where things fall upward, a robot is in the air for the whole walk, which is as long as it was asked to be."""
    upward = wl.Settings(terrain=wl.Terrain(gravity=(0, 0, 0.5))).with_(
        duration=1.0, timestep=timestep, forgive=["restless", "too_high"]
    )
    assert wl.simulate(GENOMES[0], upward).time[-1] == pytest.approx(1.0, abs=timestep)
    assert wl.simulate(GENOMES[0], upward.with_(max_airborne=1.02)).verdict == "ok"
    assert wl.simulate(GENOMES[0], upward.with_(max_airborne=0.9)).verdict == "airborne"


def test_a_record_cannot_be_written_into():
    rollout = wl.simulate(GENOMES[0], SETTINGS)
    for record in (rollout.time, rollout.com, rollout.on_ground, rollout.sink, rollout.work, rollout.poses):
        with pytest.raises(ValueError, match="read-only"):
            record[:] = 0


def test_mujocos_warnings_about_anything_else_still_reach_who_listened():
    heard = []
    mujoco.set_mju_user_warning(heard.append)
    with ThreadPoolExecutor(4) as threads:
        list(threads.map(lambda genome: wl.simulate(genome, SETTINGS), GENOMES))
    model = mujoco.MjModel.from_xml_string(
        "<mujoco><worldbody><body><freejoint/><geom size='1'/></body></worldbody></mujoco>"
    )
    data = mujoco.MjData(model)
    data.qvel[:] = np.inf
    mujoco.mj_step(model, data)
    assert heard


def test_a_world_that_blows_up_is_seen_and_stays_quiet(capfd):
    """Without autoreset a blow-up stays blown up; MuJoCo's own words do not reach the student."""
    scene = wl.compile_scene(GENOMES[0], SETTINGS)
    scene.model.dof_armature[:] = 0
    scene.model.actuator_gainprm[:, 0] *= 1e9
    scene.model.actuator_biasprm[:, 1] *= 1e9
    scene.model.actuator_forcelimited[:] = 0
    rollout = walk(scene)
    assert rollout.verdict == "unstable"
    assert not rollout.counts
    assert "".join(capfd.readouterr()) == ""


def test_on_the_moon_the_robot_is_longer_in_the_air():
    def hang_time(gravity):
        settings = wl.Settings(terrain=wl.Terrain(gravity=(0, 0, gravity)))
        return sum((~wl.simulate(genome, settings, poses=False).on_ground).mean() for genome in GENOMES)

    assert hang_time(-1.62) > 1.5 * hang_time(-9.81)
