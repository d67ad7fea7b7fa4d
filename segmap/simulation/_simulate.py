"""Rays that meet walls, drives through a room, and the log that a robot records on the way."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import arrays
from ..angles import axial_difference, wrap
from ..arrays import Array, Quantity, Radians, Segments, checked
from ..compiled import compiled
from ..poses import between, compose
from ..poses.motions import arc, twist
from ..scans import LaserScan, Log
from ..segments import angle, cut_evenly, length, midpoint
from ._rooms import polyline
from ._sensors import OdometryNoise, Sensor, drifting_odometry, measure

#: The sensor touches a wall that is at most this far away, metres.
TOUCH = 1e-9
#: No drive has more poses: more would fill the memory.
MOST_POSES = 1_000_000
#: Of more walls than this only those that are near a pose are tried: a beam takes 3 ns a wall.
MANY = 200
#: Places along all walls by which the near ones are found.
WALL_PLACES = 1_000_000


@checked
def cast_rays(
    walls: Segments,
    pose: ArrayLike,
    angles: ArrayLike,
    *,
    max_range: Annotated[float, Quantity("metres", above=0, most=np.inf)] = np.inf,
) -> Array:
    """Exact ranges of beams from one place to the nearest wall.

    A beam through a corner that two walls share never slips between them. A wall seen exactly edge
    on has no width and is not met; nor is a wall that the sensor touches.

    Parameters
    ----------
    pose : (3,) array, metres and radians
        Pose of the sensor in the frame of the walls.
    angles : (b,) array, radians
        Directions of the beams in the sensor's frame.

    Returns
    -------
    (b,) array, metres
        `inf` where nothing is met within `max_range`.

    Examples
    --------
    >>> from segmap.simulation import rectangular_room
    >>> cast_rays(rectangular_room(4, 3), (1, 1, 0), np.radians([-90, 0, 90, 180])).round(9)
    array([1., 3., 2., 1.])
    """
    beams = arrays.values(angles, "angles")
    if beams.ndim != 1 or not np.isfinite(beams).all():
        raise ValueError(f"angles must be (b,) and finite, got shape {beams.shape}")
    return _meet(arrays.segments(walls, "walls"), arrays.pose(pose), beams, max_range)[0]


def _meet(
    walls: Array, pose: Array, angles: Array, max_range: float = np.inf
) -> tuple[Array, NDArray[np.int64]]:
    """Ranges of beams, and the index of the wall that each meets (-1 for none)."""
    ranges, met = np.full(len(angles), np.inf), np.full(len(angles), -1)
    around = np.subtract(walls, pose[:2], order="C")
    turned = angles + pose[2]
    _cast_beams(around, np.cos(turned), np.sin(turned), float(max_range), ranges, met)
    return ranges, met


@compiled
def _cast_beams(
    walls: Array, cos: Array, sin: Array, max_range: float, ranges: Array, met: NDArray[np.int64]
) -> None:
    """Nearest wall of each beam, into `ranges` and `met`; walls are relative to the sensor.

    A wall is met where its end points lie on different sides of the beam. A corner shared by two
    walls gets the same side in both, bit for bit, so nothing slips through.
    """
    for i in range(len(cos)):
        c, s = cos[i], sin[i]
        for j in range(len(walls)):
            ax, ay, bx, by = walls[j, 0, 0], walls[j, 0, 1], walls[j, 1, 0], walls[j, 1, 1]
            side_a, side_b = c * ay - s * ax, c * by - s * bx
            if (side_a < 0) == (side_b < 0) and side_a != 0 and side_b != 0:
                continue
            if side_a == side_b:  # edge on, or without length
                continue
            part = side_a / (side_a - side_b)
            ahead = c * (ax + part * (bx - ax)) + s * (ay + part * (by - ay))
            if TOUCH < ahead < ranges[i] and ahead <= max_range:
                ranges[i], met[i] = ahead, j


@checked
def drive(
    waypoints: ArrayLike,
    *,
    step: Annotated[float, Quantity("metres", above=0)] = 0.10,
    turn: Radians = np.radians(10.0),
) -> Array:
    """A path from way point to way point: straight on, and turning on the spot at the corners.

    Parameters
    ----------
    waypoints : (k, 2) array, metres
        At least two, no two in a row the same.
    step : float
        Poses on a straight leg are at most so far apart: 0.10 m is a walk at ten scans a second.
    turn : float
        Poses at a corner are turned by at most so much.

    Returns
    -------
    (m, 3) array, metres and radians
        First and last lie on the first and last way point, looking along the path.

    Examples
    --------
    >>> drive([(0, 0), (1, 0), (1, 1)], step=0.5, turn=np.pi / 4).round(3)
    array([[0.   , 0.   , 0.   ],
           [0.5  , 0.   , 0.   ],
           [1.   , 0.   , 0.   ],
           [1.   , 0.   , 0.785],
           [1.   , 0.   , 1.571],
           [1.   , 0.5  , 1.571],
           [1.   , 1.   , 1.571]])
    """
    legs = polyline(arrays.points(waypoints, "waypoints"))
    d = legs[:, 1] - legs[:, 0]
    if not len(legs) or not np.all(np.hypot(*d.T) > 0):
        raise ValueError("waypoints must hold at least two points, each unlike the one before")
    headings = np.arctan2(d[:, 1], d[:, 0])
    count = np.hypot(*d.T).sum() / step + np.pi * len(d) / turn
    if count > MOST_POSES:
        raise ValueError(f"step and turn must be larger: they ask for up to {count:.0e} poses")
    poses = [np.array([[*legs[0, 0], headings[0]]])]
    for (start, end), heading in zip(legs, headings, strict=True):
        here = poses[-1][-1]
        poses.append(_even_steps(here, (*start, here[2] + wrap(heading - here[2])), turn))
        here = poses[-1][-1] if len(poses[-1]) else here
        poses.append(_even_steps(here, (*end, here[2]), step))
    path = np.concatenate(poses)
    path[:, 2] = wrap(path[:, 2])
    return path


def _even_steps(start: Array, end: ArrayLike, most: float) -> Array:
    """Poses evenly from start (left out) to end (kept), each at most `most` from the last."""
    whole = np.asarray(end, float) - start
    count = int(np.ceil(np.max([np.hypot(*whole[:2]), abs(whole[2])]) / most - 1e-9))
    return start + np.arange(1, count + 1)[:, None] / max(count, 1) * whole


@checked
def simulate(
    walls: Segments,
    path: ArrayLike,
    *,
    sensor: Sensor,
    rng: np.random.Generator,
    odometry_noise: OdometryNoise = OdometryNoise(),
    sensor_pose: ArrayLike = (0.0, 0.0, 0.0),
    moving: bool = False,
    name: str = "simulated",
) -> Log:
    """The log of a robot that scans from every pose of a path.

    Parameters
    ----------
    path : (k, 3) array, metres and radians
        True poses of the robot, one a scan, as `drive` makes them.
    sensor : Sensor
        `sensor.ideal()` measures without error.
    odometry_noise : OdometryNoise
        `OdometryNoise().ideal()` gives odometry equal to the truth.
    sensor_pose : (3,) array, metres and radians
        Pose of the sensor in the frame of the robot.
    moving
        Whether the sensor turns while the robot moves: each beam is measured where the robot then
        is on its arc to the next pose. Else the robot stops for each scan.

    Returns
    -------
    Log
        Times in seconds, from 0 in steps of the sensor's period; odometry, which starts at the
        first true pose and drifts; `truth`, `(k, 3)` in metres and radians.

    Examples
    --------
    >>> from segmap.simulation import URG_04LX, square_room
    >>> path = drive([(1, 1), (3, 1)], step=0.5)
    >>> simulate(square_room(), path, sensor=URG_04LX, rng=np.random.default_rng(1), name="square")
    Log('square', 5 scans, odometry, truth)
    """
    arrays.instance(sensor, "sensor", Sensor)
    truth, offset = arrays.poses(path, "path"), arrays.pose(sensor_pose, "sensor_pose")
    drifted = drifting_odometry(truth, odometry_noise=odometry_noise, rng=rng)
    near, angles = _near_walls(arrays.segments(walls, "walls"), sensor), sensor.angles
    lasers, delays = compose(truth, offset)[:, None], None
    if moving and len(truth) > 1:  # the last scan moves on as the one before it
        turned = np.arange(sensor.beams) * abs(sensor.step) / (2 * np.pi)
        steps = twist(between(truth[:-1], truth[1:]))[[*range(len(truth) - 1), -1]]
        on_the_way = compose(truth[:, None], arc(steps[:, None] * turned[:, None]))
        lasers, delays = compose(on_the_way, offset), turned * sensor.period
    scans = [
        LaserScan(
            _measured_ranges(near(laser[0]), laser, sensor, rng),
            angles,
            time=i * sensor.period,
            odometry=odometry,
            max_range=sensor.max_range,
            sensor_pose=offset,
            delays=delays,
        )
        for i, (laser, odometry) in enumerate(zip(lasers, drifted, strict=True))
    ]
    return Log(name, scans, truth)


def _measured_ranges(walls: Array, poses: Array, sensor: Sensor, rng: np.random.Generator) -> Array:
    """Ranges that a sensor measures from one pose, or each beam from its own, `(1 or n, 3)`."""
    parts = zip(poses, np.split(sensor.angles, len(poses)), strict=True)
    ranges, met = map(np.concatenate, zip(*(_meet(walls, *p) for p in parts), strict=True))
    seen = np.append(angle(walls), np.nan)[met]  # -1, nothing met, takes the last
    incidence = np.abs(axial_difference(sensor.angles + poses[:, 2], seen))
    return measure(ranges, incidence, sensor=sensor, rng=rng)


def _near_walls(walls: Array, sensor: Sensor) -> Callable[[Array], Array]:
    """From a pose `(3,)` to the walls `(m, 2, 2)` that a sensor can measure there, in their order.

    Walls are found by places along them: one that comes within reach has a place near that point.
    """
    from scipy.spatial import cKDTree

    # An error of a range can bring a wall within the range, but not from farther off than this.
    reach = sensor.max_range * (1 + 10 * sensor.range_share) + 10 * sensor.sigma + sensor.resolution
    if len(walls) <= MANY or not np.isfinite(reach):
        return lambda pose: walls
    along = length(walls)
    apart = max(reach, float(along.sum()) / WALL_PLACES)
    pieces, which = cut_evenly(walls, np.maximum(np.ceil(along / apart), 1).astype(np.int64))
    tree = cKDTree(midpoint(pieces))
    return lambda pose: walls[np.unique(which[tree.query_ball_point(pose[:2], reach + apart / 2)])]
