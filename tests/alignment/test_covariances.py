"""Every covariance that is handed out, against the errors that are made: the mean of e' C^-1 e.

Of errors that are as large as their covariance says it is the number of things estimated (NEES,
normalised estimation error squared; Bar-Shalom, Li and Kirubarajan 2001): divided by that number,
far below 1 the covariance claims too little knowledge, far above 1 too much.
"""

from collections.abc import Iterator

import numpy as np
import pytest
from alignment_logs import L_ROOM

from segmap.alignment import (
    Match,
    align_to_truth,
    match_angles,
    match_points,
    match_segments,
    solve_graph,
)
from segmap.alignment.graph import Edge, place_deviations
from segmap.angles import wrap
from segmap.extraction import extract_polylines
from segmap.poses import between, compose, transform
from segmap.reduction.surveyed import add_pose, fit
from segmap.simulation import SICK_LMS200, URG_04LX, Sensor, simulate

#: Two places in the room; the robot stands near one of them.
PLACES = (1.5, 1.4, 0.4), (2.2, 1.5, 2.0)
LEAST, MOST = 0.6, 1.5


def trials(sensor: Sensor, count: int) -> Iterator[tuple[np.ndarray, ...]]:
    """Points of two scans, the motion between them and a guess of it."""
    rng = np.random.default_rng(11)
    for k in range(count):
        here = np.array(PLACES[k % 2]) + rng.uniform(-0.3, 0.3, 3)
        motion = rng.uniform(-1, 1, 3) * (0.2, 0.2, 0.1)
        both = [here, compose(here, motion)]
        a, b = (s.points() for s in simulate(L_ROOM, both, sensor=sensor, rng=rng))
        yield a, b, motion, motion + rng.uniform(-1, 1, 3) * (0.05, 0.05, 0.03)


def matched(matcher: str, a: np.ndarray, b: np.ndarray, start: np.ndarray) -> Match:
    if matcher == "points":
        return match_points(a, b, start)
    walls = extract_polylines(a), extract_polylines(b)
    if matcher == "segments":
        return match_segments(*walls, start)
    return match_angles(*walls, rng=np.random.default_rng(1))


@pytest.mark.parametrize("sensor", [SICK_LMS200, URG_04LX], ids=lambda sensor: sensor.name)
@pytest.mark.parametrize("matcher", ["points", "segments", "angles"])
def test_matches_in_a_room_err_as_they_claim(matcher, sensor):
    squares, count = [], 60
    for a, b, motion, start in trials(sensor, count):
        match = matched(matcher, a, b, start)
        error = match.pose - motion
        error[2] = wrap(error[2])
        if match.matched and match.free is None and np.hypot(*error[:2]) < 0.3:
            squares.append(error @ np.linalg.solve(match.covariance, error))
    assert len(squares) > 0.9 * count
    assert LEAST <= np.mean(squares) / 3 <= MOST


def test_many_looks_at_a_wall_are_not_so_many_walls():
    """Catches a wall of the scan that counts once for each of its five partners in the map."""
    squares, rng = [], np.random.default_rng(2)
    for _ in range(60):
        here = np.array(PLACES[0]) + rng.uniform(-0.3, 0.3, 3)
        motion = rng.uniform(-1, 1, 3) * (0.2, 0.2, 0.1)
        stood = [here] * 5 + [compose(here, motion)]
        scans = simulate(L_ROOM, stood, sensor=SICK_LMS200, rng=rng)
        *map, now = (extract_polylines(scan.points()) for scan in scans)
        match = match_segments(np.concatenate(map), now, motion + (0.03, -0.02, 0.02))
        error = match.pose - motion
        squares.append(error @ np.linalg.solve(match.covariance, error))
    assert LEAST <= np.mean(squares) / 3 <= MOST


# ------------------------------------------------------------------ lines and graphs
@pytest.mark.parametrize("arm", [0.0, 3.0])
def test_lines_err_as_their_covariance_says(arm):
    """Catches noise of the beams, of the place or of the heading that is left out or doubled."""
    rng, squares = np.random.default_rng(5), []
    noise = np.array([0.01, np.radians(0.25), 0.03, np.radians(0.5)])
    for _ in range(400):
        # A wall at 2 m across the way ahead, and how far aside of the robot it begins
        y = np.linspace(arm - 1.0, arm + 1.0, 60)
        bearing, far = np.arctan2(y, 2.0), np.hypot(2.0, y)
        far, bearing = (
            v + s * rng.normal(size=60) for v, s in zip((far, bearing), noise[:2], strict=True)
        )
        seen = np.stack([far * np.cos(bearing), far * np.sin(bearing)], -1)
        wrong = np.array([*rng.normal(0, noise[2], 2), rng.normal(0, noise[3])])
        line = add_pose(fit(transform(wrong, seen), wrong[:2], *noise[:2]), wrong[:2], *noise[2:])
        x, _, alpha, rr, ra, aa = line
        turned = (alpha + np.pi / 2) % np.pi - np.pi / 2
        error = np.array([(x - 2.0) * np.cos(alpha), turned])
        squares.append(error @ np.linalg.solve([[rr, ra], [ra, aa]], error))
    assert 0.85 <= np.mean(squares) / 2 <= 1.15


@pytest.mark.parametrize("loops", [[], [(0, 39), (3, 36)]])
def test_places_in_a_graph_err_as_their_spread_says(loops):
    """Catches a spread that forgets a direction, the loops, or what alignment takes out."""
    rng, squares = np.random.default_rng(9), []
    turn = np.linspace(0, 2 * np.pi, 40)
    truth = np.stack([5 * np.sin(turn), 5 - 5 * np.cos(turn), wrap(turn)], -1)
    ends = np.array([(k, k + 1) for k in range(39)] + loops)
    sigma = np.array([0.03, 0.02, np.radians(0.4)])
    known = np.tile(np.diag(1 / sigma**2), (len(ends), 1, 1))
    for _ in range(30):
        noise = sigma * rng.normal(size=(len(ends), 3))
        relative = compose(between(truth[ends[:, 0]], truth[ends[:, 1]]), noise)
        poses = solve_graph(truth, ends, relative, information=known)
        said = place_deviations(poses, Edge(*ends.T, relative, known), np.ones(40))
        off = np.hypot(*(align_to_truth(poses, truth, best=True) - truth)[:, :2].T)
        squares.append((off / said) ** 2)
    assert LEAST <= np.mean(squares) <= MOST
