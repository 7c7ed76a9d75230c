"""The command line: ``walkerlab evolve``, ``resume``, ``show``, ``doctor`` and ``lab``."""

import argparse
import os
import sys
from collections.abc import Sequence
from pathlib import Path

import walkerlab as wl
from walkerlab.commands import flags
from walkerlab.interrupts import interrupts_held
from walkerlab.quantity import SettingsError

INTERRUPTED = 130  # what a shell expects of a program that Ctrl-C ended
REFUSED = 2  # what it expects of one that was asked for something impossible


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command.

    Args:
        argv: its words, without the program's name; those of the command line if None.

    Returns:
        The exit code: 0; 1 if the doctor found a fault; 2 for a request that cannot be met; 130 after Ctrl-C.
    """
    parser = _grammar()
    given, strangers = parser.parse_known_args(argv)
    if strangers and given.run is not _evolve:
        parser.error(f"{given.command} does not know: {' '.join(strangers)}")
    given.strangers = strangers
    try:
        return given.run(given)
    except KeyboardInterrupt:
        return _say("\nStopped.", to=INTERRUPTED)
    except BrokenPipeError:  # whoever was reading has read enough, as in: walkerlab show walk | head
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    except ImportError as error:
        return _say(f"{error}\nFor the mend, ask: walkerlab doctor", to=1)
    except (SettingsError, wl.RunFileError, OSError) as error:
        return _say(str(error), to=REFUSED)


def _grammar() -> argparse.ArgumentParser:
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

    command("doctor", _doctor, "say what this machine can do, and how to mend what it cannot", "")

    lab = command("lab", _lab, "open JupyterLab on copies of the notebooks", "[--no-browser] [--port N] [--allow-root]")
    lab.add_argument("--no-browser", action="store_true", help="only print the address")
    lab.add_argument("--port", type=int, metavar="N", help="the port to listen at, on this computer only")
    lab.add_argument("--allow-root", action="store_true", help="run as root, as in a container")
    return parser


def _evolve(given: argparse.Namespace) -> int:
    with interrupts_held():
        from walkerlab.commands.outputs import RUN_FILE
        from walkerlab.evaluation import n_cores

    settings = flags.settings_of(vars(given), given.strangers)
    path = given.out / RUN_FILE
    if path.exists():
        raise wl.RunFileError(
            f"{given.out} holds a run already, and a run is never written over.\n"
            f"Go on with it:    walkerlab resume {path}\n"
            f"Begin a new one:  walkerlab evolve --out ANOTHER-FOLDER"
        )
    if not given.quiet:
        algorithm = settings.algorithm
        print(f"{algorithm.population_size} robots, {algorithm.generations} generations, {n_cores()} cores. ", end="")
        print("Ctrl-C stops early and keeps what is done.", flush=True)
    try:
        run = wl.evolve(settings, path, progress=not given.quiet)
    except KeyboardInterrupt:
        if path.exists() and wl.load(path).n_generations:
            return _finish(wl.load(path), quiet=given.quiet)
        path.unlink(missing_ok=True)  # it is ours, made a moment ago, and empty
        return _say("\nStopped before the first generation was done, so there is nothing to keep.", to=INTERRUPTED)
    return _finish(run, quiet=given.quiet)


def _resume(given: argparse.Namespace) -> int:
    with interrupts_held():
        path = _run_file(given.path)
    done = wl.load(path).n_generations
    if given.generations is not None and given.generations < done:
        raise SettingsError(f"{path} has {done} generations already; --generations must be {done} or more, in all.")
    return _finish(wl.resume(path, given.generations, progress=not given.quiet), quiet=given.quiet)


def _finish(run: "wl.Run", *, quiet: bool) -> int:
    """Write what belongs into the run's folder, and say what has come of it and what to do next."""
    from walkerlab.commands import outputs, report

    assert run.path
    folder, wanted = run.path.parent, run.settings.algorithm.generations
    outputs.write(run, folder)
    stopped = run.n_generations < wanted
    if not quiet:
        print()
        if stopped:
            print(f"Stopped after {run.n_generations} of {wanted} generations; all of these are kept.\n")
        print(report.champion_story(run.records, run.settings.model_dump()))
        print(f"\nIn the folder {folder} there are now")
        print("\n".join(f"  {name:13} {about}" for name, about in outputs.FILES.items()))
        more = "" if stopped else f" --generations {2 * run.n_generations}"
        print("\nWhat next?")
        for words, about in (
            (f"show {folder}", "what happened, and the champion's family"),
            (f"resume {folder}{more}", "evolve on"),
            ("lab", "play with walkers in notebooks"),
        ):
            print(f"  walkerlab {words:30} {about}")
    return INTERRUPTED if stopped else 0


def _show(given: argparse.Namespace) -> int:
    from walkerlab import store
    from walkerlab.commands import report

    path = _run_file(given.path)
    facts, settings, records = store.read(path)
    algorithm = settings["algorithm"]
    print(f"{path}: {records.generation.nunique()} of {algorithm['generations']} generations")
    print("made with", ", ".join(f"{name} {version}" for name, version in facts.items() if name != "settings"))
    print(f"\n{report.changed_settings(settings)}")
    if records.empty:
        return _say(f"\nNo generation is done yet. Go on with: walkerlab resume {path}", to=0)
    best = wl.Run(wl.Settings(), records).champion
    for part in (
        report.by_generation(records),
        report.verdict_counts(records),
        report.champion_story(records, settings),
        f"Its gene:\n{best.genome}",
        report.descent(records, best.individual),
    ):
        print(f"\n{part}")
    return 0


def _doctor(_: argparse.Namespace) -> int:
    from walkerlab.commands import doctor

    faults = 0
    for finding in doctor.examine():
        print(f"{finding.level:5} {finding.says}", flush=True)
        if finding.mend:
            print(f"      mend: {finding.mend}")
        faults += finding.level == "fault"
    print(
        "\nMend the faults above, and ask again." if faults else "\nThis machine can evolve walkers: walkerlab evolve"
    )
    return 1 if faults else 0


def _lab(given: argparse.Namespace) -> int:
    from walkerlab.commands import lab

    folder = Path(lab.FOLDER)
    copied = lab.copy_notebooks(folder)
    print(f"New in {folder}: {len(copied)} notebooks. What was there before stays as it was.", flush=True)
    options = [f"--{name.replace('_', '-')}" for name in ("no_browser", "allow_root") if getattr(given, name)]
    options += [f"--port={given.port}"] if given.port else []
    try:
        lab.open_lab(folder, options)
    except ImportError:
        return _say(f'JupyterLab is not installed. Mend: "{sys.executable}" -m pip install jupyterlab', to=REFUSED)
    return 0


def _run_file(path: Path) -> Path:
    """Return the run file that is meant by its own path, or by that of its folder."""
    from walkerlab.commands.outputs import RUN_FILE

    return path / RUN_FILE if path.is_dir() else path


def _say(message: str, *, to: int) -> int:
    """Tell people on stderr, and return the exit code."""
    print(message, file=sys.stderr)
    return to


if __name__ == "__main__":
    sys.exit(main())
