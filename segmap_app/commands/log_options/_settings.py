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
    begun = argparse.Namespace(parser=parser, words=words, lent=set(), held=set())
    found, left = parser.parse_known_args(words, begun)
    if left:
        found.command.refuse_unknown(left)
    if path := getattr(found, "config", None):
        try:
            held = tomllib.loads(read_text(path))
        except LogError:
            raise
        except ValueError as error:  # no TOML, or no text
            raise ValueError(f"{shown(path)}: {error}") from error
        found, left = applied(found, held)
        if left:
            near = meant(left[0].replace("_", "-"), flags(found))
            found.refuse(f"{path} has {left[0]}, which is no option{near}")
    return found


def _written_out(words: Sequence[str]) -> list[str]:
    """The words with `--mount auto`, and `--strict` without a share, as options of their own."""
    found: list[str] = []
    for word, following in zip(words, [*words, ""][1:], strict=True):
        if word == "auto" and found[-1:] == ["--mount-auto"]:
            continue
        if word == "--mount=auto" or (word == "--mount" and following == "auto"):
            word = "--mount-auto"
        if word == "--strict" and not _is_number(following):
            word = "--strict-verdict"
        found.append(word)
    return found


def _is_number(word: str) -> bool:
    """Whether a word is a number; NaN is one."""
    try:
        float(word)
    except ValueError:
        return False
    return True


def applied(
    given: argparse.Namespace, held: Mapping[str, Any]
) -> tuple[argparse.Namespace, list[str]]:
    """The options given above those held, and the names of those that the command does not have.

    Where another method is given than is held, its thresholds are lent to none.
    """
    words, left, known = [given.words[0]], [], flags(given)
    for name, value in held.items():
        flag = name.replace("_", "-")
        if flag not in known:
            left.append(name)
        elif not (flag == "output" and given.output):
            words += _written(flag, value, known[flag])
    words += given.words[1:]
    begun = argparse.Namespace(
        parser=given.parser, words=words, lent=set(), held=given.held | {*held}
    )
    found = given.parser.parse_args(words, begun)
    for kind in ("method", "align"):
        if kind in held and getattr(found, kind, held[kind]) != held[kind]:
            found.lent = {name.replace("-", "_") for name in held}
    return found, left


def flags(given: argparse.Namespace) -> dict[str, argparse.Action]:
    """The options of a command, by their names without dashes in front."""
    found = given.command._option_string_actions
    return {flag[2:]: action for flag, action in found.items() if flag.startswith("--")}


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
