"""Add feedback to the gait of a champion: a policy that also depends on what the robot senses walks farther.

    python notebooks/beyond/policy_search.py [run.walk] [--iterations 50] [--seed 1]

A gait moves the legs in the same way whatever happens. Here, a linear policy corrects it: the target of each servo is
that of the gait plus a weighted sum of orientation, velocity and touch. The weights begin at zero and are improved by
augmented random search (Mania, Guy and Recht 2018, https://arxiv.org/abs/1803.07055), a simple method of reinforcement
learning. Without a run file, a short evolution makes the champion. An iteration takes 16 episodes, about three seconds.
"""

import argparse
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

import walkerlab as wl

Floats = NDArray[np.float64]

N_DIRECTIONS = 8  # random directions of an iteration; each is tried forward and backward
N_BEST = 4  # directions that an iteration follows
NOISE = 0.03  # standard deviation of a weight in a trial
STEP_SIZE = 0.03
MAX_CORRECTION = 0.3  # rad, by which the policy may differ from the gait
SCALES = {"velocity": 1.0, "angular_velocity": 0.2, "orientation": 1.0, "touch": 0.5}
"""Observations of the policy, and the factors that bring them to about the same size."""


def read_senses(observation: Any) -> Floats:
    """Return the inputs of the policy, shape (n_inputs,)."""
    parts = [scale * np.asarray(observation[name]) for name, scale in SCALES.items()]
    return np.concatenate([*parts, [1.0]])


def make_episode(genome: wl.Genome | str, settings: wl.Settings) -> tuple[Callable[[Floats], float], tuple[int, int]]:
    """Return a function from the weights of the policy to the distance walked [m], and the shape of the weights."""
    environment = wl.environment(genome, settings)
    gait = wl.gait_policy(environment)
    n_servos = environment.action_spec().shape[0]
    n_inputs = len(read_senses(environment.reset().observation))

    def walk(weights: Floats) -> float:
        timestep = environment.reset()
        start = environment.centre_of_mass[0]
        while not timestep.last():
            correction = weights @ read_senses(timestep.observation)
            action = gait(timestep.observation) + correction.clip(-MAX_CORRECTION, MAX_CORRECTION)
            timestep = environment.step(action)
        is_diverged = timestep.discount == 0
        return -np.inf if is_diverged else float(environment.centre_of_mass[0] - start)

    return walk, (n_servos, n_inputs)


def search(walk: Callable[[Floats], float], weights: Floats, iterations: int, seed: int) -> Floats:
    """Improve the weights, and return the best ones."""
    rng = np.random.default_rng(seed)
    best, longest = weights, walk(weights)
    print(f"gait alone: {longest:.2f} m", flush=True)
    for iteration in range(1, iterations + 1):
        directions = rng.standard_normal((N_DIRECTIONS, *weights.shape))
        trials = [[walk(weights + sign * NOISE * direction) for sign in (1, -1)] for direction in directions]
        distances = np.nan_to_num(np.array(trials), neginf=0.0)
        order = np.argsort(-distances.max(axis=1))[:N_BEST]
        gains = distances[order, 0] - distances[order, 1]
        spread = distances[order].std() or 1.0
        weights = weights + STEP_SIZE / spread * np.tensordot(gains, directions[order], axes=1) / N_BEST
        distance = walk(weights)
        if distance > longest:
            best, longest = weights, distance
        print(f"iteration {iteration}: {distance:.2f} m, best {longest:.2f} m", flush=True)
    return best


def main() -> None:
    """Read or evolve a champion, and improve it."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("run", nargs="?", help="run file; a short evolution if omitted")
    parser.add_argument("--iterations", type=int, default=50)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    if options.run:
        run = wl.load(options.run)
    else:
        settings = wl.Settings().with_(population_size=30, generations=15, duration=5, seed=options.seed)
        run = wl.evolve(settings, progress=False)
    walk, shape = make_episode(run.champion.genome, run.settings)
    gait_alone = np.zeros(shape)
    weights = search(walk, gait_alone, options.iterations, options.seed)
    print(f"{walk(gait_alone):.2f} m with the gait alone, {walk(weights):.2f} m with feedback")


if __name__ == "__main__":
    main()
