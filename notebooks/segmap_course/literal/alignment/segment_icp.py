"""Segment ICP (A 2.5.1; Amigoni, Fontana and Garigiola 2006) in arrays: turn, then shift."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from segmap.angles import axial_difference
from segmap.arrays import Array
from segmap.metrics import segment_distance
from segmap.poses import between, compose, transform
from segmap.segments import angle, length, midpoint

Cost = Callable[[Array], float]


def partners(reference: Array, current: Array, turned: float, apart: float) -> Array:
    """Whether current segments lie beside reference segments, within both bounds, (m, n).

    Bounds are an angle, radians, and a segment distance (A 2.7.7), metres.
    """
    s, at = current[:, None], angle(current)[:, None]
    x, y = np.moveaxis(midpoint(reference) - midpoint(s), -1, 0)
    beside = abs(x * np.cos(at) + y * np.sin(at)) < (length(s) + length(reference)) / 2
    parallel = abs(axial_difference(at, angle(reference))) < turned
    return beside & parallel & (segment_distance(s, reference) < apart)


def segment_cost(reference: Array, current: Array, near: Array, penalty: float) -> float:
    """A 2.1, metres: mean distance of the current segments from their partners, or the penalty.

    Partners of a segment are weighted with their lengths; the penalty stands inside the bracket.
    """
    weights = near * length(reference)
    away = (weights * segment_distance(current[:, None], reference)).sum(axis=1)
    total = weights.sum(axis=1)
    return float(np.where(total > 0, away / np.maximum(total, 1e-9), penalty).mean())


def cost_of(reference: Array, scan: Array, near: Array, penalty: float) -> Cost:
    """What a pose of the scan costs, metres, as long as partners stay the same."""
    return lambda pose: segment_cost(reference, transform(pose, scan), near, penalty)


def turned_about_middle(pose: Array, scan: Array, turn: float) -> Array:
    """The pose after a turn about the middle of the scan's segments, where they lie at the pose."""
    x, y = transform(pose, scan).mean(axis=(0, 1))
    return compose((x, y, turn), between((x, y, 0), pose))


def best_turn(cost: Cost, scan: Array, pose: Array, width: float) -> Array:
    """Of nine turns about the middle, up to a width in radians, the pose that costs least."""
    turns = width / 4 * np.array([0, 1, -1, 2, -2, 3, -3, 4, -4])
    return min((turned_about_middle(pose, scan, turn) for turn in turns), key=cost)


def best_shift(cost: Cost, scan: Array, pose: Array, step: float) -> Array:
    """Steps along and across walls, metres, each the one that saves most, until none saves."""
    ways = np.unique(angle(transform(pose, scan)).round(2) % 1.57)
    ways = np.add.outer(np.arange(4) * np.pi / 2, ways).ravel()
    moves = step * np.stack([np.cos(ways), np.sin(ways), 0 * ways], axis=1)
    while True:
        tried = min(pose + moves, key=cost)
        if cost(tried) > cost(pose) - 0.004 * step:
            return pose
        pose = tried


def turn_and_shift(
    reference: Array, scan: Array, start: Array, turned: float = np.pi / 12, apart: float = 0.30
) -> Array:
    """Turn, then shift, with new partners each time and finer steps at the end (A 2.5.1)."""
    pose, width, step = np.asarray(start, float), turned, 0.25
    while step > 5e-5:
        for _ in range(5):
            near = partners(reference, transform(pose, scan), turned, apart)
            cost = cost_of(reference, scan, near, apart)
            before, pose = pose, best_turn(cost, scan, pose, width)
            pose = best_shift(cost, scan, pose, step)
            if np.allclose(pose, before, atol=1e-9):
                break
        width, step = width / 4, step / 4
    return pose
