"""What to type on this very computer: how it gets packages, loses a variable, and is granted more cores."""

from __future__ import annotations  # for the doctor, whom a Python that is too old must be able to read

import json
import os
import platform
import sys
import sysconfig
from importlib.metadata import PackageNotFoundError, distribution, version
from importlib.util import find_spec
from pathlib import Path
from urllib.parse import urlparse
from urllib.request import url2pathname

from walkerlab.view.opengl import adapt_sudo

HOME = "walkers"  # the virtual environment that is proposed


def unset(name: str) -> str:
    """Say how a variable is taken away."""
    return f"Remove-Item Env:{name}" if os.name == "nt" else f"unset {name}"


CORES = {
    "machine": ("", "nothing is broken; for a quicker run take fewer robots: walkerlab evolve --population-size 12"),
    "LOKY_MAX_CPU_COUNT": ("LOKY_MAX_CPU_COUNT says so", unset("LOKY_MAX_CPU_COUNT")),
    "affinity": (
        "this process is bound to them",
        "start it without taskset; in a batch job ask for more cores (Slurm: --cpus-per-task=4)",
    ),
    "limit": (
        "a container or a service is granted no more",
        "have its limit raised (Docker: --cpus=4, Kubernetes: resources.limits.cpu, JupyterHub: c.Spawner.cpu_limit)",
    ),
}
"""Why fewer cores than the machine has may be used, and how it is granted more."""


def install(*requirements: str) -> str:
    """Say how packages get into the Python that is running; where it takes none, how to make one that does."""
    if not takes_packages():
        return new_environment(typed(Path(sys.executable)))
    wanted = " ".join(f'"{one}"' if set(one) & set("<>;*[ ") else one for one in requirements)
    python = typed(Path(sys.executable))
    fetch_pip = "" if find_spec("pip") else f"{python} -m ensurepip\n"
    return f"{fetch_pip}{python} -m pip install {wanted}"


def takes_packages() -> bool:
    """Tell whether pip may put anything into the Python that is running."""
    if sys.prefix != sys.base_prefix:  # a virtual environment, perhaps somebody else's
        return os.access(sysconfig.get_path("purelib"), os.W_OK)
    return not Path(sysconfig.get_path("stdlib"), "EXTERNALLY-MANAGED").exists()  # PEP 668


def new_environment(python: str) -> str:
    """Say how this user gets a virtual environment with walkerlab in it.

    Args:
        python: the command of the Python to make it with.
    """
    inside = rf"{HOME}\Scripts\python" if os.name == "nt" else f"{HOME}/bin/python"
    is_split = platform.system() == "Linux" and not find_spec("ensurepip")  # as Debian splits it
    first = f"{adapt_sudo('sudo apt-get update && sudo apt-get install python3-venv')}\n" if is_split else ""
    return f"{first}{python} -m venv {HOME}\n{inside} -m pip install {source()}"


def newer_python(needed: str) -> str:
    """Say how this system gets a Python that is new enough."""
    where, python = {
        "Windows": ("winget install Python.Python.3.12", "py -3.12"),
        "Darwin": (f"take Python {needed} or newer from python.org, and then", "python3"),
    }.get(platform.system(), (f"install Python {needed} or newer, python3.12 say, and then", "python3.12"))
    return f"{where}\n{new_environment(python)}"


def source() -> str:
    """Name what walkerlab is installed from: its checkout, or the folder that it came from."""
    checkout = Path(__file__).parents[3]
    if (checkout / "pyproject.toml").is_file():
        return typed(checkout)
    try:
        url = urlparse(json.loads(distribution("walkerlab").read_text("direct_url.json") or "{}").get("url", ""))
    except (PackageNotFoundError, ValueError):
        return "walkerlab"
    return typed(Path(url2pathname(url.path))) if url.scheme == "file" else url.geturl() or "walkerlab"


def typed(path: Path) -> str:
    """Write a path as a shell takes it."""
    if not set(str(path)) & set(" ()&;'"):
        return str(path)
    return f'& "{path}"' if os.name == "nt" and path.suffix == ".exe" else f'"{path}"'  # as PowerShell has it


def repair(package: str, said: str) -> str:
    """Say how a package that is there, but cannot be loaded, is mended.

    Args:
        package: its name.
        said: of what its import died.
    """
    missing = said.partition("No module named")[2]
    if missing and package.replace("-", "_") not in missing:  # what the package needs itself
        return install(source())
    return install("--force-reinstall", "--no-deps", f"{package}=={version(package)}")


def workers(said: str) -> str:
    """Say how worker processes are let start, by what their start died of."""
    causes = {
        "Permission denied": "as root: chmod 1777 /dev/shm",
        "Read-only": "as root: mount -o remount,rw /dev/shm",
        "No space left": "there is no shared memory left: close other programs; docker run --shm-size=1g",
        "temporarily unavailable": "too many processes are running: close some, or raise the limit, ulimit -u",
        "Function not implemented": "mount /dev/shm: there is no shared memory here",
    }
    meanwhile = "in Python meanwhile: wl.evolve(settings, executor=concurrent.futures.ThreadPoolExecutor(2))"
    return "\n".join([*(mend for cause, mend in causes.items() if cause in said), meanwhile])
