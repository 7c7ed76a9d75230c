"""Settings of a class: what the panel shows, which values are fixed, and how large a run may be.

A teacher writes them to a file, here ``class.json``; every entry is optional:

    {
      "name": "Biology 10b",
      "only": ["terrain", "selection", "population_size", "generations"],
      "locked": {"population_size": 24, "duration": 6},
      "presets": {"Low stairs": {"structure": "stairs", "step_height": 0.05}},
      "budget": 500,
      "shared_folder": "hand-in",
      "seed_per_student": true
    }
"""

import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Self, cast

from pydantic import Field, field_validator, model_validator

from walkerlab.settings.glossary import glossary_rows
from walkerlab.settings.model import MAX_JSON, SettingsError, SettingsModel
from walkerlab.settings.settings import Settings
from walkerlab.settings.values import did_you_mean, short_repr
from walkerlab.system.files import absolute_path, display_path
from walkerlab.text import strict_json

CLASS_VARIABLE = "WALKERLAB_CLASS"  # environment variable with the path of the class file
MAX_BUDGET = 10_000_000  # walks
MAX_NAME_LENGTH = 80  # characters
FIXED_REASON = "fixed by your teacher"
SEED_REASON = "made from your name"


class Classroom(SettingsModel, frozen=True):
    """Settings of a class, as its file contains them.

    Attributes:
        name: Name of the class, shown in the panel.
        only: Domains (``"terrain"``) and settings (``"step_height"``) that the panel shows; all if empty. The others
            keep their values.
        locked: Fixed settings, by the names that ``Settings.with_`` takes, with their values.
        presets: Named worlds that replace those of the panel: by name, the settings that differ.
        budget: Maximum number of walks of a run; None for any.
        shared_folder: Folder into which students hand in robots; None if there is none.
        seed_per_student: Whether the seed of the evolution follows from the name of the student.
    """

    name: str = ""
    only: tuple[str, ...] = ()
    locked: dict[str, Any] = Field(default_factory=dict)
    presets: dict[str, dict[str, Any]] = Field(default_factory=dict)
    budget: int | None = None
    shared_folder: Path | None = None
    seed_per_student: bool = False

    @field_validator("name", mode="before")
    @classmethod
    def _check_name(cls, value: object) -> object:
        if not isinstance(value, str) or len(value) > MAX_NAME_LENGTH:
            raise ValueError(
                f"name is {short_repr(value)}; it must be a text of at most {MAX_NAME_LENGTH} characters, such as "
                '"Biology 10b". It is the name of the class.'
            )
        return value

    @field_validator("only", mode="before")
    @classmethod
    def _check_only(cls, value: Any) -> object:
        names = _names(value, "only", '["terrain", "selection"]')
        require_setting_names(names, "only")
        return names

    @field_validator("locked", mode="before")
    @classmethod
    def _check_locked(cls, value: object) -> object:
        return _check_changes(value, "locked", '{"population_size": 24}')

    @field_validator("presets", mode="before")
    @classmethod
    def _check_presets(cls, value: object) -> object:
        example = '{"Low stairs": {"structure": "stairs", "step_height": 0.05}}'
        if not isinstance(value, Mapping):
            raise ValueError(f"presets is {short_repr(value)}; it must be an object of named worlds, as in {example}")
        presets = cast(Mapping[Any, Any], value)
        return {name: _check_changes(changes, f"presets.{name}", example) for name, changes in presets.items()}

    @field_validator("budget", mode="before")
    @classmethod
    def _check_budget(cls, value: object) -> object:
        is_whole = isinstance(value, int) and not isinstance(value, bool)
        if value is not None and not (is_whole and 1 <= cast(int, value) <= MAX_BUDGET):
            raise ValueError(
                f"budget is {short_repr(value)}; it must be a whole number of walks between 1 and {MAX_BUDGET:,}, or "
                "null for any. It is the largest number of walks of a run: 24 robots for 20 generations are about 480."
            )
        return value

    @field_validator("shared_folder", mode="before")
    @classmethod
    def _check_shared_folder(cls, value: object) -> object:
        if value is not None and not (isinstance(value, str | Path) and str(value)):
            raise ValueError(
                f"shared_folder is {short_repr(value)}; it must be the path of a folder, or null. Students hand in "
                "robots there."
            )
        return value

    @field_validator("seed_per_student", mode="before")
    @classmethod
    def _check_seed_per_student(cls, value: object) -> object:
        if not isinstance(value, bool):
            raise ValueError(
                f"seed_per_student is {short_repr(value)}; it must be true or false. With true, each student evolves "
                "with another seed, which follows from the name."
            )
        return value

    @model_validator(mode="after")
    def _check_presets_are_free(self) -> Self:
        """Check that the presets change only settings that are shown and not fixed."""
        errors: list[str] = []
        for preset, changes in self.presets.items():
            for name in changes:
                if name in self.locked:
                    errors.append(f"presets.{preset} changes {name}, which is locked; remove one of the two.")
                elif not self.shows(name):
                    errors.append(f'presets.{preset} changes {name}, which is not in "only"; add it there.')
        if self.seed_per_student and "seed" in self.locked:
            errors.append("seed is locked, and seed_per_student is true; remove one of the two.")
        if errors:
            raise ValueError("\n".join(errors))
        return self

    def shows(self, name: str) -> bool:
        """Return whether the panel shows a setting, by the name that ``Settings.with_`` takes."""
        return not self.only or name in self.only or Settings.field_locations()[name][0] in self.only


def read_class(path: str | Path) -> Classroom:
    """Read the settings of a class from a file.

    Args:
        path: JSON file; a relative ``shared_folder`` in it is relative to the folder of the file.

    Raises:
        SettingsError: If the file cannot be read, or an entry is wrong; the message has a line for each error.
    """
    path = absolute_path(path, "class file")
    name = display_path(path)
    try:
        with path.open("rb") as file:
            data = file.read(MAX_JSON + 1)
        content: Any = strict_json.loads(data.decode("utf-8-sig")) if len(data) <= MAX_JSON else None
    except OSError as error:
        raise SettingsError(f"{name} cannot be read: {error.strerror or error}. Check the path.") from error
    except json.JSONDecodeError as error:
        raise SettingsError(
            f"{name} is not valid JSON: line {error.lineno}, column {error.colno}: {error.msg}. Names and texts are in "
            "double quotes, and entries are separated by commas."
        ) from error
    except (ValueError, RecursionError) as error:
        raise SettingsError(f"{name} is not a class file: {error}") from error
    if not isinstance(content, dict):
        raise SettingsError(f'{name} must contain an object, as in {{"locked": {{"population_size": 24}}}}')
    try:
        classroom = Classroom.model_validate(content)
    except SettingsError as error:
        lines = str(error).replace(f"{Classroom.__name__} has no setting", "there is no entry").splitlines()
        raise SettingsError("\n".join(f"{name}: {line}" for line in lines)) from None
    if classroom.shared_folder is None:
        return classroom
    folder = path.parent / classroom.shared_folder
    if not folder.is_dir():
        raise SettingsError(
            f"{name}: shared_folder is {str(classroom.shared_folder)!r}, and there is no folder "
            f"{display_path(folder)}; create it, or correct the path."
        )
    return classroom.model_copy(update={"shared_folder": folder})


def current_class() -> Classroom:
    """Return the class that ``walkerlab lab --class`` named; without one, a class without limits.

    Raises:
        SettingsError: If its file is wrong.
    """
    path = os.environ.get(CLASS_VARIABLE, "")
    return read_class(path) if path else Classroom()


def require_setting_names(names: tuple[str, ...], argument: str) -> None:
    """Check names of domains and settings.

    Args:
        names: Names such as ``"terrain"`` and ``"step_height"``.
        argument: Name of the argument, for the message.

    Raises:
        ValueError: If a name is unknown.
    """
    known = [*Settings.model_fields, *Settings.field_locations()]
    errors = [
        f"{argument} names {name!r}; there is no such setting.{did_you_mean(name, known)}"
        for name in names
        if name not in known
    ]
    if errors:
        raise ValueError("\n".join(errors))


def require_fixed_values(settings: Settings, start: Settings, reasons: Mapping[tuple[str, str], str]) -> None:
    """Check that settings have the fixed values.

    Args:
        settings: Settings to check.
        start: Settings with the fixed values.
        reasons: Why each setting is fixed, by its domain and field.

    Raises:
        SettingsError: If a fixed setting differs; the message has a line for each.
    """
    errors: list[str] = []
    for (domain, field), reason in reasons.items():
        given, kept = (getattr(one, domain) for one in (settings, start))
        if getattr(given, field) != getattr(kept, field):
            texts = [row.value for one in (given, kept) for row in glossary_rows(one) if row.name == field]
            errors.append(
                f"{domain.capitalize()}.{field} is {texts[0]}; it must stay {texts[1]}, because it is {reason}."
            )
    if errors:
        raise SettingsError("\n".join(errors))


def _names(value: Any, entry: str, example: str) -> tuple[str, ...]:
    names: list[Any] = list(value) if isinstance(value, list | tuple) else [value]
    if not all(isinstance(name, str) for name in names):
        raise ValueError(f"{entry} is {short_repr(value)}; it must be a list of names in quotes, as in {example}")
    return tuple(names)


def _check_changes(value: Any, entry: str, example: str) -> dict[str, Any]:
    """Return settings by name, if ``Settings.with_`` accepts them; the message names each that it does not."""
    if not isinstance(value, Mapping) or not all(isinstance(name, str) for name in cast(Mapping[Any, Any], value)):
        raise ValueError(f"{entry} is {short_repr(value)}; it must be an object of settings, as in {example}")
    changes = dict(cast(Mapping[str, Any], value))
    known = Settings.field_locations()
    errors = [
        f"{entry} has no setting {name!r}.{did_you_mean(name, known) or ' Give individual settings, not domains.'}"
        for name in changes
        if name not in known
    ]
    try:
        Settings().with_(**{name: given for name, given in changes.items() if name in known})
    except SettingsError as error:
        errors += [f"{entry}: {line}" for line in str(error).splitlines()]
    if errors:
        raise ValueError("\n".join(errors))
    return changes
