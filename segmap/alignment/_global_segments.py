"""Global alignment of segments (A 2.5.1, its [42]): headings of all scans, then places of all."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ..angles import wrap
from ..arrays import Array
from ..poses import between, compose, interpolate, inverse
from ..scans import Log
from ._global_doubts import (
    BEYOND,
    DOUBLED,
    NOTHING_SHARED,
    TORN,
    beyond,
    doubled,
    doubts,
    graph,
    torn,
)
from ._global_equations import Indices, groups
from ._global_scans import (
    Rules,
    Scans,
    arcs_between,
    corresponding,
    gathered,
    kept_scans,
    settled,
    travelled,
)
from ._result import Graph, check_positive
from ._runner import Outcome, alignment_method
from ._segment_icp import long_segments

#: The spread of the weights goes down by these parts when all arcs are in.
FINER = (1.0, 1 / 4, 1 / 10)
#: What is doubtful of a kept scan that makes those after it doubtful as well.
BREAKS = (BEYOND, TORN, NOTHING_SHARED)
NO_ODOMETRY = "no odometry to begin from"


@alignment_method
def global_segments(
    log: Log,
    *,
    start: ArrayLike | None = None,
    similar: float = 0.20,
    angle: float = np.radians(15.0),
    spread: float = 0.05,
    reach: float = 1.0,
    rounds: int = 15,
    min_length: float = 0.30,
) -> Outcome:
    """Turn all scans at once until matched segments are parallel, then shift all at once; repeat.

    1. Of the scans the fewest are kept of which each shares with the next two pairs of similar
       segments that are not similar to each other. *Slip:* taken literally, a robot that comes back
       would leave its whole loop out; neighbours are at most `reach` of way apart.
    2. Every two kept scans that share so much are joined. Similar segments u, v weigh
       `exp(-D(u, v) / (2 spread))` (2.7; D as in A 2.7.7, so that sigma^2 is a length).
    3. Headings from all weighted axial differences, then places from all end points and their feet,
       by sparse least squares with the first pose fixed; again with new pairs until nothing moves.
       First scans up to 2 `reach` of way apart are joined, then twice as far, at last all: so only
       the drift round a loop, and not the whole drift, must be small.
    4. The scans between two kept ones hang on these two: the same equations, the kept ones held.
       One that shares too little is carried by odometry, its misfit spread along the way.

    Needs small odometry errors: about 15 degrees and 0.7 m from one kept scan to the next, and
    less than the distance between walls where a loop closes. A group of scans that shares nothing
    with the others hangs on odometry; only the largest group counts as used.

    Parameters
    ----------
    log : Log
    start : (k, 3) array, metres and radians, or None
        Poses to begin from; None takes the odometry (of a scan without, between its neighbours).
    similar : float, metres
        Segments are similar below this distance: 0.20 m are parallel walls 0.7 m apart.
    angle : float, radians
        Segments at a larger angle are not similar, below pi/2.
    spread : float, metres
        sigma^2 of 2.7, at last a tenth of it: 0.05 m begins with parallel walls 0.23 m apart at
        half their weight and ends with walls 0.02 m apart.
    reach : float, metres
        Way between kept scans, so that their views overlap.
    rounds : int
        Turns and shifts at most so often in each stage.
    min_length : float, metres
        Shorter segments are left out: noise decides their direction, and 2.8 lets them count as
        much as long ones.

    Returns
    -------
    Alignment
        `graph` holds the arcs between kept scans; residuals are the root mean square distances of
        end points from their feet over 0.03 m, and a loop is an arc over more way than 2 `reach`.

    Raises
    ------
    ValueError
        For thresholds out of range, a start of the wrong shape or not finite.

    References
    ----------
    Elseberg, Creed, Lakaemper, "A line segment based system for 2D global mapping", ICRA 2010.

    Examples
    --------
    >>> from segmap import load
    >>> global_segments(load("room"))
    Alignment(global_segments: 61 scans, 61 used)
    """
    check_positive(
        similar=similar,
        angle=angle,
        spread=spread,
        reach=reach,
        rounds=rounds,
        min_length=min_length,
    )
    if angle >= np.pi / 2:
        raise ValueError(f"angle must be below pi/2, in radians, got {angle}")
    rules = Rules(similar, angle, spread, int(rounds))
    guess = beginning(log, start)
    if guess is None:
        return Outcome(np.zeros((len(log), 3)), ["", *[NO_ODOMETRY] * len(log)][: len(log)])
    scans = gathered([long_segments(scan, min_length) for scan in log])
    way = travelled(guess)
    kept = kept_scans(scans.world(guess), scans.first, way, reach, rules)
    poses, joined, why = _align_kept(scans.only(kept), guess[kept], way[kept], reach, rules)
    joined = Graph(kept[joined.edges], joined.relative, joined.loop, joined.residuals)
    poses, reasons = _align_rest(scans, kept, hung_between(kept, poses, guess, way), why, rules)
    return Outcome(poses, reasons, joined)


def beginning(log: Log, start: ArrayLike | None) -> Array | None:
    """Poses to begin from, `(k, 3)`, metres and radians; None where nothing gives any.

    From the origin on where the first scan has no odometry.
    """
    if start is not None:
        given = np.array(start, float)
        if given.shape != (len(log), 3) or not np.isfinite(given).all():
            raise ValueError(f"start must be ({len(log)}, 3) finite poses, got shape {given.shape}")
        return given
    known = np.flatnonzero(np.isfinite(log.odometry).all(1))
    if not len(known):
        return None
    at = np.clip(np.arange(len(log)), known[0], known[-1])
    found = interpolate(known, log.odometry[known], at)
    return found if known[0] == 0 else between(found[0], found)


def hung_between(kept: Indices, poses: Array, guess: Array, way: Array) -> Array:
    """Poses of all scans `(k, 3)`, given those of the kept ones; metres and radians.

    Odometry from the kept scan before and from the one after, mixed by the way to each; after the
    last one, from that alone.
    """
    every = np.arange(len(guess))
    before = np.searchsorted(kept, every, side="right") - 1
    after = np.minimum(before + 1, len(kept) - 1)
    a, b = kept[before], kept[after]
    forth = compose(poses[before], between(guess[a], guess))
    back = compose(poses[after], between(guess[b], guess))
    span, done = way[b] - way[a] + 1e-6 * (b - a), way - way[a] + 1e-6 * (every - a)
    part = np.where(b > a, done / np.where(b > a, span, 1.0), 0.0)
    step = back - forth
    step[:, 2] = wrap(step[:, 2])
    found = forth + part[:, None] * step
    found[:, 2] = wrap(found[:, 2])
    return found


def _stages(way: Array, reach: float, rules: Rules) -> list[tuple[float, Rules]]:
    """How far apart on the way scans are joined, and with which spread."""
    windows = [2 * reach]
    while windows[-1] < way[-1]:
        windows.append(2 * windows[-1])
    last = [(np.inf, rules._replace(spread=part * rules.spread)) for part in FINER]
    return [*((window, rules) for window in windows[:-1]), *last]


def _align_kept(
    scans: Scans, guess: Array, way: Array, reach: float, rules: Rules
) -> tuple[Array, Graph, list[str]]:
    """Poses of the kept scans, the arcs between them, and what speaks against each pose."""
    poses, held = guess.copy(), np.arange(len(guess)) == 0
    for window, stage in _stages(way, reach, rules):
        arcs = arcs_between(scans, poses, way, window, stage)
        poses = settled(scans, poses, arcs, held, stage)
        pairs, arc = corresponding(scans, poses, arcs, stage)
        group = groups(pairs.i, pairs.j, len(poses))
        poses = _hung_groups(poses, group, guess)
    begins = np.sort(np.unique(group, return_index=True)[1])[1:]
    why, apart = doubts(scans, poses, pairs), torn(poses, group, guess, rules)
    marks = [(begins, NOTHING_SHARED), (apart, TORN), (beyond(group, apart), BEYOND)]
    for marked, reason in [*marks, (doubled(scans, poses, arcs[arc]), DOUBLED)]:
        for k in marked:
            why[k] = why[k] or reason
    return poses, graph(scans, poses, way, pairs, arcs, arc, 2 * reach), ["", *why[1:]]


def _hung_groups(poses: Array, group: Indices, guess: Array) -> Array:
    """Each group but the first, moved whole so that its first scan hangs on the one before it."""
    poses = poses.copy()
    for k in np.sort(np.unique(group, return_index=True)[1])[1:]:
        there = compose(poses[k - 1], between(guess[k - 1], guess[k]))
        whole = group == group[k]
        poses[whole] = compose(compose(there, inverse(poses[k])), poses[whole])
    return poses


def _align_rest(
    scans: Scans, kept: Indices, poses: Array, found: list[str], rules: Rules
) -> tuple[Array, list[str]]:
    """Poses and doubts of all scans: those between hang on the two kept scans around them."""
    held = np.isin(np.arange(len(poses)), kept)
    rest = np.flatnonzero(~held)
    place = np.searchsorted(kept, rest)
    ends = np.column_stack([place - 1, np.minimum(place, len(kept) - 1)])
    arcs = np.unique(np.column_stack([np.repeat(rest, 2), kept[ends].ravel()]), axis=0)
    for part in FINER:
        stage = rules._replace(spread=part * rules.spread)
        poses = settled(scans, poses, arcs, held, stage)
    pairs, _ = corresponding(scans, poses, arcs, stage)
    reasons = doubts(scans, poses, pairs)
    for k, before in zip(rest, place - 1, strict=True):
        reasons[k] = reasons[k] or (BEYOND if found[before] in BREAKS else "")
    for k, why in zip(kept, found, strict=True):
        reasons[k] = why
    return poses, reasons
