"""Repeat the walk of exported robots with MuJoCo alone, as the docstring of ``walkerlab.export_mjcf`` describes it.

    python benchmarks/plain_walk.py SECONDS FILE [FILE ...]

This prints a line of JSON for each file: the distance in m, or the error if MuJoCo does not load the file.
"""

import json
import sys

import mujoco
import numpy as np


def walk(path, duration):
    """Return how far the centre of mass moves forward in the first ``duration`` seconds of the gait, in m."""
    model = mujoco.MjModel.from_xml_path(path)
    data = mujoco.MjData(model)
    arrays = [model.numeric(i) for i in range(model.nnumeric)]
    parameters = {array.name: array.data for array in arrays}
    rate = parameters["control_rate"].item()
    timestep = model.opt.timestep
    mujoco.mj_resetDataKeyframe(model, data, model.key("start").id)
    for _ in range(int(parameters["settle_steps"].item())):
        mujoco.mj_step(model, data)
    forward = []
    for k in range(round(duration / timestep) + 1):
        t = np.floor(k * timestep * rate + 1e-9) / rate
        amplitude = min(t / parameters["gait_ramp"].item(), 1.0) * parameters["gait_amplitude"]
        duty = parameters["gait_duty"].item()
        p = (parameters["gait_frequency"] * t + parameters["gait_leg_phase"] / (2 * np.pi) + 1 / 4) % 1
        angle = np.pi * np.where(p < 1 - duty, p / (1 - duty), 1 + (p - (1 - duty)) / duty) - np.pi / 2
        data.ctrl[:] = parameters["gait_offset"] + amplitude * np.sin(angle + parameters["gait_phase"])
        mujoco.mj_step(model, data)
        forward.append(data.sensor("com").data[0])
    return forward[-1] - forward[0]


if __name__ == "__main__":
    for path in sys.argv[2:]:
        try:
            result = {"distance": walk(path, float(sys.argv[1]))}
        except ValueError as error:
            result = {"error": str(error)}
        print(json.dumps({"file": path, **result}), flush=True)
