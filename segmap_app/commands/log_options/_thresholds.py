"""Thresholds of methods as options: units by annotations, words by docstrings.

Degrees stand for radians."""

from __future__ import annotations

import argparse
import inspect
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

from segmap.arrays import Declared, Quantity, declared, described

from ...call import defaults
from ._command import Command

#: A length that may be 0.
LENGTH = Declared(float, Quantity("metres", least=0), (), False)


class Threshold(NamedTuple):
    """A keyword of a method: what is declared of it, and its default in the method's unit."""

    said: Declared
    default: Any

    @property
    def unit(self) -> str:
        """The unit on the command line."""
        return "number" if self.said.kind is int else self.said.read_unit or "value"

    def shown(self) -> str:
        """The default as a user reads it, with its unit."""
        if self.default is None:
            return "none"
        if isinstance(self.default, bool):
            return "yes" if self.default else "no"
        if self.said.words:
            return str(self.default)
        return f"{self.said.read(self.default):.4g} {self.said.read_unit}".rstrip()


def thresholds(function: Callable[..., Any]) -> dict[str, Threshold]:
    """The keywords of a method that are one number, a word of several, or a switch."""
    said, usual, found = declared(function), defaults(function), {}
    for name, parameter in inspect.signature(function).parameters.items():
        own = parameter.kind is parameter.KEYWORD_ONLY and said[name]
        if own and (own.kind in (float, int, bool) or own.words):
            found[name] = Threshold(own, usual[name])
    return found


def add_thresholds(
    command: Command, title: str, functions: Mapping[str, Callable[..., Any]], prefix: str = ""
) -> None:
    """An option for each threshold that one of the functions has, and the help of each function."""
    group = command.add_argument_group(title)
    users: dict[str, dict[str, Threshold]] = {}
    for method, function in functions.items():
        words, own = described(function), thresholds(function)
        page = argparse.ArgumentParser(add_help=False)
        command.methods[method] = page.add_argument_group(method, words[""])
        for name, threshold in own.items():
            users.setdefault(name, {})[method] = threshold
            text = f"{words[name]} Default: {threshold.shown()}.".replace("%", "%%")
            flag, kind = _flag(prefix + name), _kind({method: threshold})
            command.methods[method].add_argument(flag, help=text, **kind)
    for name, by_method in sorted(users.items()):
        group.add_argument(_flag(prefix + name), help=argparse.SUPPRESS, **_kind(by_method))


def _kind(users: Mapping[str, Threshold]) -> dict[str, Any]:
    """What an option takes; where methods differ in the unit, each has its own."""
    said = next(iter(users.values())).said
    if said.kind is bool:
        return {"action": argparse.BooleanOptionalAction}
    if said.words:
        return {"choices": said.words}
    units = dict.fromkeys(threshold.unit.upper() for threshold in users.values())
    return {"type": int if said.kind is int else float, "metavar": "|".join(units)}


def _flag(name: str) -> str:
    return "--" + name.replace("_", "-")


def chosen_thresholds(
    given: argparse.Namespace, function: Callable[..., Any], prefix: str = ""
) -> dict[str, Any]:
    """The thresholds of a function that were given, in its own units, and those of its defaults
    that are not the function's."""
    own, found = inspect.signature(function).parameters, {}
    for name, threshold in thresholds(function).items():
        if threshold.default != own[name].default:
            found[name] = threshold.default
        value = getattr(given, prefix + name, None)
        if value is not None:
            found[name] = threshold.said.meant(value)
    return found


def refuse_others(
    given: argparse.Namespace, method: str, methods: Mapping[str, Any], prefix: str = ""
) -> None:
    """End with an error of usage where a threshold is wrong, or one that another method has."""
    named = {k: thresholds(getattr(m, "function", m)) for k, m in methods.items()}
    own = named.get(method, {})
    for name in (prefix + name for every in named.values() for name in every if name not in own):
        if getattr(given, name, None) is not None and name not in given.lent:
            known = ", ".join(_flag(prefix + name) for name in own) or "no threshold"
            given.refuse(f"{method} has no {_flag(name)}; it has {known}")
    for name, threshold in own.items():
        refuse_wrong(given, prefix + name, threshold.said)


def refuse_wrong(given: argparse.Namespace, option: str, said: Declared) -> None:
    """End with an error of usage where an option is given and is not what is declared."""
    value = getattr(given, option, None)
    if value is not None and option not in given.lent:
        try:
            said.as_read().check(value, _flag(option))
        except ValueError as error:
            given.refuse(str(error))
