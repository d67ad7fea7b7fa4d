"""What `backbone` did with each scan, and what of that speaks against its assumption."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..angles import axial_difference, wrap
from ..arrays import Array
from ..poses import transform
from ..segments import angle, length
from ._backbone_lines import Lines, mean_rotation

#: A segment follows a direction to within 3 degrees: six standard deviations of a wall of 1 m,
#: seen with 20 beams and 10 mm of noise.
FOLLOWS = np.radians(3.0)
#: Walls of one scan that leave more than 1 degree after the best common rotation are bent:
#: straight ones left 0.02 to 0.6 in all logs, a ring of 30 m radius 1.8.
AGREES = np.radians(1.0)
#: Corrections on straight stretches of more than 4 degrees in 10 m come from a gentle bend as well
#: as from bad odometry: real logs needed up to 3.7, a ring of 60 m radius 9.
STRETCH, BEND = 10.0, np.radians(4.0)


class BackboneStep(NamedTuple):
    """What the method did with one scan.

    Parameters
    ----------
    guess, pose : (3,) array, metres and radians
        By odometry from the last pose, and as laid.
    segments : (m, 2, 2) array, metres
        The segments longer than `min_length`, in the robot's frame.
    partner : (m,) int array
        Line that each was laid on; -1 for none.
    lines : Lines
        The backbone at that time.
    known : (d,) array, radians
        Its directions so far.
    skipped, rebuilt : bool
        Whether the scan was not looked at, and whether the backbone was built anew for it.
    reason : str
        Why the scan was not used; empty where it was.
    """

    guess: Array
    pose: Array
    segments: Array
    partner: NDArray[np.int64]
    lines: Lines
    known: Array
    skipped: bool
    rebuilt: bool
    reason: str

    @property
    def rotation(self) -> float:
        """By how much the guess was turned, radians."""
        return float(wrap(self.pose[2] - self.guess[2]))


class Doubt(NamedTuple):
    """What speaks against the method on a log.

    Parameters
    ----------
    share : float
        Of the length of wall seen by used scans, what follows two perpendicular directions.
    spread : float, radians
        Median over scans of what their walls leave after the best common rotation.
    bend : float, radians
        Median over stretches of 10 m of the heading corrected where the robot drove straight.
    words : str
        Empty where nothing speaks against it.
    fails : bool
        Whether its result is better thrown away.
    """

    share: float
    spread: float
    bend: float
    words: str
    fails: bool


def doubt_of(steps: Sequence[BackboneStep], orthogonal: float) -> Doubt:
    """Judge what was seen against what the method assumes.

    Parameters
    ----------
    steps : sequence of BackboneStep
    orthogonal : float
        Least share of the wall that must follow two perpendicular directions.

    Returns
    -------
    Doubt
    """
    if not steps or not len(steps[-1].known):
        blind = sum(not s.skipped for s in steps) > 1
        return Doubt(1.0, 0.0, 0.0, "no backbone: no scan shows a wall long enough" * blind, False)
    share, spread, bend = _share_followed(steps), _spread_left(steps), _bend_corrected(steps)
    wrong = []
    if share < orthogonal:
        wrong.append(
            f"{share:.0%} of the wall seen follows two perpendicular directions, expected at "
            f"least {orthogonal:.0%}"
        )
    if spread > AGREES:
        wrong.append(f"the walls of a scan disagree by {np.degrees(spread):.1f} degrees")
    if wrong and orthogonal > 0:
        reason = "(not an orthogonal building, or odometry too bad)"
        words = f"the assumption fails: {'; '.join(wrong)} {reason}"
        return Doubt(share, spread, bend, words, True)
    words = (
        f"the assumption is doubtful: straight stretches were turned by {np.degrees(bend):.1f} "
        f"degrees in {STRETCH:g} m (a gentle bend, or bad odometry)"
    )
    return Doubt(share, spread, bend, words if bend > BEND else "", False)


def _share_followed(steps: Sequence[BackboneStep]) -> float:
    """Largest share of the wall seen that follows a direction of the backbone or its normal."""
    looked = [s for s in steps if not s.skipped and len(s.segments)]
    if not looked:
        return 1.0
    laid = np.concatenate([transform(s.pose, s.segments) for s in looked])
    angles, weight = angle(laid), length(laid)
    off = np.abs(axial_difference(2 * angles, 2 * steps[-1].known[:, None])) / 2
    return float(((off < FOLLOWS) @ weight).max() / weight.sum())


def _spread_left(steps: Sequence[BackboneStep]) -> float:
    """Median over scans of the weighted root mean square angle left between walls and lines."""
    left = [_left(s) for s in steps if not s.reason and (s.partner >= 0).sum() > 1]
    return float(np.median(left)) if left else 0.0


def _left(step: BackboneStep) -> float:
    on = step.partner >= 0
    weight = length(step.segments[on]) ** 3
    laid = angle(transform(step.pose, step.segments[on]))
    off = axial_difference(step.lines.angle[step.partner[on]], laid)
    off = axial_difference(off, mean_rotation(off, weight))
    return float(np.sqrt(weight @ off**2 / weight.sum()))


def _bend_corrected(steps: Sequence[BackboneStep]) -> float:
    """Median over whole stretches of 10 m of the sum of rotations while not turning, radians."""
    poses: Array = np.array([s.pose for s in steps])
    way = np.append(0.0, np.cumsum(np.hypot(*np.diff(poses[:, :2], axis=0).T)))
    straight = [0.0 if "turning" in s.reason else s.rotation for s in steps]
    sums = np.bincount((way // STRETCH).astype(int), straight)[: int(way[-1] // STRETCH)]
    return float(np.median(np.abs(sums))) if len(sums) else 0.0
