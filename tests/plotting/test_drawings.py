"""One contract for every `draw_*`: axes, figure, labels, colours, and nothing to draw."""

from dataclasses import replace

import matplotlib.pyplot as plt
import numpy as np
import pytest
import segmap_course as course
from matplotlib.colors import to_hex, to_rgba

from segmap import build_map, load, plotting, quadtree
from segmap.alignment import (
    Alignment,
    backbone_steps,
    point_steps,
)
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
LAND = course.Landscape(np.array([-0.1, 0, 0.1]), np.diag([0.0, 2.0, 0.0]))
RUNS = course.thesis_results()
USC = select(RUNS, map="usc", filtered=False)
#: Of the methods that the thesis compares.
THESIS = {method_style(method, 0)[0] for method in USC["method"]}


def plan_of_the_room():
    log = load("room")
    free = quadtree.build_map(log, log.truth, resolution=0.05, free_resolution=0.05)
    return floor_plan(build_map(log, log.truth), free)


#: Each drawing on given axes, and the colours that it uses: every meaning has its own everywhere.
DRAWINGS = {
    "against_walls": (
        lambda ax: plotting.draw_against_walls(JUDGED, ax=ax),
        {GROUPS[6], MAP, RESULT, ERROR},
    ),
    "alignment": (lambda ax: plotting.draw_alignment(LOG, ALIGNED, ax=ax), {RAW, RESULT, ERROR}),
    "backbone": (
        lambda ax: course.draw_backbone(backbone_steps(load("corridor")[:2])[1], ax=ax),
        {MAP, RESULT, ERROR},
    ),
    "basin": (lambda ax: course.draw_basin([["right"]], [0.0], [0.0], ax=ax), {RESULT}),
    "before_after": (
        lambda ax: plotting.draw_before_after(WALLS, REDUCED, ax=ax),
        {MAP, RESULT},
    ),
    "cells": (lambda ax: course.draw_cells(TREE, TREE.to_grid() > 0.5, ax=ax), {ERROR}),
    "classes": (lambda ax: course.draw_classes(ros_classes(TREE), ax=ax), set()),
    "climb": (lambda ax: course.draw_climb(POSES, ax=ax), {RESULT}),
    "corner": (lambda ax: course.draw_corner(1.2, 1.3, 0.7, ax=ax), {MAP, RESULT, ERROR}),
    "counts": (
        lambda ax: course.draw_counts({(0, 0, 2): (3, 0)}, beams=[[(0, 0), (1, 1)]], ax=ax),
        {"#939393", RESULT, ERROR},
    ),
    "curves": (lambda ax: plotting.draw_curves(USC, ax=ax), THESIS),
    "ends": (lambda ax: course.draw_ends(TREE, ax=ax), {MAP, RESULT, ERROR}),
    "equal_squares": (
        lambda ax: course.draw_equal_squares(POINTS, 0.5, ax=ax),
        {MAP, RESULT, ERROR},
    ),
    "ends_on_map": (
        lambda ax: course.draw_ends_on_map(TREE, [(1.05, 0.05), (0, 1)], nearest=True, ax=ax),
        {ERROR, RESULT},
    ),
    "fits": (
        lambda ax: course.draw_fits(POINTS, {"a": (0, 0, 1, 0), "b": (0, 0, 0, 1)}, ax=ax),
        {RAW, MAP, RESULT, ERROR},
    ),
    "frontiers": (
        lambda ax: course.draw_frontiers(frontiers(TREE, min_size=1), ax=ax),
        {GROUPS[0]},
    ),
    "icp_step": (
        lambda ax: course.draw_icp_step(POINTS, point_steps(POINTS, POINTS)[0], ax=ax),
        {RAW, RESULT, ERROR},
    ),
    "labels": (
        lambda ax: course.draw_labels(
            np.eye(3, dtype=np.int64), WALLS[:1], (0, 0), 0.1, lines=([1], []), ax=ax
        ),
        {MAP, RAW},
    ),
    "landscape": (lambda ax: course.draw_landscape(LAND, ax=ax), {ERROR, TRUTH}),
    "leaves": (
        lambda ax: course.draw_leaves(LEAVES, ax=ax, marked=[(0, 0, 1)], points=[(1, 1)]),
        {"#d9d9d9", RESULT, ERROR},
    ),
    "live": (
        lambda ax: course.draw_live({"a": hybrid(SEEN), "b": hybrid(SEEN)}, ax=ax),
        set(GROUPS[:2]),
    ),
    "log": (lambda ax: plotting.draw_log(LOG, ax=ax), {RAW, TRUTH}),
    "method_errors": (
        lambda ax: course.draw_method_errors({n: {"a": 0.1, "b": 1} for n in "xy"}, ax=ax),
        set(GROUPS[:2]),
    ),
    "marked": (lambda ax: course.draw_marked(WALLS, [True, False, True], ax=ax), {RAW, ERROR}),
    "match": (lambda ax: course.draw_match(*WALLS[[0, 2]], ax=ax), {RAW, MAP, ERROR}),
    "match_value": (
        lambda ax: course.draw_match_value(WALLS[0], WALLS[0] + 0.1, ax=ax),
        {MAP, ERROR},
    ),
    "merge": (lambda ax: course.draw_merge(WALLS[:2], WALLS[2], ax=ax), {RAW, MAP, RESULT}),
    "missed": (
        lambda ax: course.draw_missed(WALLS[[0, 2]], [(0, -0.04), (5, -0.04)], ax=ax),
        {RAW, MAP, RESULT, ERROR},
    ),
    "runs": (
        lambda ax: course.draw_runs([POINTS, POINTS[:1]], WALLS[:1], ax=ax),
        {MAP, ERROR, GROUPS[0]},
    ),
    "path": (lambda ax: plotting.draw_path(POSES, ax=ax), {TRUTH}),
    "points": (lambda ax: plotting.draw_points(POINTS, ax=ax), {RAW}),
    "plan": (
        lambda ax: plotting.draw_plan(plan_of_the_room(), ax=ax),
        {RAW, MAP, ERROR, *GROUPS[:3]},
    ),
    "poses": (lambda ax: plotting.draw_poses(POSES, ax=ax), {RESULT}),
    "position_errors": (
        lambda ax: plotting.draw_position_errors(LOG, {"a": POSES, "b": ALIGNED}, ax=ax),
        {ERROR, RESULT},
    ),
    "hill": (lambda ax: course.draw_hill([0, 0.1], [0, 0.05], 0.2, ax=ax), {MAP, ERROR}),
    "profile": (lambda ax: course.draw_profile([-1, 0, 1], [0, 2, 0], ax=ax), {RESULT, ERROR}),
    "provenance": (
        lambda ax: plotting.draw_provenance(WALLS, REDUCED, ax=ax),
        set(GROUPS[:2]),
    ),
    "quadtree": (lambda ax: plotting.draw_quadtree(TREE, ax=ax, robot=(1, 1)), {RESULT, ERROR}),
    "ray": (lambda ax: course.draw_ray((0, 0), (14, 5), ax=ax), {RESULT, RAW, ERROR}),
    "robot": (lambda ax: plotting.draw_robot((0, 0, 0), ax=ax), {ERROR}),
    "scan": (lambda ax: plotting.draw_scan(SCAN, ax=ax, beams=True), {RAW, ERROR}),
    "scans": (
        lambda ax: course.draw_scans(POINTS, POINTS, (0, 0, 0), ax=ax, pulls=[POINTS[:2]]),
        {RAW, RESULT, ERROR},
    ),
    "contradiction": (
        lambda ax: course.draw_contradiction((0, 0), {"a": np.eye(2), "b": np.eye(2)}, 9, ax=ax),
        {RESULT, ERROR, MAP},
    ),
    "known_line": (lambda ax: course.draw_known_line(LINE, [LINE, LINE], ax=ax), {RAW, RESULT}),
    "seen_wall": (
        lambda ax: course.draw_seen_wall([(0, 1), (1, 1)], (0, 0), (0.01, 0.01), ax=ax),
        {RAW, ERROR, RESULT, TRUTH, MAP},
    ),
    "sector": (
        lambda ax: course.draw_sector(
            [(0, 1), (1, 1)], (0, 0), {"a": np.array([(0, 2), (1, 2)])}, ax=ax
        ),
        {RAW, MAP, RESULT},
    ),
    "segments": (lambda ax: plotting.draw_segments(WALLS, ax=ax), {MAP}),
    "sizes_of_halls": (
        lambda ax: course.draw_sizes_of_halls({1.0: 9, 2.0: 20}, ax=ax),
        {RAW, RESULT},
    ),
    "strip": (lambda ax: course.draw_strip(WALLS[[0, 2]], 0.0, 0.01, ax=ax), {RAW, MAP, ERROR}),
    "uncertainty": (
        lambda ax: course.draw_uncertainty(Matched(np.zeros(3), np.eye(3), True), ax=ax),
        {RESULT},
    ),
    "wall_normals": (
        lambda ax: course.draw_wall_normals([(0, 0), (1, 0)], [(0, 1), (np.nan, np.nan)], ax=ax),
        {RAW, RESULT, ERROR},
    ),
    "weights": (lambda ax: course.draw_weights([0.1, -0.2], [0.9, 0.8], ax=ax), {RAW, ERROR}),
}
#: Drawings that make a figure of several pictures, and whether these have their limits in common.
ROWS = {
    "alignments": (lambda: plotting.draw_alignments(LOG, {"a": POSES, "b": ALIGNED}), True),
    "cases": (lambda: course.draw_cases({"a": WALLS, "b": WALLS[:1]}, lambda map: map[:1]), False),
    "cells_of_a_wall": (
        lambda: course.draw_cells_of_a_wall({0.5: LEAVES, 1.0: LEAVES}, limits=(0, 2, 0, 2)),
        True,
    ),
    "clusters": (
        lambda: course.draw_clusters(WALLS, {p: [((0, 2), WALLS[0], 0.1)] for p in (0.1, 1.0)}),
        True,
    ),
    "distance_curves": (lambda: course.draw_distance_curves(segment_distance), False),
    "edges": (lambda: course.draw_edges({"a": [(0, 0, 0)], "b": [(3, 4, 0)]}, []), True),
    "distance_terms": (lambda: course.draw_distance_terms(WALLS[0], WALLS[2]), True),
    "frames": (lambda: course.draw_frames(SCAN, {"a": (0, 0, 0), "b": (3, 4, 0)}), True),
    "laid": (
        lambda: course.draw_laid(WALLS, WALLS, {"right": (0, 0, 0), "wrong": (1, 2, 3)}),
        True,
    ),
    "leaf_row": (lambda: course.draw_leaf_row({"a": LEAVES, "b": LEAVES}), True),
    "maps": (lambda: plotting.draw_maps({"a": WALLS, "b": WALLS[:1]}), True),
    "pieces": (
        lambda: course.draw_pieces(
            {"a": WALLS[:1], "b": WALLS[:1]},
            WALLS[:2],
            lambda *_: [(0, 0.5, 0, 0), (0.5, 1, -1, 0)],
        ),
        False,
    ),
    "phases": (lambda: course.draw_phases([(0, 0, 0)], WALLS, WALLS[:1], 0.2), True),
    "landscapes": (lambda: course.draw_landscapes({"a": LAND, "b": LAND}), True),
    "splits": (lambda: course.draw_splits([(0, 0), (1, 1)], {1.0: WALLS, 0.3: WALLS[:1]}), True),
    "scan_poses": (
        lambda: course.draw_scan_poses(
            POINTS, POINTS, {"a": (0, 0, 0), "b": (1, 0, 0)}, (-1, -1, 3, 2)
        ),
        True,
    ),
}
#: Drawings that make a figure of a map and a chart.
BESIDE_A_CHART = {
    "shifts": lambda: course.draw_shifts(
        POINTS, POINTS, (0, 0, 0), {"along": (1, 0), "across": (0, 1)}
    ),
}
#: Drawings that make a figure of pictures with limits of their own.
OF_THEIR_OWN = {
    "closer": lambda: course.draw_closer({"a": WALLS, "b": WALLS[:1]}, (1, -1, 2, 1)),
    "costs": lambda: course.draw_costs(WALLS, WALLS, [0.1, np.inf, 0.2]),
    "leaning": lambda: course.draw_leaning([1.0, 2.0], 0.01),
    "moved": lambda: course.draw_moved(WALLS, WALLS + 0.01, (1, -1, 2, 1)),
    "normals": lambda: course.draw_normals(WALLS, at=(1, 2), box=(0.2, 0.1)),
    "sweep": lambda: course.draw_sweep(WALLS[[0]], 0.04, [1, 2], 0.01),
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
    assert draw(ax) is ax and plt.get_fignums() == []
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
    current, row = plt.figure(), draw()
    assert len(plt.get_fignums()) == 2 and row[0].figure is not current
    assert {ax.figure for ax in row} == {row[0].figure} and row[0].figure.dpi == plotting.DPI
    assert all(ax.get_title() for ax in row) and len({ax.get_ylim() for ax in row}) == 1
    assert not shared or len({ax.get_xlim() for ax in row}) == 1


@pytest.mark.parametrize("name", BESIDE_A_CHART)
def test_a_map_beside_its_chart_has_titles_and_units(name):
    """Catches a chart without units, and a map that is longer in x than in y."""
    maps, chart = BESIDE_A_CHART[name]()
    assert maps.figure is chart.figure and maps.get_title() and chart.get_title()
    assert maps.get_aspect() == 1 and maps.get_xlabel() == "x [m]"
    assert "[cm]" in chart.get_xlabel() and "[cm]" in chart.get_ylabel() and chart.get_legend()


@pytest.mark.parametrize("name", OF_THEIR_OWN)
def test_pictures_of_one_figure_have_titles_and_metres(name):
    """Catches a figure of another resolution, and a picture that does not say what it shows."""
    axes = OF_THEIR_OWN[name]()
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
