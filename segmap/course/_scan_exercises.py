"""Exercises of the chapters on poses, logs and simulated rooms."""

import numpy as np

from ..angles import wrap
from ..arrays import Array
from ..poses import compose
from ..readers import half_turn
from ..simulation import cast_rays
from ._exercise import Case, Exercise, Mistake


def _pose(x: float, y: float, degrees: float) -> Array:
    return np.array([x, y, np.radians(degrees)])


def _chain(a: Array, b: Array, heading: float, sign: float = 1.0) -> Array:
    """Step b turned by `heading` (clockwise with sign -1) and added to a."""
    c, s = np.cos(heading), sign * np.sin(heading)
    step = np.array([c * b[0] - s * b[1], s * b[0] + c * b[1]])
    return np.array([*(a[:2] + step), wrap(a[2] + b[2])])


check_compose = Exercise(
    "compose",
    "compose(a_from_b, b_from_c) -> a_from_c, each (3,): x, y in metres, heading in radians",
    compose,
    (
        Case(
            "one step ahead of a robot at (1, 2) that looks left", (_pose(1, 2, 90), _pose(1, 0, 0))
        ),
        Case("a turn of 170 and one of 60 degrees", (_pose(0, 0, 170), _pose(0, 0, 60))),
        Case("(1, -2, 30 deg), then (0.3, 0.4, -70 deg)", (_pose(1, -2, 30), _pose(0.3, 0.4, -70))),
        Case("(0.5, 0, -140 deg), then (1, 1, -100 deg)", (_pose(0.5, 0, -140), _pose(1, 1, -100))),
    ),
    (
        Mistake(
            "order swapped",
            lambda a, b: compose(b, a),
            "the order: the first pose is where you stand, the second the step taken from there",
        ),
        Mistake(
            "heading not wrapped",
            lambda a, b: np.array([*compose(a, b)[:2], a[2] + b[2]]),
            "the heading runs over half a turn: bring it back with segmap.angles.wrap",
        ),
        Mistake(
            "degrees",
            lambda a, b: _chain(a, b, np.radians(a[2])),
            "headings are radians already: sin and cos take them as they are",
        ),
        Mistake(
            "added without turning",
            lambda a, b: a + b,
            "a step ahead goes where the robot looks: turn it by the first heading before adding",
        ),
        Mistake(
            "turned clockwise",
            lambda a, b: _chain(a, b, a[2], -1.0),
            "angles count counter-clockwise: look at the signs of the two sines",
        ),
    ),
)

check_beam_angles = Exercise(
    "beam_angles",
    "beam_angles(n) -> (n,) radians: directions of the n beams of a sensor that sees half a turn",
    half_turn,
    tuple(Case(f"{n} beams", (n,)) for n in (181, 180, 361, 360, 5, 4)),
    (
        Mistake(
            "both ends always",
            lambda n: np.linspace(-np.pi / 2, np.pi / 2, n),
            "180 or 360 beams leave the end point out: their step is exactly 1 or 0.5 degrees",
        ),
        Mistake(
            "end left out always",
            lambda n: np.linspace(-np.pi / 2, np.pi / 2, n, endpoint=False),
            "181 or 361 beams include both ends: the last one points to +90 degrees",
        ),
        Mistake(
            "starting at 0",
            lambda n: half_turn(n) + np.pi / 2,
            "0 is straight ahead: the first beam looks to the right, at -90 degrees",
        ),
        Mistake(
            "degrees",
            lambda n: np.degrees(half_turn(n)),
            "the library works in radians: convert the degrees",
        ),
        Mistake(
            "clockwise",
            lambda n: -half_turn(n),
            "angles count counter-clockwise, from the right (-90 degrees) to the left",
        ),
    ),
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
    "cast_ray",
    "cast_ray(wall, pose, angle) -> metres to the wall (2, 2) along the beam at `angle` radians "
    "from a robot at pose (3,); inf where it is not met",
    lambda wall, pose, angle: float(cast_rays([wall], pose, [angle])[0]),
    (
        Case("a wall 2 m straight ahead", (_WALL, _pose(0, 0, 0), 0.0)),
        Case("a beam at 20 degrees to a wall 2 m ahead", (_WALL, _pose(0, 0, 0), np.radians(20))),
        Case(
            "a robot at (1, 0.5) that looks 15 degrees right, beam 20 degrees left",
            (_WALL, _pose(1, 0.5, -15), np.radians(20)),
        ),
        Case("a wall right behind the robot", (_WALL, _pose(0, 0, 180), 0.0)),
        Case("a beam that passes beside the wall", (_WALL, _pose(0, 0, 0), np.radians(40))),
        Case("a beam parallel to the wall", (_WALL, _pose(0, 0, 90), 0.0)),
    ),
    (
        Mistake(
            "hit behind",
            lambda wall, pose, angle: _cast_ray(wall, pose, angle, behind=True),
            "a beam goes one way only: a wall behind the sensor, at a negative range, is not met",
        ),
        Mistake(
            "beyond the end points",
            lambda wall, pose, angle: _cast_ray(wall, pose, angle, endless=True),
            "a wall ends: the meeting point must lie between its end points",
        ),
        Mistake(
            "neither tested",
            lambda wall, pose, angle: _cast_ray(wall, pose, angle, behind=True, endless=True),
            "two lines always meet somewhere: test that it is ahead, and between the end points",
        ),
        Mistake(
            "degrees",
            lambda wall, pose, angle: _cast_ray(wall, np.radians(pose), np.radians(angle)),
            "angles are radians already: sin and cos take them as they are",
        ),
        Mistake(
            "heading forgotten",
            lambda wall, pose, angle: _cast_ray(wall, np.array([*pose[:2], 0.0]), angle),
            "the beam's angle counts from straight ahead: add the robot's heading",
        ),
        Mistake(
            "place forgotten",
            lambda wall, pose, angle: _cast_ray(wall, np.array([0.0, 0.0, pose[2]]), angle),
            "the beam starts at the robot: take its x and y from the wall's first",
        ),
    ),
)
