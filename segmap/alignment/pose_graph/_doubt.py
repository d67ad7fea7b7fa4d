"""What to doubt of a pose graph, and how far each scan may be off, once that is asked for."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from ...scans.causes import Cause, Finding, Unmatched
from .._result import Appraisal
from .._verdict import ONE_LOOK
from ..graph import chain_bends, place_deviations, stacked
from ._pauses import doubtful_gaps

if TYPE_CHECKING:
    from ._front_end import TrackedScan
    from ._key_frames import KeyFrames

#: Why scans are not used that is told of the whole map.
LOOSE_CAUSES = {Unmatched.FREE_DIRECTION: Cause.NO_DISTANCE, Unmatched.UNTIED: Cause.UNTIED}


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
        edges, weight = stacked(frames.edges), np.bincount(frame, minlength=len(frames))
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
    counts = Counter(row.unmatched for row in rows)
    for why, cause in LOOSE_CAUSES.items():
        if loose := counts[why]:
            causes.append(Finding(cause, loose, f"at {loose} of {len(rows)} scans {why}"))
    return Appraisal(tuple(causes), far, near)
