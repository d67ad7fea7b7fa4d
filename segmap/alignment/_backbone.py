"""Backbone ("struttura portante", A 3.3.2, 5.2): scans turn and move onto lines of the building.

Errors of odometry come from turning, and corridors are parallel: so each straight stretch is laid
onto lines that were learned before the last turn, the rotation first, then the translation.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..angles import axial_difference, wrap
from ..arrays import Array
from ..extraction import extract_polylines
from ..poses import transform
from ..scans import LaserScan, Log
from ..segments import angle as angle_of
from ..segments import length
from ._backbone_lines import (
    NO_LINES,
    NO_WALLS,
    agreed_rotation,
    least_translation,
    parallels,
    partners,
    support_lines,
    with_segments,
)
from ._backbone_steps import BackboneStep, Doubt, doubt_of
from ._result import check_positive
from ._runner import Outcome, Trail, alignment_method

#: A direction unlike all others needs three times the length of a relevant segment: a chord across
#: a door seen once is no corridor.
FOUNDS = 3.0


@alignment_method
def backbone(
    log: Log,
    *,
    min_length: float = 1.0,
    step: float = 0.25,
    turning: float = np.pi / 36,
    rotation: float = np.pi / 6,
    distance: float = 0.20,
    angle: float = np.pi / 18,
    parallel: float = np.pi / 36,
    orthogonal: float = 0.75,
    follow: bool = True,
) -> Outcome:
    """Lay straight stretches onto the lines of an orthogonal building (A 3.3.2).

    Scans taken while turning, and those too near the last one used, are skipped. The segments of
    the others that are long enough are matched with the lines of the backbone; the scan turns about
    the robot by the weighted mean difference of their directions, then moves by least squares. Then
    its segments join the significant ones, of which the backbone is built anew after every relevant
    rotation. Each correction stays: the next odometry step starts from the corrected pose.

    It goes beyond A: a new line takes the direction of an older one (A) or its normal; segments
    that disagree with the mean rotation by more than `parallel` have no say; a scan that is not
    used still takes its heading from the directions of the backbone, as the robot would turn
    blindly otherwise; and a scan that matches no line at all has the backbone built anew for the
    next. The last two only while `follow` is True.

    The building must be orthogonal, and the method says where it is not: see `orthogonal`. Errors
    are passed on from scan to scan; no loop is closed; corridors so wide that their walls come back
    short or imprecise do not hold it.

    Parameters
    ----------
    log : Log
        With odometry that is nearly right between turns.
    min_length : float, metres
        Shorter segments are furniture as often as walls, and say little about a direction.
    step : float, metres
        Scans nearer than this to the last one used tell nothing new.
    turning : float, radians
        A scan to which the robot turned by more than this since the one before is skipped: five
        degrees are more than any drift between two scans, less than a turn on the spot.
    rotation : float, radians
        A rotation is relevant from here on: 30 degrees lead into another corridor.
    distance : float, metres
        A match needs both ends nearer than this to the line: noise and drift, not a door niche.
    angle : float, radians
        And a direction this near the line's; 10 degrees hold what a turn gets wrong.
    parallel : float, radians
        Lines nearer in direction than this are taken for parallel.
    orthogonal : float
        Share, in [0, 1], of the wall seen that must follow two perpendicular directions. Walls in
        any direction reach 0.07, three directions 0.33, a wing at 45 degrees 0.5; furnished
        orthogonal buildings 0.9. Below it, or where the walls of one scan do not agree on one
        rotation, the assumption fails: nothing is used, odometry is carried, and `.doubt` and
        `.reasons` say why. 0 insists on aligning all the same.
    follow : bool
        False leaves the headings of scans that are not used to odometry, as A does.

    Returns
    -------
    Alignment
        Poses, (k, 3) array, metres and radians; with `.doubt` where the assumption fails.

    Raises
    ------
    ValueError
        For a threshold that is not positive and finite, or a share outside [0, 1].

    Examples
    --------
    >>> from segmap.simulation import SICK_LMS200, circular_room, drive, simulate, square_room
    >>> rng, path = np.random.default_rng(1), drive([(2, 2), (6, 2), (6, 6)])
    >>> log = simulate(square_room(9), path, sensor=SICK_LMS200, rng=rng)
    >>> found = backbone(log)
    >>> error = np.abs(found.poses[:, 2] - log.truth[:, 2])
    >>> bool(np.degrees(error.max()) < 0.5), found.doubt
    (True, '')
    >>> backbone(simulate(circular_room(5), path, sensor=SICK_LMS200, rng=rng)).doubt[:18]
    'the assumption fai'
    """
    check_positive(
        min_length=min_length,
        step=step,
        turning=turning,
        rotation=rotation,
        distance=distance,
        angle=angle,
        parallel=parallel,
    )
    if not 0 <= orthogonal <= 1:
        raise ValueError(f"orthogonal must be a share between 0 and 1, got {orthogonal}")
    t = Thresholds(min_length, step, turning, rotation, distance, angle, parallel, follow)
    walk = _Walk(log, t)
    doubt = doubt_of(list(walk), orthogonal)
    trail = _carried(log, doubt) if doubt.fails else walk.trail
    return trail.outcome(doubt=doubt.words)


class Thresholds(NamedTuple):
    """The thresholds of `backbone`, metres and radians."""

    min_length: float = 1.0
    step: float = 0.25
    turning: float = np.pi / 36
    rotation: float = np.pi / 6
    distance: float = 0.20
    angle: float = np.pi / 18
    parallel: float = np.pi / 36
    follow: bool = True


def backbone_steps(log: Log, **thresholds: float) -> list[BackboneStep]:
    """What `backbone` does with each scan, for pictures; it insists even where it should not.

    Parameters
    ----------
    log : Log
    **thresholds : metres and radians
        Those of `backbone`, but `orthogonal`.

    Returns
    -------
    list of BackboneStep, one a scan

    Examples
    --------
    >>> step = backbone_steps(Log("one", [LaserScan([1.0], [0.0], odometry=(1, 2, 0))]))[0]
    >>> step.pose, len(step.segments), step.lines
    (array([1., 2., 0.]), 0, Lines(0 in 0 directions))
    """
    return list(_Walk(log, Thresholds(**thresholds)))  # type: ignore[arg-type]


def _carried(log: Log, doubt: Doubt) -> Trail:
    """Nothing but odometry, with the reason."""
    trail = Trail(log)
    for _ in range(1, len(log)):
        trail.carry(doubt.words)
    return trail


class _Walk:
    """The steps of A 5.2, scan by scan."""

    def __init__(self, log: Log, thresholds: Thresholds) -> None:
        self.log, self.t, self.trail = log, thresholds, Trail(log)
        self.lines, self.known, self.walls = NO_LINES, np.empty(0), NO_WALLS
        self.last = np.full(3, np.inf)  # pose of the last scan used
        self.built = 0.0  # heading at which the backbone was built
        self.lost = False  # whether the last scan used matched nothing

    def __iter__(self) -> Iterator[BackboneStep]:
        return (self._step(k, scan) for k, scan in enumerate(self.log))

    def _step(self, k: int, scan: LaserScan) -> BackboneStep:
        guess = self.trail.guess() if k else self.trail.poses[0]
        skipped = self._skipped(k, guess)
        seen = extract_polylines(scan.points())
        seen = seen[length(seen) > self.t.min_length]  # A 3.3.2, step 3
        rebuilt = not skipped and self._rebuilt(guess)  # step 4
        partner, pose, reason = self._laid(seen, guess, skipped)
        if k:
            self.trail.place(pose, reason)
        if not skipped:
            self._learn(transform(pose, seen), pose)
            self.lost = bool(reason and len(seen))
        reason = reason if k else ""
        return BackboneStep(
            *(guess, pose, seen, partner, self.lines, self.known),
            *(bool(skipped), rebuilt, reason),
        )

    def _skipped(self, k: int, guess: Array) -> str:
        """Why a scan is not looked at; empty where it is (A 3.3.2, step 2)."""
        if k and not np.isfinite(self.trail.steps[k - 1]).all():
            return "no odometry from the scan before"
        if k and abs(self.trail.step()[2]) > self.t.turning:
            return "taken while turning"
        near = np.hypot(*(guess - self.last)[:2]) < self.t.step
        return f"less than {self.t.step:g} m from the last scan used" if near else ""

    def _rebuilt(self, guess: Array) -> bool:
        """Build the backbone where there is none yet or a relevant rotation has just ended."""
        turned = abs(wrap(guess[2] - self.built)) > self.t.rotation
        due = turned or not len(self.lines.angle) or (self.lost and self.t.follow)
        if not due or not len(self.walls.weight):
            return False
        t, self.built = self.t, float(guess[2])
        self.lines, self.known = support_lines(
            self.walls, self.known, t.distance / 2, t.parallel, FOUNDS * t.min_length
        )
        return True

    def _laid(
        self, seen: Array, guess: Array, skipped: str
    ) -> tuple[NDArray[np.int64], Array, str]:
        """Partners, pose and reason of a scan whose relevant segments are seen."""
        partner = partners(transform(guess, seen), self.lines, self.t.distance, self.t.angle)
        missing = self._missing(seen, partner)
        if not skipped and not missing:
            on = partner >= 0
            pose = self._turned(seen[on], self.lines.angle[partner[on]], guess)
            return partner, self._moved(seen[on], partner[on], pose), ""
        partner = parallels(transform(guess, seen), self.lines, self.t.angle)
        partner[:] = partner if self.t.follow else -1
        on = partner >= 0
        pose = self._turned(seen[on], self.lines.angle[partner[on]], guess) if on.any() else guess
        return partner, pose, skipped or missing

    def _missing(self, seen: Array, partner: NDArray[np.int64]) -> str:
        """Why a scan cannot be laid; empty where a segment has found its line."""
        if not len(seen):
            return f"no segment longer than {self.t.min_length:g} m"
        if not len(self.lines.angle):
            return "no backbone yet"
        return "" if (partner >= 0).any() else "no segment on a line of the backbone"

    def _turned(self, seen: Array, onto: Array, guess: Array) -> Array:
        """The guess turned about the robot (A 3.3.2, step 6).

        A segment weighs the cube of its length: the variance of its direction is as the inverse.
        """
        differences = axial_difference(onto, angle_of(transform(guess, seen)))
        turn = agreed_rotation(differences, length(seen) ** 3, self.t.parallel)
        return np.array([guess[0], guess[1], float(wrap(guess[2] + turn))])

    def _moved(self, seen: Array, partner: NDArray[np.int64], pose: Array) -> Array:
        """The pose moved, by the ends of the segments as already turned (A 3.3.2, step 7).

        Slip: A takes them as they were before the rotation.
        """
        turned, normal = transform(pose, seen), self.lines.normal[partner]
        apart = turned - self.lines.through[partner][:, None]
        offsets = (apart * normal[:, None]).sum(-1)
        weight = np.repeat(length(seen), 2)
        shift = least_translation(np.repeat(normal, 2, axis=0), offsets.ravel(), weight)
        return pose + np.append(shift, 0.0)

    def _learn(self, laid: Array, pose: Array) -> None:
        """Merge segments into the significant ones (A 3.3.2, step 8): as laid, not as guessed."""
        t, self.last = self.t, pose
        self.walls = with_segments(self.walls, laid, t.distance / 2, t.parallel)
