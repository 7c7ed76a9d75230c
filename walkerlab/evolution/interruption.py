"""Save a run that ends early, and report how to resume it."""

from pathlib import Path

from walkerlab.evolution.stored_functions import user_functions
from walkerlab.runfile.archive import Archive
from walkerlab.runfile.opening import RunFileError
from walkerlab.settings.settings import Settings
from walkerlab.settings.values import pluralize
from walkerlab.system.files import display_path


def save_after(error: Exception, archive: Archive, settings: Settings, n_generations: int) -> None:
    """Make sure that a run is in a named file, and add a note to the error that says how to resume it.

    Args:
        error: Error that ends the run; its attribute ``saved_path`` becomes the path of the file.
        archive: Generations of the run.
        settings: Settings of the run.
        n_generations: Number of generations that are done.
    """
    try:
        path = archive.save()
    except RunFileError as problem:
        error.add_note(str(problem))
        return
    saved = f"The run is saved in {display_path(path)}, with {pluralize(n_generations, 'generation')}."
    if not n_generations:
        saved = f"No generation was completed; the settings are saved in {display_path(path)}."
    error.saved_path = path  # type: ignore[attr-defined]
    error.add_note(f"{saved} Fix the error, then resume with:\n    run = {_resume_call(path, settings)}")


def interrupted_message(path: Path | None, settings: Settings) -> str:
    """Return what is saved of a run that was interrupted in its first generation, and how to resume it.

    Args:
        path: Run file, or None.
        settings: Settings of the run.
    """
    if not path:
        return "before the first generation was complete; the run has no file, so nothing was saved"
    return (
        f"before the first generation was complete; the settings are saved, resume with: {_resume_call(path, settings)}"
    )


def _resume_call(path: Path, settings: Settings) -> str:
    """Return the Python call that resumes a run."""
    functions = "".join(f", {slot}={code}" for slot, code in user_functions(settings).items())
    return f"wl.resume({display_path(path)!r}{functions})"
