"""The house stands: imports point down, each big package is met in its own rooms only, and importing does nothing."""

import ast
import json
import subprocess
import sys
from graphlib import TopologicalSorter
from itertools import groupby
from pathlib import Path

import pytest

import walkerlab

HOUSE = Path(walkerlab.__file__).parent

FLOORS = (
    ("faults", "binding", "strict_json"),
    ("readonly",),
    (
        "quantity",
        "number_format",
        "randomness",
        "genes",
        "interrupts",
        "markup",
        "graphics",
        "gate",
        "time_limit",
        "files",
    ),
    ("choices", "glossary", "workers", "provenance", "snapshots", "fileset"),
    ("settings", "ga", "waiting"),
    ("arguments",),
    ("limits", "ground", "textures", "cameras"),
    ("layout",),
    ("genome", "entities"),
    ("phenotype", "algorithm"),
    ("assembly", "judge"),
    ("staging",),
    ("scene",),
    ("rollout", "shapes"),
    ("fitness", "footfalls", "export"),
    ("evaluation", "confirmation"),
    ("records",),
    ("layouts",),
    ("opening",),
    ("store",),
    ("archive", "missing", "plots", "story", "sketch"),
    ("viewer", "cinema"),
    ("report",),
    ("run",),
    ("rerating",),
    ("evolution", "outputs"),
    ("live", "forecast"),
    ("widgets",),
    ("commands",),
    ("__main__",),
)
"""From the ground up; Folders are a room each; ``__init__`` is the sign at the door."""

FLOOR = {room: height for height, rooms in enumerate(FLOORS) for room in rooms}

ONLY_FROM = {
    "ga": {"faults", "genes", "randomness", "readonly", "time_limit"},
    "entities": {"choices", "settings", "genes", "ground", "layout", "textures"},
}
"""Rooms that know less than their floor allows: ga meets no robot, entities spend no chance."""

ONLY_IN = {
    "dm_control": {"entities", "export", "environment"},
    "mujoco": {"assembly", "staging", "scene", "rollout", "shapes", "footfalls", "cinema", "export", "commands"},
    "matplotlib": {"plots", "viewer", "cinema", "report", "commands", "widgets"},
    "k3d": {"viewer"},
    "anywidget": {"viewer", "widgets"},
    "av": {"cinema"},
    "ipywidgets": {"widgets"},
    "IPython": {"snapshots", "widgets"},
    "loky": {"workers"},
    "sqlite3": {"store", "opening", "layouts"},
    "random": set(),
    "pickle": set(),
    "cloudpickle": set(),
    "marshal": set(),
    "shelve": set(),
    "dill": set(),
    "joblib": set(),
}
"""Packages that are met in few rooms, or in none."""

LIGHT = {"walkerlab": {"numpy", "pandas", "pydantic", "mujoco", "dm_control", "matplotlib", "ipywidgets", "tqdm"}}
LIGHT |= {
    f"walkerlab.{room}": {"pandas", "mujoco", "dm_control", "matplotlib", "ipywidgets"}
    for room in ("quantity", "choices", "settings", "randomness", "genes", "ga")
}
LIGHT |= {
    f"walkerlab.{room}": {"mujoco", "dm_control", "matplotlib", "ipywidgets"}
    for room in ("limits", "ground", "layout", "textures", "genome", "algorithm", "judge")
}
"""What must not be loaded by importing them."""


def modules():
    """Yield the dotted name within walkerlab and the path of every file."""
    for path in sorted(HOUSE.rglob("*.py")):
        parts = path.relative_to(HOUSE).with_suffix("").parts
        yield ".".join(parts[:-1] if parts[-1] == "__init__" and len(parts) > 1 else parts), path


MODULES = dict(modules())


def room(module):
    return module.partition(".")[0]


def imports(path):
    """Yield the dotted name of everything that a file imports, wherever in it."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        match node:
            case ast.Import(names=names):
                yield from (alias.name for alias in names)
            case ast.ImportFrom(module=module, names=names, level=0):
                yield from (f"{module}.{alias.name}" for alias in names)
            case ast.ImportFrom():
                raise AssertionError(f"{path} imports relatively; write walkerlab.… so that it can be read at sight")


def of_ours(path):
    """Return the modules of ours that a file imports: names of modules, not of what is in them."""
    found = set()
    for name in imports(path):
        head, _, inside = name.partition(".")
        if head == "walkerlab":
            parts = inside.split(".")
            known = [".".join(parts[:n]) for n in range(len(parts), 0, -1) if ".".join(parts[:n]) in MODULES]
            found.add(known[0] if known else "__init__")
    return found


rooms = pytest.mark.parametrize("module", [module for module in MODULES if module != "__init__"])


def test_every_file_has_its_floor_and_every_floor_its_files():
    assert {room(module) for module in MODULES} == {*FLOOR, "__init__"}
    assert len(FLOOR) == sum(map(len, FLOORS))


@rooms
def test_imports_point_down(module):
    here = room(module)
    for other in of_ours(MODULES[module]):
        if other == "__init__":
            assert here in FLOORS[-1], f"{module} imports the door; only {FLOORS[-1]} may come in by it"
        elif room(other) != here:
            assert FLOOR[room(other)] < FLOOR[here], f"{module} imports {other}, which is not below it"
            assert room(other) in ONLY_FROM.get(here, FLOOR), f"{module} imports {other}, and must not know of it"


@pytest.mark.parametrize(
    "folder", ["ga", "entities", "plots", "sketch", "viewer", "cinema", "report", "widgets", "commands"]
)
def test_no_two_files_of_a_room_need_each_other(folder):
    graph = {module: of_ours(path) - {module} for module, path in MODULES.items() if room(module) == folder}
    TopologicalSorter(graph).prepare()  # raises CycleError, which shows the cycle


@rooms
def test_each_package_is_met_in_its_own_rooms_only(module):
    for name in imports(MODULES[module]):
        package = name.partition(".")[0]
        assert room(module) in ONLY_IN.get(package, {room(module)}), f"{module} imports {package}"


def test_the_door_loads_nothing():
    tree = ast.parse(MODULES["__init__"].read_text(encoding="utf-8"))
    at_once = [node for node in tree.body if isinstance(node, ast.Import | ast.ImportFrom)]
    assert {node.module for node in at_once} == {"importlib", "typing"}


def test_every_public_name_is_there():
    names = dir(walkerlab)
    assert {"Settings", "Genome", "evolve", "load", "resume", "evaluate", "simulate", "plots", "ga"} <= set(names)
    for name in names:
        assert getattr(walkerlab, name) is not None
    with pytest.raises(AttributeError, match="walkerlab has no 'no_such_name'"):
        walkerlab.no_such_name  # noqa: B018


def test_no_code_comes_out_of_a_file_or_a_text():
    forbidden = {"eval", "exec", "read_pickle", "to_pickle", "allow_pickle"}
    for module, path in MODULES.items():
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            match node:
                case ast.Name(id=name) | ast.Attribute(attr=name) | ast.keyword(arg=name):
                    assert name not in forbidden, f"{module} uses {name}"


# ----------------------------------------------------------------------------------------------------- importing

WATCH = """
import json, os, sys, threading, warnings
from importlib import import_module

def state():
    return {
        "threads": sorted(thread.name for thread in threading.enumerate()),
        "environment": dict(os.environ),
        "folder": os.getcwd(),
        "files": sorted(os.path.join(top, name) for top, _, names in os.walk(".") for name in names),
    }

before = state()
*steps, theirs = json.loads(sys.argv[1])
with warnings.catch_warnings():  # theirs are not ours to mend
    warnings.simplefilter("ignore")
    for name in theirs:
        import_module(name)
loaded, changed, before = {}, {}, before | {"environment": state()["environment"], "threads": state()["threads"]}
for name in steps:
    import_module(name)
    loaded[name] = sorted({module.partition(".")[0] for module in sys.modules})
    after = state()
    changed[name] = [what for what in after if after[what] != before[what]]
    before = after
print(json.dumps([loaded, changed]))
"""


def watched(folder, *names, after=()):
    """Import modules, in this order, in a fresh Python; say what each had loaded, and what it had changed."""
    command = [sys.executable, "-W", "error", "-B", "-c", WATCH, json.dumps([*names, after])]
    environment = {"HOME": str(folder), "PATH": "", "MPLCONFIGDIR": str(folder.parent / "fonts")}
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)
    assert not done.returncode, done.stderr
    assert not done.stderr
    return json.loads(done.stdout)


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "home").mkdir()
    return tmp_path / "home"


def test_what_is_light_loads_nothing_heavy(folder):
    from_light_to_heavy = sorted(LIGHT, key=lambda name: (-len(LIGHT[name]), name))
    for _, names in groupby(from_light_to_heavy, key=lambda name: len(LIGHT[name])):
        loaded, _ = watched(folder, *names)
        for name, packages in loaded.items():
            assert not LIGHT[name] & set(packages), f"importing {name} loads them"


def test_importing_makes_no_file_thread_or_variable(folder):
    ours = [f"walkerlab.{module}" for module in MODULES if module not in ("__init__", "__main__")]
    _, changed = watched(folder, "walkerlab", *ours, after=["dm_control.composer", "matplotlib.pyplot", "pandas"])
    assert changed == {name: [] for name in ["walkerlab", *ours]}
    assert not list(folder.iterdir())
