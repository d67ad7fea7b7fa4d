"""Options from elsewhere: the file of --config, and what a session keeps."""

from __future__ import annotations

import argparse
import re
import tomllib
from collections.abc import Mapping, Sequence
from typing import Any

from segmap import alignment, extraction, reduction
from segmap.files import shown
from segmap.readers import LogError, read_text

from ...pipeline import BEGIN
from .._output import Usage
from ._methods import function_of, thresholds

#: Options that change the map and not the way to it.
EDITS = {"veto", "tie", "crop", "square", "place", "north", "crs"}
#: Options that say how a log is prepared.
PREPARE = ("no_deskew", "keep_body", "mask", "clockwise", "mount", "mount_auto")
#: Files that say where on Earth the map lies.
OF_A_PLACE = (".geojson", ".segmap")
#: The methods that an option names.
FAMILIES: Mapping[str, Mapping[str, Any]] = {
    "align": alignment.METHODS,
    "extract": extraction.METHODS,
    "method": reduction.METHODS,
}
#: The methods where none is named.
USUAL = {"align": "pose_graph", "extract": "extract_polylines", "method": reduction.USUAL_METHOD}


def parsed(parser: argparse.ArgumentParser, words: Sequence[str]) -> argparse.Namespace:
    """The options given, above those of the file that --config names."""
    text = re.sub("--mount[\0=]auto", "--mount-auto", "\0".join(words))
    text = re.sub(r"--strict(?=\0(?![\d.]|nan)|$)", "--strict-verdict", text)
    begin = argparse.Namespace(parser=parser, words=text.split("\0") if text else [])
    options, unknown = parser.parse_known_args(begin.words, begin)
    if unknown:
        words = f"unrecognized arguments: {' '.join(unknown)}"
        raise Usage(f"{words}\n`segmap {begin.words[0]} --help` tells what there is")
    if path := getattr(options, "config", None):
        try:
            stored = tomllib.loads(read_text(path))
        except LogError:
            raise
        except ValueError as error:  # no TOML, or no text
            raise ValueError(f"{shown(path)}: {error}") from error
        options, unknown = applied(options, stored)
        if unknown:
            raise Usage(f"{path} has {unknown[0]}, which is no option")
    names = tuple(name.lower() for name in getattr(options, "output", None) or ())
    if getattr(options, "place", None) and not any(name.endswith(OF_A_PLACE) for name in names):
        raise Usage("--place is for a .geojson, the other files have none: name one with -o")
    return options


def applied(
    given: argparse.Namespace, stored: Mapping[str, Any]
) -> tuple[argparse.Namespace, list[str]]:
    """The options given above those stored, and the names of those that the command has not."""
    words, unknown = [given.words[0]], []
    for name, value in with_calls(stored).items():
        if not hasattr(given, name):
            unknown.append(name)
        elif not (name == "output" and given.output):
            words += _written(f"--{name.replace('_', '-')}", value)
    words += given.words[1:]
    begin = argparse.Namespace(parser=given.parser, words=words)
    return given.parser.parse_args(words, begin), unknown


def _written(flag: str, value: Any) -> list[str]:
    """A value as one writes it on the command line."""
    if isinstance(value, bool):
        return [flag] * value
    if not isinstance(value, list):
        return [f"{flag}={value}"]
    if all(isinstance(each, str) for each in value):  # an option that is given several times
        return [f"{flag}={each}" for each in value]
    return [flag, *map(str, value)]


def with_calls(stored: Mapping[str, Any]) -> dict[str, Any]:
    """The options with each threshold at its method: sessions, and files, keep it for itself."""
    options = {name.replace("-", "_"): value for name, value in stored.items()}
    for option, family in FAMILIES.items():
        if (name := str(options.get(option, USUAL[option]))) in family:
            keys = {BEGIN[option] + key: key for key in thresholds(function_of(family[name]))}
            own = [f"{keys[key]}={options.pop(key)}" for key in [*options] if key in keys]
            options |= {option: f"{name}:{','.join(own)}"} if own else {}
    return options
