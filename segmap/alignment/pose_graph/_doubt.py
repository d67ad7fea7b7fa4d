"""What to doubt of a pose graph, and how far each scan may be off, once that is asked for."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from ...arrays import Array
from ...scans.causes import Cause, Finding, Unmatched
from .._result import Appraisal
from .._verdict import ONE_LOOK, SURE_M
from ..graph import chain_bends, place_deviations, stack
from ._pauses import doubtful_gaps

if TYPE_CHECKING:
    from ._front_end import TrackedScan
    from ._key_frames import KeyFrames


def appraisal(rows: Sequence[TrackedScan], frames: KeyFrames) -> Appraisal:
    """How far each scan may be off, in the whole and relative to those near by, and the findings.

    The key frames have been solved. Where their edges leave poses free, nothing is known of any.
    """
    frame = np.array([row.frame for row in rows], np.int64)
    far = near = np.zeros(len(rows))
    causes, fixed = doubtful_gaps(rows, frames), frames.fixed
    if not frames.edges:
        causes.append(Finding(Cause.NOT_CHECKED, 1, ONE_LOOK))
    else:
        edges, weight = stack(frames.edges), np.bincount(frame, minlength=len(frames))
        causes += chain_bends(edges, frames.poses).finding(frames.scans, "the map")
        try:
            deviation = place_deviations(frames.poses, edges, weight.astype(float))
            far, near = (spread[frame] for spread in deviation)
        except np.linalg.LinAlgError:
            fixed = False
    along = np.array([row.corridor_sigma_m for row in rows])
    far, near = np.hypot(far, along), np.hypot(near, along)
    if not fixed:
        far = near = np.full(len(rows), np.inf)
        words = "the matches contradict each other so much that they leave poses free: "
        words += "are there scans of two robots, or of corridors without odometry?"
        causes.append(Finding(Cause.LEFT_FREE, len(frames), words))
    causes += _findings([row.unmatched for row in rows], far)
    return Appraisal(tuple(causes), far, near)


def _findings(unmatched: Sequence[Unmatched], far: Array) -> list[Finding]:
    """What to doubt of the whole, with numbers; `Alignment.verdict` weighs the scans themselves.

    `far` are the standard deviations of all places in the whole, metres.
    """
    count, causes = len(unmatched), []
    loose_causes = {Unmatched.FREE_DIRECTION: Cause.NO_DISTANCE, Unmatched.UNTIED: Cause.UNTIED}
    for why, cause in loose_causes.items():
        if loose := unmatched.count(why):
            causes.append(Finding(cause, loose, f"at {loose} of {count} scans {why}"))
    if np.isfinite(far).all() and (vague := int((far > SURE_M).sum())):
        words = f"{vague} of {count} scans may be more than {2 * SURE_M} m off, "
        words += f"scan {np.argmax(far)} by {2 * far.max():.1f} m"
        causes.append(Finding(Cause.VAGUE, vague, words))
    return causes
