"""The loops under the point matchers: each against brute force, finite differences or numpy."""

import itertools

import numpy as np
import pytest

from segmap.alignment import _points_loops as loops
from segmap.alignment import _search_loops as searching
from segmap.alignment._point_map import FINE, PointMap
from segmap.poses import between, transform
from segmap.simulation import SICK_LMS200, cast_rays, office


def clouds() -> dict[str, np.ndarray]:
    rng = np.random.default_rng(1)
    spots = rng.uniform(-5, 5, (6, 1, 2)) + rng.normal(0, 0.05, (6, 30, 2))
    return {
        "random": rng.uniform(-3, 4, (200, 2)),
        "clustered": spots.reshape(-1, 2),
        "a line": np.stack([np.linspace(0, 8, 90), np.full(90, 1.5)], -1),
        "on the edges of cells": np.array(list(itertools.product(range(6), repeat=2))) * 0.25,
        "one point": np.array([(2.0, -1.0)]),
        "one point ten times": np.full((10, 2), 0.5),
    }


def scan_points(walls: np.ndarray, pose: tuple, noise: float = 0.01, seed: int = 0) -> np.ndarray:
    """End points of a half turn of beams in the sensor's frame, with noise along the beams."""
    angles = SICK_LMS200.angles
    ranges = cast_rays(walls, pose, angles) + np.random.default_rng(seed).normal(0, noise, 181)
    return np.stack([ranges * np.cos(angles), ranges * np.sin(angles)], -1)


@pytest.mark.parametrize("name", clouds())
def test_cells_keep_every_point(name):
    """A point that is lost or doubled by the sorting, or that lies in a cell not its own."""
    points = clouds()[name]
    cells = loops.in_cells(points, 0.25)
    assert sorted(map(tuple, cells.points)) == sorted(map(tuple, points))
    assert cells.first[0] == 0
    assert cells.first[-1] == len(points)
    owner = np.repeat(np.arange(len(cells.first) - 1), np.diff(cells.first))
    np.testing.assert_array_equal(cells.points, points[cells.order])
    i, j = np.floor((cells.points - points.min(0)) / 0.25).astype(int).T
    np.testing.assert_array_equal(owner, i * cells.rows + j)


@pytest.mark.parametrize("name", clouds())
@pytest.mark.parametrize(("size", "reach"), [(0.25, 0.1), (0.25, 0.25), (0.15, 0.9), (2.0, 0.6)])
def test_nearest_is_the_nearest(name, size, reach):
    """A ring left out, a search that ends a ring too early, a reach counted in cells."""
    points = clouds()[name]
    cells = loops.in_cells(points, size)
    rng = np.random.default_rng(2)
    asked = np.concatenate(
        [
            rng.uniform(-7, 7, (150, 2)),  # outside of the box too
            points[rng.integers(0, len(points), 150)] + rng.normal(0, reach, (150, 2)),
        ]
    )
    found = np.array([loops.nearest(cells, x, y, reach) for x, y in asked])
    apart = np.hypot(*(asked[:, None] - cells.points).transpose(2, 0, 1))
    assert 0 < (found < 0).sum() < len(asked)
    np.testing.assert_array_equal(found >= 0, apart.min(1) < reach)
    np.testing.assert_array_equal(
        apart[np.arange(300), found][found >= 0], apart.min(1)[found >= 0]
    )


def test_normals_are_those_of_the_principal_axes():
    """A covariance with a sign or a factor wrong: the normal would lie along the wall."""
    points = scan_points(office(rng=np.random.default_rng(1), rooms=2), (2.0, 5.0, 0.3))
    cells = loops.in_cells(points, 0.15)
    found = loops.normals(cells, 0.12, 1.0, 5)
    walls = 0
    for point, normal in zip(cells.points, found, strict=True):
        apart = np.hypot(*(cells.points - point).T)
        radius = next((r for r in (0.12, 0.24, 0.48, 0.96) if (apart <= r).sum() >= 5), None)
        if radius is None:
            assert np.isnan(normal).all()
            continue
        value, vector = np.linalg.eigh(np.cov(cells.points[apart <= radius].T))
        assert np.isnan(normal[0]) == (value[0] >= loops.NARROW * value[1])
        if not np.isnan(normal[0]):
            assert abs(abs(normal @ vector[:, 0]) - 1) < 1e-9
            walls += 1
    assert 100 < walls < len(points)


def test_points_that_form_no_wall_have_no_normal():
    """A normal made up for a bush, or for a point that stands alone."""
    bush = np.random.default_rng(3).normal(0, 0.03, (200, 2))
    alone = np.array([(3.0, 0.0), (3.5, 0.0), (4.0, 3.0)])
    found = loops.normals(loops.in_cells(np.concatenate([bush, alone]), 0.15), 0.12, 1.0, 5)
    assert np.isnan(found).all(1).mean() > 0.95


def test_rows_are_the_derivative_of_the_offset():
    """A sign of the heading's column, a turn about the wrong point."""
    points = scan_points(office(rng=np.random.default_rng(1), rooms=2), (2.0, 5.0, 0.3))
    cells = loops.in_cells(points, 0.15)
    normal = loops.normals(cells, 0.12, 1.0, 5)
    pose, small = np.array([0.02, -0.01, 0.4]), 1e-6
    current = transform((0.0, 0.0, -0.4), points)[::3]
    rows, near = loops.residuals(cells, normal, current, pose, 0.3, 1)
    assert len(rows) > 40
    assert near == pytest.approx(1.0, abs=0.05)
    for k in range(3):
        step = small * np.eye(3)[k]
        after = loops.residuals(cells, normal, current, pose + step, 0.3, 1)[0][:, 3]
        before = loops.residuals(cells, normal, current, pose - step, 0.3, 1)[0][:, 3]
        np.testing.assert_allclose(rows[:, k], (after - before) / (2 * small), atol=1e-5)


def test_the_two_faces_of_a_thin_wall_are_told_apart():
    """A partition of 8 cm, seen from a room and then from the next: one face drawn onto the other.

    Without it a simulated office came out 10 cm wrong, with a stated deviation of 2 mm.
    """
    x = np.arange(-2.0, 2.0, 0.02)
    near, side = np.stack([x, np.zeros(200)], -1), np.stack([np.full(200, 3.0), x + 2], -1)
    points, eye = np.concatenate([near, side]), (0.0, -3.0)
    face = near + (0.0, 0.08)
    for place, seen in (((0.5, 2.0, 0.3), False), ((0.5, -2.0, 0.3), True)):
        current = transform(between(place, (0, 0, 0)), face)
        map = PointMap(points, np.tile(eye, (400, 1)))
        rows, near_by = loops.residuals(map.cells, map.normals, current, np.array(place), 0.3, 1)
        assert len(rows) == (200 if seen else 0)
        assert near_by == 1.0
        blunt = PointMap(points)
        rows, _ = loops.residuals(blunt.cells, blunt.normals, current, np.array(place), 0.3, 1)
        assert len(rows) == 200
    towards = (map.normals * (np.array(eye) - map.cells.points)).sum(1)
    assert (towards[np.isfinite(towards)] > 0).all()


def test_every_stride_th_point_is_asked():
    """A share of points near that divides by another number than was asked."""
    wall = np.stack([np.linspace(0, 2, 41), np.zeros(41)], -1)
    cells = loops.in_cells(wall, 0.15)
    normal = loops.normals(cells, 0.12, 1.0, 5)
    half_off = wall + np.where(wall[:, :1] < 1.01, 0.0, 50.0)
    for stride in (1, 2, 3, 7):
        rows, near = loops.residuals(cells, normal, half_off, np.zeros(3), 0.12, stride)
        asked = half_off[::stride]
        assert len(rows) == (asked[:, 1] == 0).sum()
        assert near == pytest.approx((asked[:, 1] == 0).mean())


def test_the_move_leaves_free_directions_alone():
    """A step along a wall that stands alone: its offsets say nothing of it."""
    rows = np.array([(0.0, 1.0, x, 0.1) for x in (-1.0, 0.0, 1.0)])
    hessian, gradient = loops.equations(rows, np.ones(3))
    np.testing.assert_allclose(hessian, rows[:, :3].T @ rows[:, :3])
    np.testing.assert_allclose(gradient, rows[:, :3].T @ rows[:, 3])
    np.testing.assert_allclose(loops.least_move(hessian, gradient, 1.0), (0, -0.1, 0), atol=1e-12)


# ------------------------------------------------------------------ the search
def literal_search(map, current, start, radius, headings, away):
    """Score `(h, i, j)` of every heading and every shift: the whole lattice, one by one."""
    level, corner = map.levels[0], map._corner
    shifts = np.arange(-radius, radius + 1)
    scores = np.empty((len(headings), len(shifts), len(shifts)))
    for h, heading in enumerate(headings):
        turned = transform((start[0], start[1], start[2] + heading), current)
        cell = np.floor((turned - corner) / FINE).astype(int)
        for a, i in enumerate(shifts):
            for b, j in enumerate(shifts):
                at = cell + (i, j)
                inside = ((at >= 0) & (at < level.shape)).all(1)
                scores[h, a, b] = level[tuple(at[inside].T)].sum() / 255 / len(current)
                scores[h, a, b] -= away * (i * i + j * j) / radius**2
        scores[h] -= away * (heading / max(np.abs(headings).max(), 1e-9)) ** 2
    return scores


SEARCHES = {
    "in the window": ((0.2, -0.15, 0.1), 0.5, 0.1),
    "the answer outside of the window": ((0.7, 0.0, 0.0), 0.5, 0.1),
    "beyond its upper edges": ((-0.42, -0.55, 0.0), 0.5, 0.0),
    "far off across": ((0.1, 0.42, 0.0), 0.5, 0.0),
    "far off along": ((-0.32, -0.03, 0.0), 0.5, 0.0),
    "far outside of the map": ((9.0, 30.0, 1.0), 0.5, 0.1),
    "no penalty, so that there are ties": ((0.1, 0.1, 0.0), 0.3, 0.0),
    "a window that blocks do not divide": ((0.1, 0.1, -0.1), 0.35, 0.3),
    "one heading": ((0.1, 0.1, 0.0), 0.4, 0.1),
}


@pytest.mark.parametrize("name", SEARCHES)
def test_the_search_is_exact_on_its_lattice(name):
    """A bound that is none: the best place would be cut off with its block."""
    start, reach, away = SEARCHES[name]
    walls = office(rng=np.random.default_rng(1), rooms=2)
    map = PointMap(scan_points(walls, (2.0, 5.0, 0.3)))
    current = scan_points(walls, (2.1, 5.0, 0.35), seed=1)[::4]
    turn = 0.0 if name == "one heading" else 0.21
    found, score = map.search(
        current, start, reach=reach, turn=turn, step=0.03, away=away, least=-9
    )
    headings = np.linspace(-turn, turn, 15 if turn else 1)
    radius = round(reach / FINE)
    scores = literal_search(map, current, np.array(start), radius, headings, away)
    assert score == pytest.approx(scores.max(), abs=1e-12)
    assert found is not None
    h = int(np.argmin(np.abs(headings - (found[2] - start[2]))))
    i, j = np.round((found[:2] - start[:2]) / FINE).astype(int)
    assert scores[h, i + radius, j + radius] == pytest.approx(scores.max(), abs=1e-12)
    np.testing.assert_allclose(found, np.add(start, (i * FINE, j * FINE, headings[h])), atol=1e-12)


def test_the_search_finds_what_lies_in_its_window_and_only_that():
    """A window half as large as was asked, or a pose although nothing exceeds the least."""
    walls = office(rng=np.random.default_rng(1), rooms=2)
    map = PointMap(scan_points(walls, (2.0, 5.0, 0.3)))
    here = scan_points(walls, (2.0, 5.0, 0.3), seed=1)
    found, score = map.search(here, (0.45, -0.45, 0.6), reach=0.5, turn=0.7)
    np.testing.assert_allclose(found, np.zeros(3), atol=0.05)
    assert score > 0.6
    nothing, score = map.search(here, (30.0, 30.0, 0.0), least=0.3)
    assert nothing is None
    assert score == 0.3


def test_of_equal_places_the_nearest_is_taken():
    """Along a corridor all places are equal: a scan must not be thrown to the window's edge."""
    wall = np.stack([np.linspace(-10, 10, 400), np.zeros(400)], -1)
    both = np.concatenate([wall, wall + (0, 2)])
    seen = both[np.abs(both[:, 0]) < 3] - (0, 1.0)
    found, _ = PointMap(both).search(seen, (0.31, 0.93, 0.05))
    np.testing.assert_allclose(found[:2], (0.31, 1.0), atol=0.03)
    assert abs(found[2]) < 0.011


def test_each_level_holds_the_maxima_of_its_blocks():
    """A coarse level that is below a cell that it covers would cut off the best place."""
    map = PointMap(scan_points(office(rng=np.random.default_rng(1)), (2.0, 5.0, 0.3)))
    fine = map.levels[0]
    assert fine.max() == 255
    for k, level in enumerate(map.levels):
        width = 1 << k
        padded = np.zeros(np.add(fine.shape, width - 1), np.uint8)
        padded[: fine.shape[0], : fine.shape[1]] = fine
        blocks = np.lib.stride_tricks.sliding_window_view(padded, (width, width))
        np.testing.assert_array_equal(level, blocks.max((2, 3)))


def test_points_lie_on_the_ridge_of_their_stamps():
    """A stamp that is put beside its point: every pose found would be off by a cell."""
    points = np.array([(0.0, 0.0), (1.0, 0.4)])
    map = PointMap(points)
    cell = np.floor((points - map._corner) / FINE + 1e-9).astype(int)
    assert [int(map.levels[0][i, j]) for i, j in cell] == [255, 255]
    i, j = cell[0]
    around = map.levels[0][i - 3 : i + 4, j - 3 : j + 4].astype(int)
    np.testing.assert_array_equal(around, around.T)
    np.testing.assert_array_equal(around, around[::-1])
    assert around[3, 4] == int(255 * np.exp(-(FINE**2) / (2 * 0.06**2)))


def test_a_shift_reads_the_cells_that_it_moves_to():
    """Cells moved the other way, or a cell beyond the edge that wraps round."""
    level = np.arange(20, dtype=np.uint8).reshape(4, 5)
    cells = np.array([(0, 0), (3, 4)], np.int32)
    assert searching.overlay(level, cells, 0, 0) == pytest.approx((0 + 19) / 510)
    assert searching.overlay(level, cells, 1, 2) == pytest.approx(7 / 510)
    assert searching.overlay(level, cells, -1, -1) == pytest.approx(13 / 510)
    assert searching.overlay(level, cells, -9, 0) == 0
