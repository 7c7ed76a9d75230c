"""Evolve walking robots with a genetic algorithm, in Jupyter.

    import walkerlab as wl
    run = wl.evolve()
    wl.plots.fitness_curve(run.records)

Public names are imported on first use, so that ``import walkerlab`` is fast.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

_PUBLIC_NAMES = {
    "genome.breeding": (
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
        "Frozen",
        "Guard",
        "Mutation",
        "Obstacle",
        "Recording",
        "Selection",
        "Structure",
        "Texture",
    ),
    "view.film": ("Film", "FilmError", "film", "timelapse"),
    "simulation.robustness": ("Confirmation", "confirm"),
    "world.entities": ("generate_robot", "generate_terrain"),
    "simulation.evaluation": ("Evaluation", "evaluate", "evaluate_population"),
    "evolution.births": ("explain_birth",),
    "evolution.evolution": ("Evolution",),
    "evolution.generation": ("Generation",),
    "evolution.stages": ("Stage",),
    "evolution.stopping": ("Stop",),
    "evolution.loading": ("load", "rescue"),
    "evolution.run": ("Run",),
    "evolution.running": ("evolve", "resume"),
    "experiment.compare": ("compare", "sweep"),
    "experiment.experiment": ("Experiment", "load_experiment"),
    "experiment.optimisers": ("random_search",),
    "tournament.standings": ("League", "league"),
    "tournament.seals": ("Seal", "open_seal", "seal", "verify_seal"),
    "interfaces.environment": ("environment", "gait_policy"),
    "interfaces.reinforcement": ("gym_env",),
    "interfaces.genetic_algorithm": ("GeneticAlgorithm",),
    "interfaces.problem": ("Problem",),
    "simulation.export": ("export_mjcf",),
    "ga.crossover": ("Children",),
    "ga.user_functions": ("OperatorError",),
    "genome.genome": ("Genome",),
    "genome.text": ("GenomeError",),
    "genome.features": ("gene_table",),
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
    "view.pedigree": ("lineage_changes",),
    "view.replay": ("Replay", "replay"),
    "view.replay.ancestors": ("race_ancestors",),
    "view.table_files": ("save_table",),
    "simulation.workers": ("WorkersLostError",),
    "widgets.panel.lab": ("Lab",),
    "widgets.playground": ("Playground", "playground"),
}
"""Public names, keyed by the module that defines them."""

_PUBLIC_MODULES = {
    "analysis": "analysis",
    "fitness": "simulation.fitness",
    "ga": "ga",
    "lessons": "lessons",
    "plots": "view.plots",
    "stats": "experiment.stats",
    "widgets": "widgets",
}
"""Public modules: name, and path within the package."""

_DEFINING_MODULE = {name: module for module, names in _PUBLIC_NAMES.items() for name in names}

if TYPE_CHECKING:
    from walkerlab import analysis as analysis
    from walkerlab import ga as ga
    from walkerlab import lessons as lessons
    from walkerlab import widgets as widgets
    from walkerlab.evolution.births import explain_birth as explain_birth
    from walkerlab.evolution.evolution import Evolution as Evolution
    from walkerlab.evolution.generation import Generation as Generation
    from walkerlab.evolution.loading import load as load
    from walkerlab.evolution.loading import rescue as rescue
    from walkerlab.evolution.run import Run as Run
    from walkerlab.evolution.running import evolve as evolve
    from walkerlab.evolution.running import resume as resume
    from walkerlab.evolution.stages import Stage as Stage
    from walkerlab.evolution.stopping import Stop as Stop
    from walkerlab.experiment import stats as stats
    from walkerlab.experiment.compare import compare as compare
    from walkerlab.experiment.compare import sweep as sweep
    from walkerlab.experiment.experiment import Experiment as Experiment
    from walkerlab.experiment.experiment import load_experiment as load_experiment
    from walkerlab.experiment.optimisers import random_search as random_search
    from walkerlab.ga.crossover import Children as Children
    from walkerlab.ga.user_functions import OperatorError as OperatorError
    from walkerlab.genome.breeding import crossover_population as crossover_population
    from walkerlab.genome.breeding import generate_robot_gene as generate_robot_gene
    from walkerlab.genome.breeding import generate_robot_population as generate_robot_population
    from walkerlab.genome.breeding import mutate_population as mutate_population
    from walkerlab.genome.breeding import select_from_population as select_from_population
    from walkerlab.genome.features import gene_table as gene_table
    from walkerlab.genome.genome import Genome as Genome
    from walkerlab.genome.phenotype import Phenotype as Phenotype
    from walkerlab.genome.phenotype import express as express
    from walkerlab.genome.text import GenomeError as GenomeError
    from walkerlab.interfaces.environment import environment as environment
    from walkerlab.interfaces.environment import gait_policy as gait_policy
    from walkerlab.interfaces.genetic_algorithm import GeneticAlgorithm as GeneticAlgorithm
    from walkerlab.interfaces.problem import Problem as Problem
    from walkerlab.interfaces.reinforcement import gym_env as gym_env
    from walkerlab.runfile.opening import RunFileError as RunFileError
    from walkerlab.settings.choices import Camera as Camera
    from walkerlab.settings.choices import Crossover as Crossover
    from walkerlab.settings.choices import Feature as Feature
    from walkerlab.settings.choices import Fitness as Fitness
    from walkerlab.settings.choices import Frozen as Frozen
    from walkerlab.settings.choices import Guard as Guard
    from walkerlab.settings.choices import Mutation as Mutation
    from walkerlab.settings.choices import Obstacle as Obstacle
    from walkerlab.settings.choices import Recording as Recording
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
    from walkerlab.tournament.seals import Seal as Seal
    from walkerlab.tournament.seals import open_seal as open_seal
    from walkerlab.tournament.seals import seal as seal
    from walkerlab.tournament.seals import verify_seal as verify_seal
    from walkerlab.tournament.standings import League as League
    from walkerlab.tournament.standings import league as league
    from walkerlab.view import plots as plots
    from walkerlab.view.film import Film as Film
    from walkerlab.view.film import FilmError as FilmError
    from walkerlab.view.film import film as film
    from walkerlab.view.film import timelapse as timelapse
    from walkerlab.view.pedigree import lineage_changes as lineage_changes
    from walkerlab.view.replay import Replay as Replay
    from walkerlab.view.replay import replay as replay
    from walkerlab.view.replay.ancestors import race_ancestors as race_ancestors
    from walkerlab.view.table_files import save_table as save_table
    from walkerlab.widgets.panel.lab import Lab as Lab
    from walkerlab.widgets.playground import Playground as Playground
    from walkerlab.widgets.playground import playground as playground
    from walkerlab.world.entities import generate_robot as generate_robot
    from walkerlab.world.entities import generate_terrain as generate_terrain
    from walkerlab.world.scene import Scene as Scene
    from walkerlab.world.scene import compile_scene as compile_scene


def __getattr__(name: str) -> Any:
    """Import a public name on first use."""
    if name in _PUBLIC_MODULES:
        return import_module(f"walkerlab.{_PUBLIC_MODULES[name]}")
    if name not in _DEFINING_MODULE:
        from difflib import get_close_matches

        names = __dir__()
        matches = get_close_matches(name, names, n=1)
        hint = f"did you mean {matches[0]!r}?" if matches else f"its public names are {', '.join(names)}"
        raise AttributeError(f"walkerlab has no {name!r}; {hint}")
    return getattr(import_module(f"walkerlab.{_DEFINING_MODULE[name]}"), name)


def __dir__() -> list[str]:
    """Return the public names, for completion."""
    return sorted([*_DEFINING_MODULE, *_PUBLIC_MODULES])
