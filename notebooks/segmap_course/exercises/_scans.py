"""Exercises of the chapters on poses, logs, simulated rooms and ground truth."""

from __future__ import annotations

import numpy as np

from segmap.angles import wrap
from segmap.arrays import Array
from segmap.poses import between, compose, interpolate, motions
from segmap.readers import half_turn
from segmap.simulation import cast_rays, simulate

from ._exercise import Exercise
from .draws import scans as draws_scans


# ------------------------------------------------------------------------------ poses
def _chain(a: Array, b: Array, heading: float, sign: float = 1.0) -> Array:
    """Step b turned by `heading` (clockwise with sign -1) and added to a."""
    c, s = np.cos(heading), sign * np.sin(heading)
    step = np.array([c * b[0] - s * b[1], s * b[0] + c * b[1]])
    return np.array([*(a[:2] + step), wrap(a[2] + b[2])])


check_compose = Exercise(
    "compose(a_from_b, b_from_c) -> a_from_c, each (3,): x, y in metres, heading in radians",
    compose,
    {
        "one step ahead of a robot at (1, 2) that looks left": (
            draws_scans.pose(1, 2, 90),
            draws_scans.pose(1, 0, 0),
        ),
        "a turn of 170 and one of 60 degrees": (
            draws_scans.pose(0, 0, 170),
            draws_scans.pose(0, 0, 60),
        ),
        "(1, -2, 30 deg), then (0.3, 0.4, -70 deg)": (
            draws_scans.pose(1, -2, 30),
            draws_scans.pose(0.3, 0.4, -70),
        ),
        "(0.5, 0, -140 deg), then (1, 1, -100 deg)": (
            draws_scans.pose(0.5, 0, -140),
            draws_scans.pose(1, 1, -100),
        ),
    },
    {
        "the order: the first pose is where you stand, the second the step taken from there": (
            lambda a, b: compose(b, a)
        ),
        "the heading runs over half a turn: bring it back with segmap.angles.wrap": (
            lambda a, b: np.array([*compose(a, b)[:2], a[2] + b[2]])
        ),
        "headings are radians already: sin and cos take them as they are": (
            lambda a, b: _chain(a, b, np.radians(a[2]))
        ),
        "a step ahead goes where the robot looks: turn it by the first heading before adding": (
            lambda a, b: a + b
        ),
        "angles count counter-clockwise: look at the signs of the two sines": (
            lambda a, b: _chain(a, b, a[2], -1.0)
        ),
        "turn the step by the heading of the first pose, not by that of the second": (
            lambda a, b: _chain(a, b, b[2])
        ),
        "the step starts where the robot stands: add its x and y": (
            lambda a, b: compose(a * (0, 0, 1), b)
        ),
        "this is the second pose seen from the first; asked is where the step leads": between,
    },
    draw=draws_scans.compose,
    own=(compose, motions.compose),
)


def _heading_between(before: float, after: float, share: float) -> float:
    poses = [(0, 0, before), (0, 0, after)]
    return float(interpolate([0, 1], poses, [share])[0, 2])


def _mixed(before: float, after: float, share: float) -> float:
    s, c = (f([before, after]) @ [1 - share, share] for f in (np.sin, np.cos))
    return float(np.arctan2(s, c))


check_heading_between = Exercise(
    "heading_between(before, after, share) -> heading at that share of the way from before to "
    "after, by the shorter way round; radians, in [-pi, pi)",
    _heading_between,
    {
        words: (np.radians(before), np.radians(after), share)
        for words, before, after, share in (
            ("a quarter of the way from 10 to 50 degrees", 10, 50, 0.25),
            ("half the way from 170 to -160 degrees", 170, -160, 0.5),
            ("a quarter of the way from -170 to 150 degrees", -170, 150, 0.25),
            ("nine tenths of the way from 170 to -160 degrees", 170, -160, 0.9),
            ("from 100 to 20 degrees", 100, 20, 0.3),
        )
    },
    {
        "from 170 to -170 degrees is a turn of 20, not of -340: wrap the difference first": (
            lambda a, b, t: a + t * (b - a)
        ),
        "the heading runs over half a turn: bring the result back with segmap.angles.wrap": (
            lambda a, b, t: a + t * float(wrap(b - a))
        ),
        "the shorter way may be clockwise: a turn lies between minus and plus half a turn": (
            lambda a, b, t: float(wrap(a + t * ((b - a) % (2 * np.pi))))
        ),
        "a share of 0 is the heading before, of 1 the heading after": (
            lambda a, b, t: _heading_between(b, a, t)
        ),
        "headings are in radians: hand the answer back as it came": (
            lambda a, b, t: np.degrees(_heading_between(a, b, t))
        ),
        "the mean of the two directions as vectors does not turn evenly: take a share of the "
        "angle": _mixed,
    },
    draw=draws_scans.heading_between,
    own=(interpolate,),
)


# ------------------------------------------------------------------------------ beams
check_beam_angles = Exercise(
    "beam_angles(n) -> (n,) radians: directions of the n beams of a sensor that sees half a turn",
    half_turn,
    {f"{n} beams": (n,) for n in (181, 180, 361, 360, 5, 4)},
    {
        "180 or 360 beams leave the end point out: their step is exactly 1 or 0.5 degrees": (
            lambda n: np.linspace(-np.pi / 2, np.pi / 2, n)
        ),
        "181 or 361 beams include both ends: the last one points to +90 degrees": (
            lambda n: np.linspace(-np.pi / 2, np.pi / 2, n, endpoint=False)
        ),
        "0 is straight ahead: the first beam looks to the right, at -90 degrees": (
            lambda n: half_turn(n) + np.pi / 2
        ),
        "the library works in radians: convert the degrees": lambda n: np.degrees(half_turn(n)),
        "angles count counter-clockwise, from the right (-90 degrees) to the left": (
            lambda n: -half_turn(n)
        ),
        "the step depends on n: half a turn has 180 steps of 1 degree, or 360 of half a degree": (
            lambda n: np.radians(np.arange(n) - 90)
        ),
        "odd numbers include both ends, even ones leave the last out; here it is exchanged": (
            lambda n: np.linspace(-np.pi / 2, np.pi / 2, n, endpoint=n % 2 == 0)
        ),
        "the beams go from -90 to 90 degrees, half a turn, not from -180 to 180": (
            lambda n: 2 * half_turn(n)
        ),
    },
    draw=draws_scans.beam_angles,
    own=(half_turn,),
)


def _cast_ray(
    wall: Array, pose: Array, angle: float, *, behind: bool = False, endless: bool = False
) -> float:
    """Range to a wall; with the tests for what lies behind or beside it left out when asked."""
    beam = np.array([np.cos(pose[2] + angle), np.sin(pose[2] + angle)])
    start, along = wall[0] - pose[:2], wall[1] - wall[0]
    across = beam[0] * along[1] - beam[1] * along[0]
    if abs(across) < 1e-12:
        return np.inf
    distance = (start[0] * along[1] - start[1] * along[0]) / across
    share = (start[0] * beam[1] - start[1] * beam[0]) / across
    met = (behind or distance > 0) and (endless or 0 <= share <= 1)
    return float(distance) if met else np.inf


_WALL = np.array([(2.0, -1.0), (2.0, 1.0)])


def _off_wall(wall: Array, pose: Array) -> float:
    """Distance of the robot from the line of a wall, with a sign."""
    (x, y), (dx, dy) = pose[:2] - wall[0], wall[1] - wall[0]
    return float((dx * y - dy * x) / np.hypot(dx, dy))


check_cast_ray = Exercise(
    "cast_ray(wall, pose, angle) -> metres to the wall (2, 2) along the beam at `angle` radians "
    "from a robot at pose (3,); inf where it is not met",
    lambda wall, pose, angle: float(cast_rays([wall], pose, [angle])[0]),
    {
        words: (_WALL, pose, np.radians(degrees))
        for words, pose, degrees in (
            ("a wall 2 m straight ahead", draws_scans.pose(0, 0, 0), 0),
            ("a beam at 20 degrees to a wall 2 m ahead", draws_scans.pose(0, 0, 0), 20),
            (
                "a robot at (1, 0.5) that looks 15 degrees right, beam 20 degrees left",
                *(draws_scans.pose(1, 0.5, -15), 20),
            ),
            (
                "a robot at (1, 0.5) that looks 50 degrees right, beam 10 degrees left",
                *(draws_scans.pose(1, 0.5, -50), 10),
            ),
            ("a wall right behind the robot", draws_scans.pose(0, 0, 180), 0),
            ("a beam that passes beside the wall", draws_scans.pose(0, 0, 0), 40),
            ("a beam parallel to the wall", draws_scans.pose(0, 0, 90), 0),
        )
    },
    {
        "a beam goes one way only: a wall behind the sensor, at a negative range, is not met": (
            lambda wall, pose, angle: _cast_ray(wall, pose, angle, behind=True)
        ),
        "a wall ends: the meeting point must lie between its end points": (
            lambda wall, pose, angle: _cast_ray(wall, pose, angle, endless=True)
        ),
        "two lines always meet somewhere: test that it is ahead, and between the end points": (
            lambda wall, pose, angle: _cast_ray(wall, pose, angle, behind=True, endless=True)
        ),
        "angles are radians already: sin and cos take them as they are": (
            lambda wall, pose, angle: _cast_ray(wall, np.radians(pose), np.radians(angle))
        ),
        "the beam's angle counts from straight ahead: add the robot's heading": (
            lambda wall, pose, angle: _cast_ray(wall, pose * (1, 1, 0), angle)
        ),
        "the beam starts at the robot: take its x and y from the wall's first": (
            lambda wall, pose, angle: _cast_ray(wall, pose * (0, 0, 1), angle)
        ),
        "the range is measured along the beam, not square to the wall": (
            lambda wall, pose, angle: float(
                min(_cast_ray(wall, pose, angle), np.abs(_off_wall(wall, pose)))
                if np.isfinite(_cast_ray(wall, pose, angle))
                else np.inf
            )
        ),
        "angles count counter-clockwise: a beam at a positive angle looks to the left": (
            lambda wall, pose, angle: _cast_ray(wall, pose * (1, 1, -1), -angle)
        ),
        "where the wall is not met the answer is inf, not nan": (
            lambda wall, pose, angle: np.nan_to_num(_cast_ray(wall, pose, angle), posinf=np.nan)
        ),
        "where the wall is not met the answer is inf, not 0: that would be a wall at the sensor": (
            lambda wall, pose, angle: np.nan_to_num(_cast_ray(wall, pose, angle), posinf=0.0)
        ),
    },
    draw=draws_scans.cast_ray,
    own=(cast_rays, simulate),
)
