"""Entry point of the command line: ``walkerlab evolve``, ``resume``, ``compare``, ``show`` and other commands."""

from __future__ import annotations  # the doctor must run on old versions of Python

import _thread
import os
import signal
import sys
import warnings
from collections.abc import Sequence
from io import TextIOWrapper

from walkerlab.commands.terminal import EXIT_INTERRUPTED, INVALID_REQUEST, print_error, print_safely
from walkerlab.system.errors import WalkerlabError
from walkerlab.system.interrupts import interrupts_held


def main(argv: Sequence[str] | None = None) -> int:
    """Run one command.

    Args:
        argv: Arguments without the program's name; if None, the arguments of this process.

    Returns:
        Exit code: 0; 1 if the computer has a fault or a run failed; 2 for an invalid request; 130 after Ctrl-C.
    """
    words = sys.argv[1:] if argv is None else list(argv)
    if isinstance(sys.stdout, TextIOWrapper):
        sys.stdout.reconfigure(errors="backslashreplace")  # for characters that the terminal cannot print
    handler = signal.getsignal(signal.SIGINT)
    if argv is None:
        sys.unraisablehook = _repeat_interrupt
    try:
        if words == ["doctor"]:  # must run even if the parser cannot be imported
            from walkerlab.commands import doctor

            return doctor.run_doctor()
        return _run_command(words)
    except KeyboardInterrupt:
        return print_error("\nStopped.", EXIT_INTERRUPTED)
    except BrokenPipeError:  # the reader has ended, as in: walkerlab show walk | head
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    except ImportError as error:
        return print_error(f"{error}\nTo find the cause, run: walkerlab doctor", 1)
    except (WalkerlabError, OSError) as error:
        return print_error(str(error), INVALID_REQUEST)
    finally:
        if argv is None:
            _end_workers()
        else:
            signal.signal(signal.SIGINT, handler)


def _repeat_interrupt(unraisable: sys.UnraisableHookArgs) -> None:
    """Interrupt the main thread again if Ctrl-C arrived during a cleanup by Python, which ignores exceptions."""
    if unraisable.exc_type is KeyboardInterrupt:
        _thread.start_new_thread(_thread.interrupt_main, ())  # takes effect after this call
    else:
        sys.__unraisablehook__(unraisable)


def _end_workers() -> None:
    """End the worker processes so that Python can exit at once; Ctrl-C is ignored from now on."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    if workers := sys.modules.get("walkerlab.simulation.workers"):
        workers.default_executor().end()


def _run_command(words: Sequence[str]) -> int:
    """Parse the arguments, run the command and return its exit code."""
    with interrupts_held():
        from walkerlab.commands import comparing, ranking, runs
        from walkerlab.commands.parser import create_parser, describe_unknown_command

        parser, commands = create_parser()
    if not words:
        parser.print_help()
        return 0
    if words[0] not in commands and not words[0].startswith("-"):
        return print_error(describe_unknown_command(words[0], commands), INVALID_REQUEST)
    arguments, unknown_words = parser.parse_known_args(words)
    if unknown_words and arguments.run not in (
        runs.evolve_command,
        comparing.compare_command,
        ranking.league_command,
    ):
        parser.error(f"unknown arguments of {arguments.command}: {' '.join(unknown_words)}")
    arguments.unknown_words = unknown_words
    with warnings.catch_warnings():
        warnings.showwarning = lambda message, *_, **__: print_safely(f"\nNote: {message}", sys.stderr)
        try:
            return arguments.run(arguments)
        except KeyboardInterrupt:
            signal.signal(signal.SIGINT, signal.SIG_IGN)  # another Ctrl-C is ignored
            return print_error(f"\n{runs.describe_stop(arguments)}", EXIT_INTERRUPTED)
        except WalkerlabError as error:
            if not hasattr(error, "saved_path"):
                raise
            return print_error(f"\n{error}\n{runs.describe_stop(arguments)}", 1)


if __name__ == "__main__":
    sys.exit(main())
