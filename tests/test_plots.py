"""A picture shows the numbers of the table, and says what they are."""

import mujoco
import numpy as np
import pandas as pd
import pytest
from matplotlib.figure import Figure

import walkerlab as wl
from walkerlab.choices import Obstacle, Structure
from walkerlab.ground import height
from walkerlab.records import COLUMNS, join, tidy
from walkerlab.shapes import skins


def made_up(n=8, seed=0):
    rng = np.random.default_rng(seed)
    rows = pd.DataFrame(
        [(g, i, g, "", "random", rng.normal(g), "ok" if i else "airborne") for g in range(5) for i in range(n)],
        columns=list(COLUMNS)[:7],
    )
    rows.loc[rows.verdict != "ok", "fitness"] = -np.inf
    table = rows.assign(distance=0.0, velocity=0.0, n_segments=1, n_legs=2, weight=1.0, body_length=1.0, genome="")
    return tidy(table)


@pytest.fixture
def ax():
    return Figure().add_subplot()


def test_the_curve_is_best_median_and_quartiles_of_the_walks_that_count(ax):
    records = made_up()
    wl.plots.fitness_curve(records, ax)
    lines = {line.get_label(): line.get_ydata() for line in ax.lines}
    for generation in range(5):
        counted = records[(records.generation == generation) & (records.verdict == "ok")].fitness
        assert lines["best"][generation] == pytest.approx(max(counted))
        assert lines["median"][generation] == pytest.approx(np.median(counted))
    assert ax.get_xlabel() == "generation"


def test_axes_bear_the_name_and_unit_of_the_fitness(ax):
    run = wl.Run(wl.Settings(), made_up())
    wl.plots.fitness_curve(run.records, ax)
    assert ax.get_ylabel() == "distance [m]"


def test_several_runs_on_one_axes_can_be_told_apart(ax):
    for i, label in enumerate(("gentle", "harsh")):
        wl.plots.fitness_curve(made_up(seed=i), ax, label=label)
    best = [line for line in ax.lines if line.get_label().endswith("best")]
    assert [line.get_label() for line in best] == ["gentle: best", "harsh: best"]
    assert best[0].get_color() != best[1].get_color()


def test_text_stays_text_in_svg(ax, tmp_path):
    wl.plots.fitness_curve(made_up(), ax)
    wl.plots.save(ax, tmp_path / "a.svg", tmp_path / "a.png")
    assert "generation</text>" in (tmp_path / "a.svg").read_text()
    assert (tmp_path / "a.png").read_bytes().startswith(b"\x89PNG")


def test_a_table_without_rows_is_drawn_as_an_empty_picture(ax):
    wl.plots.fitness_curve(join([]), ax)


class TestStride:
    """The robot as it is drawn without GL is the robot that walked."""

    genome = wl.Genome.random(wl.Robot(), rng=np.random.default_rng(2))
    settings = wl.Settings().with_(duration=2.0)

    def test_it_shows_the_body_to_scale_and_over_the_ground(self, ax):
        wl.plots.stride(self.genome, self.settings, ax)
        robot = wl.express(self.genome)
        one = len(robot.segments) + 2 * robot.n_legs
        assert len(ax.patches) in {one, 2 * one, 3 * one, 4 * one}
        assert min(patch.get_path().vertices[:, 1].min() for patch in ax.patches) > -0.02
        assert ax.get_aspect() == 1

    def test_a_robot_whose_physics_broke_down_is_drawn_as_it_started(self, ax):
        torn = wl.Settings().with_(gravity=(-30, 12, -30), carry_weight=60, duration=2, timestep=0.01, texture_size=0.2)
        torn = torn.with_(robot=wl.Robot(leg_force=(500, 500), weight=(0.1, 0.1), carry_weight=60))
        rollout = wl.simulate(self.genome, torn)
        assert rollout.verdict == "unstable", "or this shows nothing"
        wl.plots.stride(self.genome, torn, ax)
        assert ax.patches

    @pytest.mark.parametrize("obstacle", [kind for kind in Obstacle if kind])
    def test_a_skin_reaches_as_far_as_the_thing_whichever_way(self, obstacle):
        settings = self.settings.with_(obstacle=obstacle, carry_weight=2, drag_weight=2)
        scene, rollout = wl.compile_scene(self.genome, settings), wl.simulate(self.genome, settings)
        model, data = scene.model, mujoco.MjData(scene.model)
        data.qpos[:] = rollout.poses[-1]
        mujoco.mj_kinematics(model, data)
        *parts, rope = skins(scene, rollout.poses[-1])
        parts += skins(scene, rollout.poses[-1], loose=True)
        assert len(rope[0]) == 2
        moving = [geom for geom in range(model.ngeom) if model.geom_bodyid[geom]]
        ways = np.random.default_rng(0).normal(size=(20, 3))
        for geom, (skin, _) in zip(moving, parts, strict=True):
            for way in ways / np.linalg.norm(ways, axis=1, keepdims=True):
                farthest = np.max((skin - data.geom_xpos[geom]) @ way)
                along = np.abs(data.geom_xmat[geom].reshape(3, 3).T @ way)
                size = model.geom_size[geom]
                reach = {
                    mujoco.mjtGeom.mjGEOM_SPHERE: size[0],
                    mujoco.mjtGeom.mjGEOM_CAPSULE: size[0] + size[1] * along[2],
                    mujoco.mjtGeom.mjGEOM_CYLINDER: size[0] * np.hypot(*along[:2]) + size[1] * along[2],
                    mujoco.mjtGeom.mjGEOM_BOX: size @ along,
                    mujoco.mjtGeom.mjGEOM_MESH: farthest,  # it is drawn by its own corners
                }[mujoco.mjtGeom(model.geom_type[geom])]
                assert farthest == pytest.approx(reach, rel=0.03)

    @pytest.mark.parametrize("structure", [kind for kind in Structure if kind != Structure.rough])
    def test_the_ground_is_drawn_where_mujoco_has_it(self, structure):
        settings = self.settings.with_(structure=structure)
        scene = wl.compile_scene(self.genome, settings)
        data = mujoco.MjData(scene.model)
        mujoco.mj_forward(scene.model, data)
        for x in (-0.5, 0.7, 1.3, 2.9, 6.1):
            above = np.array([x, 3.0, 8.0])  # beside the robot, which stands in the middle
            depth = mujoco.mj_ray(scene.model, data, above, np.array([0, 0, -1.0]), None, 1, -1, np.zeros(1, np.int32))
            assert 8.0 - depth == pytest.approx(height(settings.terrain, np.array([x]))[0], abs=1e-6)
