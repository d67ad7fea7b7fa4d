"""Options from elsewhere: the file of --config, and what a session keeps."""

from __future__ import annotations

import argparse
import tomllib
from collections.abc import Mapping, Sequence
from typing import Any

from segmap.files import shown
from segmap.readers import LogError, read_text

from ._command import meant

#: Options that change the map and not the way to it.
EDITS = {"veto", "tie", "crop", "square", "place", "north", "crs"}

#: Options that say how a log is prepared.
PREPARE = ("no_deskew", "keep_body", "mask", "clockwise", "mount", "mount_auto")


def parsed(parser: argparse.ArgumentParser, words: Sequence[str]) -> argparse.Namespace:
    """The options given, above those of the file that --config names."""
    words = _written_out(words)
    begin = argparse.Namespace(parser=parser, words=words, lent=set(), held=set())
    options, unknown = parser.parse_known_args(words, begin)
    if unknown:
        options.command.refuse_unknown(unknown)
    if path := getattr(options, "config", None):
        try:
            stored = tomllib.loads(read_text(path))
        except LogError:
            raise
        except ValueError as error:  # no TOML, or no text
            raise ValueError(f"{shown(path)}: {error}") from error
        options, unknown = applied(options, stored)
        if unknown:
            near = meant(unknown[0].replace("_", "-"), flags(options))
            options.refuse(f"{path} has {unknown[0]}, which is no option{near}")
    return options


def _written_out(words: Sequence[str]) -> list[str]:
    """The words with `--mount auto`, and `--strict` without a share, as options of their own."""
    written: list[str] = []
    for word, following in zip(words, [*words, ""][1:], strict=True):
        if word == "auto" and written[-1:] == ["--mount-auto"]:
            continue
        if word == "--mount=auto" or (word == "--mount" and following == "auto"):
            word = "--mount-auto"
        if word == "--strict" and not _is_number(following):
            word = "--strict-verdict"
        written.append(word)
    return written


def _is_number(word: str) -> bool:
    """Whether a word is a number; NaN is one."""
    try:
        float(word)
    except ValueError:
        return False
    return True


def applied(
    given: argparse.Namespace, stored: Mapping[str, Any]
) -> tuple[argparse.Namespace, list[str]]:
    """The options given above those stored, and the names of those that the command does not have.

    Where another method is given than is stored, its thresholds are lent to none.
    """
    words, unknown, actions = [given.words[0]], [], flags(given)
    for name, value in stored.items():
        flag = name.replace("_", "-")
        if flag not in actions:
            unknown.append(name)
        elif not (flag == "output" and given.output):
            words += _written(flag, value, actions[flag])
    words += given.words[1:]
    begin = argparse.Namespace(
        parser=given.parser, words=words, lent=set(), held=given.held | {*stored}
    )
    options = given.parser.parse_args(words, begin)
    for kind in ("method", "align"):
        if kind in stored and getattr(options, kind, stored[kind]) != stored[kind]:
            options.lent = {name.replace("-", "_") for name in stored}
    return options, unknown


def flags(given: argparse.Namespace) -> dict[str, argparse.Action]:
    """The options of a command, by their names without dashes in front."""
    actions = given.command._option_string_actions
    return {flag[2:]: action for flag, action in actions.items() if flag.startswith("--")}


def _written(flag: str, value: Any, action: argparse.Action) -> list[str]:
    """A value as one writes it on the command line."""
    if value is True or value is False:
        wanted = f"--{flag}" if value else f"--no-{flag}"
        return [wanted] if value or wanted in action.option_strings else []
    values = value if isinstance(value, list) else [value]
    if not values or isinstance(values[0], list):  # an option that is given several times
        return [word for one in values for word in _written(flag, one, action)]
    if isinstance(action.nargs, int) and action.nargs:
        return [f"--{flag}", *map(str, values)]
    return [f"--{flag}={each}" for each in values]
