"""One contract for every `draw_*`: axes, figure, labels, colours, and nothing to draw."""

from dataclasses import replace
from functools import partial

import matplotlib.pyplot as plt
import numpy as np
import pytest
import segmap_course as course
from matplotlib.colors import to_hex, to_rgba

from segmap import build_map, load, plotting, quadtree
from segmap.alignment import Alignment, backbone_steps, point_steps
from segmap.alignment import Match as Matched
from segmap.experiments import select
from segmap.exports import ros_classes
from segmap.metrics import against_walls, segment_distance
from segmap.plan import floor_plan
from segmap.plotting import ERROR, GROUPS, MAP, RAW, RESULT, TRUTH, method_style
from segmap.quadtree import QuadtreeMap, frontiers
from segmap.reduction import Reduction, hybrid
from segmap.reduction.surveyed import Line
from segmap.scans import LaserScan, Log
from segmap.segments import SegmentMap

WALLS = np.array([[(0, 0), (4, 0)], [(4, 0), (4, 3)], [(0, 0.02), (4, 0.02)]], float)
SEEN = SegmentMap(WALLS, [0, 0, 1])
REDUCED = Reduction(WALLS[:2], np.array([0, 1, 0]), 0.0, "by hand")
JUDGED = against_walls([*WALLS[:2], [(1, 1), (1, 2)]], [*WALLS, [(2, 1), (2, 2)]])
SCAN = LaserScan([1.0, 2.0], [0.0, 0.5])
POSES = np.array([(0, 0, 0), (1, 0, 0.1), (2, 1, 0.2)], float)
LOG = Log("three", [replace(SCAN, odometry=tuple(pose)) for pose in POSES], truth=POSES)
ALIGNED = Alignment(POSES, np.array([True, False, True]), 0.0, "by hand", ("", "turning", ""))
POINTS = np.array([(0.1 * k, 0) for k in range(30)])
TREE = QuadtreeMap(resolution=0.5, size=8, bias=1)
TREE.insert_scan((1, 1), [(3.25, 1.25)])
#: Leaves of a quadtree, and how many ends each has.
LEAVES = {(0, 0, 1): 1, (1, 0, 1): 0, (0, 1, 1): 0, (1, 1, 1): 2}
#: A line that is known.
LINE = Line(0, 1, np.pi / 2, 1e-4, 0, 1e-4)
PIECES = [(0, 0.5, 0, 0), (0.5, 1, -1, 0)]
LAND = course.Landscape(np.array([-0.1, 0, 0.1]), np.diag([0.0, 2.0, 0.0]))
RUNS = course.thesis_results()
USC = select(RUNS, map="usc", filtered=False)
#: Of the methods that the thesis compares.
THESIS = {method_style(method, 0)[0] for method in USC["method"]}


def plan_of_the_room():
    log = load("room")
    free = quadtree.build_map(log, log.truth, resolution=0.05, free_resolution=0.05)
    return floor_plan(build_map(log, log.truth), free)


class Late(partial):
    """What a drawing is given, made once it is asked for."""


def case(what, *given, **named):
    """What is expected of a drawing, and a function that calls it with these arguments."""

    def drawn(name, **more):
        draw = getattr(plotting, f"draw_{name}", None) or getattr(course, f"draw_{name}")
        return draw(*(g() if isinstance(g, Late) else g for g in given), **named, **more)

    return drawn, what


#: Each drawing on given axes, and the colours that it uses: every meaning has its own everywhere.
DRAWINGS = {
    "against_walls": case({GROUPS[6], MAP, RESULT, ERROR}, JUDGED),
    "alignment": case({RAW, RESULT, ERROR}, LOG, ALIGNED),
    "backbone": case({MAP, RESULT, ERROR}, Late(lambda: backbone_steps(load("corridor")[:2])[1])),
    "basin": case({RESULT}, [["right"]], [0.0], [0.0]),
    "before_after": case({MAP, RESULT}, WALLS, REDUCED),
    "cells": case({ERROR}, TREE, TREE.to_grid() > 0.5),
    "classes": case(set(), Late(lambda: ros_classes(TREE))),
    "climb": case({RESULT}, POSES),
    "corner": case({MAP, RESULT, ERROR}, 1.2, 1.3, 0.7),
    "counts": case({"#939393", RESULT, ERROR}, {(0, 0, 2): (3, 0)}, beams=[[(0, 0), (1, 1)]]),
    "curves": case(THESIS, USC),
    "ends": case({MAP, RESULT, ERROR}, TREE),
    "equal_squares": case({MAP, RESULT, ERROR}, POINTS, 0.5),
    "ends_on_map": case({ERROR, RESULT}, TREE, [(1.05, 0.05), (0, 1)], nearest=True),
    "fits": case({RAW, MAP, RESULT, ERROR}, POINTS, {"a": (0, 0, 1, 0), "b": (0, 0, 0, 1)}),
    "frontiers": case({GROUPS[0]}, Late(lambda: frontiers(TREE, min_size=1))),
    "icp_step": case({RAW, RESULT, ERROR}, POINTS, Late(lambda: point_steps(POINTS, POINTS)[0])),
    "labels": case({MAP, RAW}, np.eye(3, dtype=np.int64), WALLS[:1], (0, 0), 0.1, lines=([1], [])),
    "landscape": case({ERROR, TRUTH}, LAND),
    "leaves": case({"#d9d9d9", RESULT, ERROR}, LEAVES, marked=[(0, 0, 1)], points=[(1, 1)]),
    "live": case(set(GROUPS[:2]), Late(lambda: {"a": hybrid(SEEN), "b": hybrid(SEEN)})),
    "log": case({RAW, TRUTH}, LOG),
    "method_errors": case(set(GROUPS[:2]), {n: {"a": 0.1, "b": 1} for n in "xy"}),
    "marked": case({RAW, ERROR}, WALLS, [True, False, True]),
    "match": case({RAW, MAP, ERROR}, *WALLS[[0, 2]]),
    "match_value": case({MAP, ERROR}, WALLS[0], WALLS[0] + 0.1),
    "merge": case({RAW, MAP, RESULT}, WALLS[:2], WALLS[2]),
    "missed": case({RAW, MAP, RESULT, ERROR}, WALLS[[0, 2]], [(0, -0.04), (5, -0.04)]),
    "runs": case({MAP, ERROR, GROUPS[0]}, [POINTS, POINTS[:1]], WALLS[:1]),
    "path": case({TRUTH}, POSES),
    "points": case({RAW}, POINTS),
    "plan": case({RAW, MAP, ERROR, *GROUPS[:3]}, Late(plan_of_the_room)),
    "poses": case({RESULT}, POSES),
    "position_errors": case({ERROR, RESULT}, LOG, {"a": POSES, "b": ALIGNED}),
    "hill": case({MAP, ERROR}, [0, 0.1], [0, 0.05], 0.2),
    "profile": case({RESULT, ERROR}, [-1, 0, 1], [0, 2, 0]),
    "provenance": case(set(GROUPS[:2]), WALLS, REDUCED),
    "quadtree": case({RESULT, ERROR}, TREE, robot=(1, 1)),
    "ray": case({RESULT, RAW, ERROR}, (0, 0), (14, 5)),
    "robot": case({ERROR}, (0, 0, 0)),
    "scan": case({RAW, ERROR}, SCAN, beams=True),
    "scans": case({RAW, RESULT, ERROR}, POINTS, POINTS, (0, 0, 0), pulls=[POINTS[:2]]),
    "contradiction": case({RESULT, ERROR, MAP}, (0, 0), {"a": np.eye(2), "b": np.eye(2)}, 9),
    "known_line": case({RAW, RESULT}, LINE, [LINE, LINE]),
    "seen_wall": case({RAW, ERROR, RESULT, TRUTH, MAP}, [(0, 1), (1, 1)], (0, 0), (0.01, 0.01)),
    "sector": case({RAW, MAP, RESULT}, [(0, 1), (1, 1)], (0, 0), {"a": np.array([(0, 2), (1, 2)])}),
    "segments": case({MAP}, WALLS),
    "sizes_of_halls": case({RAW, RESULT}, {1.0: 9, 2.0: 20}),
    "strip": case({RAW, MAP, ERROR}, WALLS[[0, 2]], 0.0, 0.01),
    "uncertainty": case({RESULT}, Matched(np.zeros(3), np.eye(3), True)),
    "wall_normals": case({RAW, RESULT, ERROR}, [(0, 0), (1, 0)], [(0, 1), (np.nan, np.nan)]),
    "weights": case({RAW, ERROR}, [0.1, -0.2], [0.9, 0.8]),
}
#: Drawings that make a figure of several pictures, and whether these have their limits in common.
ROWS = {
    "alignments": case(True, LOG, {"a": POSES, "b": ALIGNED}),
    "cases": case(False, {"a": WALLS, "b": WALLS[:1]}, lambda map: map[:1]),
    "cells_of_a_wall": case(True, {0.5: LEAVES, 1.0: LEAVES}, limits=(0, 2, 0, 2)),
    "clusters": case(True, WALLS, {p: [((0, 2), WALLS[0], 0.1)] for p in (0.1, 1.0)}),
    "distance_curves": case(False, segment_distance),
    "edges": case(True, {"a": [(0, 0, 0)], "b": [(3, 4, 0)]}, []),
    "distance_terms": case(True, WALLS[0], WALLS[2]),
    "frames": case(True, SCAN, {"a": (0, 0, 0), "b": (3, 4, 0)}),
    "laid": case(True, WALLS, WALLS, {"right": (0, 0, 0), "wrong": (1, 2, 3)}),
    "leaf_row": case(True, {"a": LEAVES, "b": LEAVES}),
    "maps": case(True, {"a": WALLS, "b": WALLS[:1]}),
    "pieces": case(False, {n: WALLS[:1] for n in "ab"}, WALLS[:2], lambda *_: PIECES),
    "phases": case(True, [(0, 0, 0)], WALLS, WALLS[:1], 0.2),
    "landscapes": case(True, {"a": LAND, "b": LAND}),
    "splits": case(True, [(0, 0), (1, 1)], {1.0: WALLS, 0.3: WALLS[:1]}),
    "scan_poses": case(True, POINTS, POINTS, {"a": (0, 0, 0), "b": (1, 0, 0)}, (-1, -1, 3, 2)),
}
#: Drawings that make a figure of a map and a chart.
BESIDE_A_CHART = {
    "shifts": case(None, POINTS, POINTS, (0, 0, 0), {"along": (1, 0), "across": (0, 1)})
}
#: Drawings that make a figure of pictures with limits of their own.
OF_THEIR_OWN = {
    "closer": case(None, {"a": WALLS, "b": WALLS[:1]}, (1, -1, 2, 1)),
    "costs": case(None, WALLS, WALLS, [0.1, np.inf, 0.2]),
    "leaning": case(None, [1.0, 2.0], 0.01),
    "moved": case(None, WALLS, WALLS + 0.01, (1, -1, 2, 1)),
    "normals": case(None, WALLS, at=(1, 2), box=(0.2, 0.1)),
    "sweep": case(None, WALLS[[0]], 0.04, [1, 2], 0.01),
}
#: What x or y is these do not know: the caller says it.
CALLER_LABELS = {"basin", "climb", "trade_off"}
#: Along x and y in metres, with scales of their own so that what is near can be told apart.
STRETCHED = {"missed", "strip"}


pytestmark = pytest.mark.usefixtures("agg")


def colors_of(ax):
    """Colours of lines, patches and collections, but for those that stand for a value."""
    plain = [c for c in ax.collections if c.get_array() is None]
    found = [line.get_color() for line in ax.lines]
    found += [patch.get_facecolor() for patch in ax.patches]
    found += [color for c in plain for color in (*c.get_edgecolor(), *c.get_facecolor())]
    return {to_hex(color) for color in found if to_rgba(color)[3] > 0}


def test_every_drawing_is_in_the_contract():
    """Catches a new drawing that nothing looks at."""
    public = {n for room in (plotting, course) for n in dir(room) if n.startswith("draw_")}
    assert public == {f"draw_{name}" for name in (*DRAWINGS, *ROWS, *BESIDE_A_CHART, *OF_THEIR_OWN)}


@pytest.mark.parametrize("name", DRAWINGS)
def test_a_drawing_uses_the_axes_given_and_the_colours_that_all_share(name, ax):
    """Catches a figure of pyplot left over, axes without names, walls longer in x than in y."""
    draw, colors = DRAWINGS[name]
    assert draw(name, ax=ax) is ax and plt.get_fignums() == []
    assert colors_of(ax) == colors
    labels = ax.get_xlabel(), ax.get_ylabel()
    assert all(labels) or name in CALLER_LABELS
    if "x [m]" in labels:
        assert labels == ("x [m]", "y [m]") and (ax.get_aspect() == 1) is (name not in STRETCHED)
    assert 1000 < len(plotting.figure_png(ax.figure)) < 40_000


@pytest.mark.parametrize("name", ROWS)
def test_a_row_of_pictures_is_one_figure_with_titles_at_one_scale(name):
    """Catches a small map blown up until it looks as large as the other, and lost titles."""
    draw, shared = ROWS[name]
    current, row = plt.figure(), draw(name)
    assert len(plt.get_fignums()) == 2 and row[0].figure is not current
    assert {ax.figure for ax in row} == {row[0].figure} and row[0].figure.dpi == plotting.DPI
    assert all(ax.get_title() for ax in row) and len({ax.get_ylim() for ax in row}) == 1
    assert not shared or len({ax.get_xlim() for ax in row}) == 1


@pytest.mark.parametrize("name", BESIDE_A_CHART)
def test_a_map_beside_its_chart_has_titles_and_units(name):
    """Catches a chart without units, and a map that is longer in x than in y."""
    maps, chart = BESIDE_A_CHART[name][0](name)
    assert maps.figure is chart.figure and maps.get_title() and chart.get_title()
    assert maps.get_aspect() == 1 and maps.get_xlabel() == "x [m]"
    assert "[cm]" in chart.get_xlabel() and "[cm]" in chart.get_ylabel() and chart.get_legend()


@pytest.mark.parametrize("name", OF_THEIR_OWN)
def test_pictures_of_one_figure_have_titles_and_metres(name):
    """Catches a figure of another resolution, and a picture that does not say what it shows."""
    axes = OF_THEIR_OWN[name][0](name)
    assert {ax.figure for ax in axes} == {axes[0].figure} and axes[0].figure.dpi == plotting.DPI
    other = {"sweep": "shift of the strip [mm]", "normals": "theta [degrees]"}
    below = other.get(name, "x [m]")
    assert all(ax.get_title() for ax in axes) and axes[-1].get_xlabel() == below
    assert "[m]" in axes[-1 if name == "sweep" else 0].get_ylabel()


# ------------------------------------------------------------------------- colours
#: What a reader sees of red, green and blue: Machado, Oliveira, Fernandes 2009.
CONES = {
    "all": np.eye(3),
    "no green": [(0.367322, 0.860646, -0.227968), (0.280085, 0.672501, 0.047413),
                 (-0.01182, 0.04294, 0.968881)],
    "no red": [(0.152286, 1.052583, -0.204868), (0.114503, 0.786281, 0.099216),
               (-0.003882, -0.048116, 1.051998)],
}  # fmt: skip


@pytest.mark.parametrize("cones", CONES)
def test_the_colours_with_a_meaning_can_be_told_apart(cones):
    """Catches grey dots with a green path of the same lightness: one reader in twelve loses it."""
    light = np.array([to_rgba(color)[:3] for color in (RAW, MAP, RESULT, TRUTH, ERROR)])
    linear = np.where(light <= 0.04045, light / 12.92, ((light + 0.055) / 1.055) ** 2.4)
    mixed = np.clip(linear @ np.transpose(CONES[cones]), 0, 1)
    seen = np.where(mixed <= 0.0031308, 12.92 * mixed, 1.055 * mixed ** (1 / 2.4) - 0.055)
    gaps = np.linalg.norm(seen[:, None] - seen, axis=-1)
    assert gaps[np.triu_indices(len(seen), 1)].min() > 0.25
