"""User functions in run files: a file stores the name and arguments of a function, and never its code."""

import builtins
import json
import unicodedata
from collections.abc import Collection
from dataclasses import replace
from functools import partial
from typing import Any

from walkerlab.evolution.run import Run
from walkerlab.ga.user_functions import name_of
from walkerlab.genome.breeding import OPERATOR_MODULES, slot_entries
from walkerlab.runfile.missing_functions import MissingFitness, MissingFunction, function_as_python
from walkerlab.runfile.opening import RunFileError
from walkerlab.settings import binding, choices
from walkerlab.settings.choices import Choice, Fitness
from walkerlab.settings.model import MAX_JSON, STORED_MODULES, SettingsError
from walkerlab.settings.settings import Settings
from walkerlab.settings.values import function_name
from walkerlab.simulation import fitness
from walkerlab.system.files import display_path

_BUILT_IN = {"fitness": fitness} | {kind.__name__.lower(): module for kind, module in OPERATOR_MODULES.items()}
"""The module with walkerlab's own functions for each slot that can hold a function."""

_CHOICE_TYPES = {kind.__name__: kind for kind in Choice.__subclasses__() if kind.__module__ == choices.__name__}

_RESERVED_NAMES = {*dir(builtins), "exit", "quit", "get_ipython"}
"""Names that no function of a run may have: in code generated from a run file they would call Python itself."""


def restore_settings(stored: dict[str, Any]) -> Settings:
    """Build settings from plain data; a stand-in replaces each user function.

    Args:
        stored: Settings as a run file stores them.

    Raises:
        ValueError: If a value is not allowed, or the name of a function is not allowed.
    """
    algorithm = stored["algorithm"]
    restored = {slot: _restore_operators(algorithm[slot], slot) for slot in _BUILT_IN}
    domains: dict[str, Any] = {**stored, "algorithm": {**algorithm, **restored}}
    return Settings(**domains)


def check_storable(settings: Settings) -> None:
    """Check that a run file with these settings can be written and loaded again.

    Raises:
        SettingsError: If the name of a function or of its arguments cannot be stored, or there is too much to store.
    """
    plain = json.loads(json.dumps(settings.model_dump()))
    faults: list[str] = []
    for slot in _BUILT_IN:
        try:
            _restore_operators(plain["algorithm"][slot], slot)
        except (ValueError, RecursionError) as error:
            faults.append(f"Algorithm.{slot} cannot be stored in a run file: {error}. Rename it.")
    if not faults and (length := len(json.dumps(plain))) > MAX_JSON:
        faults.append(
            f"these settings take {length} characters to store, including the arguments bound to functions; a run "
            f"file holds at most {MAX_JSON}. Use fewer functions, or keep large data in the function or in a global "
            "variable."
        )
    if faults:
        raise SettingsError("\n".join(faults))


def split_changes(settings: Settings, given: dict[str, Any]) -> tuple[dict[str, Any], dict[str, Any]]:
    """Split the settings given to ``resume`` into the run's own user functions and changed settings.

    In a slot in which the run has a user function, a user function or a function of the same name is its own.

    Args:
        settings: Settings of the loaded run.
        given: Settings given, keyed by name.

    Returns:
        User functions, keyed by slot, and changed settings, keyed by name.

    Raises:
        SettingsError: If a name is unknown or a value is not allowed.
    """
    changed = settings.with_(**given)
    functions: dict[str, Any] = {}
    for slot in user_functions(settings).keys() & given.keys():
        recorded, now = (slot_entries(getattr(one.algorithm, slot)) for one in (settings, changed))
        is_same_name = list(map(_name_of_entry, now)) == list(map(_name_of_entry, recorded))
        if is_same_name or any(_is_user_function(operator, slot) for operator in now):
            functions[slot] = given[slot]
    return functions, {name: value for name, value in given.items() if name not in functions}


def _name_of_entry(operator: Any) -> str:
    return operator.name if isinstance(operator, Choice) else name_of(operator)


def restore_user_functions(run: Run, functions: dict[str, Any], replaced: Collection[str] = ()) -> Run:
    """Return a loaded run with the user functions that its file does not contain.

    Args:
        run: Loaded run.
        functions: User functions, keyed by slot.
        replaced: Names of settings that change, whose functions are not required.

    Raises:
        RunFileError: If a function is missing, or is not the one that the run was made with.
    """
    recorded = {slot: slot_entries(getattr(run.settings.algorithm, slot)) for slot in _BUILT_IN}
    required = {slot: code for slot, code in user_functions(run.settings).items() if slot not in replaced}
    settings = run.settings.with_(**functions)
    wrong = [
        f"{slot}={code}"
        for slot, code in required.items()
        if not _operators_match(slot_entries(getattr(settings.algorithm, slot)), recorded[slot], slot)
        or any(map(_is_missing, slot_entries(getattr(settings.algorithm, slot))))
    ]
    if wrong:
        arguments = ", ".join(wrong)
        raise RunFileError(
            f"{display_path(run.path)} was made with user functions ({', '.join(required)}), and a run file holds no "
            "code. To resume the run, pass the functions under the same names; their code may be corrected. In "
            f"Python: wl.resume({display_path(run.path)!r}, {arguments}). To view the run, they are not required."
        )
    stages = (*run.stages[:-1], replace(run.stages[-1], settings=settings))
    return Run(settings, run.records, run.path, run.rated_since, run.stop_reason, stages, run.founders)


def user_functions(settings: Settings) -> dict[str, str]:
    """Return the contents of each slot that holds a user function as Python code, keyed by slot."""
    filled = {slot: slot_entries(getattr(settings.algorithm, slot)) for slot in _BUILT_IN}
    return {
        slot: _operators_as_python(operators)
        for slot, operators in filled.items()
        if any(_is_user_function(operator, slot) for operator in operators)
    }


def _is_user_function(operator: Any, slot: str) -> bool:
    function = operator.func if isinstance(operator, partial) else operator
    built_in = getattr(_BUILT_IN[slot], function_name(function), None)
    return not isinstance(operator, Choice) and function is not built_in


def _operators_match(given: tuple[Any, ...], recorded: tuple[Any, ...], slot: str) -> bool:
    """Return whether operators are those that a run file names; any function matches a lambda, which has no name."""

    def identity(operator: Any) -> tuple[bool, bool, str, str]:
        function, arguments = (
            (operator.func, binding.arguments_key(operator)) if isinstance(operator, partial) else (operator, "")
        )
        name = operator.name if isinstance(operator, Choice) else name_of(function)
        return _is_user_function(operator, slot), isinstance(operator, Choice), name, arguments

    pairs = [(identity(one), identity(other)) for one, other in zip(given, recorded, strict=False)]
    return len(given) == len(recorded) and all(
        one == other or (other[2] == "<lambda>" and one == (*other[:2], one[2], other[3])) for one, other in pairs
    )


def _operators_as_python(operators: tuple[Any, ...]) -> str:
    """Return the contents of a slot as Python code."""
    codes = [repr(one.name) if isinstance(one, Choice) else function_as_python(one) for one in operators]
    return codes[0] if len(codes) == 1 else f"[{', '.join(codes)}]"


def _restore_operators(stored: Any, slot: str) -> Any:
    """Turn the stored contents of a slot into operators; the file holds names and values only.

    Raises:
        ValueError: If a function or an argument has a name that is not allowed.
    """
    match stored:
        case list():
            return [_restore_operators(one, slot) for one in stored]
        case {"function": str(address), "with": dict(keywords), **rest}:
            module, _, name = address.rpartition(".")
            names = (name.replace("<lambda>", "function"), *keywords)
            if name in _RESERVED_NAMES or not all(map(_is_python_name, names)):
                raise ValueError(
                    f"a function of a run cannot be called {name!r:.60}, with {', '.join(keywords)!r:.60}; names must "
                    "be Python names other than those of Python's own functions"
                )
            built_in = _BUILT_IN[slot]
            is_built_in = module == STORED_MODULES.get(
                built_in.__name__, built_in.__name__
            ) and name in _own_function_names(slot)
            stand_in = MissingFitness if slot == "fitness" else MissingFunction
            function = getattr(built_in, name) if is_built_in else stand_in(name, slot)
            arguments = [binding.from_json_data(one, _CHOICE_TYPES) for one in list[Any](rest.get("args", []))]
            keywords = {name: binding.from_json_data(one, _CHOICE_TYPES) for name, one in keywords.items()}
            return partial(function, *arguments, **keywords) if arguments or keywords else function
        case _:
            return stored


def _is_python_name(text: str) -> bool:
    """Return whether a string is a Python name, and one that Python does not normalise to another."""
    return text.isidentifier() and unicodedata.normalize("NFKC", text) == text


def _own_function_names(slot: str) -> set[str]:
    """Return the names of walkerlab's own functions for a slot."""
    kinds: dict[str, type[Choice]] = {kind.__name__.lower(): kind for kind in (Fitness, *OPERATOR_MODULES)}
    return set(kinds[slot].__members__)


def _is_missing(operator: Any) -> bool:
    return isinstance(operator.func if isinstance(operator, partial) else operator, MissingFunction)
