"""Buildings whose places look alike, drives that return to them, and what became of the loops.

A loop is false where it is wrong by more than half a metre and by more than three of the standard
deviations that it claims: along a hall without features a loop claims to know nothing.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from segmap.alignment import pose_graph
from segmap.angles import wrap
from segmap.poses import between, transform
from segmap.scans import Log
from segmap.simulation import (
    OdometryNoise,
    Sensor,
    _city,
    box,
    drive,
    office,
    polyline,
    rectangular_room,
    simulate,
)

LASER = Sensor("laser", 181, -np.pi / 2, np.pi / 180, max_range=8.0, sigma=0.01)
#: A lap ends some metres off.
WHEELS = OdometryNoise(turn_bias=0.03, turn_noise=0.03, heading_noise=0.01, distance_noise=0.1)
LENGTH, SHORT, DEPTH, WIDTH = 40.0, 24.0, 13.0, 2.0
DOOR, THICK = 0.9, 0.15
#: A loop is false where it is wrong by more, metres and standard deviations.
FALSE, CLAIMED = 0.5, 3.0
#: A return: a key frame so near an older pose, seen from the same heading, after so long a path.
NEAR, TURN, AFTER = 1.0, np.radians(20), 10.0
#: Returns along so much path are one place, metres.
PLACE = 5.0

Facade = Callable[[np.ndarray, np.random.Generator], np.ndarray]


def ring(rng: np.random.Generator, made: "Building", length: float) -> np.ndarray:
    """A corridor round a block; its first leg lies along y = 0."""
    outer = rectangular_room(length, DEPTH)
    inner = box(length - 2 * WIDTH, DEPTH - 2 * WIDTH, (length / 2, DEPTH / 2, 0))[:, ::-1]
    walls = [made.below(outer[0], rng), made.above(inner[0], rng)]
    walls += [made.back(wall, rng) for wall in (outer[2], inner[2])]
    return np.concatenate([*walls, *(_city._facade(w, rng) for w in (*outer[1::2], *inner[1::2]))])


def doors(wall: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """A door after every pier that is as wide as a door, from end to end."""
    reach = float(np.hypot(*(wall[1] - wall[0])))
    first = np.arange(DOOR, reach - 2 * DOOR, 2 * DOOR)
    along = (first[:, None] + (0, 0, DOOR, DOOR)).ravel()
    right = np.tile([0, THICK, THICK, 0], len(first))
    line = polyline(np.stack([np.r_[0, along, reach], -np.r_[0, right, 0]], -1))
    return transform((*wall[0], np.arctan2(*(wall[1] - wall[0])[::-1])), line)


def plain(wall: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    return wall[None]


def equal_offices(wall: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Two equal offices side by side below a plain wall, 14 to 22 m from its left end."""
    one = office(rng=rng, rooms=1)
    kept = (one[..., 1].max(1) < 4.0 + 1e-6) & ~np.all(np.abs(one[..., 1] - 6.0) < 1e-6, axis=1)
    room = one[kept] - (0.0, 4.0)
    left, right = polyline([(0, 0), (14, 0)]), polyline([(22, 0), wall[1]])
    return np.concatenate([left, room + (14.0, 0), room + (18.0, 0), right])


class Building(NamedTuple):
    """How the legs are made, and where the first one is left, in the first and second lap."""

    below: Facade
    above: Facade
    back: Facade
    first: tuple = ()
    second: tuple = ()


VISIT, NEXT = (((x, 1), (x, -1.5), (x, 1)) for x in (16, 20))
BUILDINGS = {
    "repeated doors": Building(doors, doors, plain),
    "equal offices": Building(equal_offices, plain, _city._facade, VISIT, NEXT),
    "featureless hall": Building(plain, plain, _city._facade),
}


def drive_through(name: str, seed: int, length: float = LENGTH) -> Log:
    """Two laps and a half; the second passes what looks alike with the errors of the first."""
    made, rng = BUILDINGS[name], np.random.default_rng(seed)
    walls, end = ring(rng, made, length), length - 1
    back, legs = [(end, 1), (end, DEPTH - 1), (1, DEPTH - 1)], (made.first, made.second)
    laps = [corner for leg in legs for corner in ((1, 1), *leg, *back)]
    path = drive([(12, DEPTH - 1), (1, DEPTH - 1), *laps], step=0.3, turn=np.radians(15))
    return simulate(walls, path, sensor=LASER, rng=rng, odometry_noise=WHEELS, name=name)


def equal_corridors(seed: int) -> Log:
    """Two corridors of equal doors, three metres apart, shifted by a door: A, B, and both again."""
    rng = np.random.default_rng(seed)
    outer = rectangular_room(LENGTH, 12.0)
    between_them = box(LENGTH - 4, 1.0, (LENGTH / 2, 2.5, 0))[:, ::-1]
    beyond = box(LENGTH - 4, 5.0, (LENGTH / 2, 7.5, 0))[:, ::-1]
    alike = [doors(wall, rng) for wall in (outer[0], *between_them[::2], beyond[0])]
    rest = [_city._facade(wall, rng) for wall in (*outer[1:], *beyond[1:])]
    end = LENGTH - 1
    laps = [corner for y in (1, 4, 1) for corner in ((1, y), (end, y), (end, 11), (1, 11))]
    path = drive([*laps, (1, 4), (12, 4)], step=0.3, turn=np.radians(15))
    walls = np.concatenate([*alike, *rest, between_them[1::2]])
    return simulate(walls, path, sensor=LASER, rng=rng, odometry_noise=WHEELS, name="corridors")


class Verdict(NamedTuple):
    loops: int
    off: int  # wrong by more than half a metre,
    false: int  # and by more than three of its own standard deviations
    worst: float  # metres
    places: int  # returns, a place in every five metres of way
    closed: int  # of these, with a loop
    error: float  # of the poses against each other, metres


def verdict(log: Log, **settings) -> Verdict:
    found = pose_graph(log, **settings)
    graph, loop = found.graph, found.graph.loop
    ends = graph.edges[loop]
    left = between(log.truth[ends[:, 0]], log.truth[ends[:, 1]]) - graph.relative[loop]
    left[:, 2] = wrap(left[:, 2])
    far = np.hypot(left[:, 0], left[:, 1])
    sure = np.sqrt(np.einsum("ni,nij,nj->n", left, graph.information[loop], left)) > CLAIMED
    keys = np.unique(graph.edges)
    places, closed = returns(log.truth, keys, ends)
    away = between(between(log.truth[0], log.truth), between(found.poses[0], found.poses))
    worst = float(far.max(initial=0.0))
    error = float(np.hypot(*away[:, :2].T).max())
    off = far > FALSE
    return Verdict(len(ends), int(off.sum()), int((off & sure).sum()), worst, places, closed, error)


def returns(truth: np.ndarray, keys: np.ndarray, loops: np.ndarray) -> tuple[int, int]:
    """Places that are seen again, and those of them where a loop is closed."""
    path = np.r_[0, np.cumsum(np.hypot(*np.diff(truth[:, :2], axis=0).T))]
    back = np.array([_returns(truth, path, k) for k in keys])
    place = (path[keys] / PLACE).astype(int)
    seen, ended = set(place[back]), {int(path[k] / PLACE) for k in loops.max(1, initial=0)}
    return len(seen), len(seen & ended)


def _returns(truth: np.ndarray, path: np.ndarray, k: int) -> bool:
    left = between(truth[k], truth[path < path[k] - AFTER])
    near = np.hypot(left[:, 0], left[:, 1]) < NEAR
    return bool(np.any(near & (np.abs(left[:, 2]) < TURN)))
