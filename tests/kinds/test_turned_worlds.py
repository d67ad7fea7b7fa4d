"""Worlds turned by any angle: where headings jump from pi to -pi is the same place for nobody."""

from dataclasses import replace

import numpy as np
import pytest

from segmap import Log, alignment, load
from segmap.matching import localize, search
from segmap.metrics import doubled_walls, relation_errors
from segmap.poses import between, compose, interpolate, transform
from segmap.poses.motions import arc, twist
from segmap.reduction import METHODS
from segmap.scans.motion import velocities
from segmap.segments import SegmentMap
from segmap.simulation import Sensor, box, simulate, square_room

ROOM = np.concatenate([square_room(4), box(0.5, 0.8, (3, 3, 0.2))])
ROUND = Sensor("round", 90, -np.pi, np.radians(4), max_range=9.0, sigma=0.0, period=0.18)
#: A robot that looks along x and weaves by a quarter of a radian, so that, where the world is
#: turned by pi, its heading jumps all the time.
WEAVING = np.array(
    [(1 + 0.03 * k, 2 + 0.2 * np.sin(0.6 * k), 0.25 * np.cos(1.1 * k)) for k in range(60)]
)
TURNS = (0.4, np.pi / 2, np.pi - 0.02, np.pi, -2.0)


def turned(turn, poses):
    """The poses in a world that lies otherwise, headings within pi."""
    return compose((3.0, -2.0, turn), poses)


def carried_back(turn):
    """Beams carried by wheels that are read once a turn of the laser, in the middle of it.

    It turns by less than a degree a scan: nobody doubts then that it drove while it measured.
    """
    path = WEAVING * (1, 1, 0.05)
    ways = compose(path[:-1], arc(twist(between(path[:-1], path[1:])) / 2))
    log = simulate(ROOM, path, sensor=ROUND, rng=np.random.default_rng(1), moving=True)
    times = ROUND.period * (np.arange(len(ways)) + 0.5)
    track = np.column_stack([times + 0.26, turned(turn, ways)])
    found = alignment.deskew(replace(log, track=track), log.truth)
    assert "scans and odometry differ by" in found.doubt
    return np.concatenate([scan.ranges for scan in found])


def kept_track_of(turn):
    """A robot on a known map: where it is in the world that is not turned, and how surely."""
    map = SegmentMap(transform((3.0, -2.0, turn), ROOM))
    log = simulate(ROOM, WEAVING[:8], sensor=ROUND, rng=np.random.default_rng(1))
    scans = [replace(s, odometry=p) for s, p in zip(log, turned(turn, WEAVING), strict=False)]
    belief = list(localize(map, scans, rng=np.random.default_rng(2)))[-1]
    off = between(turned(turn, WEAVING)[7], belief.pose)
    assert np.abs(off).max() < 0.06 and belief.found
    return np.sqrt(np.linalg.eigvalsh(belief.covariance)[-1]) < 0.1


def found_anywhere(turn):
    map = SegmentMap(transform((3.0, -2.0, turn), ROOM))
    scan = simulate(ROOM, WEAVING[:1], sensor=ROUND, rng=np.random.default_rng(1))[0]
    return np.abs(between(turned(turn, WEAVING)[0], search(map, scan).poses[0])).max() < 0.1


def doubled(turn):
    """Looks at walls that face all four ways, each turned a little otherwise, and one drawn twice.

    By right angles only: cells of a decimetre lie otherwise in other worlds.
    """
    frame = (0.0, 0.0, np.round(2 * turn / np.pi) * np.pi / 2)
    sides, scans = [], []
    for scan in range(12):
        far = 3.25 if scan % 2 else 2.95  # the wall at the right, twice
        for place in ((0, 2.95, 0), (-2.95, 0, np.pi / 2), (far, 0, np.pi / 2), (0, -2.95, 0)):
            tilted = compose(place, (0, 0, 0.001 * (-1) ** (scan // 2)))
            sides.append(transform(tilted, np.array([(-2.0, 0), (2.0, 0)])))
            scans.append(scan)
    map = SegmentMap(transform(frame, np.array(sides)), scans)
    return doubled_walls(map, np.zeros((12, 2)), looks=6)


def reduced(name):
    """How many segments a method leaves of a room, each wall seen five times."""

    def left(turn):
        rng = np.random.default_rng(5)
        ends = np.repeat(ROOM, 5, axis=0) + rng.normal(0, 0.005, (5 * len(ROOM), 2, 2))
        return len(METHODS[name].function(SegmentMap(transform((3.0, -2.0, turn), ends))))

    return left


def placed(name):
    """How an alignment lays scans whose odometry lies in a turned world."""

    def way(turn):
        log = load("room")[:12]
        scans = [replace(s, odometry=turned(turn, s.odometry)) for s in log]
        poses = alignment.METHODS[name].function(Log("it", scans)).poses
        return between(poses[0], poses)

    return way


def off_relations(turn):
    steps = between(WEAVING[:-1], WEAVING[1:])
    rows = [[k, k + 1, x, y, 0, 0, 0, a + 0.01] for k, (x, y, a) in enumerate(steps)]
    return np.stack(relation_errors(np.arange(60.0), turned(turn, WEAVING), rows))


FUNCTIONS = {
    "deskew": carried_back,
    "localize": kept_track_of,
    "search": found_anywhere,
    "doubled_walls": doubled,
    "relation_errors": off_relations,
    "velocities": lambda turn: velocities(np.arange(60.0), turned(turn, WEAVING)),
    "interpolate": lambda turn: between(
        turned(turn, WEAVING[0]),
        interpolate(np.arange(60.0), turned(turn, WEAVING), np.arange(59) + 0.3, max_gap=2.0),
    ),
    **{name: reduced(name) for name in ("fusion", "one_per_wall", "least_cost", "mean_shift")},
    **{name: placed(name) for name in ("odometry", "pose_graph", "segment_icp")},
}


@pytest.mark.parametrize("function", FUNCTIONS.values(), ids=FUNCTIONS)
def test_nothing_depends_on_where_the_heading_jumps(function):
    """Catches a difference of headings, a rounded or an interpolated one that nobody wraps."""
    wanted = np.asarray(function(0.0), float)
    for turn in TURNS:
        np.testing.assert_allclose(function(turn), wanted, atol=2e-3, err_msg=f"turned by {turn}")
