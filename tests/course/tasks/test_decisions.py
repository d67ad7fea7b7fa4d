"""What is right in a task of judgement: by the figures that a student reads, printed nowhere."""

from itertools import pairwise

import numpy as np
import pytest
import segmap_course as course
from chapter_rules import ROOT
from segmap_course import OPEN_EXERCISES, Decision
from segmap_course.grading import read_chapter

from segmap.metrics import doubled_walls

DECISIONS = {name: one for name, one in OPEN_EXERCISES.items() if isinstance(one, Decision)}


def sealed(decision, against):
    """Seals of what is right, where `against` is a name -> the witnesses that refuse it."""
    pairs = [(name, word) for name, words in against.items() for word in (words or {"keep"})]
    return {decision.seal(name, word) for name, word in pairs}


def maps_of_floor_4():
    """By the text of chapter 13: three deviations, a quarter of the walls."""
    case, against = course.unknown_building(4), {}
    for name, alignment in case.alignments.items():
        verdict, path = alignment.verdict_on(case.maps[name]), alignment.poses[:, :2]
        off = [case.measured(name, taped) - taped.metres for taped in case.tape]
        told = {
            "verdict": verdict.grade != "good",
            "doubled": doubled_walls(case.maps[name], path) > 0.25,
            "tape": max(np.abs(off)) > 3 * 0.03,
        }
        against[name] = {word for word in told if told[word]}
    return against


def ways_of_1676():
    """By the text of chapter 61, on its map as its cells make it."""
    cells = read_chapter(ROOT / "notebooks" / "61_where_to_go_next.ipynb")["cells"]
    code = [cell["source"] for cell in cells if cell["cell_type"] == "code"]
    names = {}
    for source in code[:3]:
        exec(source, names)
    (source,) = (source for source in code if "def clearance" in source)
    exec(source, names)
    ways, clearance, tree = course.four_ways(1676), names["clearance"], names["tree"]
    metres = {name: np.hypot(*np.diff(way, axis=0).T).sum() for name, way in ways.items()}
    steps = {name: course.sample_points([*pairwise(way)], 0.01) for name, way in ways.items()}
    told = {
        name: {
            "wall": clearance(way) < 0.25,
            "unknown": (tree.occupancy(steps[name]) == 0.5).any(),
            "long": metres[name] > 1.1 * metres["M"],
        }
        for name, way in ways.items()
    }
    return {name: {word for word in words if words[word]} for name, words in told.items()}


@pytest.mark.parametrize(
    ("name", "figures"), [("decide_map", maps_of_floor_4), ("decide_way", ways_of_1676)]
)
def test_what_is_right_is_what_the_figures_say(name, figures):
    """Catches an answer that was right for the maps of another version."""
    decision, against = DECISIONS[name], figures()
    assert tuple(against) == decision.names
    assert [*map(bool, against.values())].count(False) == decision.keeps
    assert sealed(decision, against) == {*decision.seals.split()}
