"""The program `segmap`: what its commands and options are made of, and what a line of them says.

Options that the line does not have come from the file of --config, or from a session.
"""

from __future__ import annotations

import os
import re
import tomllib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any, get_origin

from cyclopts import App, ArgumentCollection, CycloptsError, Parameter, Token
from cyclopts.config import Dict

from segmap import __version__
from segmap.arrays import Declared
from segmap.files import escape
from segmap.readers import read_text

from .._output import Usage
from ._methods import call_of, with_calls

#: Set where a command is one job of another: what is for all of them is done there.
JOB = "SEGMAP_JOB"
#: Options of the command that a job does not have, each with its value.
FOR_ALL = ("--workers", "--table")
EPILOG = """\
LOG is a file or a folder of any format that segmap reads, a folder of such logs, or the name of a
log that comes with segmap: malaga, clinic, corridor, room. Exit codes: 0 done, 1 something failed,
2 the command was not understood, or names a file that cannot be written: nothing was done; 3 a log
gave no map, or was not found on one; 130 stopped by Control-C.
`segmap COMMAND --help` tells the rest; `segmap --install-completion` lets Tab complete commands
and options.
"""
APP = App(
    name="segmap",
    help="Maps of buildings from the logs of a 2D laser.",
    help_epilogue=EPILOG,
    help_format="markdown",
    version=f"segmap {__version__}",
    default_parameter=Parameter(negative=(), show_default=False),
)
APP.register_install_completion_command()
#: `--strict` without a share.
STRICT_ALONE = re.compile(r"--strict(?=\0(?![\d.]|nan|good)|$)")


def command(name: str, *examples: str) -> Callable[[Callable[..., Any]], Callable[..., Any]]:
    """Make a function a command, with lines to copy at the end of its help."""
    lines = "\n".join(f"    segmap {line}" for line in examples)
    return APP.command(name=name, help_epilogue=f"Examples:\n\n{lines}")


def option(read: Callable[[str], Any], metavar: str, **settings: Any) -> Parameter:
    """An option whose words, one or several, a function reads or refuses."""

    def convert(kind: Any, tokens: Sequence[Token]) -> Any:
        """What the words mean."""
        values = tuple(read(token.value) for token in tokens)
        return values if get_origin(kind) is tuple else values[0]

    return Parameter(converter=convert, metavar=metavar, **settings)


def checked(check: Callable[[str], Any], metavar: str, **settings: Any) -> Parameter:
    """An option whose words are taken as they are, where a function does not refuse them."""

    def read(word: str) -> str:
        """The word itself."""
        check(word)
        return word

    return option(read, metavar, **settings)


def method(methods: Mapping[str, Any], default: str, *others: str) -> Parameter:
    """An option that names one of these methods, with its thresholds, or is another word."""
    words = (
        f"{', '.join([*methods, *others])}; {default}; METHOD:NAME=VALUE,... sets thresholds, "
        "which `segmap methods METHOD` tells."
    )
    return checked(lambda word: word in others or call_of(word, methods), "METHOD", help=words)


def quantity(declared: Declared, metavar: str) -> Parameter:
    """An option that is a number, as it is declared."""
    return option(lambda word: declared.check(declared.kind(word), "it"), metavar)


def files(*suffixes: str, **settings: Any) -> Parameter:
    """An option that names files, which end in one of the suffixes."""

    def check(name: str) -> None:
        """Refuse another."""
        if not name.lower().endswith(suffixes) or name.startswith(suffixes):
            raise ValueError(f"{name!r} must end in one of {', '.join(suffixes)}")

    return checked(check, "FILE", **settings)


def output(what: str, *suffixes: str) -> Parameter:
    """The option -o."""
    words = (
        f"Write {what}; the name ends in {', '.join(suffixes)}; may be given more than once; "
        "{name} in it stands for the name of the log, for several logs: 'maps/{name}.svg'."
    )
    return files(*suffixes, alias="-o", help=words)


def parse(words: Sequence[str], stored: Mapping[str, Any] | None = None) -> partial[Any]:
    """The command that a line says, with its options, and below them those that are stored.

    Raises
    ------
    Usage
        Where it is not understood.
    """
    below = Dict(dict(stored or {}), allow_unknown=True, use_commands_as_keys=False)
    APP.config = (_from_file, below)
    line = STRICT_ALONE.sub("--strict=good", "\0".join(words))
    tokens = line.split("\0") if words else []
    try:
        function, bound, _ = APP.parse_args(tokens, print_error=False, exit_on_error=False)
    except CycloptsError as error:
        named = f"{error.argument.name}: " if error.argument else ""
        why = str(error) if named[:-2] in str(error) else f"{named}{error}"
        help = " ".join(["segmap", *(word for word in words[:1] if word in APP), "--help"])
        raise Usage(f"{why}\n`{help}` tells what there is") from error
    bound.apply_defaults()
    if given := bound.arguments.get("given"):
        bound.arguments["given"] = replace(given, words=tuple(words))
    return partial(function, *bound.args, **bound.kwargs)


def with_stored(given: Any, stored: Mapping[str, Any]) -> tuple[Any, list[str]]:
    """The options given above those stored, and the names of those that the command has not."""
    options = with_calls(stored)
    arguments = APP[given.words[0]].assemble_argument_collection()
    unknown = [name for name in options if arguments.get(f"--{name}", None) is None]
    return parse(given.words, options).keywords["given"], unknown


def _from_file(app: App, commands: tuple[str, ...], arguments: ArgumentCollection) -> None:
    """Take what the line does not say from the file of --config."""
    config = arguments.get("--config", None)
    for path in [token.value for token in config.tokens] if config else ():
        try:
            stored = tomllib.loads(read_text(path))
        except tomllib.TOMLDecodeError as error:
            raise ValueError(f"{escape(path)}: {error}") from error
        options = with_calls(stored)
        if JOB in os.environ:
            options = {name: each for name, each in options.items() if f"--{name}" not in FOR_ALL}
        Dict(options, source=path, use_commands_as_keys=False)(app, commands, arguments)
