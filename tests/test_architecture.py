"""The layout: imports point to earlier folders, heavy packages stay where they belong, and imports do nothing."""

import ast
import json
import subprocess
import sys
from graphlib import TopologicalSorter
from importlib.util import find_spec
from itertools import groupby
from pathlib import Path
from statistics import median

import pytest

import walkerlab

PACKAGE = Path(walkerlab.__file__).parent

LAYERS = (
    ("text", "system"),
    ("ga", "settings"),
    ("genome",),
    ("world",),
    ("simulation",),
    ("runfile",),
    ("analysis",),
    ("view",),
    ("evolution",),
    ("experiment", "interfaces", "tournament"),
    ("widgets",),
    ("lessons", "commands"),
    ("__main__",),
)
"""Folders and top-level modules, in the order in which data passes; each imports only from layers before its own."""

LAYER = {name: number for number, names in enumerate(LAYERS) for name in names}

ONLY_FROM = {
    "ga": {"system"},
    "world.entities": {"settings", "ga", "world"},
    "commands": {*LAYER} - {"widgets", "lessons"},
}
"""Modules that may import less than their layer allows: ga knows no robot, entities draw no random numbers."""

ONLY_IN = {
    "dm_control": {"world.entities"},
    "mujoco": {
        *("world.assembly", "world.compilation", "world.scene", "world.geometry", "simulation.export"),
        *(
            "simulation.rollout",
            "simulation.starts",
            "simulation.stepping",
            "simulation.footfalls",
            "view.film",
            "interfaces",
            "commands",
        ),
    },
    "matplotlib": {"view.plots", "view.replay", "view.film", "view.report", "commands", "widgets"},
    "k3d": {"view.replay"},
    "anywidget": {"view.replay", "widgets"},
    "av": {"view.film"},
    "ipywidgets": {"widgets"},
    "IPython": {"widgets", "view.snapshots"},
    "jinja2": {"text.templates"},
    "markupsafe": {"text.templates"},
    "loky": {"simulation.workers"},
    "gymnasium": {"interfaces.gymnasium_env"},
    "sqlite3": {"runfile.store", "runfile.opening", "runfile.schema", "runfile.experiments"},
    "random": set(),
    "pickle": set(),
    "cloudpickle": set(),
    "marshal": set(),
    "shelve": set(),
    "dill": set(),
    "joblib": set(),
}
"""Packages that few modules import, or no module."""

OPTIONAL = {"interfaces.gymnasium_env": "gymnasium"}
"""Modules that require a package of an extra; no other module imports them at its top level."""

LIGHT = {
    "walkerlab": {"numpy", "pandas", "pydantic", "mujoco", "dm_control", "matplotlib", "ipywidgets", "tqdm", "jinja2"}
}
LIGHT |= {
    f"walkerlab.{name}": {"pandas", "mujoco", "dm_control", "matplotlib", "ipywidgets", "jinja2"}
    for name in ("settings.model", "settings.settings", "settings", "system.randomness", "ga.genes", "ga")
}
LIGHT |= {
    f"walkerlab.{name}": {"mujoco", "dm_control", "matplotlib", "ipywidgets", "jinja2"}
    for name in (
        *(
            "genome.features",
            "genome.repair",
            "world.heights",
            "world.placement",
            "world.materials",
            "genome.genome",
            "genome.breeding",
        ),
        "simulation.validity",
    )
}
"""Modules, and the packages that importing them must not load."""

MAX_LINES = 300
MAX_MEDIAN_LINES = 130
MAX_TOP_LEVEL_ENTRIES = 20


def modules():
    """Yield the dotted name within walkerlab and the path of every file."""
    for path in sorted(PACKAGE.rglob("*.py")):
        parts = path.relative_to(PACKAGE).with_suffix("").parts
        yield ".".join(parts[:-1] if parts[-1] == "__init__" and len(parts) > 1 else parts), path


MODULES = dict(modules())


def top(module):
    return module.partition(".")[0]


def is_below(module, places):
    return any(module == place or module.startswith(f"{place}.") for place in places)


def imports(path):
    """Yield the dotted name of everything that a file imports, at any level."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        match node:
            case ast.Import(names=names):
                yield from (alias.name for alias in names)
            case ast.ImportFrom(module=module, names=names, level=0):
                yield from (f"{module}.{alias.name}" for alias in names)
            case ast.ImportFrom():
                raise AssertionError(f"{path} imports relatively; write the absolute name, walkerlab.…")


def imported_modules(path):
    """Return the walkerlab modules that a file imports: names of modules, not of their contents."""
    found = set()
    for name in imports(path):
        head, _, inside = name.partition(".")
        if head == "walkerlab":
            parts = inside.split(".")
            known = [".".join(parts[:n]) for n in range(len(parts), 0, -1) if ".".join(parts[:n]) in MODULES]
            found.add(known[0] if known else "__init__")
    return found


each_module = pytest.mark.parametrize("module", [module for module in MODULES if module != "__init__"])


def test_every_module_has_a_layer_and_every_layer_its_modules():
    assert {top(module) for module in MODULES} == {*LAYER, "__init__"}
    assert len(LAYER) == sum(map(len, LAYERS))


def test_the_top_folder_can_be_taken_in_at_a_glance():
    entries = [path for path in PACKAGE.iterdir() if path.name != "__pycache__"]
    assert len(entries) <= MAX_TOP_LEVEL_ENTRIES


def test_modules_are_short():
    lengths = {module: len(path.read_text(encoding="utf-8").splitlines()) for module, path in MODULES.items()}
    assert {module: n for module, n in lengths.items() if n > MAX_LINES} == {}
    assert median(lengths.values()) <= MAX_MEDIAN_LINES


@each_module
def test_imports_point_to_earlier_layers(module):
    here = top(module)
    for other in imported_modules(MODULES[module]):
        if other == "__init__":
            assert here in LAYERS[-1], f"{module} imports walkerlab itself, which only {LAYERS[-1]} may"
        elif top(other) != here:
            assert LAYER[top(other)] < LAYER[here], f"{module} imports {other}, which is in a later layer"
        for place, allowed in ONLY_FROM.items():
            if is_below(module, [place]) and not is_below(other, [place]):
                assert top(other) in allowed, f"{module} imports {other}, which {place} must not know"


def test_a_widget_that_can_be_used_alone_does_not_depend_on_the_panel():
    alone = [
        path for module, path in MODULES.items() if module.startswith("widgets.") and "panel" not in module.split(".")
    ]
    assert alone
    assert not {path: names for path in alone if (names := {one for one in imports(path) if "widgets.panel" in one})}


@pytest.mark.parametrize("folder", sorted({top(module) for module in MODULES if "." in module}))
def test_no_two_modules_of_a_folder_import_each_other(folder):
    graph = {
        module: imported_modules(path) - {module, *faces(module)}
        for module, path in MODULES.items()
        if top(module) == folder
    }
    TopologicalSorter(graph).prepare()  # raises CycleError, which shows the cycle


def faces(module):
    """Return the packages that a module is in: importing from them runs their ``__init__`` anyway."""
    parts = module.split(".")
    return {".".join(parts[:n]) for n in range(1, len(parts))}


@each_module
def test_each_package_is_imported_only_where_it_belongs(module):
    for name in imports(MODULES[module]):
        package = name.partition(".")[0]
        if package in ONLY_IN:
            assert is_below(module, ONLY_IN[package]), f"{module} imports {package}"


def test_importing_walkerlab_loads_nothing_else():
    tree = ast.parse(MODULES["__init__"].read_text(encoding="utf-8"))
    at_once = [node for node in tree.body if isinstance(node, ast.Import | ast.ImportFrom)]
    assert {node.module for node in at_once} == {"importlib", "typing"}


def test_no_module_requires_the_package_of_an_extra():
    for module, path in MODULES.items():
        for node in ast.parse(path.read_text(encoding="utf-8")).body:
            if isinstance(node, ast.ImportFrom):
                assert (node.module or "").removeprefix("walkerlab.") not in OPTIONAL, f"{module} imports {node.module}"


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
with warnings.catch_warnings():  # warnings of other packages
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
    """Import modules, in this order, in a new Python; return what each had loaded, and what it had changed."""
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


def test_light_modules_load_no_heavy_packages(folder):
    from_light_to_heavy = sorted(LIGHT, key=lambda name: (-len(LIGHT[name]), name))
    for _, names in groupby(from_light_to_heavy, key=lambda name: len(LIGHT[name])):
        loaded, _ = watched(folder, *names)
        for name, packages in loaded.items():
            assert not LIGHT[name] & set(packages), f"importing {name} loads them"


def test_importing_makes_no_file_thread_or_variable(folder):
    missing = {module for module, package in OPTIONAL.items() if not find_spec(package)}
    ours = [f"walkerlab.{module}" for module in MODULES if module not in {"__init__", "__main__", *missing}]
    optional = {*OPTIONAL.values()} - {OPTIONAL[module] for module in missing}
    theirs = ["dm_control.composer", *sorted(optional), "matplotlib.pyplot", "pandas"]
    _, changed = watched(folder, "walkerlab", *ours, after=theirs)
    assert changed == {name: [] for name in ["walkerlab", *ours]}
    assert not list(folder.iterdir())


def test_every_module_with_a_public_name_can_be_imported_first():
    """An import cycle through the ``__init__.py`` of a folder fails only if this module is imported first."""
    script = """
import importlib, sys
import walkerlab
for name in sorted({*walkerlab._DEFINING_MODULE.values(), *walkerlab._PUBLIC_MODULES.values()}):
    for module in [module for module in sys.modules if module.startswith("walkerlab.")]:
        del sys.modules[module]
    importlib.import_module(f"walkerlab.{name}")
"""
    subprocess.run([sys.executable, "-c", script], check=True)
