"""The data of a playground page: models, genomes, limits and constants, which the scripts of the page read.

Python computes all values that do not change on the page. The sizes of a robot are computed on the page, by Python
functions that are translated to JavaScript.
"""

import math
from collections.abc import Iterator
from itertools import product
from pathlib import Path
from typing import Any

from walkerlab.genome.features import BODY_FEATURES, MAX_SEGMENTS, SEGMENT_FEATURES, feature_ranges
from walkerlab.genome.genome import Genome
from walkerlab.genome.phenotype import express
from walkerlab.genome.text import CHOICES, ERROR_CONTEXT, FEATURES_SINCE_2, MAX_TEXT_LENGTH, VERSION, text_layout
from walkerlab.settings.choices import Feature, Structure, Texture
from walkerlab.settings.proportions import MAX_LEGS_MASS, MAX_TRUNK_MASS, MIN_LEGS_MASS, MIN_TRUNK_MASS
from walkerlab.settings.robot import Robot
from walkerlab.settings.settings import Settings
from walkerlab.settings.terrain import PLANET_GRAVITY, Terrain
from walkerlab.settings.values import MAX_TEXT
from walkerlab.simulation import pushes, starts, validity
from walkerlab.simulation.export import format_mjcf
from walkerlab.view.playground.translation import translate
from walkerlab.world import assembly, heights, scene
from walkerlab.world.entities.terrain import AIR_DENSITY, AIR_VISCOSITY
from walkerlab.world.entities.walker import BodyPlan
from walkerlab.world.materials import MATERIALS
from walkerlab.world.placement import PIECE_HEIGHT

SCRIPT_FOLDER = Path(__file__).parent
MAX_PLANS = 32  # maximum number of body plans on a page
MAX_MODELS_SIZE = 400_000  # characters; if the models of all body plans take more, only those of the robots are used

DAMPING = 2  # index of the damping ratio, or of the damping, in the bias parameters of a servo

CONTACT_SENSORS = ("ground_contact", "ground_distance", "any_contact", "self_contact")


def physics_script() -> str:
    """Return the JavaScript that simulates walks with MuJoCo, without any display."""
    parts = [
        (SCRIPT_FOLDER / f"{name}.js").read_text(encoding="utf-8") for name in ("python", "genome", "walk", "verdict")
    ]
    return "\n".join([parts[0], translate([assembly.write_individual]), *parts[1:]])


def page_data(genomes: list[Genome], settings: Settings) -> dict[str, Any]:
    """Return the data of a page as JSON values.

    Args:
        genomes: Genomes of the robots, within the limits of the settings.
        settings: Settings of terrain, robot and simulation.
    """
    return {
        "models": _models(genomes, settings),
        "damping_ratio": _damping_ratio(genomes[0]),
        "duration": settings.simulation.duration,
        "robot": {"carry_weight": settings.robot.carry_weight, "drag_weight": settings.robot.drag_weight},
        **_scene_constants(settings.terrain),
        **_ground(settings.terrain),
        "guards": _guards(settings),
        "forgive": [guard.name for guard in validity.forgiven_guards(settings) if guard],
        **_genes(settings.robot),
        "limits": _limits(settings.robot),
        **_text_form(),
    }


def _models(genomes: list[Genome], settings: Settings) -> dict[str, str]:
    """Return the MJCF of each body plan on this ground, those of the genomes first; the page overwrites the sizes."""
    models = {
        _plan_name(express(genome).plan): format_mjcf(genome, settings, "walker", only_physics=True)
        for genome in genomes
    }
    plans = list(_possible_plans(settings.robot))
    if len(plans) > MAX_PLANS or len(plans) * max(map(len, models.values())) > MAX_MODELS_SIZE:
        return models
    for plan in plans:
        if _plan_name(plan) not in models:
            models[_plan_name(plan)] = format_mjcf(_with_plan(genomes[0], plan), settings, "walker", only_physics=True)
    return models


def _plan_name(plan: BodyPlan) -> str:
    """Return a body plan as text: for each segment from the front, 1 with legs and 0 without."""
    return "".join(str(int(has_legs)) for has_legs in plan)


def _possible_plans(robot: Robot) -> Iterator[BodyPlan]:
    """Yield the body plans of all robots within the limits."""
    fewest, most = robot.leg_pairs
    for count in range(robot.segment_range[0], robot.segment_range[1] + 1):
        for plan in product((False, True), repeat=count):
            if fewest <= sum(plan) <= most:
                yield plan


def _with_plan(genome: Genome, plan: BodyPlan) -> Genome:
    """Return a genome with a different body plan; its sizes are arbitrary, because the page overwrites them."""
    values = genome.values.copy()
    values[BODY_FEATURES.index(Feature.segments)] = len(plan)
    parts = values[len(BODY_FEATURES) :].reshape(genome.n_parts, -1)
    parts[: len(plan), SEGMENT_FEATURES.index(Feature.legs)] = plan
    return Genome(values)


def _damping_ratio(genome: Genome) -> float:
    """Return the damping ratio of all servos; an MJCF file contains only the resulting damping."""
    return float(assembly.nominal_spec(express(genome).plan, 0.0, 0.0, Terrain()).actuators[0].biasprm[DAMPING])


def _scene_constants(terrain: Terrain) -> dict[str, Any]:
    sensor = assembly.Sensor
    positions = (sensor.GROUND_CONTACT, sensor.GROUND_DISTANCE, sensor.ANY_CONTACT, sensor.SELF_CONTACT)
    vectors = {"com": sensor.COM, "up": sensor.UP, "sledge": sensor.SLEDGE}
    return {
        "robot_body": assembly.ROBOT_BODY,
        "start_clearance": scene.START_CLEARANCE,
        "pieces_top": PIECE_HEIGHT * terrain.texture_size if terrain.n_pieces else 0.0,
        "rope_slack": scene.ROPE_SLACK,
        "rope_ends": scene.ROPE_ENDS,
        "control_rate": scene.CONTROL_RATE,
        "ramp_time": scene.RAMP_TIME,
        "settling": {
            "chunk": starts.SETTLE_CHUNK,
            "max_time": starts.MAX_SETTLE_TIME,
            "rest_speed": starts.REST_SPEED,
            "min_rest_time": starts.MIN_REST_TIME,
            "min_support_margin": starts.MIN_SUPPORT_MARGIN,
            "n_margin_directions": starts.N_MARGIN_DIRECTIONS,
        },
        "sensors": {
            **{name: (part.start, part.stop - part.start) for name, part in vectors.items()},
            **{name: (position, 1) for name, position in zip(CONTACT_SENSORS, positions, strict=True)},
            "rope": (sensor.ROPE, 1),
        },
    }


def _ground(terrain: Terrain) -> dict[str, Any]:
    """Return gravity, wind and material of the world, and the shape of the ground."""
    is_plane = terrain.structure in (Structure.flat, Structure.incline)
    return {
        "world": {
            "gravity": terrain.gravity,
            "wind": terrain.wind,
            "texture": terrain.texture.name,
            "slope": heights.slope(terrain),
        },
        "planets": PLANET_GRAVITY,
        "air": {"density": AIR_DENSITY, "viscosity": AIR_VISCOSITY},
        "textures": {
            texture.name: {
                **dict(zip(("sliding", "torsional"), MATERIALS[texture].friction(), strict=False)),
                "rolling": MATERIALS[texture].rolling,
                "about": texture.about,
            }
            for texture in Texture
        },
        "has_slope": is_plane and not terrain.n_pieces and not terrain.obstacle,
        "ground": {
            "structure": terrain.structure.name,
            "landing": heights.LANDING_LENGTH,
            "arena_length": heights.ARENA_LENGTH,
            "arena_width": heights.ARENA_WIDTH,
            "trench_depth": heights.TRENCH_DEPTH,
            "step_height": terrain.step_height,
            "step_depth": terrain.step_depth,
            "gaps": heights.gap_ranges(terrain).tolist() if terrain.structure == Structure.gaps else [],
            "hills": heights.hill_heights(terrain).tolist(),
        },
    }


def _guards(settings: Settings) -> dict[str, Any]:
    """Return the limits of all guards; an infinite one is None."""
    arena = [
        [value if math.isfinite(value) else None for value in row]
        for row in heights.arena_bounds(settings.terrain).tolist()
    ]
    return {
        "max_start_overlap": validity.MAX_START_OVERLAP,
        "max_rest_speed": validity.MAX_REST_SPEED,
        "max_drive_frequency": validity.MAX_DRIVE_FREQUENCY,
        "max_speed": settings.simulation.max_speed,
        "max_rise": validity.MAX_RISE,
        "max_sink": validity.MAX_SINK,
        "max_airborne": settings.simulation.max_airborne,
        "min_height": validity.MIN_HEIGHT,
        "max_time_down": validity.MAX_TIME_DOWN,
        "arena": arena,
        "max_rope_stretch": validity.MAX_ROPE_STRETCH,
        "max_load_lead": validity.MAX_LOAD_LEAD,
        "max_sledge_sink": validity.MAX_SLEDGE_SINK,
        "max_overturned_time": validity.MAX_OVERTURNED_TIME,
        "min_level_share": validity.MIN_LEVEL_SHARE,
        "level_walk_duration": pushes.LEVEL_WALK_DURATION,
    }


def _genes(robot: Robot) -> dict[str, Any]:
    ranges = feature_ranges(robot)
    return {
        "n_segments": robot.segments[1],
        "body_features": [feature.name for feature in BODY_FEATURES],
        "segment_features": [feature.name for feature in SEGMENT_FEATURES],
        "genes": {
            feature.name: dict(zip(("low", "high", "unit", "kind"), ranges[feature], strict=True))
            | {"about": feature.about}
            for feature in (*BODY_FEATURES, *SEGMENT_FEATURES)
        },
    }


def _limits(robot: Robot) -> dict[str, Any]:
    """Return the limits of the whole robot."""
    return {
        "segments": robot.segment_range,
        "leg_pairs": robot.leg_pairs,
        "body_length": [robot.length_for_weight(n) for n in range(1, robot.segments[1] + 1)],
        "weight": robot.weight,
        "mass_per_cube": {
            "min_trunk": MIN_TRUNK_MASS,
            "max_trunk": MAX_TRUNK_MASS,
            "min_legs": MIN_LEGS_MASS,
            "max_legs": MAX_LEGS_MASS,
        },
    }


def _text_form() -> dict[str, Any]:
    """Return the tokens of a genome's text for each number of segments, in both versions of the format."""
    counts = range(1, int(MAX_SEGMENTS) + 1)
    return {
        "layouts": [text_layout(count, VERSION) for count in counts],
        "layouts_1": [text_layout(count, 1) for count in counts],
        "choices": CHOICES,
        "initial_values": {
            "body": [FEATURES_SINCE_2.get(feature, 0.0) for feature in BODY_FEATURES],
            "segment": [FEATURES_SINCE_2.get(feature, 0.0) for feature in SEGMENT_FEATURES],
        },
        "max_text_length": MAX_TEXT_LENGTH,
        "error_context": ERROR_CONTEXT,
        "max_text": MAX_TEXT,
    }
