"""walkerlab: a class evolves walking robots with a genetic algorithm, in Jupyter.

    import walkerlab as wl
    run = wl.evolve()
    wl.plots.fitness_curve(run.records)

A name is looked up when it is first used, so that importing costs next to nothing.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

_ROOMS = {
    "algorithm": (
        "crossover_population",
        "generate_robot_gene",
        "generate_robot_population",
        "mutate_population",
        "select_from_population",
    ),
    "choices": (
        "Camera",
        "Crossover",
        "Feature",
        "Fitness",
        "Guard",
        "Mutation",
        "Obstacle",
        "Selection",
        "Structure",
        "Texture",
    ),
    "cinema": ("Film", "FilmError", "film", "timelapse"),
    "confirmation": ("Confirmation", "confirm"),
    "entities": ("generate_robot", "generate_terrain"),
    "evaluation": ("Evaluation", "evaluate", "evaluate_population"),
    "evolution": ("Evolution", "Generation", "evolve", "resume"),
    "run": ("Run", "load", "rescue"),
    "export": ("export_mjcf",),
    "ga.crossover": ("Children",),
    "ga.slots": ("OperatorError",),
    "genome": ("Genome", "GenomeError"),
    "limits": ("gene_table",),
    "phenotype": ("Phenotype", "express"),
    "quantity": ("SettingsError",),
    "rollout": ("Rollout", "simulate"),
    "scene": ("Scene", "compile_scene"),
    "settings": ("Algorithm", "Robot", "Settings", "Simulation", "Terrain"),
    "store": ("RunFileError",),
    "viewer": ("Replay", "replay"),
    "workers": ("WorkersLostError",),
    "widgets.lab": ("Lab",),
}
"""Where each public name lives."""

_MODULES = ("fitness", "ga", "plots", "widgets")
_HOME = {name: room for room, names in _ROOMS.items() for name in names}

if TYPE_CHECKING:
    from walkerlab import fitness as fitness
    from walkerlab import ga as ga
    from walkerlab import plots as plots
    from walkerlab import widgets as widgets
    from walkerlab.algorithm import crossover_population as crossover_population
    from walkerlab.algorithm import generate_robot_gene as generate_robot_gene
    from walkerlab.algorithm import generate_robot_population as generate_robot_population
    from walkerlab.algorithm import mutate_population as mutate_population
    from walkerlab.algorithm import select_from_population as select_from_population
    from walkerlab.choices import Camera as Camera
    from walkerlab.choices import Crossover as Crossover
    from walkerlab.choices import Feature as Feature
    from walkerlab.choices import Fitness as Fitness
    from walkerlab.choices import Guard as Guard
    from walkerlab.choices import Mutation as Mutation
    from walkerlab.choices import Obstacle as Obstacle
    from walkerlab.choices import Selection as Selection
    from walkerlab.choices import Structure as Structure
    from walkerlab.choices import Texture as Texture
    from walkerlab.cinema import Film as Film
    from walkerlab.cinema import FilmError as FilmError
    from walkerlab.cinema import film as film
    from walkerlab.cinema import timelapse as timelapse
    from walkerlab.confirmation import Confirmation as Confirmation
    from walkerlab.confirmation import confirm as confirm
    from walkerlab.entities import generate_robot as generate_robot
    from walkerlab.entities import generate_terrain as generate_terrain
    from walkerlab.evaluation import Evaluation as Evaluation
    from walkerlab.evaluation import evaluate as evaluate
    from walkerlab.evaluation import evaluate_population as evaluate_population
    from walkerlab.evolution import Evolution as Evolution
    from walkerlab.evolution import Generation as Generation
    from walkerlab.evolution import evolve as evolve
    from walkerlab.evolution import resume as resume
    from walkerlab.export import export_mjcf as export_mjcf
    from walkerlab.ga.crossover import Children as Children
    from walkerlab.ga.slots import OperatorError as OperatorError
    from walkerlab.genome import Genome as Genome
    from walkerlab.genome import GenomeError as GenomeError
    from walkerlab.limits import gene_table as gene_table
    from walkerlab.phenotype import Phenotype as Phenotype
    from walkerlab.phenotype import express as express
    from walkerlab.quantity import SettingsError as SettingsError
    from walkerlab.rollout import Rollout as Rollout
    from walkerlab.rollout import simulate as simulate
    from walkerlab.run import Run as Run
    from walkerlab.run import load as load
    from walkerlab.run import rescue as rescue
    from walkerlab.scene import Scene as Scene
    from walkerlab.scene import compile_scene as compile_scene
    from walkerlab.settings import Algorithm as Algorithm
    from walkerlab.settings import Robot as Robot
    from walkerlab.settings import Settings as Settings
    from walkerlab.settings import Simulation as Simulation
    from walkerlab.settings import Terrain as Terrain
    from walkerlab.store import RunFileError as RunFileError
    from walkerlab.viewer import Replay as Replay
    from walkerlab.viewer import replay as replay
    from walkerlab.widgets.lab import Lab as Lab
    from walkerlab.workers import WorkersLostError as WorkersLostError


def __getattr__(name: str) -> Any:
    """Fetch a public name from its room."""
    if name in _MODULES:
        return import_module(f"walkerlab.{name}")
    if name not in _HOME:
        from difflib import get_close_matches

        meant = get_close_matches(name, names := sorted([*_HOME, *_MODULES]), n=1)
        mend = f"did you mean {meant[0]!r}?" if meant else f"it has {', '.join(names)}"
        raise AttributeError(f"walkerlab has no {name!r}; {mend}")
    return getattr(import_module(f"walkerlab.{_HOME[name]}"), name)


def __dir__() -> list[str]:
    """List the public names, for completion."""
    return sorted([*_HOME, *_MODULES])
