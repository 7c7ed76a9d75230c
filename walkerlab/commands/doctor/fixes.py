"""Commands and instructions that fix a fault on this computer."""

from __future__ import annotations  # old versions of Python must be able to import this file

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

ENVIRONMENT_FOLDER = "walkers"  # folder of the virtual environment that is suggested

FIRST_PYTHON_WITHOUT_LABMAZE = (3, 13)  # dm_control requires labmaze, which walkerlab does not use


def unset_variable(name: str) -> str:
    """Return the command that removes an environment variable."""
    return f"Remove-Item Env:{name}" if os.name == "nt" else f"unset {name}"


CORE_LIMITS = {
    "machine": ("", "this is not a fault; for a faster run use fewer robots: walkerlab evolve --population-size 12"),
    "LOKY_MAX_CPU_COUNT": ("limited by LOKY_MAX_CPU_COUNT", unset_variable("LOKY_MAX_CPU_COUNT")),
    "affinity": (
        "limited by the CPU affinity of this process",
        "start it without taskset; in a batch job request more cores (Slurm: --cpus-per-task=4)",
    ),
    "limit": (
        "limited by a container or a service",
        "raise its limit (Docker: --cpus=4, Kubernetes: resources.limits.cpu, JupyterHub: c.Spawner.cpu_limit)",
    ),
}
"""Reasons why not all cores may be used, each with a description and a fix."""


def install_commands(*requirements: str) -> str:
    """Return the commands that install packages; in a new environment if this Python does not allow it."""
    if not allows_packages():
        return create_environment(quote_path(Path(sys.executable)))
    quoted = " ".join(f'"{one}"' if set(one) & set("<>;*[ ") else one for one in requirements)
    python = quote_path(Path(sys.executable))
    get_pip = "" if find_spec("pip") else f"{python} -m ensurepip\n"
    dm_control = install_dm_control(python) if find_source() in requirements else ""
    return f"{get_pip}{dm_control}{python} -m pip install {quoted}"


def install_dm_control(python: str) -> str:
    """Return the command that must precede the installation of walkerlab with this version of Python; "" if none must.

    Args:
        python: Command of the Python into which walkerlab is installed.
    """
    return f"{python} -m pip install --no-deps dm-control\n" if sys.version_info >= FIRST_PYTHON_WITHOUT_LABMAZE else ""


def allows_packages() -> bool:
    """Return whether pip may install packages into the Python that is running."""
    if sys.prefix != sys.base_prefix:  # a virtual environment, perhaps of another user
        return os.access(sysconfig.get_path("purelib"), os.W_OK)
    return not Path(sysconfig.get_path("stdlib"), "EXTERNALLY-MANAGED").exists()  # PEP 668


def create_environment(python: str) -> str:
    """Return the commands that create a virtual environment with walkerlab.

    Args:
        python: Command of the Python that creates it.
    """
    inside = rf"{ENVIRONMENT_FOLDER}\Scripts\python" if os.name == "nt" else f"{ENVIRONMENT_FOLDER}/bin/python"
    is_split = platform.system() == "Linux" and not find_spec("ensurepip")  # a separate package on Debian
    install_venv = f"{adapt_sudo('sudo apt-get update && sudo apt-get install python3-venv')}\n" if is_split else ""
    create = f"{install_venv}{python} -m venv {ENVIRONMENT_FOLDER}\n"
    return f"{create}{install_dm_control(inside)}{inside} -m pip install {find_source()}"


def install_python(needed: str) -> str:
    """Return the instructions that install a newer Python on this system."""
    instruction, python = {
        "Windows": ("winget install Python.Python.3.12", "py -3.12"),
        "Darwin": (f"install Python {needed} or newer from python.org, then run", "python3"),
    }.get(platform.system(), (f"install Python {needed} or newer, for example python3.12, then run", "python3.12"))
    return f"{instruction}\n{create_environment(python)}"


def find_source() -> str:
    """Return the source of this walkerlab, as an argument of pip: a checkout, a folder, an address, or its name."""
    checkout = Path(__file__).parents[3]
    if (checkout / "pyproject.toml").is_file():
        return quote_path(checkout)
    try:
        url = urlparse(json.loads(distribution("walkerlab").read_text("direct_url.json") or "{}").get("url", ""))
    except (PackageNotFoundError, ValueError):
        return "walkerlab"
    return quote_path(Path(url2pathname(url.path))) if url.scheme == "file" else url.geturl() or "walkerlab"


def quote_path(path: Path) -> str:
    """Quote a path for a shell."""
    if not set(str(path)) & set(" ()&;'"):
        return str(path)
    return f'& "{path}"' if os.name == "nt" and path.suffix == ".exe" else f'"{path}"'  # syntax of PowerShell


def reinstall_command(package: str, error: str) -> str:
    """Return the command that fixes an installed package that cannot be imported.

    Args:
        package: Name of the package.
        error: Error message of its import.
    """
    missing = error.partition("No module named")[2]
    if missing and package.replace("-", "_") not in missing:  # a dependency of the package
        return install_commands(find_source())
    return install_commands("--force-reinstall", "--no-deps", f"{package}=={version(package)}")


def allow_workers(error: str) -> str:
    """Return how to make worker processes start, from the error message of their start."""
    fixes = {
        "Permission denied": "as root: chmod 1777 /dev/shm",
        "Read-only": "as root: mount -o remount,rw /dev/shm",
        "No space left": "shared memory is full: close other programs; in Docker: docker run --shm-size=1g",
        "temporarily unavailable": "too many processes: close some, or raise the limit with ulimit -u",
        "Function not implemented": "there is no shared memory: mount /dev/shm",
    }
    workaround = "until then, in Python: wl.evolve(settings, executor=concurrent.futures.ThreadPoolExecutor(2))"
    return "\n".join([*(fix for cause, fix in fixes.items() if cause in error), workaround])
