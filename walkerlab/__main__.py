"""The command line: ``walkerlab evolve``, ``resume``, ``show``, ``rescue``, ``doctor`` and ``lab``; and how it ends."""

from __future__ import annotations  # for the doctor, whom a Python that is too old must be able to read

import _thread
import os
import signal
import sys
import warnings
from collections.abc import Sequence
from io import TextIOWrapper

from walkerlab.commands.terminal import INTERRUPTED, REFUSED, say, tell
from walkerlab.errors import Fault
from walkerlab.system.interrupts import interrupts_held


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
        if words == ["doctor"]:  # who speaks where no grammar can be loaded
            from walkerlab.commands import doctor

            return doctor.tell()
        return _obey(words)
    except KeyboardInterrupt:
        return say("\nStopped.", to=INTERRUPTED)
    except BrokenPipeError:  # whoever was reading has read enough, as in: walkerlab show walk | head
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0
    except ImportError as error:
        return say(f"{error}\nFor the mend, ask: walkerlab doctor", to=1)
    except (Fault, OSError) as error:
        return say(str(error), to=REFUSED)
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
    if workers := sys.modules.get("walkerlab.simulation.workers"):
        workers.default_executor().end()


def _obey(words: Sequence[str]) -> int:
    """Run the command that the words name."""
    with interrupts_held():
        from walkerlab.commands import runs
        from walkerlab.commands.parser import grammar, no_such_command

        parser, commands = grammar()
    if not words:
        parser.print_help()
        return 0
    if words[0] not in commands and not words[0].startswith("-"):
        return say(no_such_command(words[0], commands), to=REFUSED)
    given, strangers = parser.parse_known_args(words)
    if strangers and given.run is not runs.evolve:
        parser.error(f"{given.command} does not know: {' '.join(strangers)}")
    given.strangers = strangers
    with warnings.catch_warnings():
        warnings.showwarning = lambda message, *_, **__: tell(f"\nNote: {message}", to=sys.stderr)
        try:
            return given.run(given)
        except KeyboardInterrupt:
            signal.signal(signal.SIGINT, signal.SIG_IGN)  # it has been heard
            return say(f"\n{runs.stopped(given)}", to=INTERRUPTED)
        except Fault as error:
            if not hasattr(error, "kept"):
                raise
            return say(f"\n{error}\n{runs.stopped(given)}", to=1)


if __name__ == "__main__":
    sys.exit(main())
