"""Exercises of the chapters on poses, logs, simulated rooms, ground truth and the sensor."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ..angles import wrap
from ..arrays import Array
from ..hokuyo import decode
from ..poses import compose, interpolate
from ..readers import half_turn
from ..simulation import cast_rays
from . import _exercise_draws_scans as draws_scans
from ._exercise import Exercise


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
    },
    draw=draws_scans.compose,
    own=(
        "poses.py:compose",
        "_motions.py:compose",
        "_motions.py:_composed",
    ),
)


def _heading_between(before: float, after: float, share: float) -> float:
    poses = [(0, 0, before), (0, 0, after)]
    return float(interpolate([0, 1], poses, [share])[0, 2])


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
    },
    draw=draws_scans.heading_between,
    own=("poses.py:interpolate",),
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
    },
    draw=draws_scans.beam_angles,
    own=("readers/_raw_scans.py:half_turn",),
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
    },
    draw=draws_scans.cast_ray,
    own=("simulation/_simulate.py",),
)


# ------------------------------------------------------------------------- the sensor
def _joined(lines: list[bytes]) -> bytes:
    return b"".join(line[:-1] for line in lines)


def _digits(text: bytes) -> Array:
    return np.frombuffer(text, np.uint8).astype(float).reshape(-1, 3) - 0x30


def _sums_kept(lines: list[bytes]) -> Array:
    text = b"".join(lines)
    return decode(text[: len(text) // 3 * 3], 3).astype(float)


check_distances = Exercise(
    "distances(lines) -> (n,) millimetres; lines: list of bytes, each a block of characters and "
    "its sum; three characters a distance, of six bits each, most significant first, from '0' on",
    lambda lines: decode(_joined(lines), 3).astype(float),
    {
        "one block": ([draws_scans.with_sum(b"06805m1Dh")],),
        "a distance that crosses a border": (
            [draws_scans.with_sum(b"06805m1D"), draws_scans.with_sum(b"h000007")],
        ),
        "no block": ([],),
    },
    {
        "the first character is the most significant one": (
            lambda lines: _digits(_joined(lines)) @ (1, 64, 4096)
        ),
        "the character '0' stands for 0: take 0x30 from each": (
            lambda lines: decode(_joined(lines), 3) + 0x30 * 4161
        ),
        "the last character of each block is its sum, no part of a number": _sums_kept,
        "a block need not hold whole numbers: join the blocks, then decode": (
            lambda lines: [d for line in lines for d in decode(line[:-1][:6], 3)]
        ),
    },
    draw=draws_scans.distances,
    own=("hokuyo/_protocol.py:decode",),
)


def _unwrapped(stamps: ArrayLike, wrap: float = draws_scans.WRAP) -> Array:
    return np.append(0, np.cumsum(np.diff(np.asarray(stamps, float)) % wrap)) / 1000


check_unwrapped = Exercise(
    "unwrapped(stamps) -> (n,) seconds since the first; stamps (n,) in milliseconds, which start "
    "again at 0 after 2 ** 24 - 1",
    _unwrapped,
    {
        "three turns": (np.array([500, 600, 800]),),
        "a clock that wraps": (np.array([draws_scans.WRAP - 150, draws_scans.WRAP - 50, 50, 150]),),
        "a clock that wraps twice": (np.array([draws_scans.WRAP - 1, 8_000_000, 16_000_000, 99]),),
    },
    {
        "after 2 ** 24 - 1 comes 0, not a time before": lambda s: (s - s[0]) / 1000,
        "it may wrap more than once: add up the steps from stamp to stamp": (
            lambda s: (s - s[0]) % draws_scans.WRAP / 1000
        ),
        "from 2 ** 24 - 1 to 0 is one millisecond: there are 2 ** 24 values": (
            lambda s: _unwrapped(s, draws_scans.WRAP - 1)
        ),
        "stamps are milliseconds, not seconds": lambda s: 1000 * _unwrapped(s),
    },
    draw=draws_scans.unwrapped,
)
