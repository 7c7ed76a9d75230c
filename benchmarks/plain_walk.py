"""Repeat the walk of exported robots with MuJoCo alone, as the docstring of ``walkerlab.export_mjcf`` describes it.

    python benchmarks/plain_walk.py SECONDS FILE [FILE ...]

Prints a line of JSON for each file: how far it walked in m, or why MuJoCo does not load it.
"""

import json
import sys

import mujoco
import numpy as np


def walk(path, duration):
    """Return how far the centre of mass moves forward in the first ``duration`` seconds of the gait, in m."""
    model = mujoco.MjModel.from_xml_path(path)
    data = mujoco.MjData(model)
    numbers = [model.numeric(i) for i in range(model.nnumeric)]
    read = {number.name: number.data for number in numbers}
    rate, timestep = read["control_rate"].item(), model.opt.timestep
    mujoco.mj_resetDataKeyframe(model, data, model.key("start").id)
    for _ in range(int(read["settle_steps"].item())):
        mujoco.mj_step(model, data)
    forward = []
    for k in range(round(duration / timestep) + 1):
        t = np.floor(k * timestep * rate + 1e-9) / rate
        swing = min(t / read["gait_ramp"].item(), 1.0) * read["gait_amplitude"]
        wave = np.sin(2 * np.pi * read["gait_frequency"] * t + read["gait_phase"])
        data.ctrl[:] = read["gait_offset"] + swing * wave
        mujoco.mj_step(model, data)
        forward.append(data.sensor("com").data[0])
    return forward[-1] - forward[0]


if __name__ == "__main__":
    for path in sys.argv[2:]:
        try:
            found = {"distance": walk(path, float(sys.argv[1]))}
        except ValueError as error:
            found = {"error": str(error)}
        print(json.dumps({"file": path, **found}), flush=True)
