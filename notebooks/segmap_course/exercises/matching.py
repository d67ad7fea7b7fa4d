"""Exercises on scores, matchers and particles: a score, a step of a climb, the weights."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from segmap.arrays import Array
from segmap.poses import transform

from ..literal import MOVES, climb_step, distance_score, weighed
from ..literal.quadtrees import matching, particles
from ._answers import Cases
from ._exercise import Exercise, Rng, anywhere, changed, edited


# --------------------------------------------------------------------------------- scores
def _scans(rng: Rng) -> Cases:
    points, centres = rng.uniform(-3, 3, (5, 2)), rng.uniform(-3, 3, (7, 2))
    moved = np.append(rng.uniform(0.2, 1, 2) * rng.choice([-1, 1], 2), 0.0)
    turned = np.array([0, 0, rng.uniform(0.4, 2.5) * rng.choice([-1, 1])])
    return {
        "a pose that changes nothing": (points, np.zeros(3), centres),
        "a pose that is shifted": (points, moved, centres),
        "a pose that is turned": (points[:3], turned, centres),
        "a pose that is shifted and turned": (points, anywhere(rng), centres),
        "a single beam": (points[:1], moved + turned, centres),
    }


def _distances(points: Array, pose: Array, centres: Array) -> Array:
    return np.linalg.norm(transform(pose, points)[:, None] - centres, axis=-1)


check_scan_score = Exercise(
    "scan_score(points, pose, centres) -> float: minus the sum of the distances of the ends "
    "(n, 2), carried by the pose, to the nearest centre (m, 2)",
    distance_score,
    _scans,
    {
        "the higher the better: distances count as a loss, so the score is never above 0": (
            changed(distance_score, np.negative)
        ),
        "every end looks for its nearest cell, not every cell for an end: a map holds many cells "
        "that this scan does not see": changed(_distances, lambda away: -away.min(0).sum()),
        "only the nearest cell counts for each end": (
            changed(_distances, lambda away: -away.mean(1).sum())
        ),
        "the sum over the beams, not their mean": (
            changed(_distances, lambda away: -away.min(1).mean())
        ),
        "the heading turns counter-clockwise: x' = x cos h - y sin h, y' = x sin h + y cos h": (
            lambda points, pose, centres: distance_score(points, pose * (1, 1, -1), centres)
        ),
        "the points are in the robot's frame: carry them by the pose first": (
            lambda points, pose, centres: distance_score(points, (0, 0, 0), centres)
        ),
        "the heading is in radians already": (
            lambda points, pose, centres: distance_score(
                points, pose * (1, 1, np.pi / 180), centres
            )
        ),
        "distances, not their squares: one beam through a door would count for all others": (
            changed(_distances, lambda away: -(away.min(1) ** 2).sum())
        ),
    },
    own=(distance_score,),
)


# ------------------------------------------------------------------------------ hill climb
#: A pose is an array or a tuple: three numbers.
Pose = Any
Value = Callable[[Pose], float]
Three = tuple[float, float, float]


@dataclass(frozen=True)
class Surface:
    """The value of a pose: so much for each metre or radian from a point, or away from it."""

    slope: Three
    point: Three = (0.0, 0.0, 0.0)
    away: tuple[bool, bool, bool] = (False, False, False)

    def __call__(self, pose: Pose) -> float:
        """The score of a pose."""
        off = np.subtract(pose, self.point)
        return float(np.where(self.away, np.abs(off), off) @ np.array(self.slope))


def _hills(rng: Rng) -> Cases:
    top = rng.uniform(-1, 1, 3)
    move, right, up = rng.uniform(0.05, 0.2), *rng.uniform(0.3, 0.9, 2)
    hill, start = Surface((-1, -2, -1), tuple(top.tolist()), (True,) * 3), rng.uniform(-1, 1, 3)
    valley, slope = Surface((0, 1, 0), away=(False, True, False)), Surface((2, 1, 0))
    return {
        words: (value, np.array(pose, float), float(step), float(turn))
        for words, value, pose, step, turn in (
            ("a hill to the right and below", hill, top + (-right, up, 0.3), move, move),
            ("a hill to the left and above", hill, top + (right, -up, -0.3), move, move),
            ("a hill, nearly there", hill, top + (0, move, 0), move, move),
            ("on the top", hill, top, move, move),
            ("a plain", Surface((0, 0, 0)), start, move, move),
            ("a valley, both ways up", valley, start * (1, 0, 1), 0.125, 0.125),
            ("a slope, the robot turned", slope, start * (1, 1, 0) + (0, 0, 2), move, move),
            ("a coarse turn", hill, top - (0, 0, 0.4), 0.001, 1.0),
        )
    }


_always = edited(climb_step, ("pose, value(pose)", "pose, float('-inf')"))


def _if_as_good(value: Value, pose: Pose, move: float, turn: float) -> Pose:
    best = _always(value, pose, move, turn)
    return best if value(best) >= value(pose) else pose


def _along_the_robot(value: Value, pose: Pose, move: float, turn: float) -> Pose:
    c, s = np.cos(pose[2]), np.sin(pose[2])
    turned = np.array(MOVES) @ [(c, s, 0), (-s, c, 0), (0, 0, 1)]
    return climb_step(value, pose, move, turn, turned)


check_climb_step = Exercise(
    "climb_step(value, pose, move, turn) -> (3,): the best of the moves -x, +x, -y, +y, -heading, "
    "+heading, where it improves value(pose)",
    climb_step,
    _hills,
    {
        "an equal score is no improvement: on a plain the robot would walk for ever": _if_as_good,
        "look at all six before you move: the best counts, not the first that improves": (
            edited(climb_step, ("best, most = tried, value(tried)", "return tried"))
        ),
        "of equal moves the first in the order counts": (
            lambda value, at, move, turn: climb_step(value, at, move, turn, MOVES[::-1])
        ),
        "the moves go along the axes of the map, not along those of the robot": _along_the_robot,
        "stay where none of the six improves the score": _always,
        "the higher the better: you climb down": (
            lambda value, *rest: climb_step(lambda p: -value(p), *rest)
        ),
        "try all six moves from where the pose is: do not walk on from each that improves": (
            edited(climb_step, ("best, most = t", "pose, most = t"), ("return best", "return pose"))
        ),
        "the pose after the move is asked for, not its value": (
            lambda value, *rest: value(climb_step(value, *rest))
        ),
        "the heading moves by `turn`, x and y by `move`": (
            lambda value, at, move, turn: climb_step(value, at, turn, move)
        ),
    },
    own=(matching,),
)


# ------------------------------------------------------------------------------- particles
def _particles(rng: Rng) -> Cases:
    weights = rng.uniform(0.1, 1, 5)
    fits, even = rng.uniform(0.4, 0.95, 5), np.full(5, 0.2)
    return {
        "equal weights": (even, fits, 10),
        "weights of their own": (weights / weights.sum(), fits, 10),
        "one independent beam": (weights / weights.sum(), fits, 1),
        "fits that are all equal": (weights / weights.sum(), np.full(5, fits[0]), 10),
        "a single particle": (np.ones(1), fits[:1], 10),
    }


check_weighed = Exercise(
    "weighed(weights, fits, beams) -> (n,): the weights of particles after a scan that fits them "
    "so well, as often as it has independent beams",
    weighed,
    _particles,
    {
        "the weights must sum to 1": (edited(weighed, ("[w / sum(each) for w in each]", "each"))),
        "what was believed before the scan counts too: multiply": (
            lambda weights, fits, beams: weighed([1.0] * len(weights), fits, beams)
        ),
        "each independent beam is a factor: a power, not a product": (
            edited(weighed, ("w * f**beams", "w * f * beams"))
        ),
        "the power is that of the fit alone, not that of the weight": (
            edited(weighed, ("w * f**beams", "(w * f) ** beams"))
        ),
        "divide by the sum, not by the largest": (
            edited(weighed, ("w / sum(each)", "w / max(each)"))
        ),
    },
    own=(particles,),
)
