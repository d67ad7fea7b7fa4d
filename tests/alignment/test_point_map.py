"""Maps of points: each loop against plain loops, brute force, finite differences or numpy."""

import itertools

import numpy as np
import pytest
from segmap_course import literal

from segmap.alignment.points import _point_kernels as kernels
from segmap.alignment.points._point_kernels import uncertainty
from segmap.alignment.points._point_map import SEARCH_CELL_M, PointMap
from segmap.poses import between, transform
from segmap.simulation import SICK_LMS200, cast_rays, office

OFFICE = office(rng=np.random.default_rng(1), rooms=2)


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


def scan_points(pose: tuple = (2.0, 5.0, 0.3), noise: float = 0.01, seed: int = 0) -> np.ndarray:
    """End points of a half turn of beams in the sensor's frame, with noise along the beams."""
    angles = SICK_LMS200.angles
    ranges = cast_rays(OFFICE, pose, angles) + np.random.default_rng(seed).normal(0, noise, 181)
    return np.stack([ranges * np.cos(angles), ranges * np.sin(angles)], -1)


def residuals(map: PointMap, current, pose, reach: float, stride: int = 1):
    rows, partner = np.full((len(current), 6), np.nan), np.full(len(current), -1)
    pose = np.array(pose, float)
    used, near = kernels.wall_residuals(
        map.grid, np.ascontiguousarray(current), pose, reach, stride, partner, rows
    )
    return rows[:used], near


def partners(map: PointMap, asked: np.ndarray, reach: float, before=-1) -> np.ndarray:
    """Nearest point of each of those asked, -1 for none; `before` is what is known to be near."""
    found, rows = np.full(len(asked), before), np.empty((len(asked), 6))
    kernels.wall_residuals(
        map.grid, np.ascontiguousarray(asked), np.zeros(3), reach, 1, found, rows
    )
    return found


@pytest.mark.parametrize("name", clouds())
@pytest.mark.parametrize("reach", [0.1, 0.25, 0.9])
def test_nearest_is_the_nearest(name, reach):
    """A point lost by the sorting, a reach counted in cells, a last partner that hides another."""
    points, rng = clouds()[name], np.random.default_rng(2)
    cloud = PointMap(points)
    grid = cloud.grid
    assert sorted(map(tuple, grid.points)) == sorted(map(tuple, points))
    assert (grid.first[0], grid.first[-1]) == (0, len(points))
    near = points[rng.integers(0, len(points), 150)] + rng.normal(0, reach, (150, 2))
    asked = np.concatenate([rng.uniform(-7, 7, (150, 2)), near])  # outside of the box too
    found = partners(cloud, asked, reach)
    for before in (found, rng.integers(0, len(points), 300)):
        np.testing.assert_array_equal(partners(cloud, asked, reach, before), found)
    apart = np.hypot(*(asked[:, None] - grid.points).transpose(2, 0, 1))
    assert 0 < (found < 0).sum() < len(asked)
    np.testing.assert_array_equal(found >= 0, apart.min(1) < reach)
    np.testing.assert_array_equal(
        apart[np.arange(300), found][found >= 0], apart.min(1)[found >= 0]
    )


def test_normals_are_those_of_the_principal_axes():
    """A covariance with a sign or a factor wrong: the normal would lie along the wall.

    A normal made up for a bush, or for a point that stands alone.
    """
    bush = np.random.default_rng(3).normal(0, 0.03, (50, 2)) - 30.0
    alone = np.array([(50.0, 0.0), (50.5, 0.0), (50.0, 4.0)])
    grid = PointMap(np.concatenate([scan_points(), bush, alone])).grid
    walls = 0
    for point, normal in zip(grid.points, grid.normals, strict=True):
        apart = np.hypot(*(grid.points - point).T)
        radius = next((r for r in (0.12, 0.24, 0.48, 0.96) if (apart <= r).sum() >= 5), None)
        if radius is None:
            assert np.isnan(normal).all()
            continue
        value, vector = np.linalg.eigh(np.cov(grid.points[apart <= radius].T))
        assert np.isnan(normal[0]) == (value[0] >= kernels.WALL_VARIANCE_RATIO * value[1])
        if not np.isnan(normal[0]):
            assert abs(abs(normal @ vector[:, 0]) - 1) < 1e-9
            walls += 1
    assert 100 < walls < len(scan_points())


def test_rows_are_the_derivative_of_the_offset():
    """A sign of the heading's column, a turn about the wrong point, a point of another row."""
    points, small = scan_points(), 1e-6
    map, pose = PointMap(points), np.array([0.02, -0.01, 0.4])
    current = transform((0.0, 0.0, -0.4), points)[::3]
    rows, near = residuals(map, current, pose, 0.3)
    assert len(rows) > 40
    assert near == pytest.approx(1.0, abs=0.05)
    for k in range(3):
        step = small * np.eye(3)[k]
        after, before = (residuals(map, current, pose + s * step, 0.3)[0] for s in (1, -1))
        slope = (after[:, 3] - before[:, 3]) / (2 * small)
        np.testing.assert_allclose(rows[:, k], slope, atol=1e-5)
    placed = transform(pose, current[rows[:, 5].astype(int)])
    nearest = partners(map, placed, 0.3)
    offsets = ((placed - map.grid.points[nearest]) * rows[:, :2]).sum(1)
    np.testing.assert_allclose(offsets, rows[:, 3], atol=1e-12)


def test_the_two_faces_of_a_thin_wall_are_told_apart():
    """A partition of 8 cm, seen from a room and then from the next: one face drawn onto the other.

    Without it a simulated office came out 10 cm wrong, with a stated deviation of 2 mm.
    """
    x = np.arange(-2.0, 2.0, 0.02)
    near, side = np.stack([x, np.zeros(200)], -1), np.stack([np.full(200, 3.0), x + 2], -1)
    points, eye = np.concatenate([near, side]), (0.0, -3.0)
    map, blunt = PointMap(points, np.tile(eye, (400, 1))), PointMap(points)
    for place, seen in (((0.5, 2.0, 0.3), False), ((0.5, -2.0, 0.3), True)):
        current = transform(between(place, (0, 0, 0)), near + (0.0, 0.08))
        rows, near_by = residuals(map, current, place, 0.3)
        assert (len(rows), near_by) == (200 if seen else 0, 1.0)
        assert len(residuals(blunt, current, place, 0.3)[0]) == 200
    towards = (map.grid.normals * (np.array(eye) - map.grid.points)).sum(1)
    assert (towards[np.isfinite(towards)] > 0).all()


def test_every_stride_th_point_is_asked():
    """A share of points near that divides by another number than was asked; other points than
    those of the scan the other way round.
    """
    wall = np.stack([np.linspace(0, 2, 41), np.zeros(41)], -1)
    half_off = wall + np.where(wall[:, :1] < 1.01, 0.0, 50.0)
    for stride, first in ((1, 0), (3, 2), (7, 6)):
        rows, near = residuals(PointMap(wall), half_off, np.zeros(3), 0.12, stride)
        back, _ = residuals(PointMap(wall), half_off[::-1], np.zeros(3), 0.12, stride)
        asked = half_off[first::stride]
        assert len(rows) == (asked[:, 1] == 0).sum()
        assert sorted(40 - back[:, 5]) == rows[:, 5].tolist()
        assert near == pytest.approx((asked[:, 1] == 0).mean())


def test_a_normal_that_is_fitted_when_first_asked_for_is_the_same():
    """A partner whose normal nobody fitted, or that is fitted from another neighbourhood then."""
    points, eye = scan_points(), np.zeros((181, 2))
    lazy, whole = PointMap(points, eye), PointMap(points, eye)
    expected = whole.grid.normals.copy()
    here = scan_points((2.1, 5.0, 0.35), seed=1)[60:120]
    found, match = (map.register(here, (0.05, 0.0, 0.04)) for map in (lazy, whole))
    assert found.matched and found.pose.tolist() == match.pose.tolist()
    asked = ~np.isinf(lazy._grid.normals[:, 0])
    assert 20 < asked.sum() < 120
    np.testing.assert_array_equal(lazy._grid.normals[asked], expected[asked])
    np.testing.assert_array_equal(lazy.grid.normals, expected)


@pytest.mark.parametrize("free", [0, 1, 2])
def test_the_uncertainty_is_that_of_the_eigenvectors(free):
    """A heading that counts as metres, a free direction that keeps its small eigenvalue."""
    rng, span, variance = np.random.default_rng(free), 2.5, 0.03**2
    axes = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    value, scale = np.array([3.0, 50.0, 90.0]) * 10.0, np.array([1.0, 1.0, 1.0 / span])
    value[:free] *= 1e-4
    hessian = (axes * value) @ axes.T / scale[:, None] / scale
    covariance, scratch = np.empty((3, 3)), np.empty((2, 3, 3))
    *along, shift = uncertainty(hessian, variance, span, *scratch, covariance)
    spread = np.where(np.arange(3) < free, 1.0, variance / value)
    np.testing.assert_allclose(covariance, (axes * spread) @ axes.T * scale[:, None] * scale)
    if free == 1:
        assert shift == pytest.approx(np.hypot(*axes[:2, 0]))
        assert abs(along @ axes[:2, 0]) == pytest.approx(shift)
    assert (shift >= 0.0) == (free > 0)


@pytest.mark.parametrize("count", [6, 7, 40, 41])
@pytest.mark.parametrize("directions", ["all", "one"])
def test_a_step_is_that_of_the_plain_loops(count, directions):
    """A median of the wrong rank, weights squared, a step along a wall that stands alone."""
    rng = np.random.default_rng(count)
    angle = rng.uniform(-3, 3, count) * (directions == "all")
    normals = np.stack([np.cos(angle), np.sin(angle)], -1)
    points = rng.normal(0, 2, (count, 2)) * (1, directions == "all")
    offsets = np.round(rng.standard_t(2, count), 1) * 0.1  # some are equal
    rows = np.zeros((count, 6))
    rows[:, :2], rows[:, 3] = normals, offsets
    rows[:, 2] = points[:, 0] * normals[:, 1] - points[:, 1] * normals[:, 0]
    system, span = np.empty((3, 4)), 2.5
    sigma = kernels.normal_equations(rows, count, 0.01, system)
    step = kernels.gauss_newton_step(system, span, np.empty((3, 3)), np.empty((3, 3)))
    assert sigma == pytest.approx(max(1.4826 * np.median(np.abs(offsets)), 0.01))
    weights = 1 / (1 + (offsets / (2 * sigma)) ** 2)
    np.testing.assert_allclose(rows[:, 4], weights)
    feet = points - offsets[:, None] * normals
    plain = literal.point_to_line_step(
        *map(np.ndarray.tolist, (points, feet, normals, weights)), span
    )
    np.testing.assert_allclose(step, plain, atol=1e-9)
    if directions == "one":
        np.testing.assert_allclose(step[1:], 0, atol=1e-12)


# ------------------------------------------------------------------ the search
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
def test_the_search_is_that_of_the_plain_loops(name):
    """A bound that is none cuts off the best place; a pose although none exceeds the least."""
    start, reach, away = SEARCHES[name]
    map, current = PointMap(scan_points()), scan_points((2.1, 5.0, 0.35), seed=1)[::4]
    turn = 0.0 if name == "one heading" else 0.21
    window = {"reach": reach, "turn": turn, "step": 0.03, "reach_cost": away}
    found, score = map.search(current, start, least=-9, **window)
    assert map.search(current, start, least=score, **window) == (None, score)
    headings = np.linspace(-turn, turn, 15 if turn else 1).tolist()
    corner, radius = map.corner.tolist(), round(reach / SEARCH_CELL_M)
    cells = literal.likelihoods(map.grid.points.tolist(), corner)
    plain = literal.correlative_search(
        cells, corner, current.tolist(), start, radius, headings, away
    )
    scores = {tuple(np.round(pose, 6)): value for value, pose in plain}
    assert score == pytest.approx(max(scores.values()), abs=1e-12)
    assert scores[tuple(np.round(found, 6))] == pytest.approx(score, abs=1e-12)


def test_levels_hold_the_stamps_and_the_maxima_of_their_blocks():
    """A stamp beside its point; a coarse level below a cell that it covers cuts off the best."""
    map = PointMap(scan_points())
    fine, points = map.levels[0].T, map.grid.points.tolist()
    cells = literal.likelihoods(points, map.corner.tolist())
    assert {(int(i), int(j)): fine[i, j] for i, j in np.argwhere(fine)} == {
        cell: value for cell, value in cells.items() if value
    }
    for k, level in enumerate(map.levels):
        width = 1 << k
        padded = np.zeros(np.add(fine.shape, width - 1), np.uint8)
        padded[: fine.shape[0], : fine.shape[1]] = fine
        blocks = np.lib.stride_tricks.sliding_window_view(padded, (width, width))
        np.testing.assert_array_equal(level.T, blocks.max((2, 3)))


def ring(radius: float, centre: tuple[float, float]) -> np.ndarray:
    """Points of a round wall, as a robot sees it whose middle lies at `centre`."""
    angle = np.linspace(-np.pi, np.pi, 360, endpoint=False)
    return np.column_stack([np.cos(angle), np.sin(angle)]) * radius + centre


@pytest.mark.parametrize("centre", [(0.0, 0.0), (1.0, 0.5), (-4.0, 3.0)])
def test_a_round_room_fixes_no_turn_about_its_middle(centre):
    """Catches a middle that is taken to be the robot, and a wall that faces a shift but no turn."""
    points = ring(8.0, centre)
    map = PointMap(points)
    match = map.register(points, (0.0, 0.0, 0.0))
    assert match.matched and (match.turns or match.free is not None)
    (motion,) = map.free_motions(points, match.pose)
    span = np.sqrt((points**2).sum(1).mean())
    turn = motion[2] / span
    middle = np.array([-motion[1], motion[0]]) / turn  # which the motion leaves where it is
    np.testing.assert_allclose(middle, centre, atol=0.05)
    # Along it the guess counts: the robot has turned by 0.1 about the middle
    c, s = np.cos(0.1), np.sin(0.1)
    guess = np.append(centre - np.array([[c, -s], [s, c]]) @ centre, 0.1)
    for turns in (0, 1):  # a heading that is told with a whole turn more is the same one
        moved = map.slide_to(points, match.pose, guess + (0, 0, 2 * np.pi * turns))
        np.testing.assert_allclose(moved, guess, atol=0.05)
    pillar = np.vstack([points, ring(0.3, (2.0, -2.0))[::4] * (1, 1.4)])
    assert len(PointMap(pillar).free_motions(pillar, np.zeros(3))) == 0


def test_a_corridor_leaves_its_own_direction_free_until_a_wall_faces_it():
    """Catches a turn in the place of a shift, and an end that is overlooked."""
    along = np.arange(-6.0, 6.0, 0.05)
    walls = np.vstack([np.column_stack([along, np.full_like(along, y)]) for y in (-1.0, 1.0)])
    (motion,) = PointMap(walls).free_motions(walls, np.zeros(3))
    np.testing.assert_allclose(np.abs(motion), [1, 0, 0], atol=0.02)
    end = np.column_stack([np.full(5, 6.0), np.linspace(-0.2, 0.2, 5)])
    closed = np.vstack([walls, end])
    assert len(PointMap(closed).free_motions(closed, np.zeros(3))) == 0
