"""The command line: ``walkerlab evolve``, ``resume``, ``show``, ``rescue``, ``doctor`` and ``lab``."""

from __future__ import annotations  # for the doctor, whom a Python that is too old must be able to read

import _thread
import argparse
import os
import signal
import sys
import warnings
from collections.abc import Mapping, Sequence
from difflib import get_close_matches
from io import TextIOWrapper
from pathlib import Path
from typing import TextIO

import walkerlab as wl
from walkerlab.faults import Fault
from walkerlab.interrupts import interrupts_held
from walkerlab.markup import printable

INTERRUPTED = 130  # what a shell expects of a program that Ctrl-C ended
REFUSED = 2  # what it expects of one that was asked for something impossible


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command.

    Args:
        argv: its words, without the program's name; those of the command line if None.

    Returns:
        The exit code: 0; 1 if the doctor found a fault; 2 for a request that cannot be met; 130 after Ctrl-C.
    """
    words = sys.argv[1:] if argv is None else list(argv)
    if isinstance(sys.stdout, TextIOWrapper):
        sys.stdout.reconfigure(errors="backslashreplace")  # a folder's name may have letters that a terminal has not
    listener = signal.getsignal(signal.SIGINT)
    if argv is None:
        sys.unraisablehook = _pass_on
    try:
        return _doctor() if words == ["doctor"] else _obey(words)  # the doctor speaks where no grammar can be loaded
    except KeyboardInterrupt:
        return _say("\nStopped.", to=INTERRUPTED)
    except BrokenPipeError:  # whoever was reading has read enough, as in: walkerlab show walk | head
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    except ImportError as error:
        return _say(f"{error}\nFor the mend, ask: walkerlab doctor", to=1)
    except (Fault, OSError) as error:
        return _say(str(error), to=REFUSED)
    finally:
        if argv is None:
            _end_workers()
        else:
            signal.signal(signal.SIGINT, listener)


def _pass_on(lost: sys.UnraisableHookArgs) -> None:
    """Press Ctrl-C again where it came while Python was tidying up, and would be lost."""
    if lost.exc_type is KeyboardInterrupt:
        _thread.start_new_thread(_thread.interrupt_main, ())  # which comes when this is done
    else:
        sys.__unraisablehook__(lost)


def _end_workers() -> None:
    """Let Python end at once and undisturbed: it would wait for whoever walks, and Ctrl-C would break that off."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    if workers := sys.modules.get("walkerlab.workers"):
        workers.default_executor().end()


def _obey(words: Sequence[str]) -> int:
    """Run the command that the words name."""
    with interrupts_held():
        parser, commands = _grammar()
    if not words:
        parser.print_help()
        return 0
    if words[0] not in commands and not words[0].startswith("-"):
        return _say(_no_such_command(words[0], commands), to=REFUSED)
    given, strangers = parser.parse_known_args(words)
    if strangers and given.run is not _evolve:
        parser.error(f"{given.command} does not know: {' '.join(strangers)}")
    given.strangers = strangers
    with warnings.catch_warnings():
        warnings.showwarning = lambda message, *_, **__: print(f"\nNote: {message}", file=sys.stderr)
        try:
            return given.run(given)
        except KeyboardInterrupt:
            signal.signal(signal.SIGINT, signal.SIG_IGN)  # it has been heard
            return _say(f"\n{_stopped(given)}", to=INTERRUPTED)
        except Fault as error:
            if kept := getattr(error, "run", None):
                return _say(f"\n{error}\n{_kept(kept)}", to=1)
            raise


def _stopped(given: argparse.Namespace) -> str:
    """Say how far a command had come that was stopped."""
    if given.run not in (_evolve, _resume):
        return "Stopped."
    try:
        return _kept(wl.load(given.path if given.run is _resume else given.out))
    except wl.RunFileError:
        return "Stopped before the first generation was done, so there is nothing to keep."


def _kept(run: wl.Run) -> str:
    """Say what is kept of a run that was stopped, and how to go on with it."""
    done, wanted = run.n_generations, run.settings.algorithm.generations
    return (
        f"Stopped after {done} of {wanted} generations; all of these are kept.\n"
        f"Go on, and have all files made: walkerlab resume {_named(run)}"
    )


def _grammar() -> tuple[argparse.ArgumentParser, Mapping[str, argparse.ArgumentParser]]:
    """Return the parser of all, and that of each command."""
    from walkerlab.commands import flags

    parser = argparse.ArgumentParser(
        prog="walkerlab",
        description="Evolve walking robots with a genetic algorithm.",
        epilog="Start with: walkerlab evolve",
        allow_abbrev=False,
    )
    commands = parser.add_subparsers(title="commands", dest="command", metavar="COMMAND", required=True)

    def command(name: str, run: object, about: str, usage: str) -> argparse.ArgumentParser:
        added = commands.add_parser(
            name,
            help=about,
            description=f"{about[0].upper()}{about[1:]}.",
            usage=f"walkerlab {name} {usage}",
            formatter_class=flags.Help,
            allow_abbrev=False,
        )
        added.set_defaults(run=run)
        return added

    evolve = command(
        "evolve", _evolve, "evolve walkers into a new folder", "[--out FOLDER] [--quiet] [--SETTING VALUE ...]"
    )
    evolve.add_argument("--out", type=Path, default=Path("walk"), metavar="FOLDER", help="where to put it all [walk]")
    evolve.add_argument("--quiet", action="store_true", help="say nothing unless something is wrong")
    flags.add_flags(evolve)

    resume = command("resume", _resume, "go on with a run", "PATH [--generations N] [--quiet]")
    resume.add_argument("path", type=Path, metavar="PATH", help="a run file, or the folder with it")
    resume.add_argument("--generations", type=int, metavar="N", help="how many it shall have in all")
    resume.add_argument("--quiet", action="store_true", help="say nothing unless something is wrong")

    show = command("show", _show, "show what a run has brought forth", "PATH")
    show.add_argument("path", type=Path, metavar="PATH", help="a run file, or the folder with it")

    rescue = command("rescue", _rescue, "save what is whole of a damaged run", "PATH [--out FOLDER]")
    rescue.add_argument("path", type=Path, metavar="PATH", help="a run file, or the folder with it")
    rescue.add_argument(
        "--out", type=Path, default=Path("rescued"), metavar="FOLDER", help="where to put the new run [rescued]"
    )

    command("doctor", _doctor, "say what this machine can do, and how to mend what it cannot", "")

    lab = command("lab", _lab, "open JupyterLab on copies of the notebooks", "[--no-browser] [--port N] [--allow-root]")
    lab.add_argument("--no-browser", action="store_true", help="only print the address")
    lab.add_argument("--port", type=int, metavar="N", help="the port to listen at, on this computer only")
    lab.add_argument("--allow-root", action="store_true", help="run as root, as in a container")
    return parser, commands.choices


def _no_such_command(word: str, commands: Mapping[str, object]) -> str:
    guess = get_close_matches(word, commands, n=1)
    mend = f"Did you mean: walkerlab {guess[0]}?" if guess else f"There are {', '.join(commands)}."
    return f"There is no command {word!r}. {mend}"


def _evolve(given: argparse.Namespace) -> int:
    with interrupts_held():
        from walkerlab import story
        from walkerlab.commands import flags
        from walkerlab.store import RUN_FILE
        from walkerlab.workers import n_cores

    settings = flags.settings_of(vars(given), given.strangers)
    path = given.out / RUN_FILE
    if path.exists():
        raise wl.RunFileError(
            f"{given.out} holds a run already, and a run is never written over.\n"
            f"Go on with it:    walkerlab {_to_go_on(wl.load(path))}\n"
            f"Begin a new one:  walkerlab evolve --out ANOTHER-FOLDER"
        )
    if not given.quiet:
        print(story.opening(settings, n_cores()), flush=True)
    with interrupts_held():
        from walkerlab import evolution  # for which mujoco is loaded
    try:
        run = evolution.evolve(settings, path, progress=not given.quiet)
    except KeyboardInterrupt:
        if not path.exists():
            raise
        run = wl.load(path)
    return _finish(run, quiet=given.quiet)


def _resume(given: argparse.Namespace) -> int:
    with interrupts_held():
        from walkerlab import outputs, story
        from walkerlab.run import with_functions
        from walkerlab.workers import n_cores

    run = with_functions(wl.load(given.path), {})
    done, wanted = run.n_generations, given.generations
    wanted = run.settings.algorithm.generations if wanted is None else wanted
    if done == wanted and run.path:
        if not all((run.path.parent / name).exists() for name in outputs.FILES):  # stopped when all but these was done
            outputs.write(run, run.path.parent)
        if not given.quiet:
            print(f"All {done} generations are done; to go on: walkerlab {_to_go_on(run)}")
        return 0
    if not given.quiet and done < wanted:
        print(story.opening(run.settings.with_(generations=wanted), n_cores(), done=done), flush=True)
    return _finish(wl.resume(given.path, given.generations, progress=not given.quiet), quiet=given.quiet)


def _to_go_on(run: wl.Run) -> str:
    """Give the words that resume a run: to its end, or if it is there, to twice as many generations."""
    done, wanted = run.n_generations, run.settings.algorithm.generations
    return f"resume {_named(run)}" + (f" --generations {2 * done}" if done == wanted else "")


def _named(run: wl.Run) -> str:
    """Name a run as briefly as a shell takes it: by its folder, if its file is the run file of that folder."""
    from walkerlab import store

    assert run.path
    name = str(run.path.parent if run.path.name == store.RUN_FILE else run.path)
    return f'"{name}"' if " " in name else name


def _finish(run: wl.Run, *, quiet: bool) -> int:
    """Write what belongs into the run's folder, and say what has come of it and what to do next."""
    with interrupts_held():
        from walkerlab import outputs, story

    assert run.path
    folder, wanted = run.path.parent, run.settings.algorithm.generations
    stopped = run.n_generations < wanted
    if stopped:
        print(f"\n{_kept(run)}", file=sys.stderr if quiet else sys.stdout)
    if not quiet:
        print()
        _tell(story.champion_story(run.records, run.settings.model_dump()))
        if run.champion.verdict == "ok":
            print(run.confirm())
        print("\nDrawing the report …", flush=True)
    outputs.write(run, folder)
    if not quiet:
        print(f"\nIn the folder {folder} there are now")
        print("\n".join(f"  {name:13} {about}" for name, about in outputs.FILES.items()))
        print("\nWhat next?")
        next_steps = {
            f"show {_named(run)}": "what happened, and the champion's family",
            _to_go_on(run): "evolve on",
            "lab": "play with walkers in notebooks",
        }
        width = max(map(len, next_steps))
        print("\n".join(f"  walkerlab {words:{width}}   {about}" for words, about in next_steps.items()))
    return INTERRUPTED if stopped else 0


def _show(given: argparse.Namespace) -> int:
    from walkerlab import store, story

    run, path = wl.load(given.path), store.locate(given.path)
    settings, records = run.settings.model_dump(), run.records
    _tell(f"{path}: {run.n_generations} of {run.settings.algorithm.generations} generations")
    whose, made_with = store.read_facts(path)
    for about, facts in (("it has", whose), ("made with", made_with)):
        _tell(f"{about} {', '.join(f'{name} {fact}' for name, fact in facts.items())}")
    _tell(f"\n{story.changed_settings(settings)}")
    best = run.champion
    for part in (
        story.by_generation(records, settings),
        story.verdict_counts(records),
        story.champion_story(records, settings),
        story.gene(best),
        story.descent(records, best.individual),
    ):
        _tell(f"\n{part}")
    return 0


def _rescue(given: argparse.Namespace) -> int:
    from walkerlab.store import RUN_FILE

    run = wl.rescue(given.path, given.out / RUN_FILE)
    done, wanted = run.n_generations, run.settings.algorithm.generations
    print(f"{done} of {wanted} generations are whole, and saved in {given.out}; {given.path} is left as it was.")
    print(f"Go on with them: walkerlab {_to_go_on(run)}")
    return 0


def _doctor(_: argparse.Namespace | None = None) -> int:
    from walkerlab.commands import doctor

    faults = 0
    for finding in doctor.examine():
        print(finding, flush=True)
        faults += finding.level == "fault"
    print(
        "\nMend the faults above, and ask again." if faults else "\nThis machine can evolve walkers: walkerlab evolve"
    )
    return 1 if faults else 0


def _lab(given: argparse.Namespace) -> int:
    from walkerlab.commands import lab

    folder = Path(lab.FOLDER)
    copied = lab.copy_notebooks(folder)
    notebooks = f"{len(copied)} notebook{'' if len(copied) == 1 else 's'}"
    new = f"New in {folder}: {notebooks}." if copied else f"All notebooks are in {folder} already."
    print(f"{new} What was there before stays as it was.", flush=True)
    options = [f"--{name.replace('_', '-')}" for name in ("no_browser", "allow_root") if getattr(given, name)]
    options += [f"--port={given.port}"] if given.port else []
    try:
        lab.open_lab(folder, options)
    except ImportError:
        return _say(f'JupyterLab is not installed. Mend: "{sys.executable}" -m pip install jupyterlab', to=REFUSED)
    return 0


def _tell(text: str, to: TextIO | None = None) -> None:
    """Print what has texts from a file or a user in it: none of them may move the cursor."""
    print(printable(text, keep="\n"), file=to)


def _say(message: str, *, to: int) -> int:
    """Tell people on stderr, and return the exit code."""
    _tell(message, to=sys.stderr)
    return to


if __name__ == "__main__":
    sys.exit(main())
