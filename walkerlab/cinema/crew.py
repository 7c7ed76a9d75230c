"""Has a film made in a process of its own: one that has a GL, and whose crash hurts nobody."""

import os
import subprocess
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import IO, Any

from tqdm.auto import tqdm

from walkerlab import graphics
from walkerlab.cinema.job import FilmError, Job
from walkerlab.files import PathError, file_path, replacing, shown
from walkerlab.interrupts import interrupts_held

START = "import sys; sys.path.append(sys.argv[1]); from walkerlab.cinema.__main__ import main; main()"
"""Unlike ``-m``, it finds walkerlab wherever it is, and never a ``random.py`` of the user's own."""
HOME = Path(__file__).parents[2]


def make(job: Job, path: Path, *, progress: bool) -> None:
    """Make a film; what was at the path before stays there until the film is whole.

    Raises:
        FilmError: if there is no GL, or the film cannot be written.
    """
    try:
        with replacing(path) as part, tqdm(total=job.n_frames, unit=" frames", disable=not progress) as bar:
            _draw(job, part, bar.update)
    except FileNotFoundError as error:
        raise FilmError(str(error)) from error
    except OSError as error:
        where, what = shown(path.parent), error.strerror or error
        raise FilmError(f"the film {path.name} cannot be written to {where}: {what}. Is it being played?") from error


def film_path(given: str | os.PathLike[str]) -> Path:
    """Make the path of a film absolute.

    Raises:
        FilmError: If no film can be written to this path.
    """
    try:
        return file_path(given)
    except PathError as error:
        raise FilmError(str(error)) from error


def _draw(job: Job, part: Path, on_frame: Callable[[int], object]) -> None:
    """Draw with the first GL that there is."""
    told: list[str] = []
    for backend in graphics.backends():
        has_gl, fault = _try(job, part, backend, on_frame)
        if has_gl and fault:
            raise FilmError(f"the film could not be made: {fault}")
        if has_gl:
            return
        told.append(f"{backend or 'the default GL'}: {fault}")
    raise FilmError(
        f"There is {graphics.missing_gl()}, which only films need: wl.replay shows the same walk here and now.\n"
        f"The mend: {graphics.mend()}\n({'; '.join(told)})"
    )


def _try(job: Job, part: Path, backend: str, on_frame: Callable[[int], object]) -> tuple[bool, str]:
    """Try one backend: whether it is a GL, and what went wrong, if anything did."""
    command = [sys.executable, "-P", "-c", START, str(HOME)]
    environment = {**os.environ, **graphics.variables(backend), "PYTHONIOENCODING": "utf-8"}
    pipes: dict[str, Any] = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "text": True, "encoding": "utf-8"}
    with tempfile.TemporaryFile("w+", encoding="utf-8", errors="replace") as complaints:
        child: subprocess.Popen[str] | None = None
        try:
            with interrupts_held():
                child = subprocess.Popen(command, stderr=complaints, env=environment, **pipes)
            has_gl = _follow(child, job.to_json(part.resolve()), on_frame)
            code = child.wait()
        finally:
            if child:
                _end(child)
        return has_gl, "" if code == 0 else _last_line(complaints) or f"it ended with code {code}"


def _follow(child: subprocess.Popen[str], order: str, on_frame: Callable[[int], object]) -> bool:
    """Hand over what is to be done, and listen till the end; return whether there was a GL."""
    assert child.stdin
    assert child.stdout
    has_gl = False
    for line in child.stdout:
        word = line.split()[:1]
        if word == ["gl"]:
            has_gl = True
            print(order, file=child.stdin, flush=True)
        elif word == ["frame"]:
            on_frame(1)
    return has_gl


def _end(child: subprocess.Popen[str]) -> None:
    """End it, if it has not ended by itself, and close what was open to it; not even Ctrl-C stops that."""
    with interrupts_held():
        child.kill()
        child.wait()
        for pipe in (child.stdin, child.stdout):
            try:
                if pipe:
                    pipe.close()
            except BrokenPipeError:
                pass


def _last_line(complaints: IO[str]) -> str:
    complaints.seek(0)
    return next((line.strip() for line in reversed(complaints.readlines()) if line.strip()), "")
