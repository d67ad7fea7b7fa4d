"""A handout's own case of each *Decide*: one that no chapter shows, drawn from the lecturer's seed.

What is right there stands in hidden cells and in solutions alone: students get the case's number.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import cache
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from scipy.spatial import cKDTree

from segmap.metrics import doubled_walls
from segmap.quadtree import QuadtreeMap, build_map
from segmap.simulation import URG_04LX, office, simulate

from .. import (
    decide_map,
    decide_way,
    explore,
    four_ways,
    occupied_centres,
    sample_points,
    unknown_building,
)
from ..exercises.open.decision import KEPT, Decision

#: Cases to draw from: each is one that can be decided, or is drawn again.
CASES = 10_000


class OwnCase(NamedTuple):
    """A number, and for each name the words that refuse it: none for the one to keep."""

    decision: Decision
    number: int
    against: dict[str, list[str]]

    @property
    def solution(self) -> dict[str, str]:
        """A right answer."""
        return {name: (words or [KEPT])[0] for name, words in self.against.items()}

    @property
    def seals(self) -> str:
        """The seals of all that is right."""
        right = [(name, w) for name, words in self.against.items() for w in words or [KEPT]]
        return " ".join(sorted(self.decision.seal(name, word) for name, word in right))


def figures_of_maps(floor: int) -> dict[str, dict[str, float]]:
    """By how much each witness is beyond its limit in each map, by the text of chapter 13."""
    case, figures = unknown_building(floor), {}
    for name, alignment in case.alignments.items():
        verdict = alignment.verdict_on(case.maps[name])
        unsure = 0.5 if verdict.sure is None else 0.9 - float(alignment.locally_sure.mean())
        off = max(abs(case.measured(name, taped) - taped.metres) for taped in case.tape)
        figures[name] = {
            "verdict": max(bool(verdict.causes) - 0.5, unsure),
            "doubled": doubled_walls(case.maps[name], alignment.poses[:, :2]) - 0.25,
            "tape": off - 3 * 0.03,
        }
    return figures


def figures_of_ways(number: int) -> dict[str, dict[str, float]]:
    """By how much each reason is beyond its limit in each way, by the text of chapter 61."""
    ways = four_ways(number)
    metres = {name: float(np.hypot(*np.diff(way, axis=0).T).sum()) for name, way in ways.items()}
    seen = {name: near_and_unknown(tuple(map(tuple, way))) for name, way in ways.items()}
    least = min((metres[name] for name, by in seen.items() if max(by) < 0), default=np.inf)
    return {
        name: {"wall": near, "unknown": unknown, "long": metres[name] / least - 1.1}
        for name, (near, unknown) in seen.items()
    }


@cache
def near_and_unknown(way: tuple[tuple[float, float], ...]) -> tuple[float, float]:
    """By how much a way is nearer than 0.25 m to a wall, and over unknown places by parts of it."""
    map, steps = map_of_ways(), sample_points([*pairwise(way)], 0.01)
    centres = occupied_centres(map)
    away = np.asarray(cKDTree(centres).query(steps)[0])
    nearest = steps[away <= away.min() + map.resolution]  # No other place can have the least gap.
    gap = np.maximum(np.abs(nearest[:, None] - centres) - map.resolution / 2, 0)
    unknown = (map.occupancy(steps) == 0.5).mean()
    return 0.25 - float(np.hypot(*gap.T).min()), float(unknown) - 0.02


@cache
def map_of_ways() -> QuadtreeMap:
    """The map of chapter 61 after 30 metres of its drive."""
    rng = np.random.default_rng(1)
    walls = office(rng=rng)
    drive = explore(walls, rng=rng)
    path = drive.poses[drive.metres < 30]
    log = simulate(walls, path, sensor=URG_04LX, rng=np.random.default_rng(69))
    return build_map(log, path, resolution=0.05, free_resolution=0.1)


class Judged(NamedTuple):
    """A task of judgement that has a case of its own in each handout."""

    decision: Decision
    #: The case that its chapter shows, and what stands before and behind its number there.
    shown: int
    places: tuple[tuple[str, str], ...]
    figures: Callable[[int], dict[str, dict[str, float]]]
    #: So far from its limit is each figure of a case, lest another machine decides otherwise.
    margins: dict[str, float]
    #: The words that alone refuse one each; none refuses the one to keep.
    alone: tuple[str, ...]

    def case(self, number: int) -> OwnCase | None:
        """A case, if it can be decided."""
        figures = self.figures(number)
        against = {name: [w for w, by in f.items() if by > 0] for name, f in figures.items()}
        clear = all(abs(by) >= self.margins[w] for f in figures.values() for w, by in f.items())
        alone = sorted(words for words in against.values() if len(words) < 2)
        right = clear and alone == [[], *([word] for word in self.alone)]
        return OwnCase(self.decision, number, against) if right else None

    def told(self, source: str, number: int) -> str:
        """A cell of the chapter with another case's number."""
        for before, behind in self.places:
            source = re.sub(rf"(?<={before}){self.shown}(?={behind})", str(number), source)
        return source


#: Name of each task of judgement -> how its cases are drawn.
JUDGED = {
    judged.decision.name: judged
    for judged in (
        Judged(
            decide_map,
            4,
            ((r"\bfloor ", r"\b"), (r"unknown_building\(", r"\)")),
            figures_of_maps,
            {"verdict": 0.03, "doubled": 0.03, "tape": 0.03},
            ("tape", "verdict"),
        ),
        Judged(
            decide_way,
            1676,
            ((r"four_ways\(", r"\)"),),
            figures_of_ways,
            {"wall": 0.005, "unknown": 0.01, "long": 0.02},
            ("long", "unknown", "wall"),
        ),
    )
}


@cache
def own_case(task: str, seed: int) -> OwnCase:
    """The case of a seed: one to keep, and others that one word alone refuses.

    About every second floor is a case of `decide_map`, of four ways one in a hundred.
    """
    judged = JUDGED[task]
    rng = np.random.default_rng((seed, judged.shown))
    while True:
        if case := judged.case(int(rng.integers(judged.shown + 1, CASES))):
            return case


def with_own_case(cells: list[dict[str, Any]], seed: int) -> list[dict[str, Any]]:
    """Cells of a chapter, the number of its case replaced where it has one."""
    for task, judged in JUDGED.items():
        if any(f"course.{task}(" in cell["source"] for cell in cells):
            number = own_case(task, seed).number
            cells = [{**cell, "source": judged.told(cell["source"], number)} for cell in cells]
    return cells
