"""Command ``lab``: open JupyterLab on copies of the notebooks."""

import argparse
import os
import secrets
import shutil
import sys
from collections.abc import Sequence
from pathlib import Path

from walkerlab.commands.terminal import INVALID_REQUEST, print_error
from walkerlab.settings.classroom import CLASS_VARIABLE, Classroom, read_class
from walkerlab.settings.values import pluralize
from walkerlab.system.files import absolute_path, display_path, replace_atomically
from walkerlab.system.package_files import find_package_file

NOTEBOOKS_FOLDER = "walkerlab-notebooks"
SOURCE_FOLDER = "notebooks"
STUDENT_FILES = ("*.ipynb", "*.md", "pictures/*.png")
TEACHER_FILES = ("teacher/*.ipynb", "teacher/*/*.md")
INDEX = "index.ipynb"

LOCAL_ONLY_OPTIONS = [
    "--ServerApp.ip=127.0.0.1",
    "--ServerApp.allow_remote_access=False",
    "--KernelManager.ip=127.0.0.1",
    "--ServerKernelManager.ip=127.0.0.1",
]
"""Options that limit access to the server and its kernels to this computer; they override the user's configuration."""


def copy_files(folder: Path, *, teacher: bool = False) -> list[Path]:
    """Copy notebooks, pictures and glossary into a folder, apart from files that it contains already.

    Args:
        folder: Folder of the copies; created if it is missing.
        teacher: Whether to copy the notebooks with answers, the guides and the sheets, too.

    Returns:
        The new copies.
    """
    source = find_package_file(SOURCE_FOLDER)
    patterns = STUDENT_FILES + (TEACHER_FILES if teacher else ())
    originals = sorted(path for pattern in patterns for path in source.glob(pattern))
    copies = [(original, folder / original.relative_to(source)) for original in originals]
    new = [(original, copy) for original, copy in copies if not copy.exists()]
    for original, copy in new:
        copy.parent.mkdir(parents=True, exist_ok=True)
        with replace_atomically(copy) as temporary:
            shutil.copyfile(original, temporary)
    return [copy for _, copy in new]


def open_lab(folder: Path, page: str, options: Sequence[str] = ()) -> None:
    """Run JupyterLab on a folder, with a notebook open, until it is stopped.

    It is reachable from this computer only, with its token or with the password that the user has configured.

    Args:
        folder: Folder that JupyterLab shows.
        page: Path of the notebook in the folder.
        options: Further options of JupyterLab.

    Raises:
        ImportError: If JupyterLab is not installed.
    """
    from jupyterlab.labapp import LabApp  # type: ignore[import-untyped]

    root = f"--ServerApp.root_dir={folder.resolve()}"
    # A file name as an argument would make the server print the address of the Launcher instead.
    address = f"--LabApp.default_url=/lab/tree/{page}"
    server = LabApp.initialize_server([root, *LOCAL_ONLY_OPTIONS, address, *options])
    if not getattr(server.identity_provider, "hashed_password", "") and not server.identity_provider.token:
        server.identity_provider.token = secrets.token_hex(24)
        server.identity_provider.token_generated = True  # so that the printed address contains it
    server.start()


def describe_class(classroom: Classroom) -> str:
    """Return a line on the limits of a class."""
    facts = [f"{pluralize(len(classroom.locked), 'setting')} fixed"]
    facts += [f"at most {classroom.budget:,} walks for a run"] if classroom.budget else []
    facts += [f"robots are handed in to {display_path(classroom.shared_folder)}"] if classroom.shared_folder else []
    return f"Class {classroom.name}: {', '.join(facts)}.".replace("Class :", "Class:")


def run_lab(arguments: argparse.Namespace) -> int:
    """Copy the notebooks and open JupyterLab on their index; return the exit code.

    Raises:
        SettingsError: If the file of the class is wrong.
    """
    if arguments.class_file:
        classroom = read_class(arguments.class_file)
        os.environ[CLASS_VARIABLE] = str(absolute_path(arguments.class_file))  # the kernels inherit it
        print(describe_class(classroom), flush=True)
    folder = Path(NOTEBOOKS_FOLDER)
    try:
        copied = copy_files(folder, teacher=arguments.teacher)
    except OSError as error:
        return print_error(
            f"The notebooks cannot be copied into {NOTEBOOKS_FOLDER}: {error.strerror or error}. Change to a folder "
            "that you can write to.",
            INVALID_REQUEST,
        )
    files = f"{len(copied)} file{'' if len(copied) == 1 else 's'}"
    new = f"New in {NOTEBOOKS_FOLDER}: {files}." if copied else f"All notebooks are in {NOTEBOOKS_FOLDER} already."
    print(f"{new} Existing files were not changed.", flush=True)
    options = [f"--{name.replace('_', '-')}" for name in ("no_browser", "allow_root") if getattr(arguments, name)]
    options += [f"--port={arguments.port}"] if arguments.port else []
    try:
        open_lab(folder, f"teacher/{INDEX}" if arguments.teacher else INDEX, options)
    except ImportError:
        return print_error(
            f'JupyterLab is not installed. To fix it: "{sys.executable}" -m pip install jupyterlab', INVALID_REQUEST
        )
    return 0
