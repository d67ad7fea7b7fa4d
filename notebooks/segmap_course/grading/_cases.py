"""A handout's own case of *Decide*: a floor that no chapter shows, drawn from the lecturer's seed.

What is right there stands in hidden cells and in solutions alone: students get the floor's number.
"""

from __future__ import annotations

import re
from functools import cache
from typing import Any, NamedTuple

import numpy as np

from segmap.metrics import doubled_walls

from .. import decide_map, unknown_building
from ..exercises.open.decision import KEPT

#: The task of judgement with a case of its own, and the floor that its chapter names.
TASK, SHOWN = decide_map.name, 4
FLOOR = re.compile(rf"\bfloor {SHOWN}\b|(?<=unknown_building\(){SHOWN}(?=\))")
#: Floors to draw from, and how many at most.
FLOORS, MOST_DRAWS = 10_000, 100
#: So far from its limit is each figure of a case, lest another machine decides otherwise.
MARGINS = {"verdict": 0.5, "spread": 0.03, "doubled": 0.03, "tape": 0.03}


class OwnCase(NamedTuple):
    """A floor, and for each of its maps the witnesses that refuse it: none for the one to keep."""

    floor: int
    against: dict[str, list[str]]

    @property
    def solution(self) -> dict[str, str]:
        """A right answer."""
        return {name: (words or [KEPT])[0] for name, words in self.against.items()}

    @property
    def seals(self) -> str:
        """The seals of all that is right."""
        right = [(name, w) for name, words in self.against.items() for w in words or [KEPT]]
        return " ".join(sorted(decide_map.seal(name, word) for name, word in right))


def figures(floor: int) -> dict[str, dict[str, float]]:
    """By how much each witness is beyond its limit in each map, by the text of chapter 13."""
    case, found = unknown_building(floor), {}
    for name, alignment in case.alignments.items():
        verdict = alignment.verdict_on(case.maps[name])
        off = max(abs(case.measured(name, taped) - taped.metres) for taped in case.tape)
        found[name] = {
            "verdict": (verdict.grade != "good") - 0.5,
            "spread": -1.0 if verdict.sure is None else 0.9 - verdict.sure / verdict.scans,
            "doubled": doubled_walls(case.maps[name], alignment.poses[:, :2]) - 0.25,
            "tape": off - 3 * 0.03,
        }
    return found


@cache
def own_case(seed: int) -> OwnCase:
    """The case of a seed: one map to keep, one refused by the tape alone, one by its spread alone.

    Raises
    ------
    ValueError
        Where no floor is such a case; about every second one is.
    """
    rng = np.random.default_rng((seed, SHOWN))
    for floor in map(int, rng.integers(SHOWN + 1, FLOORS, MOST_DRAWS)):
        found = figures(floor)
        against = {name: [w for w, by in f.items() if by > 0] for name, f in found.items()}
        clear = all(abs(by) >= MARGINS[w] for f in found.values() for w, by in f.items())
        alone = [words for words in against.values() if len(words) < 2]
        if clear and sorted(alone) == [[], ["spread"], ["tape"]]:
            return OwnCase(floor, against)
    raise ValueError(f"none of {MOST_DRAWS} floors is a case to decide: take another seed")


def with_own_case(cells: list[dict[str, Any]], seed: int) -> list[dict[str, Any]]:
    """Cells of a chapter, its floor to be decided on replaced where it has one."""
    if not any(f"course.{TASK}(" in cell["source"] for cell in cells):
        return cells
    floor = own_case(seed).floor

    def told(match: re.Match[str]) -> str:
        return match.group().replace(str(SHOWN), str(floor))

    return [{**cell, "source": FLOOR.sub(told, cell["source"])} for cell in cells]
