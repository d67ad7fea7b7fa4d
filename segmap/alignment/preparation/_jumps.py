"""Steps of the odometry that no robot drives: did the odometry jump, or did the recorder pause?"""

from __future__ import annotations

from typing import Any

import numpy as np

from ...arrays import Array
from ...display import plural
from ...poses.motions import between, compose
from ...scans import Log
from ...scans.causes import Cause, Finding
from ...scans.odometry import odometry_jumps
from ..points import LEAST_POINTS, PointMap, in_range
from ._blind_steps import register_near

#: Scans before and after a step are compared where they lie so near by the odometry, metres.
PAIR_ACROSS_M = 1.5
#: Pairs across a step that are compared, spread over the scans after it.
PAIRS_ACROSS = 20
#: A hypothesis holds where this share of the pairs matches: 0.5 to 1 if right, else 0 to 0.1.
HOLDS_SHARE = 1 / 3
#: What is told where the odometry jumped.
JUMPED = "no motion is known there"
#: What is told where the recorder paused.
PAUSED = "the scans move so too, so the recorder paused"
#: What is told where it may be both: the map is doubtful.
UNCLEAR = "the scans fit that and a pause of the recorder, or neither"


def without_jumps(log: Log, rows: Array) -> tuple[Array, list[Finding]]:
    """Odometry `(k, 3)` with NaN where it jumped, and what is told of its jumps.

    A step that no robot drives is true where the recorder paused and the wheels did not. So both
    are tried on the whole map: scans after the step are laid on those before it as if the robot
    had stood, and as if it had driven so. Where both hold, or neither, the map is doubtful; the
    step stays where the robot cannot have stood and no place is seen again.
    """
    jumps = odometry_jumps(rows, log.times)
    rows, frame, ends = rows.copy(), rows.copy(), [*jumps.tolist(), len(rows)][1:]
    scans_by_kind: dict[str, list[int]] = {}
    for scan, end in zip(jumps.tolist(), ends, strict=True):
        way = np.hypot(*between(frame[scan - 1], frame[scan : scan + 2])[:, :2].T)
        wild = len(way) > 1 and way[1] < way[0] / 2  # one row alone: the next goes on
        restarted = compose(frame[scan - 1], between(frame[scan], frame[scan:]))
        stood = wild or _holds(log, frame[:scan], restarted[: end - scan])
        drove = not wild and _holds(log, frame[:scan], frame[scan:end])
        clear = bool(stood) is not bool(drove)
        kind = (JUMPED if stood else PAUSED) if clear else UNCLEAR
        if kind is JUMPED and not wild:
            frame[scan:] = restarted
        if stood or drove is False:
            rows[scan] = np.nan
        scans_by_kind.setdefault(kind, []).append(scan)
    findings = []
    for kind, scans in scans_by_kind.items():
        words = f"the odometry jumps {plural(len(scans), 'time')}, first at scan {scans[0]}"
        unclear = kind is UNCLEAR
        findings.append(Finding(Cause.JUMP, len(scans), f"{words}: {kind}", doubtful=unclear))
    return rows, findings


def _holds(log: Log, before: Array, after: Array) -> bool | None:
    """Whether scans after a step lie on those before it, by poses `(m, 3)` and `(n, 3)` of both.

    None where no two of them see the same place, or walls that fix no place.
    """
    from scipy.spatial import cKDTree

    first, second = (np.flatnonzero(np.isfinite(rows).all(1)) for rows in (before, after))
    nearest: Any
    away, nearest = cKDTree(before[first, :2]).query(after[second, :2])
    near, fits = np.flatnonzero(away < PAIR_ACROSS_M), []
    for after_k in near[:: 1 + len(near) // PAIRS_ACROSS]:
        one, two = int(first[nearest[after_k]]), int(second[after_k])
        points, current = (in_range(log[k].points()) for k in (one, len(before) + two))
        if min(len(points), len(current)) >= LEAST_POINTS:
            match = register_near(PointMap(points), current, between(before[one], after[two]))
            if match is None or match.free is None:  # a corridor fits everywhere
                fits.append(match is not None)
    return bool(np.mean(fits) >= HOLDS_SHARE) if fits else None
