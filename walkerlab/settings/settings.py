"""All settings of a run: terrain, robot, algorithm and simulation."""

from collections.abc import Mapping
from typing import Any, Self, cast

from pydantic import ValidationInfo, field_validator

from walkerlab.settings.algorithm import Algorithm
from walkerlab.settings.fields import OneOf
from walkerlab.settings.glossary import glossary
from walkerlab.settings.model import Domain, SettingsModel, report_together
from walkerlab.settings.robot import Robot
from walkerlab.settings.simulation import Simulation
from walkerlab.settings.terrain import Terrain
from walkerlab.settings.values import code_text, did_you_mean, short_repr
from walkerlab.text.templates import render

COMMON_NAMES = {
    **dict.fromkeys(("robots", "n_robots", "individuals", "size"), "population_size"),
    **dict.fromkeys(("seconds", "time"), "duration"),
    **dict.fromkeys(("slope", "angle"), "incline"),
    **dict.fromkeys(("ground", "surface"), "structure"),
    **dict.fromkeys(("friction", "floor"), "texture"),
    "steps": "step_height",
    "rounds": "generations",
}
"""Names of settings that are easily guessed wrong, and the right ones."""


class Settings(SettingsModel, frozen=True):
    """All settings of a run.

    Attributes:
        terrain: The ground, the objects on it, gravity and wind.
        robot: Limits on the bodies of all robots.
        algorithm: Fitness, operators, population size and number of generations.
        simulation: Duration and time step of a walk, and the guards that decide whether it counts.
    """

    terrain: Terrain = Terrain()
    robot: Robot = Robot()
    algorithm: Algorithm = Algorithm()
    simulation: Simulation = Simulation()

    def with_(self, *unnamed: object, **changes: Any) -> Self:
        """Return a copy with some settings changed: ``s.with_(selection="top_half", duration=4)``.

        Args:
            unnamed: Not allowed; a value without a name raises a ``TypeError`` that shows the usage.
            changes: Individual settings by name, or whole domains: ``s.with_(terrain=Terrain(structure="stairs"))``.

        Raises:
            SettingsError: If a name is unknown or a value is invalid.
            TypeError: If a value is given without a name.
        """
        if unnamed:
            raise TypeError(f"with_ takes settings by name, as in s.with_(duration=4); got {short_repr(unnamed[0])}")
        locations = self.field_locations()
        errors: list[str] = []
        values: dict[str, Any] = dict(self)
        for name in sorted(changes, key=locations.__contains__):  # whole domains come first
            if name in locations:
                domain, field = locations[name]
                values[domain] = dict(values[domain]) | {field: changes[name]}
                continue
            try:
                values[name] = self._check_domain(name, changes[name])
            except ValueError as error:  # the other changes are checked with the unchanged domain
                errors.append(str(error))
        with report_together(errors):
            return type(self)(**values)

    def changes(self) -> dict[str, Any]:
        """Return each setting that differs from its default: ``Settings().with_(**s.changes()) == s``."""
        return {
            name: getattr(getattr(self, domain), field)
            for name, (domain, field) in self.field_locations().items()
            if getattr(getattr(self, domain), field) != getattr(type(self).model_fields[domain].default, field)
        }

    def as_python(self) -> str:
        """Return Python code that creates these settings, with ``import walkerlab as wl``; functions appear by name."""
        lines = [f"    {name}={code_text(value)}," for name, value in self.changes().items()]
        return "\n".join(["wl.Settings().with_(", *lines, ")"]) if lines else "wl.Settings()"

    def _repr_html_(self) -> str:
        tables = [glossary(domain) for _, domain in self]
        return render("settings/settings.html", tables=tables, python=self.as_python())

    @field_validator("*", mode="before")
    @classmethod
    def _validate_domain(cls, value: object, info: ValidationInfo) -> object:
        return cls._check_domain(info.field_name or "", value)

    @classmethod
    def _check_domain(cls, name: str, value: Any) -> Any:
        """Return the settings of a domain, or a copy of a dict of them.

        Args:
            name: Name of the domain; if it is unknown, the value is returned unchanged and pydantic reports the name.
            value: Value given for it.

        Raises:
            ValueError: If the value is neither settings of this domain nor a dict.
        """
        if name not in cls.model_fields:
            return value
        kind: type[Domain] = type(cls.model_fields[name].default)
        if isinstance(value, kind):
            return value
        if isinstance(value, Mapping):
            return dict(cast(Mapping[str, Any], value))
        fields = [
            field
            for field, declared in kind.declared().items()
            if isinstance(declared, OneOf) and isinstance(value, str) and value in declared.choices.__members__
        ]
        guess = f" Did you mean {name}={kind.__name__}({fields[0]}={value!r})?" if fields else ""
        raise ValueError(
            f"Settings.{name} is {short_repr(value)}; it must be a {kind.__name__}, or a dict of its settings.{guess}"
        )

    @classmethod
    def suggest_name(cls, name: str) -> str:
        """Return a sentence that suggests a valid name for an unknown one, in any domain."""
        locations = cls.field_locations()
        if name in locations:
            domain, field = locations[name]
            return f" It is a setting of {domain}: {domain}={domain.capitalize()}({field}=…)."
        if meant := COMMON_NAMES.get(name.lower()):
            return f" Did you mean {meant!r}?"
        return did_you_mean(name, [*cls.model_fields, *locations]) or super().suggest_name(name)

    @classmethod
    def field_locations(cls) -> dict[str, tuple[str, str]]:
        """Return the domain and field of each setting, keyed by the name that ``with_`` takes.

        The name is the field's name. If a field has the same name as one of the algorithm, its domain is put in front:
        ``seed`` and ``terrain_seed``.
        """
        fields = {
            domain: list(type(field.default).model_fields)  # type: ignore[union-attr]
            for domain, field in cls.model_fields.items()
        }
        return {
            name if domain == "algorithm" or name not in fields["algorithm"] else f"{domain}_{name}": (domain, name)
            for domain, names in fields.items()
            for name in names
        }
