"""All settings of a run: terrain, robot, algorithm and simulation."""

from collections.abc import Mapping
from typing import Any, Self, cast

from pydantic import ValidationInfo, field_validator

from walkerlab.settings.algorithm import Algorithm
from walkerlab.settings.fields import OneOf
from walkerlab.settings.glossary import glossary
from walkerlab.settings.model import Domain, SettingsModel, told_with
from walkerlab.settings.robot import Robot
from walkerlab.settings.simulation import Simulation
from walkerlab.settings.terrain import Terrain
from walkerlab.settings.values import brief, did_you_mean, pasted
from walkerlab.text.html import code, details, shown


class Settings(SettingsModel, frozen=True):
    """All that a run is made from."""

    terrain: Terrain = Terrain()
    robot: Robot = Robot()
    algorithm: Algorithm = Algorithm()
    simulation: Simulation = Simulation()

    def with_(self, *unnamed: object, **changes: Any) -> Self:
        """Return a copy with some settings changed, each named alone: ``s.with_(selection="top_half", duration=4)``.

        A whole domain may be named as well: ``s.with_(terrain=Terrain(structure="stairs"), duration=4)``.

        Raises:
            SettingsError: if no domain has such a setting, or the value will not do.
            TypeError: If a value is given without a name.
        """
        if unnamed:
            raise TypeError(f"with_ takes settings by name, as in s.with_(duration=4); got {brief(unnamed[0])}")
        places, faults = self.places(), list[str]()
        parts: dict[str, Any] = dict(self)
        for name in sorted(changes, key=places.__contains__):  # whole domains come first
            if name in places:
                domain, field = places[name]
                parts[domain] = dict(parts[domain]) | {field: changes[name]}
                continue
            try:
                parts[name] = self._domain(name, changes[name])
            except ValueError as fault:  # the others are held against the domain as it was
                faults.append(str(fault))
        with told_with(faults):
            return type(self)(**parts)

    def changes(self) -> dict[str, Any]:
        """Return each single setting that differs from its default: ``Settings().with_(**s.changes()) == s``."""
        return {
            name: getattr(getattr(self, domain), field)
            for name, (domain, field) in self.places().items()
            if getattr(getattr(self, domain), field) != getattr(type(self).model_fields[domain].default, field)
        }

    def as_python(self) -> str:
        """Write the code that makes them, given ``import walkerlab as wl``; functions are called by their names."""
        lines = [f"    {name}={pasted(value)}," for name, value in self.changes().items()]
        return "\n".join(["wl.Settings().with_(", *lines, ")"]) if lines else "wl.Settings()"

    def _repr_html_(self) -> str:
        return shown(*(glossary(domain) for _, domain in self), details("The same as Python", code(self.as_python())))

    @field_validator("*", mode="before")
    @classmethod
    def _check(cls, value: object, info: ValidationInfo) -> object:
        return cls._domain(info.field_name or "", value)

    @classmethod
    def _domain(cls, name: str, value: Any) -> Any:
        """Refuse what is no domain of this name, nor the settings of one; pass over names that there are not."""
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
            f"Settings.{name} is {brief(value)}; it must be a {kind.__name__}, or a dict of its settings.{guess}"
        )

    @classmethod
    def advice(cls, name: str) -> str:
        """Say what might have been meant by a name that there is not, looking into the domains as well."""
        places = cls.places()
        if name in places:
            domain, field = places[name]
            return f" It is one of {domain}: {domain}={domain.capitalize()}({field}=…)."
        return did_you_mean(name, [*cls.model_fields, *places]) or super().advice(name)

    @classmethod
    def places(cls) -> dict[str, tuple[str, str]]:
        """Name each single setting in one word, and say its domain and field.

        The word is the field's name. Where two domains have one of that name, it is the algorithm's, and the other is
        called after its domain as well: ``seed`` and ``terrain_seed``.
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
