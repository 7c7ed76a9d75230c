"""Simulation of many physics steps by one call of MuJoCo's C code, with its warnings counted but not printed."""

import ctypes
import threading
from collections.abc import Callable, Generator
from contextlib import contextmanager, suppress
from pathlib import Path

import mujoco
import numpy as np
from mujoco.rollout import rollout

from walkerlab.ga.genes import Floats

STATE_PARTS = mujoco.mjtState.mjSTATE_FULLPHYSICS  # time, positions (nq), velocities (nv), …
POSITIONS_START = 1  # index in the state


def simulate_steps(
    model: mujoco.MjModel, data: mujoco.MjData, state: Floats, controls: Floats
) -> tuple[Floats, Floats]:
    """Simulate physics steps from a state, with a warm start of the solver so that the result equals one long run.

    Args:
        model: Compiled model.
        data: Data of the model.
        state: Initial state, shape (1, n_state).
        controls: Servo targets of each step, shape (1, n_steps, nu).

    Returns:
        States after, (1, n_steps, n_state), and sensor readings before each step, (1, n_steps, n_sensor).
    """
    n_steps = controls.shape[1]
    return rollout(
        [model],
        [data],
        state,
        controls,
        nstep=n_steps,
        initial_warmstart=data.qacc_warmstart[np.newaxis].copy(),
        state=np.empty((1, n_steps, state.shape[1])),
        sensordata=np.empty((1, n_steps, model.nsensordata)),
        skip_checks=True,  # the checks take as long as a hundred steps
    )


def positions_in(model: mujoco.MjModel, states: Floats) -> Floats:
    """Return the generalised positions in (n, n_state) states, shape (n, nq)."""
    return states[:, POSITIONS_START : POSITIONS_START + model.nq]


def velocities_in(model: mujoco.MjModel, states: Floats) -> Floats:
    """Return the generalised velocities in (n, n_state) states, shape (n, nv)."""
    start = POSITIONS_START + model.nq
    return states[:, start : start + model.nv]


def disable_step_timers() -> None:
    """Disable MuJoCo's timers for the parts of a step in this process; ``mjData.timer`` then stays 0.

    The timers take 6 % of the time of a walk. MuJoCo's Python package enables them and has no function to disable them.
    """
    folder = Path(mujoco.__file__).parent
    library = next(folder.glob("libmujoco.*"), folder / "mujoco.dll")
    with suppress(OSError, ValueError):  # the library has another name: walks are the same but slower
        ctypes.c_void_p.in_dll(ctypes.CDLL(str(library)), "mjcb_time").value = None


_thread = threading.local()


@contextmanager
def warnings_counted_not_printed() -> Generator[None]:
    """Suppress the output of MuJoCo's warnings about walks in this thread; ``mjData.warning`` still counts them."""
    if mujoco.get_mju_user_warning() is not _warning_handler:
        _warning_handler.previous = mujoco.get_mju_user_warning()
        mujoco.set_mju_user_warning(_warning_handler)
    _thread.is_walking = True
    try:
        yield
    finally:
        _thread.is_walking = False


class _WarningHandler:
    """MuJoCo's warning handler, one for all threads: passes on every warning that is not about a walk."""

    previous: Callable[[str], None] | None = None  # handler that was installed before

    def __call__(self, warning: str) -> None:
        if not getattr(_thread, "is_walking", False) and self.previous:
            self.previous(warning)


_warning_handler = _WarningHandler()
