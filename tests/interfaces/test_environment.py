"""Environments: they obey the interfaces, and the evolved gait walks exactly as far as in the evaluation."""

from typing import Any, ClassVar
from unittest import TestCase

import dm_env
import numpy as np
import pytest
from dm_env import test_utils

import walkerlab as wl
from walkerlab.settings.choices import Structure
from walkerlab.system.randomness import random_stream

WALKER = wl.Genome.random(wl.Robot(), rng=random_stream(4, "check"))
WORLDS = [
    {},
    {"structure": "gaps", "carry_weight": 1.0},
    {"structure": "stairs", "carry_weight": 1.0, "drag_weight": 1.0},
    {"structure": "rough", "obstacle": "rock", "obstacle_density": 1.0},
    {"structure": "incline", "drag_weight": 1.0, "texture": "gravel", "timestep": 0.003},
]


def settings_of(world, **changes):
    return wl.Settings().with_(**{"duration": 1.0, **world, **changes})


def walk_gait(environment):
    policy = wl.gait_policy(environment)
    timestep = environment.reset()
    rewards = []
    while not timestep.last():
        timestep = environment.step(policy(timestep.observation))
        rewards.append(timestep.reward)
    return sum(rewards)


class EnvironmentTest(test_utils.EnvironmentTestMixin):
    """dm_env's own tests, for one world."""

    world: ClassVar[dict[str, Any]]

    def make_object_under_test(self):
        return wl.environment(WALKER, settings_of(self.world))

    def make_action_sequence(self):
        for _ in range(5):
            yield self.make_action()


for number, of_class in enumerate(WORLDS):
    name = f"TestWorld{number}"
    globals()[name] = type(name, (EnvironmentTest, TestCase), {"world": of_class})


def test_the_worlds_have_every_structure():
    assert {settings_of(world).terrain.structure for world in WORLDS} == {*Structure}


@pytest.mark.parametrize("world", WORLDS, ids=str)
def test_the_gait_walks_as_far_as_in_the_evaluation(world):
    settings = settings_of(world)
    environment = wl.environment(WALKER, settings)
    distance = wl.simulate(WALKER, settings).distance
    for _ in range(2):  # the second episode equals the first
        assert walk_gait(environment) == pytest.approx(distance, abs=1e-9)
    environment.close()


@pytest.mark.parametrize("fitness", ["distance", "velocity", "efficiency", "straightness"])
def test_the_return_of_an_episode_is_the_fitness(fitness):
    settings = settings_of({}, fitness=fitness)
    [rated] = wl.evaluate([WALKER], settings.with_(forgive=["none"]))
    walk = wl.simulate(WALKER, settings)
    assert walk_gait(wl.environment(WALKER, settings)) == pytest.approx(getattr(wl.fitness, fitness)(walk), rel=0.02)
    assert rated.distance == walk.distance


def test_a_user_fitness_requires_a_reward():
    settings = settings_of({}, fitness=lambda rollout: rollout.distance)
    with pytest.raises(ValueError, match="reward=function"):
        wl.environment(WALKER, settings)
    environment = wl.environment(WALKER, settings, reward=lambda physics: physics.time())
    environment.reset()
    assert environment.step(np.zeros(environment.action_spec().shape)).reward == pytest.approx(0.02)
    with pytest.raises(TypeError, match="must be a function"):
        wl.environment(WALKER, settings, reward=3)
    with pytest.raises(TypeError, match=r"wl\.environment"):
        wl.gait_policy(dm_env)


def test_actions_are_clipped_and_wrong_ones_are_explained():
    ends = []
    for target in (np.inf, 100.0, np.pi):
        environment = wl.environment(WALKER, settings_of({}))
        environment.reset()
        ends.append(environment.step(np.full(environment.action_spec().shape, target)).observation["joint_angles"])
    assert np.array_equal(ends[0], ends[1])
    assert np.array_equal(ends[0], ends[2])
    with pytest.raises(ValueError, match=r"shape \(\d+,\), a target for each servo; got \(3,\)"):
        environment.step(np.zeros(3))
    with pytest.raises(ValueError, match="target 0 of the action is NaN"):
        environment.step(np.full(environment.action_spec().shape, np.nan))
    environment.close()
    environment.close()
    with pytest.raises(RuntimeError, match="closed"):
        environment.reset()


def test_an_episode_ends_when_the_physics_diverges():
    environment = wl.environment(WALKER, settings_of({}))
    environment.reset()
    environment.physics.data.qvel[:] = 1e12
    timestep = environment.step(np.zeros(environment.action_spec().shape))
    assert timestep.last()
    assert timestep.discount == 0
