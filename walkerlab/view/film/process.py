"""Rendering of a film in a child process, which has an OpenGL context; a crash there does not end the caller."""

import os
import subprocess
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import IO, Any

from tqdm.auto import tqdm

from walkerlab.system.files import PathError, display_path, file_path, replace_atomically
from walkerlab.system.interrupts import interrupts_held
from walkerlab.view import opengl
from walkerlab.view.film.job import FilmError, Job

CHILD_PROGRAM = "import sys; sys.path.append(sys.argv[1]); from walkerlab.view.film.__main__ import main; main()"
"""Unlike ``python -m``, it finds this walkerlab in any folder, and ignores a ``random.py`` in the current one."""
PACKAGE_PARENT = Path(__file__).parents[3]


def render_film(job: Job, path: Path, *, progress: bool) -> None:
    """Render a film to a file; an existing file is replaced only when the film is complete.

    Args:
        job: Film to render.
        path: Path of the file.
        progress: Whether to show a progress bar.

    Raises:
        FilmError: If OpenGL is not available or the film cannot be written.
    """
    try:
        with replace_atomically(path) as part, tqdm(total=job.n_frames, unit=" frames", disable=not progress) as bar:
            _render_with_first_backend(job, part, bar.update)
    except FileNotFoundError as error:
        raise FilmError(str(error)) from error
    except OSError as error:
        where = display_path(path.parent)
        what = error.strerror or error
        raise FilmError(
            f"the film {path.name} cannot be written to {where}: {what}. Close programs that play it, or use another "
            "path."
        ) from error


def film_path(given: str | os.PathLike[str]) -> Path:
    """Make the path of a film absolute.

    Raises:
        FilmError: If no film can be written to this path.
    """
    try:
        return file_path(given)
    except PathError as error:
        raise FilmError(str(error)) from error


def _render_with_first_backend(job: Job, path: Path, on_frame: Callable[[int], object]) -> None:
    """Render with the first OpenGL backend that is available."""
    failures: list[str] = []
    for backend in opengl.candidate_backends():
        is_available, failure = _render_with_backend(job, path, backend, on_frame)
        if is_available and failure:
            raise FilmError(f"the film could not be rendered: {failure}")
        if is_available:
            return
        failures.append(f"{backend or 'default OpenGL'}: {failure}")
    raise FilmError(
        f"{opengl.unavailable_message()}. Only films need it; wl.replay shows the same walk without it.\n"
        f"How to fix it: {opengl.how_to_fix()}\n({'; '.join(failures)})"
    )


def _render_with_backend(job: Job, path: Path, backend: str, on_frame: Callable[[int], object]) -> tuple[bool, str]:
    """Render in a child process with one OpenGL backend.

    Returns:
        Whether the backend is available, and the reason for a failure, "" after a success.
    """
    command = [sys.executable, "-P", "-c", CHILD_PROGRAM, str(PACKAGE_PARENT)]
    environment = {**os.environ, **opengl.backend_environment(backend), "PYTHONIOENCODING": "utf-8"}
    pipes: dict[str, Any] = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "text": True, "encoding": "utf-8"}
    with tempfile.TemporaryFile("w+", encoding="utf-8", errors="replace") as stderr:
        child: subprocess.Popen[str] | None = None
        try:
            with interrupts_held():
                child = subprocess.Popen(command, stderr=stderr, env=environment, **pipes)
            is_available = _communicate(child, job.to_json(path.resolve()), on_frame)
            code = child.wait()
        finally:
            if child:
                _terminate(child)
        failure = "" if code == 0 else _last_line(stderr) or f"the process ended with code {code}"
        return is_available, failure


def _communicate(child: subprocess.Popen[str], job_json: str, on_frame: Callable[[int], object]) -> bool:
    """Send the job when the child reports an OpenGL context, and report its frames until it ends.

    Returns:
        Whether the child has created an OpenGL context.
    """
    assert child.stdin
    assert child.stdout
    has_context = False
    for line in child.stdout:
        keyword = line.split()[:1]
        if keyword == ["gl"]:
            has_context = True
            print(job_json, file=child.stdin, flush=True)
        elif keyword == ["frame"]:
            on_frame(1)
    return has_context


def _terminate(child: subprocess.Popen[str]) -> None:
    """Kill the child if it still runs, and close its pipes; Ctrl-C is delayed meanwhile."""
    with interrupts_held():
        child.kill()
        child.wait()
        for pipe in (child.stdin, child.stdout):
            try:
                if pipe:
                    pipe.close()
            except BrokenPipeError:
                pass


def _last_line(file: IO[str]) -> str:
    """Return the last line of a file that is not blank, or ""."""
    file.seek(0)
    return next((line.strip() for line in reversed(file.readlines()) if line.strip()), "")
