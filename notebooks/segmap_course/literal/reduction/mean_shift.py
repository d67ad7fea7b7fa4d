"""Mean shift (A 4.3, 5.5): every centre and every piece at every step.

As in the fast version, what lies beyond three deviations does not pull (at three it does), and a
piece perpendicular to a centre turns it neither way. A scale holds the deviation of the kernel in
each column of the points.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from segmap.angles import axial_difference
from segmap.arrays import Array
from segmap.segments import angle, length

from ..lines import SAME

TIE = 1e-9
Indices = NDArray[np.int64]


def cut(segments: Array, sigma: float) -> tuple[Array, Indices]:
    """Equal pieces, as few as are no longer than sigma, and the segment of each (A 4.3.2)."""
    size = length(segments)
    counts = np.where(size < SAME, 0, np.ceil(size / sigma - TIE).clip(1)).astype(int)
    ways = [np.linspace(p, q, n + 1) for (p, q), n in zip(segments, counts, strict=True)]
    pieces = [np.stack([w[:-1], w[1:]], 1) for w in ways]
    return np.concatenate([np.empty((0, 2, 2)), *pieces]), np.repeat(np.arange(len(size)), counts)


def differences(points: Array, centres: Array) -> Array:
    """From each centre to each point; of a third column, an angle, the axial difference."""
    d = points - centres[:, None]
    return np.concatenate([d[..., :2], axial_difference(d[..., 2:], 0.0)], axis=2)


def moves(points: Array, centres: Array, scale: Array) -> Array:
    """From each centre to the mean of the points, weighted with the kernel (A 4.8)."""
    d = differences(points, centres)
    square = ((d / scale) ** 2).sum(axis=2)
    weights = np.exp(-square / 2) * (square <= (3 * (1 + TIE)) ** 2)
    d[..., 2:][abs(d[..., 2:]) >= np.pi / 2 * (1 - TIE)] = 0.0
    return (weights[..., None] * d).sum(axis=1) / weights.sum(axis=1, keepdims=True)


def climb(points: Array, scale: Array, stop: float) -> Array:
    """Where centres rest that start at the points: none moves by more than stop deviations."""
    centres, largest = points, np.inf
    while largest > stop:
        move = moves(points, centres, scale)
        centres, largest = centres + move, np.linalg.norm(move / scale, axis=1).max(initial=0)
    return centres


def chains(near: NDArray[np.bool_]) -> list[Indices]:
    """The members of each chain of what is near each other, by lowest member."""
    chain, before = np.arange(len(near)), np.empty(0, int)
    while not np.array_equal(chain, before):
        before, chain = chain, np.where(near, chain, len(near)).min(axis=1, initial=len(near))
    return [np.flatnonzero(chain == k) for k in np.unique(chain)]


def linked(centres: Array, scale: Array, bound: float) -> list[Indices]:
    """Chains of centres that are closer than a bound, in deviations (A 4.3.3)."""
    return chains(np.linalg.norm(differences(centres, centres) / scale, axis=2) < bound)


def lines_of(pieces: Array, theta: float, sigma: float) -> list[tuple[Indices, Array]]:
    """Phase 2, for pieces of direction theta: the members and the ends of each output."""
    turn = np.array([(np.cos(theta), -np.sin(theta)), (np.sin(theta), np.cos(theta))])
    uv = pieces @ turn  # along theta, across it
    scale = np.sqrt(2) * np.array([2 * sigma, sigma / 10])
    centres, lines = climb(uv.mean(axis=1), scale, 1 / 200 / np.sqrt(2)), []
    for chain in linked(centres, scale, np.sqrt(1 / 2)):
        (low, high), v = np.sort(uv[chain, :, 0]).T, centres[chain, 1].mean()
        for k in chains((low <= high[:, None] + SAME) & (low[:, None] <= high + SAME)):  # A 4.3.5
            lines.append((chain[k], np.array([(low[k].min(), v), (high[k].max(), v)]) @ turn.T))
    return lines


def mean_shift(
    segments: Array, *, sigma: float = 0.20, bandwidth: float = np.pi / 18 / 0.20
) -> tuple[list[Array], list[int]]:
    """Outputs by their lowest piece, and the output with the longest share of each input."""
    pieces, owner = cut(np.reshape(segments, (-1, 2, 2)), sigma)
    scale, outputs = np.array([sigma, sigma, sigma * bandwidth]), []
    centres = climb(np.column_stack([pieces.mean(axis=1), angle(pieces)]), scale, 1 / 200)
    for cluster in linked(centres, scale, 2.0):
        theta = float(np.angle(np.exp(2j * centres[cluster, 2]).sum()) / 2)
        outputs += [(cluster[k], ends) for k, ends in lines_of(pieces[cluster], theta, sigma)]
    outputs.sort(key=lambda entry: min(entry[0]))
    into = np.empty(len(owner), int)
    for k, (members, _) in enumerate(outputs):
        into[members] = k
    shares = [np.bincount(into[owner == i], minlength=1) for i in range(len(segments))]
    return [ends for _, ends in outputs], [int(s.argmax()) if s.any() else -1 for s in shares]
