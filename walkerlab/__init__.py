"""walkerlab: a class evolves walking robots with a genetic algorithm, in Jupyter.

    import walkerlab as wl
    run = wl.evolve()
    wl.plots.fitness_curve(run.records)

A name is looked up when it is first used, so that importing costs next to nothing.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

_ROOMS = {
    "breeding": (
        "crossover_population",
        "generate_robot_gene",
        "generate_robot_population",
        "mutate_population",
        "select_from_population",
    ),
    "settings.choices": (
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
    "view.film": ("Film", "FilmError", "film", "timelapse"),
    "simulation.robustness": ("Confirmation", "confirm"),
    "world.entities": ("generate_robot", "generate_terrain"),
    "simulation.evaluation": ("Evaluation", "evaluate", "evaluate_population"),
    "evolution.evolution": ("Evolution", "Generation", "evolve", "resume"),
    "evolution.run": ("Run", "load", "rescue"),
    "simulation.export": ("export_mjcf",),
    "ga.crossover": ("Children",),
    "ga.slots": ("OperatorError",),
    "genome.genome": ("Genome", "GenomeError"),
    "genome.repair": ("gene_table",),
    "genome.phenotype": ("Phenotype", "express"),
    "settings.model": ("SettingsError",),
    "simulation.rollout": ("Rollout", "simulate"),
    "world.scene": ("Scene", "compile_scene"),
    "settings.algorithm": ("Algorithm",),
    "settings.robot": ("Robot",),
    "settings.settings": ("Settings",),
    "settings.simulation": ("Simulation",),
    "settings.terrain": ("Terrain",),
    "runfile.store": ("RunFileError",),
    "view.replay": ("Replay", "replay"),
    "simulation.workers": ("WorkersLostError",),
    "widgets.lab": ("Lab",),
}
"""Where each public name lives."""

_MODULES = {"fitness": "simulation.fitness", "ga": "ga", "plots": "view.plots", "widgets": "widgets"}
"""Public modules, and where each is."""

_HOME = {name: room for room, names in _ROOMS.items() for name in names}

if TYPE_CHECKING:
    from walkerlab import ga as ga
    from walkerlab import widgets as widgets
    from walkerlab.breeding import crossover_population as crossover_population
    from walkerlab.breeding import generate_robot_gene as generate_robot_gene
    from walkerlab.breeding import generate_robot_population as generate_robot_population
    from walkerlab.breeding import mutate_population as mutate_population
    from walkerlab.breeding import select_from_population as select_from_population
    from walkerlab.evolution.evolution import Evolution as Evolution
    from walkerlab.evolution.evolution import Generation as Generation
    from walkerlab.evolution.evolution import evolve as evolve
    from walkerlab.evolution.evolution import resume as resume
    from walkerlab.evolution.run import Run as Run
    from walkerlab.evolution.run import load as load
    from walkerlab.evolution.run import rescue as rescue
    from walkerlab.ga.crossover import Children as Children
    from walkerlab.ga.slots import OperatorError as OperatorError
    from walkerlab.genome.genome import Genome as Genome
    from walkerlab.genome.genome import GenomeError as GenomeError
    from walkerlab.genome.phenotype import Phenotype as Phenotype
    from walkerlab.genome.phenotype import express as express
    from walkerlab.genome.repair import gene_table as gene_table
    from walkerlab.runfile.store import RunFileError as RunFileError
    from walkerlab.settings.algorithm import Algorithm as Algorithm
    from walkerlab.settings.choices import Camera as Camera
    from walkerlab.settings.choices import Crossover as Crossover
    from walkerlab.settings.choices import Feature as Feature
    from walkerlab.settings.choices import Fitness as Fitness
    from walkerlab.settings.choices import Guard as Guard
    from walkerlab.settings.choices import Mutation as Mutation
    from walkerlab.settings.choices import Obstacle as Obstacle
    from walkerlab.settings.choices import Selection as Selection
    from walkerlab.settings.choices import Structure as Structure
    from walkerlab.settings.choices import Texture as Texture
    from walkerlab.settings.model import SettingsError as SettingsError
    from walkerlab.settings.robot import Robot as Robot
    from walkerlab.settings.settings import Settings as Settings
    from walkerlab.settings.simulation import Simulation as Simulation
    from walkerlab.settings.terrain import Terrain as Terrain
    from walkerlab.simulation import fitness as fitness
    from walkerlab.simulation.evaluation import Evaluation as Evaluation
    from walkerlab.simulation.evaluation import evaluate as evaluate
    from walkerlab.simulation.evaluation import evaluate_population as evaluate_population
    from walkerlab.simulation.export import export_mjcf as export_mjcf
    from walkerlab.simulation.robustness import Confirmation as Confirmation
    from walkerlab.simulation.robustness import confirm as confirm
    from walkerlab.simulation.rollout import Rollout as Rollout
    from walkerlab.simulation.rollout import simulate as simulate
    from walkerlab.simulation.workers import WorkersLostError as WorkersLostError
    from walkerlab.view import plots as plots
    from walkerlab.view.film import Film as Film
    from walkerlab.view.film import FilmError as FilmError
    from walkerlab.view.film import film as film
    from walkerlab.view.film import timelapse as timelapse
    from walkerlab.view.replay import Replay as Replay
    from walkerlab.view.replay import replay as replay
    from walkerlab.widgets.lab import Lab as Lab
    from walkerlab.world.entities import generate_robot as generate_robot
    from walkerlab.world.entities import generate_terrain as generate_terrain
    from walkerlab.world.scene import Scene as Scene
    from walkerlab.world.scene import compile_scene as compile_scene


def __getattr__(name: str) -> Any:
    """Fetch a public name from its room."""
    if name in _MODULES:
        return import_module(f"walkerlab.{_MODULES[name]}")
    if name not in _HOME:
        from difflib import get_close_matches

        meant = get_close_matches(name, names := sorted([*_HOME, *_MODULES]), n=1)
        mend = f"did you mean {meant[0]!r}?" if meant else f"it has {', '.join(names)}"
        raise AttributeError(f"walkerlab has no {name!r}; {mend}")
    return getattr(import_module(f"walkerlab.{_HOME[name]}"), name)


def __dir__() -> list[str]:
    """List the public names, for completion."""
    return sorted([*_HOME, *_MODULES])
