"""The Gymnasium environment passes Gymnasium's own check, and replays the gait."""

import numpy as np
import pytest

import walkerlab as wl
from tests.interfaces.test_environment import WALKER, WORLDS, settings_of

gymnasium = pytest.importorskip("gymnasium")


@pytest.mark.parametrize("world", WORLDS, ids=str)
def test_it_passes_the_check_and_replays_the_gait(world):
    from gymnasium.utils.env_checker import check_env

    settings = settings_of(world)
    env = wl.gym_env(WALKER, settings)
    check_env(env, skip_render_check=True)
    policy = wl.gait_policy(env)
    observation, info = env.reset(seed=0)
    is_over = False
    while not is_over:
        observation, _, terminated, is_over, info = env.step(policy(observation))
        assert not terminated
    assert info["distance"] == pytest.approx(wl.simulate(WALKER, settings).distance, abs=1e-4)


def test_it_is_registered_and_renders_the_robot():
    import walkerlab.interfaces.gymnasium_env

    identifier = walkerlab.interfaces.gymnasium_env.ENVIRONMENT_ID
    env = gymnasium.make(identifier, genome=WALKER, settings=settings_of({}), render_mode="rgb_array")
    env.reset()
    policy = wl.gait_policy(env)
    env.step(policy())
    try:
        picture = env.render()
    except Exception as error:
        from tests.conftest import skip_without

        skip_without(f"OpenGL ({error})")
    assert picture.shape == (480, 640, 3)
    assert np.ptp(picture) > 100
    env.close()
