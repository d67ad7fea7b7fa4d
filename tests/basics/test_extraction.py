"""Clusters and polylines against literal forms, simulated truth, and awkward scans."""

import itertools
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from segmap_course import literal

from segmap import extraction
from segmap.extraction import build_map, extract_clusters, extract_polylines, fit_line
from segmap.scans import LaserScan, Log
from segmap.testing import assert_segments_equal


def wall(a, b, spacing: float = 0.05) -> np.ndarray:
    """Points on a wall from a to b."""
    steps = max(round(math.dist(a, b) / spacing), 1)
    t = np.linspace(0, 1, steps + 1)[:, None]
    return (1 - t) * np.array(a) + t * np.array(b)


def path(*corners, spacing: float = 0.05) -> np.ndarray:
    """Points on walls from corner to corner, each corner once."""
    walls = [wall(a, b, spacing)[:-1] for a, b in itertools.pairwise(corners)]
    return np.concatenate([*walls, np.array(corners[-1:], float)])


def square_scan(start: float = 0.0, sigma: float = 0.0) -> np.ndarray:
    """A 360-degree scan of a 4 m x 3 m room whose first beam looks at `start`, radians."""
    angles = start + np.radians(np.arange(360))
    c, s = np.cos(angles), np.sin(angles)
    ranges = 1 / np.maximum(np.abs(c) / 2, np.abs(s) / 1.5)
    ranges += sigma * np.random.default_rng(1).normal(size=360)
    return np.stack([ranges * c, ranges * s], -1)


def assert_same(found, expected, atol=1e-9):
    """Segments agree, whichever end point comes first."""
    assert_segments_equal(found, np.reshape(expected, (-1, 2, 2)), ordered=True, atol=atol)


# ----------------------------------------------------------------------------- clusters
def walk(seed: int) -> np.ndarray:
    """Points that wander: many short pieces, most of them joined again."""
    return np.cumsum(np.random.default_rng(seed).normal(0, 0.12, (60, 2)), axis=0) + (1, 2)


def noisy_walls(seed: int) -> np.ndarray:
    rng = np.random.default_rng(seed)
    corners = np.cumsum(rng.uniform(0.4, 1.0, (6, 2)) * rng.choice([-1, 1], (6, 2)), axis=0)
    return path(*corners) + rng.normal(0, 0.01, (len(path(*corners)), 2))


def noisy_square(seed: int) -> np.ndarray:
    return square_scan(seed, 0.01)


@pytest.mark.parametrize("make", [walk, noisy_walls, noisy_square])
@pytest.mark.parametrize("closed", [False, True])
@pytest.mark.parametrize("seed", range(4))
def test_equals_the_plain_method(make, closed, seed):
    """A's loop never advances, compares with the wrong point and loses the last cluster.

    In polylines: another farthest point, a merge too many, a corner that goes to the wrong wall.
    """
    points = make(seed)
    for extract in ("extract_clusters", "extract_polylines"):
        plain = getattr(literal, extract)
        assert_same(
            getattr(extraction, extract)(points, closed=closed),
            plain(points.tolist(), closed=closed),
        )
    fine = {"gap": 0.15, "tolerance": 0.01, "min_points": 2, "min_length": 0.0, "closed": closed}
    assert_same(
        extract_polylines(points, **fine), literal.extract_polylines(points.tolist(), **fine)
    )
    found = extract_clusters(points, fit="algebraic", closed=closed)
    plain = literal.extract_clusters(points.tolist(), fit="algebraic", closed=closed)
    assert_same(found, plain, 1e-6)


@pytest.mark.parametrize("tolerance", [0.03, 0.125, 0.25])
def test_sums_settle_no_tie(tolerance):
    """Errors on a lattice are equal, or equal to the tolerance: merged as if fits were exact."""
    rng = np.random.default_rng(2)
    scans = [0.25 * np.cumsum(rng.integers(-1, 2, (60, 2)), 0) for _ in range(40)]
    some = {"tolerance": tolerance, "gap": 1.0, "min_points": 2, "min_length": 0.0}
    for points in scans:
        assert_same(
            extract_polylines(points, **some), literal.extract_polylines(points.tolist(), **some)
        )


def test_the_plain_fits_are_least_squares():
    """Closed forms against numpy's: the eigenvectors of the scatter, and a x + b y = 1."""
    p = walk(3)
    x, y, dx, dy = literal.fit_total(p.tolist())
    along = np.linalg.eigh((p - p.mean(0)).T @ (p - p.mean(0)))[1][:, 1]
    assert (x, y) == pytest.approx(p.mean(0))
    assert abs(dx * along[1] - dy * along[0]) < 1e-9
    a, b = np.linalg.lstsq(p, np.ones(len(p)), rcond=None)[0]
    x, y, dx, dy = literal.fit_algebraic(p.tolist())
    assert (a * x + b * y, a * dx + b * dy) == pytest.approx((1, 0), abs=1e-9)


def test_points_exactly_a_gap_apart_are_cut():
    """`>=`, not `>` (A 3.2)."""
    points = [(0, 0), (0.25, 0), (0.75, 0), (1.0, 0)]
    assert len(extract_clusters(points, gap=0.5)) == 2
    assert len(extract_clusters(points, gap=0.5000001)) == 1


def test_algebraic_fit_fails_through_the_origin_and_total_does_not():
    """A 3.1-3.3 solves a x + b y = 1, which no line through the sensor satisfies."""
    radial = wall((0.5, 0.5), (1.5, 1.5))
    assert len(extract_clusters(radial, fit="algebraic")) == 0
    assert_same(extract_clusters(radial), [[(0.5, 0.5), (1.5, 1.5)]])


# ---------------------------------------------------------------------------- polylines


# ------------------------------------------------------------------------ awkward scans
@pytest.mark.parametrize("away", [(0, 0), (0, 30), (-30, 0), (30, -30)])
def test_a_round_without_a_gap_begins_at_its_farthest_corner(away):
    """Catches a start that is farthest from the origin, in x or y, and not from the middle."""
    kite = path((0, 0), (2, 1), (4, 0), (2, -4), (0, 0))[:-1] + away
    kite = np.roll(kite, 7, axis=0) + np.random.default_rng(2).normal(0, 0.01, kite.shape)
    found = extract_polylines(kite, closed=True)
    assert len(found) == 4
    assert_same(found, literal.extract_polylines(kite.tolist(), closed=True))


@pytest.mark.parametrize("extract", [extract_clusters, extract_polylines])
@pytest.mark.parametrize("closed", [False, True])
@pytest.mark.parametrize("points", [[], np.empty((0, 2)), [(1, 1)], [(1, 1)] * 9])
def test_nothing_to_extract(extract, points, closed):
    assert extract(points, closed=closed).shape == (0, 2, 2)


@pytest.mark.parametrize("extract", [extract_clusters, extract_polylines])
def test_an_infinite_gap_cuts_nowhere(extract):
    """Chapter 03 shows what a wall becomes without gaps."""
    assert len(extract([(x, 0) for x in range(9)] + [(2000, 0)], gap=np.inf)) == 1


# ------------------------------------------------------------------------------ fit_line
@given(st.integers(0, 10_000))
def test_fit_line_equals_the_plain_fit(seed):
    points = np.random.default_rng(seed).normal(0, 1, (7, 2)) * (1, 0.3)
    centre, turn = fit_line(points)
    x, y, dx, dy = literal.fit_total(points.tolist())
    np.testing.assert_allclose(centre, (x, y), atol=1e-12)
    assert abs(np.cos(turn) * dy - np.sin(turn) * dx) < 1e-9


# ----------------------------------------------------------------------------- build_map
def test_build_map_puts_scans_in_one_frame():
    """A corner seen from two places, one of them turned: both scans give the same walls."""
    world = path((2, -2), (2, 2), (-1, 2), spacing=0.04)
    scans, poses = [], [(0, 0, 0), (0.5, 0.3, 0.8), (0, 0, 0)]
    for pose in poses:
        c, s = math.cos(pose[2]), math.sin(pose[2])
        local = (world - pose[:2]) @ np.array([[c, -s], [s, c]])
        scans.append(LaserScan(np.hypot(*local.T), np.arctan2(local[:, 1], local[:, 0])))
    found = build_map(Log("corner", scans), [*poses[:2], (np.nan,) * 3])
    assert found.scan.tolist() == [0, 0, 1, 1]
    assert_same(found.segments[2:], found.segments[:2], 1e-9)


def test_build_map_hands_thresholds_on():
    log = Log("circle", [LaserScan(np.full(181, 2.0), np.radians(np.arange(181)))])
    poses = np.zeros((1, 3))
    assert len(build_map(log, poses, tolerance=0.2)) < len(build_map(log, poses, tolerance=0.01))
    assert len(build_map(log, poses, extract=extract_clusters)) == 1


@pytest.mark.parametrize("keep_points", [False, True])
def test_a_map_that_is_empty_says_why(keep_points):
    """Catches three scans without a segment, each for another reason, and no word of it."""
    wall = np.ones(9)
    blind = LaserScan([np.nan, np.inf, 0.0, -1.0, 6.0, 6.0, 9.0], np.arange(7) / 10, max_range=6.0)
    short = LaserScan(wall, np.arange(9) * 1e-3)
    log, poses = Log("dim", [blind, short, short]), np.zeros((3, 3))
    poses[2, 0] = np.nan
    with pytest.warns(UserWarning, match="the map of log 'dim' is empty") as caught:
        assert len(build_map(log, poses, keep_points=keep_points)) == 0
    said = str(caught[0].message)
    assert "1 of 3 scans without a pose (NaN), " in said
    assert "no valid beam (of their 7 beams 2 not finite, 2 not above 0, 3 at max_range" in said
    assert said.endswith("1 of 3 scans without a segment (too few points, or too short)")
    assert caught[0].filename == __file__


def test_a_log_without_scans_gives_an_empty_map_in_silence():
    assert len(build_map(Log("none", []), np.empty((0, 3)))) == 0


# ------------------------------------------ the fixed workload beside the project
@pytest.mark.parametrize("case", ["office_181", "office_1081"])
@pytest.mark.parametrize(
    ("thresholds", "truth"),
    [({"min_points": 8, "min_length": 0.3}, {}), ({}, {"min_beams": 2, "min_length": 0.0})],
    ids=["same thresholds for both", "defaults against all visible walls"],
)
def test_precision_and_recall(workloads, case, thresholds, truth):
    """Within 5 cm and 5 degrees, by length. The truth leaves out pieces of fewer than 8 beams or
    0.3 m unless told otherwise; so recall is asked where both have the same thresholds."""
    office = workloads.extraction_case(case, **truth)
    scores = np.zeros(4)
    for ranges, pieces in zip(office.ranges, office.truth, strict=True):
        points = workloads.end_points(ranges, office.sensor.angles)
        scores += workloads.score_segments(extract_polylines(points, **thresholds), pieces)
    assert scores[0] / scores[1] >= 0.99
    if not truth:
        assert scores[2] / scores[3] >= 0.99
