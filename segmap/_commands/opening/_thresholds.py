"""Thresholds of methods as options, as their annotations declare them: degrees for radians."""

from __future__ import annotations

import argparse
import inspect
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple

from ...arrays import Declared, declared


class Threshold(NamedTuple):
    """A keyword of a method: what is declared of it, and its default in the method's unit."""

    said: Declared
    default: Any

    @property
    def unit(self) -> str:
        """The unit on the command line."""
        return "number" if self.said.kind is int else self.said.read_unit or "value"

    def shown(self) -> str:
        """The default as a user reads it."""
        if self.default is None:
            return "none"
        if isinstance(self.default, bool):
            return "yes" if self.default else "no"
        return self.default if self.said.words else f"{self.said.read(self.default):.4g}"


def thresholds(function: Callable[..., Any]) -> dict[str, Threshold]:
    """The keywords of a method that are one number, a word of several, or a switch."""
    said, found = declared(function), {}
    for name, parameter in inspect.signature(function).parameters.items():
        own = parameter.kind is parameter.KEYWORD_ONLY and said[name]
        if own and (own.kind in (float, int, bool) or own.words):
            found[name] = Threshold(own, parameter.default)
    return found


def add_thresholds(
    command: argparse.ArgumentParser,
    title: str,
    functions: Mapping[str, Callable[..., Any]],
    prefix: str = "",
) -> None:
    """An option for each threshold that one of the functions has; the help tells their defaults."""
    group = command.add_argument_group(title)
    users: dict[str, dict[str, Threshold]] = {}
    for method, function in functions.items():
        for name, threshold in thresholds(function).items():
            users.setdefault(name, {})[method] = threshold
    for name, by_method in sorted(users.items()):
        defaults: dict[str, list[str]] = {}
        for method, threshold in by_method.items():
            defaults.setdefault(threshold.shown(), []).append(method)
        said = [f"{value} for {', '.join(methods)}" for value, methods in defaults.items()]
        text = "; ".join(said if len(functions) > 1 else defaults)
        group.add_argument(_flag(prefix + name), help=f"default: {text}", **_kind(by_method))


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
    """The thresholds of a function that were given, in its own units."""
    found = {}
    for name, threshold in thresholds(function).items():
        value = getattr(given, prefix + name, None)
        if value is not None:
            found[name] = threshold.said.meant(value)
    return found


def refuse_others(
    given: argparse.Namespace, method: str, methods: Mapping[str, Any], prefix: str = ""
) -> None:
    """End with an error of usage where a threshold is given that another method has."""
    named = {k: thresholds(getattr(m, "function", m)) for k, m in methods.items()}
    own = named.get(method, {})
    for name in (prefix + name for every in named.values() for name in every if name not in own):
        if getattr(given, name, None) is not None and name not in given.lent:
            known = ", ".join(_flag(prefix + name) for name in own) or "no threshold"
            given.refuse(f"{method} has no {_flag(name)}; it has {known}")
