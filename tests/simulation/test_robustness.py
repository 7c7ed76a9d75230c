"""Robustness compares the fitness of a champion with that of slightly different walks."""

import math
from concurrent.futures import ThreadPoolExecutor

import mujoco
import numpy as np
import pytest

import walkerlab as wl
from tests.simulation.test_validity import WALKER
from walkerlab.simulation import robustness, starts
from walkerlab.simulation.robustness import FIRST_NUDGE, Confirmation, confirm
from walkerlab.simulation.rollout import simulate_walk
from walkerlab.simulation.starts import NUDGE_BEND, NUDGE_SHIFT, NUDGE_TURN, draw_nudge
from walkerlab.world.assembly import ROBOT_BODY
from walkerlab.world.geometry import surface_points
from walkerlab.world.scene import compile_scene

SHORT = wl.Settings().with_(duration=2)


def confirmation(fitness, finer=1.0, nudged=(1.0, 2.0, 3.0)):
    """Return a confirmation in which all walks count."""
    return Confirmation(fitness, finer, nudged, ("ok",) * (1 + len(nudged)), "distance m")


def test_an_identical_walk_keeps_the_whole_fitness(monkeypatch):
    for name in ("NUDGE_SHIFT", "NUDGE_TURN", "NUDGE_BEND"):
        monkeypatch.setattr(starts, name, 0.0)
    monkeypatch.setattr(robustness, "TIMESTEP_DIVISOR", 1)
    confirmed = confirm(WALKER, SHORT, 2)
    assert (confirmed.kept_finer, confirmed.kept_nudged) == (1.0, 1.0)
    assert confirmed.fitness == wl.fitness.distance(wl.simulate(WALKER, SHORT))


def test_a_good_walker_keeps_most_of_its_distance():
    confirmed = confirm(WALKER, wl.Settings(), 3)
    assert set(confirmed.verdicts) == {"ok"}
    assert 0.7 < confirmed.kept_finer < 1.3
    assert 0.7 < confirmed.kept_nudged < 1.3
    assert confirmed.kept_finer != 1.0, "the timestep changes the walk"
    assert confirmed.nudged == tuple(sorted(confirmed.nudged))
    assert len(set(confirmed.nudged)) == 3, "each start is different"


def test_walks_that_do_not_count_keep_nothing():
    confirmed = confirm(WALKER, SHORT.with_(gravity=(0, 0, 0)), 2)
    assert (confirmed.fitness, confirmed.finer, *confirmed.nudged) == (-math.inf,) * 4
    assert (confirmed.kept_finer, confirmed.kept_nudged) == (0.0, 0.0)
    assert str(confirmed).endswith("3 of these walks did not count: airborne, airborne, airborne")


@pytest.mark.parametrize("fitness", [2.0, 1e-9, -1e-9, -1.5, -1e9])
def test_a_loss_is_relative_to_the_absolute_value_of_the_fitness(fitness):
    for loss, share in ((0.0, 1.0), (0.25, 0.75), (-0.5, 1.5), (1.0, 0.0), (7.0, 0.0)):
        confirmed = confirmation(fitness, finer=fitness - loss * abs(fitness), nudged=(fitness,))
        assert confirmed.kept_finer == pytest.approx(share)
        assert confirmed.kept_nudged == 1.0


@pytest.mark.parametrize("again", [-math.inf, -1.0, 0.0, -0.0, 1.0])
def test_a_loss_from_zero_keeps_nothing_and_neither_does_a_walk_that_does_not_count(again):
    for zero in (0.0, -0.0):
        assert confirmation(zero, finer=again).kept_finer == (1.0 if again >= 0 else 0.0)
    assert confirmation(-math.inf, finer=again, nudged=(again,)).kept_nudged == 0.0
    assert confirmation(-1.0, finer=-math.inf).kept_finer == 0.0


@pytest.mark.parametrize(
    ("again", "share"), [(-math.inf, 0.0), (-1.0, 0.0), (0.0, 0.0), (1.0, 0.5), (2.0, 1.0), (3.0, 1.5)]
)
def test_the_share_is_never_negative(again, share):
    assert confirmation(2.0, finer=again).kept_finer == share
    assert confirmation(2.0, nudged=(again,)).kept_nudged == share


def test_kept_nudged_is_the_share_of_the_median():
    assert confirmation(2.0, nudged=(-math.inf, -math.inf, 1.0, 2.0, 9.0)).kept_nudged == 0.5
    assert confirmation(2.0, nudged=(-math.inf, -math.inf, -math.inf, 2.0, 2.0)).kept_nudged == 0.0


# ------------------------------------------------------------------------------------------------ nudges

WITH_BALLS = wl.Settings(terrain=wl.Terrain(obstacle="ball", obstacle_density=0.5))


def test_nudges_depend_on_the_seed_and_the_number_of_the_start():
    scenes = [compile_scene(WALKER, WITH_BALLS.with_(terrain_seed=seed)) for seed in (7, 7, 8)]
    first, again, other = ([draw_nudge(scene, number).tobytes() for number in range(1, 4)] for scene in scenes)
    assert first == again
    assert len({*first, *other}) == 6
    assert confirm(WALKER, SHORT, 2) == confirm(WALKER, SHORT, 2)
    assert confirm(WALKER, SHORT, 2).nudged != confirm(WALKER, SHORT.with_(terrain_seed=1), 2).nudged


def test_confirmation_uses_starts_that_evolution_never_uses():
    assert wl.Simulation.declared()["n_starts"].high < FIRST_NUDGE


def test_a_nudge_is_small_and_moves_only_the_robot():
    scene = compile_scene(WALKER, WITH_BALLS)
    is_robot_dof = scene.model.body_rootid[scene.model.dof_bodyid] == ROBOT_BODY
    drawn = np.array([draw_nudge(scene, number) for number in range(1, 201)])
    spread = drawn[:, is_robot_dof].std(axis=0)
    assert not drawn[:, ~is_robot_dof].any()
    assert not drawn[:, [0, 2]].any(), "neither forward, which would change the fitness, nor up"
    np.testing.assert_allclose(spread[[1, 3, 4, 5]], [NUDGE_SHIFT, NUDGE_TURN, NUDGE_TURN, NUDGE_TURN], rtol=0.2)
    np.testing.assert_allclose(spread[6:], NUDGE_BEND, rtol=0.25)
    assert np.abs(drawn).max() < 0.15


def test_a_nudge_moves_neither_obstacles_nor_the_front_of_the_robot():
    scene = compile_scene(WALKER, WITH_BALLS)
    model = scene.model
    balls = [model.jnt_qposadr[joint] for joint in range(model.njnt) if "obstacle" in model.joint(joint).name]
    plain, moved = mujoco.MjData(model), mujoco.MjData(model)
    scene.place(plain)
    assert balls
    for number in range(1, 6):
        mujoco.mj_resetData(model, moved)
        scene.place(moved, draw_nudge(scene, number))
        np.testing.assert_array_equal(moved.qpos[min(balls) :], plain.qpos[min(balls) :])
        mujoco.mj_forward(model, moved)
        robot_vertices = np.concatenate(
            [skin for skin, _ in surface_points(scene, moved.qpos)[: scene.is_robot_geom.sum()]]
        )
        assert robot_vertices[:, 0].max() == pytest.approx(0.0, abs=0.002)
        assert 0 < robot_vertices[:, 2].min() < 0.02


def test_a_sledge_starts_level_and_without_overlap_for_every_nudge():
    scene = compile_scene(WALKER, SHORT.with_(drag_weight=2))
    data = mujoco.MjData(scene.model)
    for number in range(1, 11):
        scene.place(data, draw_nudge(scene, number))
        mujoco.mj_forward(scene.model, data)
        assert data.body("sledge/").xmat[8] == pytest.approx(1.0)
        assert data.ten_length[0] < 1.05 * scene.rope_length
        assert simulate_walk(scene, nudge=draw_nudge(scene, number), poses=False).verdict == "ok"


# ------------------------------------------------------------------------------------------------ summaries


def test_a_run_confirms_its_champion():
    settings = SHORT.with_(population_size=4, generations=1, n_elites=1)
    with ThreadPoolExecutor(1) as thread:
        run = wl.evolve(settings, executor=thread, progress=False)
    confirmed = run.confirm(n_nudges=2)
    assert confirmed == confirm(run.champion.genome, run.settings, 2)
    assert confirmed.fitness == run.champion.fitness
    assert len(confirmed.nudged) == 2


def test_the_summary_has_shares_or_differences():
    assert str(confirmation(2.0, finer=1.9, nudged=(0.5, 1.8, 2.2))) == (
        "Its distance of 2.00 m, when it walks again:\n"
        "   95% of it at a quarter of the timestep\n"
        "   90% of it from slightly different starts (median of 3; 25% from the poorest)"
    )
    below = Confirmation(-0.52, -0.6, (-1.5, -0.52, 0.1), ("ok",) * 4, "near(target=2, k=3)")
    assert str(below) == (
        "Its near(target=2, k=3) of -0.520, when it walks again:\n"
        "  -0.600 (0.0800 less) at a quarter of the timestep\n"
        "        -0.520 (equal) from slightly different starts (median of 3; -1.50 (0.980 less) from the poorest)"
    )
    assert "1.00e-09 (1.00 less)" not in str(confirmation(1e-9, finer=1.0, nudged=(1.0,)))
    assert str(confirmation(1e-9, finer=1.0, nudged=(1.0,))).split("\n")[1] == (
        "  1.00 m (1.00 more) at a quarter of the timestep"
    ), "not 100000000000%"
    with_fault = Confirmation(3.0, -math.inf, (3.0,), ("fell", "ok"), "my_score")
    assert str(with_fault).startswith("Its my_score of 3.00, when it walks again:\n    0% of it")
    assert str(with_fault).endswith("1 of these walks did not count: fell")


@pytest.mark.parametrize("end", ["low", "high"])
def test_confirmation_works_at_both_limits_of_the_timestep(end):
    """A quarter of the smallest timestep is below the range of the setting."""
    timestep = getattr(wl.Simulation.declared()["timestep"], end)
    confirmed = confirm(WALKER, wl.Settings().with_(duration=1, timestep=timestep), 1)
    assert confirmed.verdicts == ("ok", "ok")
    assert 0.5 < confirmed.kept_finer < 2


def test_zero_other_starts_are_rejected():
    with pytest.raises(ValueError, match="n_nudges is 0; it must be a whole number, 1 or more"):
        confirm(WALKER, SHORT, 0)
