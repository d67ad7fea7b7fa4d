"""A simulated robot that explores a building by itself: it drives to where it knows nothing yet."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import scipy
from numpy.typing import ArrayLike

from segmap import arrays
from segmap.arrays import Array, Metres, Segments, checked
from segmap.matching import NoRoute, route
from segmap.poses import transform
from segmap.quadtree import QuadtreeMap, frontiers
from segmap.segments import point_distance
from segmap.simulation import URG_04LX, Sensor, drive, simulate

#: Metres from scan to scan, and metres after which the robot looks anew for the best frontier.
STEP, AGAIN = 0.2, 1.0
#: Looking around on the spot: headings.
AROUND = np.radians(np.arange(0, 360, 60))
#: Parts of the radius: a wall that was seen late may be nearer, and the robot must get away.
CLOSER = (1.0, 0.8, 0.6, 0.4)
#: Part of the radius: a wall that comes nearer to the leg ahead ends it.
NEAR = 0.9
#: A place where the robot has been needs no second visit, metres.
BEEN = 0.3
#: No drive has more legs.
MOST = 10_000
#: Side of the squares in which the floor is counted, metres.
FLOOR = 0.1


class Explored(NamedTuple):
    """What a robot knew, scan by scan.

    The map in the end, the poses, `(k, 3)`, the metres driven up to each, `(k,)`, the share of the
    floor that was known then, `(k,)`, and the places that it chose, `(m, 2)`.
    """

    map: QuadtreeMap
    poses: Array
    metres: Array
    known: Array
    goals: Array


@checked
def explore(
    walls: Segments,
    start: ArrayLike = (1.0, 5.0),
    *,
    rng: np.random.Generator,
    radius: Metres = 0.25,
    sensor: Sensor = URG_04LX,
) -> Explored:
    """Drive from frontier to frontier until none is left that the robot can reach (Yamauchi 1997).

    Poses are the true ones; scans have the sensor's noise. The robot looks around, drives up to a
    metre towards the frontier that is nearest to drive to, and chooses anew. `start` is a place,
    `(2,)`, metres.

    Examples
    --------
    >>> from segmap.simulation import rectangular_room
    >>> drive = explore(rectangular_room(3, 3), (1, 1), rng=np.random.default_rng(0))
    >>> bool(drive.known[-1] > 0.95)
    True
    """
    walls, here = arrays.segments(walls, "walls"), arrays.point(start, "start")
    map = QuadtreeMap(resolution=0.05, free_resolution=0.1)
    floor = floor_of(walls, here)
    poses: list[Array] = []
    shares: list[float] = []

    def look(pose: Array) -> Array:
        """Scan from a pose into the map; the ends of its beams."""
        scan = simulate(walls, pose[None], sensor=sensor, rng=rng)[0]
        ends = transform(pose, scan.points())
        map.insert_scan(pose[:2], ends)
        poses.append(pose)
        shares.append(float((map.occupancy(floor) != 0.5).mean()))
        return ends

    goals = drive_to_frontiers(map, here, look, radius)
    driven = np.r_[0, np.cumsum(np.hypot(*np.diff(np.array(poses)[:, :2], axis=0).T))]
    return Explored(map, np.array(poses), driven, np.array(shares), np.array(goals[1:]))


def drive_to_frontiers(
    map: QuadtreeMap, here: Array, look: Callable[[Array], Array], radius: float
) -> list[Array]:
    """Explore from a place: the places that were reached, until no frontier can be reached.

    `look` puts a scan from a pose into the map, and answers the ends of its beams, `(n, 2)`. The
    place and the radius of the robot are in metres.

    Examples
    --------
    >>> tree = QuadtreeMap(resolution=0.05, free_resolution=0.1)
    >>> def blind(pose):
    ...     return np.empty((0, 2))
    >>> drive_to_frontiers(tree, np.array([1.0, 1.0]), blind, 0.25)
    [array([1., 1.])]
    """
    goals = [here]
    for heading in AROUND:
        look(np.append(here, heading))
    for _ in range(MOST):
        way = next_way(map, here, goals, radius)
        if way is None:
            break
        path = drive(way, step=STEP, turn=np.radians(30))
        path = path[np.r_[0, np.cumsum(np.hypot(*np.diff(path[:, :2], axis=0).T))] <= AGAIN]
        for k in range(1, len(path)):
            ends, ahead = look(path[k]), np.stack([path[k:-1, :2], path[k + 1 :, :2]], 1)
            if len(ahead) and point_distance(ends[:, None], ahead).min() < NEAR * radius:
                break  # a wall that was not known
        here = path[k, :2]
        if np.allclose(here, way[-1]):
            goals.append(here)
            for heading in AROUND:
                look(np.append(here, heading))
    return goals


def next_way(map: QuadtreeMap, here: Array, been: list[Array], radius: float) -> Array | None:
    """The way to the frontier that is nearest to drive to; None where none can be reached."""
    places = np.concatenate([np.empty((0, 2)), *(frontier.places for frontier in frontiers(map))])
    fresh = places[np.hypot(*(places[:, None] - been).T).min(0) > BEEN]
    for part in CLOSER:
        if len(fresh) and (way := _way(map, here, fresh, part * radius)) is not None:
            return way
        if _way(map, here, here[None], part * radius) is not None:
            return None  # it could leave, and there is nowhere to go
    return None


def _way(map: QuadtreeMap, here: Array, goals: Array, radius: float) -> Array | None:
    try:
        return route(map, here, goals, radius=radius)
    except NoRoute:
        return None


def floor_of(walls: Array, start: Array) -> Array:
    """Middles of all squares of floor that hang together with a place, without crossing a wall."""
    low, high = walls.min((0, 1)), walls.max((0, 1))
    x, y = (np.arange(a + FLOOR / 2, b, FLOOR) for a, b in zip(low, high, strict=True))
    middles = np.stack(np.meshgrid(x, y), -1)
    apart = point_distance(middles[:, :, None], walls).min(-1)
    part, _ = scipy.ndimage.label(apart > FLOOR * np.sqrt(0.5))
    column, row = np.floor((start - low) / FLOOR).astype(np.int64)
    return middles[part == part[row, column]]
