"""Exercises on poses: motions in a row, headings in between, pose graphs."""

from __future__ import annotations

import numpy as np

from segmap.angles import wrap
from segmap.arrays import Array
from segmap.poses import between, compose, inverse, motions, transform

from ._answers import Cases
from ._exercise import Exercise, Rng, anywhere, changed


# ---------------------------------------------------------------------- two motions in a row
def _steps(rng: Rng) -> Cases:
    return {
        "a step ahead of a robot that looks left": (anywhere(rng, 60, 120), anywhere(rng, -20, 20)),
        "two turns that end beyond half a turn": (anywhere(rng, 120, 179), anywhere(rng, 70, 150)),
        "two turns clockwise, beyond half a turn": (
            anywhere(rng, -179, -120),
            anywhere(rng, -150, -70),
        ),
        "two small turns": (anywhere(rng, -60, 60), anywhere(rng, -60, 60)),
    }


def _chain(a: Array, b: Array, heading: float, sign: float = 1.0) -> Array:
    """Step b turned by `heading` (clockwise with sign -1) and added to a."""
    c, s = np.cos(heading), sign * np.sin(heading)
    step = np.array([c * b[0] - s * b[1], s * b[0] + c * b[1]])
    return np.array([*(a[:2] + step), wrap(a[2] + b[2])])


check_compose = Exercise(
    "compose(a_from_b, b_from_c) -> a_from_c, each (3,): x, y in metres, heading in radians",
    compose,
    _steps,
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
)


# ---------------------------------------------------------------------------- pose graphs
def _at(rng: Rng, size: float, low: float, high: float) -> Array:
    """A motion of up to `size` metres, by a turn between these degrees."""
    return np.append(rng.uniform(-size, size, 2), np.radians(rng.uniform(low, high)))


def _edges(rng: Rng) -> Cases:
    first, step = anywhere(rng, -60, 60), _at(rng, 2, 20, 70)
    off = np.append(rng.uniform(-0.3, 0.3, 2), rng.uniform(-0.2, 0.2))
    over, back = _at(rng, 2, 155, 175), _at(rng, 2, -175, -155)
    return {
        "a straight way": (first * (1, 1, 0), first * (1, 1, 0) + (1, 0, 0), np.array([1.2, 0, 0])),
        "a turn on the way": (first, anywhere(rng, -60, 60), step + off),
        "a turn over half a turn": (over, back, step * (1, 1, 0.3)),
        "a turn back over half a turn": (back, over, step * (1, 1, -0.3)),
    }


def _edge_error(first: Array, second: Array, relative: Array) -> Array:
    return between(relative, between(first, second))


check_edge_error = Exercise(
    "edge_error(first, second, relative) -> (3,): pose of the second (x, y, heading) in the frame "
    "of where the measured motion `relative`, in the frame of the first, would put it",
    _edge_error,
    _edges,
    {
        "poses are not numbers: where the second lies depends on where the first one looks; "
        "take segmap.poses.between(first, second)": lambda a, b, z: b - a - z,
        "the difference of two motions is again one: seen from where the measurement ends, which "
        "looks elsewhere; compose its inverse in front, do not subtract": (
            lambda a, b, z: between(a, b) - z
        ),
        "the wrong way round: the measured place seen from the second pose is the inverse of what "
        "is asked": lambda a, b, z: between(between(a, b), z),
        "relative is the pose of the second in the frame of the first: between(first, second)": (
            lambda a, b, z: between(z, between(b, a))
        ),
        "headings 3.0 and -3.0 are 0.28 apart, not 6: wrap the difference": (
            lambda a, b, z: np.append(_edge_error(a, b, z)[:2], b[2] - a[2] - z[2])
        ),
        "the order of the two: the measurement comes first, seen from there the second pose": (
            lambda a, b, z: compose(between(a, b), inverse(z))
        ),
        "the frame of the measured place is wanted, not that of the world: turn the difference": (
            lambda a, b, z: b - compose(a, z)
        ),
        "all three parts are asked for, not only how far the place is off": (
            changed(_edge_error, lambda error: np.hypot(*error[:2]))
        ),
    },
)


def _moves(rng: Rng) -> Cases:
    before, pose = anywhere(rng, -60, 60), anywhere(rng, -60, 60)
    shift, turn = rng.uniform(-1, 1, 2), np.radians(rng.uniform(20, 60))
    over = _at(rng, 2, 120, 150)
    return {
        "a key frame that is shifted": (before, before + (*shift, 0), pose),
        "one that turns where it stands": (before, before + (0, 0, turn), pose),
        "one that is shifted and turned": (before, before + (*shift, -turn), pose),
        "a turn over half a turn": (over, over + (*shift, 0.4), over + (0.5, -0.3, 0.5)),
    }


def _carried(before: Array, after: Array, pose: Array) -> Array:
    return compose(after, between(before, pose))


check_carried = Exercise(
    "carried(before, after, pose) -> (3,): where a scan lies (x, y, heading) that lay at `pose`, "
    "once a loop has moved its key frame from `before` to `after`",
    _carried,
    _moves,
    {
        "poses are not numbers: where the key frame turns, its scans turn about it; take the pose "
        "in the key frame, segmap.poses.between(before, pose)": lambda b, a, p: p + a - b,
        "the key frame comes first: compose(after, ...), not compose(..., after)": (
            lambda b, a, p: compose(between(b, p), a)
        ),
        "the wrong way round: the scan lay beside `before`, and goes to `after`": (
            lambda b, a, p: compose(b, between(a, p))
        ),
        "the scan turns with its key frame: its heading changes too": (
            lambda b, a, p: np.append(_carried(b, a, p)[:2], p[2])
        ),
        "headings end at half a turn: wrap the sum, as compose does": (
            lambda b, a, p: np.append(_carried(b, a, p)[:2], p[2] + a[2] - b[2])
        ),
        "the scan keeps its place beside the key frame; it does not go onto it": lambda b, a, p: a,
    },
)


# --------------------------------------------------------------------------- a moving laser
def _beams_in_motion(rng: Rng) -> Cases:
    def beam(ahead: float, rate: float) -> tuple[float, ...]:
        return float(rng.uniform(1, 4)), float(rng.uniform(-3, 3)), 0.15, ahead, rate

    return {
        "a robot that drives straight on": beam(2.0, 0.0),
        "one that turns on the spot": beam(0.0, float(rng.uniform(2, 3))),
        "one that drives to the left": beam(2.0, float(rng.uniform(2, 3))),
        "one that drives to the right": beam(3.0, -float(rng.uniform(2, 3))),
    }


def _beam(distance: float, angle: float, *motion: float) -> Array:
    return transform(motion, [distance * np.cos(angle), distance * np.sin(angle)])


def _carried_beam(distance: float, angle: float, delay: float, ahead: float, rate: float) -> Array:
    return _beam(distance, angle, *motions.arc(np.array([ahead, 0, rate]) * delay))


check_carried_beam = Exercise(
    "carried_beam(distance, angle, delay, ahead, rate) -> (2,) metres: end point of a beam, seen "
    "from where the robot was when its scan began; the beam, metres and radians from straight "
    "ahead, was measured `delay` seconds later, and the robot drives `ahead` metres and turns by "
    "`rate` radians a second; the laser sits at its turning point",
    _carried_beam,
    _beams_in_motion,
    {
        "the point is where the laser saw it: it moves by what the robot moved, not back by it": (
            lambda r, a, t, v, w: _carried_beam(r, a, -t, v, w)
        ),
        "the robot drives, it does not only turn": (
            lambda r, a, t, v, w: _carried_beam(r, a, t, 0.0, w)
        ),
        "the robot turns, it does not only drive: after a turn the beam looks elsewhere": (
            lambda r, a, t, v, w: _beam(r, a, v * t, 0, 0)
        ),
        "it turns while it drives: its way is an arc, not straight ahead; take a circle of radius "
        "ahead / rate": lambda r, a, t, v, w: _beam(r, a, v * t, 0, w * t),
        "it does not turn first and drive then: its way is an arc": (
            lambda r, a, t, v, w: _beam(r, a, v * t * np.cos(w * t), v * t * np.sin(w * t), w * t)
        ),
        "speeds are a second, the delay is in seconds: how far it came is their product": (
            lambda r, a, t, v, w: _carried_beam(r, a, 1.0, v, w)
        ),
        "x and y are asked for, not range and direction": changed(
            _carried_beam, lambda p: np.array([np.hypot(*p), np.arctan2(p[1], p[0])])
        ),
    },
)
