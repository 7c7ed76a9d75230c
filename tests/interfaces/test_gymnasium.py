"""The Gymnasium environment passes Gymnasium's own check, and replays the gait."""

import json
import os
import subprocess
import sys

import mujoco
import pytest

import walkerlab as wl
from tests.conftest import skip_without
from tests.interfaces.test_environment import WALKER, WORLDS, settings_of
from walkerlab.view import opengl

gymnasium = pytest.importorskip("gymnasium", reason="gymnasium, of the extra ecosystem, is not installed")

RENDER = """
import json, sys, gymnasium, numpy as np, walkerlab as wl, walkerlab.interfaces.gymnasium_env as ours
genome, settings = sys.argv[1], wl.Settings().with_(duration=1)
environment = gymnasium.make(ours.ENVIRONMENT_ID, genome=genome, settings=settings, render_mode="rgb_array")
environment.reset()
policy = wl.gait_policy(environment)
environment.step(policy())
picture = environment.render()
print(json.dumps([picture.shape, int(np.ptp(picture))]))
environment.close()
"""


@pytest.mark.parametrize("world", WORLDS, ids=str)
def test_it_passes_the_check_and_replays_the_gait(world):
    from gymnasium.utils.env_checker import check_env

    settings = settings_of(world)
    check_env(wl.gym_env(WALKER, settings), skip_render_check=True)
    env = wl.gym_env(WALKER, settings)
    policy = wl.gait_policy(env)
    observation, info = env.reset(seed=0)
    is_over = False
    while not is_over:
        observation, _, terminated, is_over, info = env.step(policy(observation))
        assert not terminated
    assert info["distance"] == pytest.approx(wl.simulate(WALKER, settings).distance, abs=1e-9)
    with pytest.raises(RuntimeError, match="call reset"):
        env.step(policy(observation))


def test_it_is_registered_and_renders_the_robot():
    if not (found := opengl.find_backend()):
        skip_without(f"OpenGL: {opengl.how_to_fix()}")
    environment = {**os.environ, **opengl.backend_environment(found[0])}
    command = [sys.executable, "-W", "error", "-c", RENDER, str(WALKER)]
    shape, contrast = json.loads(subprocess.run(command, env=environment, check=True, capture_output=True).stdout)
    assert shape == [480, 640, 3]
    assert contrast > 100


def test_without_opengl_or_gymnasium_the_error_explains_the_fix(monkeypatch):
    env = wl.gym_env(WALKER, settings_of({}), render_mode="rgb_array")
    env.reset()
    monkeypatch.delenv("MUJOCO_GL", raising=False)
    monkeypatch.setattr(mujoco, "Renderer", lambda *size: 1 / 0)
    with pytest.raises(RuntimeError, match="set MUJOCO_GL=egl before mujoco is first imported"):
        env.render()
    with pytest.raises(ValueError, match="'rgb_array' or None"):
        wl.gym_env(WALKER, settings_of({}), render_mode="human")
    monkeypatch.setitem(sys.modules, "gymnasium", None)
    monkeypatch.delitem(sys.modules, "walkerlab.interfaces.gymnasium_env")
    with pytest.raises(ModuleNotFoundError, match="pip install"):
        wl.gym_env(WALKER, settings_of({}))
