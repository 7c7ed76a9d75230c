"""Command ``league``: rank the genomes of a folder, or seal the settings of a mystery terrain."""

from __future__ import annotations  # League is imported for type checking only

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from walkerlab.commands import flags
from walkerlab.commands.terminal import print_safely
from walkerlab.system.errors import WalkerlabError
from walkerlab.system.files import display_path, quote_path
from walkerlab.system.interrupts import interrupts_held

if TYPE_CHECKING:
    from walkerlab.settings.settings import Settings
    from walkerlab.tournament.seals import Seal
    from walkerlab.tournament.standings import League

PAGE = "league.html"
SEALED_FILE = "sealed.json"
N_PRINTED_SKIPPED = 30  # maximum number of invalid entries that are printed; the page lists all


class LeagueCommandError(WalkerlabError):
    """Arguments of the command that do not fit together."""


def add_arguments(command: argparse.ArgumentParser) -> None:
    """Add the arguments of the command, without the settings."""
    command.add_argument(
        "folder", nargs="?", type=flags.parse_path, metavar="FOLDER", help="folder with a genome or a run in each file"
    )
    command.add_argument(
        "--mystery", type=flags.parse_path, metavar="FILE", help="sealed settings, which the page reveals"
    )
    command.add_argument("--digest", default="", metavar="DIGITS", help="digest that the class noted down, to compare")
    command.add_argument("--rounds", type=int, default=1, metavar="N", help="number of rounds, each on new ground [1]")
    command.add_argument("--out", type=flags.parse_path, metavar="FILE", help=f"page to write [{PAGE}]")
    command.add_argument(
        "--seal",
        type=flags.parse_path,
        metavar="SETTINGS",
        help="seal the settings in a JSON file, and print the digest",
    )
    command.add_argument("--quiet", action="store_true", help="print only errors")


def league_command(arguments: argparse.Namespace) -> int:
    """Hold a league and write its page, or seal settings; return the exit code."""
    with interrupts_held():
        from walkerlab.tournament.seals import open_seal
        from walkerlab.tournament.standings import league

    given = flags.given_settings(vars(arguments))
    settings: Settings | Seal = flags.build_settings(vars(arguments), arguments.unknown_words)
    if arguments.seal:
        if arguments.folder or arguments.mystery or given:
            raise LeagueCommandError("--seal takes only a settings file: walkerlab league --seal settings.json")
        return _seal(arguments.seal, arguments.out or Path(SEALED_FILE).absolute())
    if not arguments.folder:
        raise LeagueCommandError("Name the folder of the entries: walkerlab league FOLDER")
    if arguments.mystery:
        if given:
            raise LeagueCommandError(f"The settings are in the sealed file; remove {', '.join(given)} or --mystery.")
        settings = open_seal(arguments.mystery, arguments.digest)
    elif arguments.digest:
        raise LeagueCommandError("--digest requires the sealed file: --mystery sealed.json")
    result = league(arguments.folder, settings, rounds=arguments.rounds, progress=not arguments.quiet)
    page = result.save(arguments.out or Path(PAGE).absolute())
    if not arguments.quiet:
        _print_result(result, page)
    return 0


def _seal(settings_file: Path, out: Path) -> int:
    """Seal the settings in a file; a sealed file is never overwritten, because a class may have its digest."""
    from walkerlab.tournament.seals import read_settings_file, seal

    if out.exists():
        raise LeagueCommandError(f"{display_path(out)} exists already; name another file: --out FILE")
    sealed = seal(read_settings_file(settings_file))
    sealed.save(out)
    print_safely(
        f"The class can note down this digest:\n\n    {sealed.shown_digest}\n\n"
        f"Keep {display_path(out)} secret until the tournament: walkerlab league FOLDER --mystery {quote_path(out)}"
    )
    return 0


def _print_result(result: League, page: Path) -> None:
    """Print the leaderboard, the invalid entries and the name of the page."""
    _, unit = result.measure
    width = max(len(standing.score_text) for standing in result.standings)
    for standing in result.standings:
        print_safely(f"{standing.rank:3}. {standing.score_text:>{width}} {unit}  {standing.entry.name}")
    for one in result.skipped[:N_PRINTED_SKIPPED]:
        print_safely(f"  not valid: {one.file}: {one.reason}")
    if len(result.skipped) > N_PRINTED_SKIPPED:
        print_safely(f"  and {len(result.skipped) - N_PRINTED_SKIPPED} more, which the page lists")
    print_safely(f"Leaderboard, final and rules: {display_path(page)}")
