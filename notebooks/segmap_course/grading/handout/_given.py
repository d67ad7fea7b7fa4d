"""What a jail holds of the library: the few functions that a task lists, and not its answer."""

from __future__ import annotations

from functools import cache

from ...exercises import Exercise
from ._source import Gatherer

#: What every task may use, as far as the answer to it is no part of that.
BASICS = {
    "segmap.angles": ("wrap", "axial_difference", "axial_mean", "axial_mean_of_two"),
    "segmap.poses": ("compose", "between", "inverse", "transform", "interpolate"),
    "segmap.segments": ("length", "angle", "midpoint", "point_distance", "extreme_projections"),
}
#: The source of the functions, and their names by the module that a student takes them from.
Package = tuple[str, dict[str, list[str]]]


@cache
def package(exercise: Exercise) -> Package:
    """The basics that do not hold the answer to an exercise, with all that they call.

    They are copied from the library's source, so that nothing else of it has to be there.
    """
    all_of_them = [(room, name) for room, names in BASICS.items() for name in names]
    given = [(room, name) for room, name in all_of_them if name not in exercise.withheld]
    found = gathered(*given)
    head = ["from __future__ import annotations", *dict.fromkeys(found.imports)]
    return "\n".join([*head, *found.parts]), {
        room: [name for name in names if (room, name) in given] for room, names in BASICS.items()
    }


@cache
def gathered(*basics: tuple[str, str]) -> Gatherer:
    """Functions, each by its room and name, and all that they call."""
    found = Gatherer()
    for room, name in basics:
        found.gather(room, name)
    return found


def listed(exercise: Exercise) -> str:
    """The functions that a task gives, in words."""
    return "; ".join(
        f"`{room}`: {', '.join(names)}" for room, names in package(exercise)[1].items()
    )
