"""Exercises on scores, matchers and filters: a scan, a step of a climb, what a filter claims."""

from __future__ import annotations

from collections.abc import Callable
from itertools import product
from typing import Any

import numpy as np

from segmap.arrays import Array
from segmap.poses import transform

from ..literal import climb_step, distance_score, systematic, weighed
from ._answers import Cases, Surface
from ._exercise import Exercise, Rng, anywhere, changed, edited

# --------------------------------------------------------------------------------- scores
#: No end costs more than this, metres: twice the thickness of a wall of the clinic.
_MOST = 0.2


def _scans(rng: Rng) -> Cases:
    """Of the ends of each scan half lie near a cell, the others far from all."""
    points = rng.uniform(-3, 3, (6, 2))
    moved = np.append(rng.uniform(0.4, 1, 2) * rng.choice([-1, 1], 2), 0.0)
    turned = np.array([0, 0, rng.uniform(0.4, 2.5) * rng.choice([-1, 1])])

    def case(pose: Array, beams: int = 6) -> tuple[Array, Array, Array]:
        near = transform(pose, points[:beams:2])
        centres = near + rng.uniform(0.02, 0.1, near.shape) * rng.choice([-1, 1], near.shape)
        return points[:beams], pose, np.concatenate([centres, centres[:1] + (9, 9)])

    return {
        "a pose that changes nothing": case(np.zeros(3)),
        "a pose that is shifted": case(moved),
        "a pose that is turned": case(turned, 4),
        "a pose that is shifted and turned": case(anywhere(rng)),
        "a single beam": case(moved + turned, 1),
    }


def _nearest(points: Array, pose: Array, centres: Array) -> Array:
    return np.linalg.norm(transform(pose, points)[:, None] - centres, axis=-1).min(1)


def _capped(points: Array, pose: Array, centres: Array) -> Any:
    return -np.minimum(_nearest(points, pose, centres), _MOST).sum()


check_capped_score = Exercise(
    "capped_score(points, pose, centres) -> float: minus the sum of the distances of the ends "
    "(n, 2), carried by the pose, to the nearest centre (m, 2), where no end costs more than 0.2 m",
    _capped,
    _scans,
    {
        "an end in an unknown room still costs all its metres: take at most 0.2 m of each": (
            distance_score
        ),
        "each end is limited, not their sum": (
            changed(_nearest, lambda away: -min(away.sum(), _MOST))
        ),
        "an end beyond 0.2 m costs 0.2 m; if it cost nothing, a pose at which all ends are far "
        "from the map would be the best": (
            changed(_nearest, lambda away: -away[away <= _MOST].sum())
        ),
        "the higher the better: distances count as a loss, so the score is never above 0": (
            changed(_capped, np.negative)
        ),
        "0.2 m is the most that an end costs, and not the least": (
            changed(_nearest, lambda away: -np.maximum(away, _MOST).sum())
        ),
        "the sum over the beams, not their mean": (
            changed(_nearest, lambda away: -np.minimum(away, _MOST).mean())
        ),
        "the heading turns counter-clockwise: x' = x cos h - y sin h, y' = x sin h + y cos h": (
            lambda points, pose, centres: _capped(points, pose * (1, 1, -1), centres)
        ),
        "the points are in the robot's frame: carry them by the pose first": (
            lambda points, pose, centres: _capped(points, np.zeros(3), centres)
        ),
        "distances, not their squares": (
            changed(_nearest, lambda away: -(np.minimum(away, _MOST) ** 2).sum())
        ),
    },
)


# ------------------------------------------------------------------------------ hill climb
#: A pose is an array or a tuple: three numbers.
Pose = Any
Value = Callable[[Pose], float]


def _hills(rng: Rng) -> Cases:
    top, start = rng.uniform(-1, 1, 3), rng.uniform(-1, 1, 3)
    move, right, up = rng.uniform(0.05, 0.2), *rng.uniform(0.3, 0.9, 2)
    hill = Surface((-1, -2, -1.5), tuple(top.tolist()), (True,) * 3)

    def ridge(*along: float) -> Surface:
        """A ridge through the start, which rises slowly along x, y and heading."""
        slope = rng.uniform(0.2, 0.6, 3).tolist()
        return Surface(tuple(slope), tuple(start.tolist()), ridge=along)  # type: ignore[arg-type]

    return {
        words: (value, np.array(pose, float), float(step), float(turn))
        for words, value, pose, step, turn in (
            ("a hill to the right and below", hill, top + (-right, up, 0.3), move, move),
            ("a hill to the left and above", hill, top + (right, -up, -0.3), move, move),
            ("a hill, nearly there", hill, top + (0, move, 0), move, move),
            ("on the top", hill, top, move, move),
            ("a plain", Surface((0, 0, 0)), start, move, move),
            ("a ridge up to the right", ridge(9, -9, 0), start, move, move),
            ("a ridge along which the robot turns", ridge(9, 0, -9), start, move, move),
            ("a ridge of x, y and heading", ridge(9, -5, -4), start, move, move),
            ("a slope, the robot turned", Surface((2, 1, 0.5)), start + (0, 0, 2), move, move),
            ("a coarse turn", hill, top - (0, 0, 0.4), 0.001, 1.0),
            ("a turn to the left", hill, top - (0, 0, right), 0.01, 0.2),
            ("a turn to the right", hill, top + (0, 0, up), 0.01, 0.2),
        )
    }


def _climb_diagonally(value: Value, pose: Pose, move: float, turn: float) -> Pose:
    best, most = pose, value(pose)
    for x, y, heading in product((-1, 0, 1), repeat=3):
        tried = pose[0] + x * move, pose[1] + y * move, pose[2] + heading * turn
        if value(tried) > most:
            best, most = tried, value(tried)
    return best


_MOVES = "product((-1, 0, 1), repeat=3)"

check_climb_diagonally = Exercise(
    "climb_diagonally(value, pose, move, turn) -> (3,): the best of all 26 moves in which x and y "
    "change by -move, 0 or move and the heading by -turn, 0 or turn, where it improves value(pose)",
    _climb_diagonally,
    _hills,
    {
        "on a ridge that runs diagonally each of the six moves falls off the side: let two or "
        "three of the numbers change at once": climb_step,
        "the heading may change in the same move as x or y": (
            edited(
                _climb_diagonally, (_MOVES, f"[m for m in {_MOVES} if not m[2] or m[:2] == (0, 0)]")
            )
        ),
        "a number may also stay as it is: 26 moves, not 8": (
            edited(_climb_diagonally, ("(-1, 0, 1)", "(-1, 1)"))
        ),
        "stay where none of the moves improves the score": (
            edited(
                _climb_diagonally,
                ("pose, value(pose)", "pose, float('-inf')"),
                ("in product", "in (m for m in product"),
                ("=3):", "=3) if any(m)):"),
            )
        ),
        "look at all moves before you choose: the best counts, not the first that improves": (
            edited(_climb_diagonally, ("best, most = tried, value(tried)", "return tried"))
        ),
        "the higher the better: you climb down": (
            lambda value, *rest: _climb_diagonally(lambda p: -value(p), *rest)
        ),
        "try all moves from where the pose is: do not walk on from each that improves": (
            edited(
                _climb_diagonally,
                ("best, most = t", "pose, most = t"),
                ("return best", "return pose"),
            )
        ),
        "the pose after the move is asked for, not its value": (
            lambda value, *rest: value(_climb_diagonally(value, *rest))
        ),
        "the heading moves by `turn`, x and y by `move`": (
            lambda value, at, move, turn: _climb_diagonally(value, at, turn, move)
        ),
    },
)


# ------------------------------------------------------------------------------ resampling
def _combs(rng: Rng) -> Cases:
    count, offset = int(rng.integers(5, 9)), float(rng.uniform(0.1, 0.4))
    drawn, heavy = rng.dirichlet(np.ones(count)), rng.permutation(np.r_[0.72, np.full(7, 0.04)])
    return {
        "weights of all sizes": (drawn, offset),
        "the same, the comb further on": (drawn, offset + 0.5),
        "a heavy particle": (heavy, offset),
        "equal weights": (np.full(count, 1 / count), 0.5),
        "a particle without weight first, the comb at 0": (np.r_[0, drawn], 0.0),
        "a particle without weight last": (np.r_[drawn, 0], offset + 0.5),
        "one particle": (np.ones(1), offset),
    }


def _toothed(weights: Array, teeth: Array) -> Array:
    index = np.searchsorted(np.cumsum(weights), teeth, side="right")
    return np.minimum(index, len(weights) - 1)


def _teeth(weights: Array) -> Array:
    return np.arange(len(weights)) / len(weights)


check_resampled = Exercise(
    "resampled(weights, offset) -> (n,): which particle each new one goes on from, by a comb of n "
    "teeth, 1 / n apart, the first at offset / n, laid on the weights (n,) in a row",
    systematic,
    _combs,
    {
        "the first tooth is at offset / n, not at 0": lambda w, offset: _toothed(w, _teeth(w)),
        "the first tooth is at offset / n, not at offset": (
            lambda w, offset: _toothed(w, _teeth(w) + offset)
        ),
        "n teeth, the last beyond 1 - 1 / n: yours are 1 / (n + 1) apart": (
            lambda w, offset: _toothed(w, (np.arange(len(w)) + offset) / (len(w) + 1))
        ),
        "the weights lie in a row: compare a tooth with their running sum": (
            lambda w, offset: np.minimum(
                np.searchsorted(np.sort(w), _teeth(w) + offset / len(w)), len(w) - 1
            )
        ),
        "not the heaviest alone: every particle has as many teeth as its weight is long": (
            lambda w, offset: np.full(len(w), np.argmax(w))
        ),
        "heavy particles go on several times, light ones not at all: yours all go on": (
            lambda w, offset: np.arange(len(w))
        ),
        "a particle begins where the one before ends: yours are one too far": (
            lambda w, offset: np.minimum(_toothed(w, _teeth(w) + offset / len(w)) + 1, len(w) - 1)
        ),
        "a particle without weight has no teeth: a tooth on an edge belongs to what follows": (
            lambda w, offset: np.searchsorted(np.cumsum(w), _teeth(w) + offset / len(w))
        ),
        "which particle, not how many of each": (
            lambda w, offset: np.bincount(
                _toothed(w, _teeth(w) + offset / len(w)), minlength=len(w)
            )
        ),
    },
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
)


# -------------------------------------------------------------------------------- consistency
def _claims(rng: Rng) -> Cases:
    def some(count: int) -> tuple[Array, Array, Array]:
        truths = np.stack([anywhere(rng) for _ in range(count)]) * (1, 1, 0.9)
        roots = rng.uniform(0.05, 0.3, (count, 3, 3)) * (1 + 2 * np.eye(3))
        poses = truths + rng.uniform(0.1, 0.3, (count, 3)) * rng.choice([-1, 1], (count, 3))
        return poses, truths, roots @ roots.swapaxes(1, 2)

    poses, truths, covariances = some(2)
    truths[:, 2], poses[:, 2] = np.pi - 0.05, 0.1 - np.pi
    return {
        "one pose": some(1),
        "four poses": some(4),
        "headings on both sides of 180 degrees": (poses, truths, covariances),
    }


def _nees(poses: Array, truths: Array, covariances: Array) -> Array:
    off = poses - truths
    off[:, 2] = (off[:, 2] + np.pi) % (2 * np.pi) - np.pi
    return np.einsum("ni,nij,nj->n", off, np.linalg.inv(covariances), off)


check_nees = Exercise(
    "nees(poses, truths, covariances) -> (n,): normalised estimation error squared of poses (n, 3) "
    "against the truth (n, 3), metres and radians, with their covariances (n, 3, 3)",
    _nees,
    _claims,
    {
        "headings of 179 and -179 degrees are 2 degrees apart: wrap their difference": (
            edited(_nees, ("(off[:, 2] + np.pi) % (2 * np.pi) - np.pi", "off[:, 2]"))
        ),
        "divide by the covariance: the inverse stands between the errors": (
            edited(_nees, ("np.linalg.inv(covariances)", "covariances"))
        ),
        "x, y and heading err together: the whole covariance counts, not its diagonal": (
            edited(_nees, ("np.linalg.inv(covariances)", "np.linalg.inv(covariances * np.eye(3))"))
        ),
        "invert the covariance as a matrix, not each of its numbers": (
            edited(_nees, ("np.linalg.inv(covariances)", "1 / covariances"))
        ),
        "the square is asked for, not its root": changed(_nees, np.sqrt),
        "3 is expected, for three numbers: do not divide by their count": (
            changed(_nees, lambda found: found / 3)
        ),
        "the heading counts too, not x and y alone": (
            lambda p, t, c: np.einsum(
                "ni,nij,nj->n", (p - t)[:, :2], np.linalg.inv(c[:, :2, :2]), (p - t)[:, :2]
            )
        ),
        "errors of heading have a sign, as those of x and y have: no absolute value": (
            edited(_nees, ("off[:, 2] = (off", "off[:, 2] = abs((off"), ("- np.pi\n", "- np.pi)\n"))
        ),
        "each pose has a covariance of its own: no mean of them": (
            edited(_nees, ("inv(covariances)", "inv(0 * covariances + covariances.mean(axis=0))"))
        ),
        "one number for each pose: no mean over them": lambda *given: float(_nees(*given).mean()),
        "headings are radians, as their variances are": (
            edited(_nees, ("return", "off[:, 2] = np.degrees(off[:, 2])\n    return"))
        ),
    },
)
