"""Thresholds of methods as options, made from the signatures: degrees here, radians there."""

from __future__ import annotations

import argparse
import inspect
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

#: Thresholds that are radians in Python and degrees on the command line.
ANGLES = {"angle", "axes", "sigma_bearing", "sigma_heading", "turn"}
#: And one that is radians a metre.
SLOPES = {"bandwidth"}
#: Thresholds without a unit.
PLAIN = {"chi2"}


def thresholds(function: Callable[..., Any]) -> dict[str, inspect.Parameter]:
    """The keywords of a method that are one number, or a switch."""
    kept = inspect.signature(function).parameters.values()
    return {p.name: p for p in kept if p.kind is p.KEYWORD_ONLY and _is_plain(p)}


def _is_plain(parameter: inspect.Parameter) -> bool:
    wanted = str(parameter.annotation).split(" | ")[0]
    return wanted in ("float", "int", "bool")


def add_thresholds(
    command: argparse.ArgumentParser,
    title: str,
    functions: Mapping[str, Callable[..., Any]],
    prefix: str = "",
) -> None:
    """An option for each threshold that one of the functions has; the help tells their defaults."""
    group = command.add_argument_group(title)
    options: dict[str, dict[str, inspect.Parameter]] = {}
    for method, function in functions.items():
        for name, parameter in thresholds(function).items():
            options.setdefault(name, {})[method] = parameter
    for name, users in sorted(options.items()):
        _add(group, prefix + name, name, users, alone=len(functions) == 1)


def _add(group: Any, option: str, name: str, users: dict[str, Any], *, alone: bool) -> None:
    defaults: dict[str, list[str]] = {}
    for method, parameter in users.items():
        defaults.setdefault(_shown(name, parameter.default), []).append(method)
    said = "; ".join(f"{value} for {', '.join(names)}" for value, names in defaults.items())
    parameter = next(iter(users.values()))
    flag = "--" + option.replace("_", "-")
    text = next(iter(defaults)) if alone else said
    if str(parameter.annotation) == "bool":
        group.add_argument(flag, action=argparse.BooleanOptionalAction, help=f"default: {text}")
        return
    unit = unit_of(name, parameter)
    number: Callable[[str], float] = int if unit == "number" else float
    group.add_argument(flag, type=number, metavar=unit.upper(), help=f"default: {text}")


def unit_of(name: str, parameter: inspect.Parameter) -> str:
    """The unit of a threshold on the command line."""
    if str(parameter.annotation) == "int" or name in PLAIN:
        return "number" if str(parameter.annotation) == "int" else "value"
    return "degrees" if name in ANGLES else "degrees/m" if name in SLOPES else "metres"


def _shown(name: str, default: Any) -> str:
    if default is None:
        return "none"
    if isinstance(default, bool):
        return "yes" if default else "no"
    return f"{np.degrees(default) if name in ANGLES | SLOPES else default:.4g}"


def chosen_thresholds(
    given: argparse.Namespace, method: str, function: Callable[..., Any], prefix: str = ""
) -> dict[str, Any]:
    """The thresholds that were given, in metres and radians.

    One that the method does not have is an error of usage.
    """
    own, found = thresholds(function), {}
    for option, value in vars(given).items():
        name = option.removeprefix(prefix)
        if option.startswith(prefix) and name in own and value is not None:
            found[name] = float(np.radians(value)) if name in ANGLES | SLOPES else value
    return found


def refuse_others(given: argparse.Namespace, method: str, methods: Mapping[str, Any]) -> None:
    """End with an error of usage where a threshold is given that another method has."""
    every = {name for other in methods.values() for name in thresholds(other.function)}
    own = set(thresholds(methods[method].function)) if method in methods else set()
    for name in sorted(every - own):
        if getattr(given, name) is not None:
            known = ", ".join(f"--{n.replace('_', '-')}" for n in sorted(own)) or "no threshold"
            given.refuse(f"{method} has no --{name.replace('_', '-')}; it has {known}")
