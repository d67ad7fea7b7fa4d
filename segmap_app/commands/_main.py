"""All commands behind one name, and how each may end."""

from __future__ import annotations

import argparse
import os
import sys
from contextlib import suppress
from typing import Any

from segmap import __version__
from segmap.arrays import described
from segmap.files import speak

from . import _app, _compare, _convert, _info, _live, _locate, _map, _merge, _occupancy, _setup
from ._output import (
    FAULTS,
    Usage,
    plain_warnings,
    print_error,
    print_line,
    progress_bars,
    reason,
)
from .log_options import FAMILIES, Command, call_of, examples, parsed, thresholds

DESCRIPTION = "Maps of buildings from the logs of a 2D laser."
EPILOG = """\
LOG is a file or a folder of any format that segmap reads, a folder of such logs, or the name of a
log that comes with segmap: malaga, clinic, corridor, room. Exit codes: 0 done, 1 something failed,
2 the command was not understood, or names a file that cannot be written: nothing was done; 3 a log
gave no map, or was not found on one; 130 stopped by Control-C.
`segmap COMMAND --help` tells the rest.
"""


def _add_methods(commands: Any) -> None:
    """`segmap methods [METHOD]`: all methods, or one and its thresholds."""
    command = commands.add_parser(
        "methods",
        help="all methods, or the thresholds of one, as `--method fusion:tolerance=0.05` sets them",
        epilog=examples("methods", "methods fusion", "methods pose_graph"),
    )
    command.add_argument("method", nargs="?", metavar="METHOD", help="one of them")
    command.set_defaults(run=_tell_methods)


def _tell_methods(given: argparse.Namespace) -> None:
    methods = {name: method for family in FAMILIES.values() for name, method in family.items()}
    for name in [given.method] if given.method else methods:
        function = call_of(name, methods).function
        words = described(function)
        print_line(f"{name}: {words['']}")
        for key, threshold in thresholds(function).items() if given.method else ():
            print_line(f"  {key}: {words[key]} Default: {threshold.shown()}.")


#: In the order in which they are listed.
COMMANDS = (
    *(_info.add, _map.add, _map.add_plan, _merge.add, _compare.add, _occupancy.add, _locate.add),
    *(_convert.add, _app.add, _live.add, _setup.add_notebooks),
    *(_setup.add_warm, _add_methods),
)


def main(arguments: list[str] | None = None) -> int:
    """Run a command and return its exit code."""
    speak()
    commands = parser()
    with suppress(ImportError):  # Tab, where it is installed
        import argcomplete

        argcomplete.autocomplete(commands)
    try:
        options = parsed(commands, sys.argv[1:] if arguments is None else arguments)
        with plain_warnings(), progress_bars(quiet=getattr(options, "quiet", False)):
            return int(options.run(options) or 0)
    except KeyboardInterrupt:
        print_error("stopped")
        return 130
    except BrokenPipeError:  # `segmap info ... | head`
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 1
    except Usage as error:
        print_error(str(error))
        return 2
    except FAULTS as error:
        print_error(reason(error))
        return 1


def parser() -> Command:
    """The parser of all commands."""
    program = Command(prog="segmap", description=DESCRIPTION, epilog=EPILOG)
    program.add_argument("--version", action="version", version=f"segmap {__version__}")
    commands = program.add_subparsers(
        required=True, metavar="COMMAND", title="commands", prog="segmap", parser_class=Command
    )
    for add in COMMANDS:
        add(commands)
    return program
