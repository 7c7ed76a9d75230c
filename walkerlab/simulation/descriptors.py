"""Behaviour descriptors: numbers that describe a walk or a body, for quality diversity and several objectives."""

from collections.abc import Callable, Iterable, Mapping
from types import MappingProxyType
from typing import NamedTuple, TypeAlias

from walkerlab.ga.user_functions import RUN_TIME_LIMIT, OperatorError, Slot, call_in_slot, describe_result
from walkerlab.settings.values import did_you_mean, short_repr
from walkerlab.simulation.fitness import as_number
from walkerlab.simulation.rollout import Rollout

Descriptor: TypeAlias = Callable[[Rollout], float]
"""Function from a walk to one number."""


class BuiltInDescriptor(NamedTuple):
    """A descriptor with its unit and its meaning."""

    function: Descriptor
    unit: str
    about: str


DESCRIPTORS: Mapping[str, BuiltInDescriptor] = MappingProxyType(
    {
        "distance": BuiltInDescriptor(lambda walk: walk.distance, "m", "net forward travel of the centre of mass"),
        "velocity": BuiltInDescriptor(
            lambda walk: walk.velocity, "m/s", "mean forward speed over the last two thirds of the walk"
        ),
        "work": BuiltInDescriptor(lambda walk: float(walk.work[-1]), "J", "work of all servos during the walk"),
        "power": BuiltInDescriptor(
            lambda walk: float(walk.work[-1] / walk.time[-1]), "W", "mean power of all servos during the walk"
        ),
        "height": BuiltInDescriptor(
            lambda walk: float(walk.com[0, 2]), "m", "height of the centre of mass when the walk begins"
        ),
        "contact": BuiltInDescriptor(
            lambda walk: float(walk.on_ground.mean()), "", "share of the walk in which the robot touches the ground"
        ),
        "n_segments": BuiltInDescriptor(lambda walk: float(len(walk.phenotype.segments)), "", "number of segments"),
        "n_legs": BuiltInDescriptor(lambda walk: float(walk.phenotype.n_legs), "", "number of legs"),
        "weight": BuiltInDescriptor(lambda walk: walk.phenotype.weight, "kg", "total mass without loads"),
        "body_length": BuiltInDescriptor(lambda walk: walk.phenotype.body_length, "m", "length of the body"),
        "frequency": BuiltInDescriptor(lambda walk: walk.phenotype.frequency, "Hz", "frequency of the strides"),
        "duty": BuiltInDescriptor(
            lambda walk: walk.phenotype.duty, "", "share of the stride in which the thighs swing backward"
        ),
    }
)
"""Built-in descriptors by name."""

DESCRIPTOR_SLOT = Slot(
    "the descriptor",
    "descriptor(rollout)",
    "com = rollout.com.copy()",
    advice="It is called with one Rollout, as a fitness function is.",
    repeatability_advice="It must depend only on the walk.",
)


def read_descriptors(given: Iterable[str] | Mapping[str, Descriptor]) -> dict[str, Descriptor]:
    """Return descriptors by name.

    Args:
        given: Names of built-in descriptors, or a dict from names to functions of a ``Rollout``.

    Raises:
        ValueError: If there is no built-in descriptor of a name.
        TypeError: If they are neither, or a value of a dict is not a function.
    """
    if isinstance(given, str):
        given = (given,)
    if isinstance(given, Mapping):
        for name, function in given.items():
            if not callable(function):
                raise TypeError(f"descriptor {name!r} must be a function of a Rollout; got {short_repr(function)}")
        return dict(given)
    if not hasattr(given, "__iter__"):
        raise TypeError(
            "descriptors must be names, such as ['height'], or a dict, such as {'legs': function}; got "
            f"{short_repr(given)}"
        )
    names = list(map(str, given))
    for name in names:
        if name not in DESCRIPTORS:
            hint = did_you_mean(name, list(DESCRIPTORS)) or f" There are {', '.join(DESCRIPTORS)}."
            raise ValueError(
                f"there is no descriptor {short_repr(name)}.{hint} For your own, give a dict from its name to a "
                "function of a Rollout."
            )
    return {name: DESCRIPTORS[name].function for name in names}


def describe_walk(rollout: Rollout, descriptors: Mapping[str, Descriptor]) -> dict[str, float]:
    """Return the descriptors of a walk by name.

    Raises:
        OperatorError: If a function fails, or does not return one number.
    """
    described: dict[str, float] = {}
    for name, function in descriptors.items():
        value = call_in_slot(DESCRIPTOR_SLOT, function, lambda function=function: function(rollout), RUN_TIME_LIMIT)
        number = as_number(value)
        if number is None:
            raise OperatorError(
                f"the descriptor {name!r} must return one number; it returned {describe_result(value)}",
                "Return a number, such as float(rollout.com[:, 2].mean()).",
            )
        described[name] = number
    return described
