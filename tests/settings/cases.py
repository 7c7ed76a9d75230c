"""Fields of all domains as test parameters, and functions that the tests of settings share."""

import pytest

from walkerlab.settings.algorithm import Algorithm
from walkerlab.settings.fields import OneOf, Quantity
from walkerlab.settings.model import SettingsError
from walkerlab.settings.robot import Robot
from walkerlab.settings.settings import Settings
from walkerlab.settings.simulation import Simulation
from walkerlab.settings.terrain import Terrain

DOMAINS = {"terrain": Terrain, "robot": Robot, "algorithm": Algorithm, "simulation": Simulation}
FIELDS = [(domain, name) for domain in DOMAINS.values() for name in domain.declared()]
NUMBERS = [(domain, name) for domain, name in FIELDS if isinstance(domain.declared()[name], Quantity)]
CHOICES = [(domain, name) for domain, name in FIELDS if isinstance(domain.declared()[name], OneOf)]
NAMESPACE = {kind.__name__: kind for kind in (Settings, *DOMAINS.values())}
"""Names that the code of settings needs."""

every_field = pytest.mark.parametrize(("domain", "name"), FIELDS)
every_number = pytest.mark.parametrize(("domain", "name"), NUMBERS)
every_choice = pytest.mark.parametrize(("domain", "name"), CHOICES)


def default(domain, name):
    return domain.model_fields[name].default


def with_part(domain, name, number):
    """Yield values of a field in which one number is replaced; the others are those of the default."""
    declared = domain.declared()[name]
    if not declared.components:
        yield number
    for i in range(len(declared.components)):
        yield (*default(domain, name)[:i], number, *default(domain, name)[i + 1 :])


def error_message(make, *args, **values):
    with pytest.raises(SettingsError) as caught:
        make(*args, **values)
    return str(caught.value)


def user_function(*args):
    return 1.0
