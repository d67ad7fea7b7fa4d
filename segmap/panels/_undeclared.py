"""Units of keywords whose annotation does not say them yet: read from the docstring."""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable
from dataclasses import replace
from typing import Any

from ..arrays import Declared, Quantity, declared

#: `angle, distance : float, radians and metres` in a docstring, however far it is indented.
LISTED = re.compile(r"^ *((?:\w+, )*\w+) : (.+)$", re.MULTILINE)
#: What a docstring says of two things in one line: `step : float, metres, and turn : float`.
ALSO = re.compile(r",? and (\w+) : ")


def said_of(function: Callable[..., Any]) -> dict[str, Declared]:
    """What the annotations of a function declare; of plain numbers and words, its docstring."""
    listed = _units_of(function)
    return {k: _completed(said, listed.get(k, "")) for k, said in declared(function).items()}


def _completed(said: Declared, listed: str) -> Declared:
    words = tuple(re.findall(r'"(\w+)"', listed))
    if said.kind is str and words and not said.words:
        return said._replace(words=words)
    if said.kind is not float or said.quantity.unit is not None:
        return said
    angle = "radians" in listed
    unit = "rad/m" if "radians a m" in listed else "radians" if angle else ""
    unit = unit or ("metres" if "metre" in listed else "")
    return said._replace(quantity=replace(Quantity(), unit=unit))


def _units_of(function: Callable[..., Any]) -> dict[str, str]:
    found: dict[str, str] = {}
    for names, said in LISTED.findall(inspect.getdoc(function) or ""):
        parts = ALSO.split(said)
        found |= _each(names.split(", "), parts[0])
        found |= dict(zip(parts[1::2], parts[2::2], strict=True))
    return found


def _each(names: list[str], said: str) -> dict[str, str]:
    """`float, radians; metres` said of two names, to each its own part."""
    parts = re.split(r"; | and ", said) if len(names) > 1 else [said]
    return {name: parts[min(k, len(parts) - 1)] for k, name in enumerate(names)}
