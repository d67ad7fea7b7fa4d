"""Numbers out of the fields of a line; every fault is a ValueError that says what was expected."""

from collections.abc import Sequence

import numpy as np

from ..arrays import Array

#: Farther from its origin, in metres, no pose of an indoor log lies; nor has it turned more.
FARTHEST = 1e7
#: Later than this, in seconds, no clock stands.
LATEST = 1e12


def numbers(fields: Sequence[str], what: str) -> Array:
    """Fields as floats, `(n,)` array, in the unit of the file."""
    try:
        found = np.array(fields, float)
    except (ValueError, OverflowError):
        found = None
    if found is None or any("_" in field for field in fields):
        bad = next((f for f in fields if not is_number(f)), "")
        raise ValueError(f"expected numbers for {what}, got {bad[:40]!r}")
    return found


def is_number(field: str) -> bool:
    """Whether a field reads as a number: Python's underscores are no part of one."""
    try:
        float(field)
    except ValueError:
        return False
    return "_" not in field


def pose(fields: Sequence[str], what: str) -> Array:
    """Three fields as a (3,) array, metres and radians; three times `nan` where there is none."""
    found = numbers(fields, what)
    if len(found) != 3:
        raise ValueError(f"expected x, y, heading for {what}, got {len(found)} fields")
    if not (np.isnan(found).all() or (np.abs(found) <= FARTHEST).all()):
        raise ValueError(f"expected metres and radians for {what}, got {' '.join(fields)[:80]}")
    return found


def time(field: str, what: str = "the time", unit: float = 1.0) -> float:
    """A field in units of `unit` seconds as seconds."""
    found = float(numbers([field], what)[0]) * unit
    if not abs(found) <= LATEST:
        raise ValueError(f"expected seconds for {what}, got {field[:40]!r}")
    return found


def counted(
    fields: Sequence[str], what: str, least: int = 1
) -> tuple[Sequence[str], Sequence[str]]:
    """Split `n f1 ... fn rest` into the n fields that the first one announces, and the rest."""
    field, rest = (fields[0], fields[1:]) if fields else ("", ())
    if not (field.isdecimal() and len(field) < 19):
        raise ValueError(f"expected the number of {what}, got {field[:40]!r}")
    if not least <= int(field) <= len(rest):
        raise ValueError(f"announces {int(field)} {what}, but {len(rest)} fields follow")
    return rest[: int(field)], rest[int(field) :]
