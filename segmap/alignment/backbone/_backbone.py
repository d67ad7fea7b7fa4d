"""Backbone ("struttura portante", A 3.3.2, 5.2): scans turn and move onto lines of the building.

Errors of odometry come from turning, and corridors are parallel: so each straight stretch is laid
onto lines that were learned before the last turn, the rotation first, then the translation.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from ... import arrays
from ...angles import axial_difference
from ...arrays import Array, Metres, Radians, Settings, Share
from ...extraction import extract_polylines
from ...poses.motions import transform, wrap
from ...scans import LaserScan, Log
from ...scans.causes import Cause, Finding, Unmatched
from ...segments import angle as angle_of
from ...segments import length
from .._result import Appraisal, Outcome, Trail, alignment_method
from . import _lines as geometry
from ._lines import BackboneStep

#: A direction unlike all others needs so many times `min_length` of wall: a chord across a door,
#: seen once, is no corridor.
NEW_DIRECTION = 3.0
# What is expected of an orthogonal building before the result is believed:
#: A segment follows a direction to within this, radians: six standard deviations of a wall of 1 m,
#: seen with 20 beams and 10 mm of noise.
ALONG_AXIS_RAD = np.radians(3.0)
#: Walls of one scan that leave more after the best common rotation, radians, are bent: straight
#: ones left 0.02 to 0.6 degrees in all logs, a ring of 30 m radius 1.8.
BENT_WALLS_RAD = np.radians(1.0)
#: Length of a straight stretch, metres, in which corrections are added up.
STRAIGHT_STRETCH_M = 10.0
#: Larger corrections in a stretch, radians, come from a gentle bend as well as from bad odometry:
#: real logs needed up to 3.7 degrees, a ring of 60 m radius 9.
MOST_BEND_RAD = np.radians(4.0)


@dataclass(frozen=True)
class Thresholds(Settings):
    """The thresholds of `backbone` by which it lays scans."""

    min_length: Metres = 1.0
    step: Metres = 0.25
    turning: Radians = np.pi / 36
    rotation: Radians = np.pi / 6
    distance: Metres = 0.20
    angle: Radians = np.pi / 18
    parallel: Radians = np.pi / 36


@alignment_method
def backbone(
    log: Log,
    *,
    min_length: Metres = 1.0,
    step: Metres = 0.25,
    turning: Radians = np.pi / 36,
    rotation: Radians = np.pi / 6,
    distance: Metres = 0.20,
    angle: Radians = np.pi / 18,
    parallel: Radians = np.pi / 36,
    orthogonal: Share = 0.75,
) -> Outcome:
    """Lay straight stretches onto the lines of an orthogonal building (A 3.3.2).

    Scans taken while turning, and those too near the last one used, are skipped. The segments of
    the others that are long enough are matched with the lines of the backbone; the scan turns about
    the robot by the weighted mean difference of their directions, then moves by least squares. Then
    its segments join the significant ones, of which the backbone is built anew after every relevant
    rotation. Each correction stays: the next odometry step starts from the corrected pose.

    It goes beyond A: a new line takes the direction of an older one (A) or its normal; segments
    that disagree with the mean rotation by more than `parallel` are left out; a scan that is not
    used still takes its heading from the directions of the backbone, and one that matches no line
    has the backbone built anew for the next.

    The building must be orthogonal, and the method says where it is not: see `orthogonal`. Errors
    pass from scan to scan, and no loop is closed. In corridors so wide that their walls come back
    short or imprecise it does not work.

    Parameters
    ----------
    log
        With odometry that is nearly right between turns.
    min_length
        Shorter segments are furniture as often as walls, and say little about a direction.
    step
        Scans nearer than this to the last one used add nothing new.
    turning
        A scan to which the robot turned by more than this since the one before is skipped: five
        degrees are more than any drift between two scans, less than a turn on the spot.
    rotation
        A rotation is relevant from here on: 30 degrees lead into another corridor.
    distance
        A match needs both ends nearer than this to the line: noise and drift, not a door niche.
    angle
        A match needs a direction this near the line's: 10 degrees are more than a turn gets wrong.
    parallel
        Lines nearer in direction than this are taken for parallel.
    orthogonal
        Share of the wall seen that must follow two perpendicular directions. Walls in any direction
        reach 0.07, three directions 0.33, a wing at 45 degrees 0.5; furnished orthogonal buildings
        0.9. Below it, or where the walls of one scan do not agree on one rotation, the assumption
        fails: nothing is used, odometry is carried, and `.doubt` and `.reasons` say why. 0 insists
        on aligning all the same.

    Examples
    --------
    >>> from segmap.simulation import SICK_LMS200, circular_room, drive, simulate, square_room
    >>> rng, path = np.random.default_rng(1), drive([(2, 2), (6, 2), (6, 6)])
    >>> log = simulate(square_room(9), path, sensor=SICK_LMS200, rng=rng)
    >>> alignment = backbone(log)
    >>> error = np.abs(alignment.poses[:, 2] - log.truth[:, 2])
    >>> bool(np.degrees(error.max()) < 0.5), alignment.doubt
    (True, '')
    >>> backbone(simulate(circular_room(5), path, sensor=SICK_LMS200, rng=rng)).doubt[:18]
    'the assumption fai'
    """
    rules = Thresholds(min_length, step, turning, rotation, distance, angle, parallel)
    walk = _Backbone(log, rules)
    causes, fails = _causes([walk.step(k, scan) for k, scan in enumerate(log)], orthogonal)
    trail = Trail(log) if fails else walk.trail
    while len(trail.laid) < len(log):
        trail.carry(Unmatched.ASSUMPTION, str(causes[0]))
    return Outcome(trail.laid, appraise=partial(Appraisal, tuple(causes)))


def backbone_steps(log: Log, **thresholds: Any) -> list[BackboneStep]:
    """What `backbone` does with each scan, for pictures; it insists even where it should not.

    Takes the thresholds of `backbone` but for `orthogonal`.

    Examples
    --------
    >>> step = backbone_steps(Log("one", [LaserScan([1.0], [0.0], odometry=(1, 2, 0))]))[0]
    >>> step.pose, len(step.segments), step.lines
    (array([1., 2., 0.]), 0, Lines(0 in 0 directions))
    """
    arrays.instance(log, "log", Log)
    walk = _Backbone(log, Thresholds(**thresholds))
    return [walk.step(k, scan) for k, scan in enumerate(log)]


class _Backbone:
    """The steps of A 5.2, scan by scan."""

    def __init__(self, log: Log, thresholds: Thresholds) -> None:
        self.t, self.trail = thresholds, Trail(log)
        self.lines, self.known, self.walls = geometry.NO_LINES, np.empty(0), geometry.NO_WALLS
        self.last = np.full(3, np.inf)  # pose of the last scan used
        self.built = 0.0  # heading at which the backbone was built
        self.lost = False  # whether the last scan used matched nothing

    def step(self, k: int, scan: LaserScan) -> BackboneStep:
        """Lay one scan."""
        t, guess = self.t, self.trail.guess() if k else self.trail.pose()
        skipped = self._reason_to_skip(k, guess)
        seen = extract_polylines(scan.points(), closed=scan.whole_turn)
        seen = seen[length(seen) > t.min_length]  # A 3.3.2, step 3
        rebuilt = not skipped and self._rebuild(guess)  # step 4
        there = transform(guess, seen)  # step 5
        partner = geometry.partners(there, self.lines, t.distance, t.angle)
        why, reason = skipped or (Unmatched.NONE, "")
        if not skipped and not len(seen):
            why, reason = Unmatched.TOO_LITTLE_SEEN, f"no segment longer than {t.min_length:g} m"
        elif not skipped and not len(self.lines.angle):
            why, reason = Unmatched.NO_REFERENCE, "no backbone yet"
        elif not skipped and not (partner >= 0).any():
            why, reason = Unmatched.LITTLE_OVERLAP, "no segment on a line of the backbone"
        used = why is Unmatched.NONE
        if not used:
            partner = geometry.parallels(there, self.lines, t.angle)
        pose = geometry.turn_pose(guess, seen, self.lines, partner, t.parallel)  # step 6
        if used:
            pose = geometry.shifted_onto_lines(pose, seen, self.lines, partner)  # step 7
        if k:
            self.trail.place(pose, why, reason)
        if not skipped and len(seen):
            self.last, self.lost = pose, not used
            laid = transform(pose, seen)  # step 8; A merges them before they are moved
            self.walls = geometry.merged_into_walls(self.walls, laid, t.distance / 2, t.parallel)
        evidence = (guess, pose, seen, partner, self.lines, self.known)
        cause = (why, reason) if k else (Unmatched.NONE, "")
        return BackboneStep(*evidence, skipped is not None, rebuilt, *cause)

    def _reason_to_skip(self, k: int, guess: Array) -> tuple[Unmatched, str] | None:
        """Why a scan is left out; None where it is not (A 3.3.2, step 2)."""
        if k and not self.trail.has_odometry(k):
            return Unmatched.NO_ODOMETRY, "no odometry from the scan before"
        if k and abs(self.trail.step()[2]) > self.t.turning:
            return Unmatched.TURNING, str(Unmatched.TURNING)
        if np.hypot(*(guess - self.last)[:2]) < self.t.step:
            return Unmatched.TOO_NEAR, f"less than {self.t.step:g} m from the last scan used"
        return None

    def _rebuild(self, guess: Array) -> bool:
        """Build the backbone where there is none yet or a relevant rotation has just ended."""
        turned = abs(wrap(guess[2] - self.built)) > self.t.rotation
        due = turned or not len(self.lines.angle) or self.lost
        if not due or not len(self.walls.weight):
            return False
        t, self.built = self.t, float(guess[2])
        self.lines, self.known = geometry.support_lines(
            self.walls, self.known, t.distance / 2, t.parallel, NEW_DIRECTION * t.min_length
        )
        return True


def _causes(steps: Sequence[BackboneStep], orthogonal: float) -> tuple[list[Finding], bool]:
    """What speaks against the assumption of the method, and whether its result is thrown away."""
    if not steps or not len(steps[-1].known):
        blind = sum(not s.skipped for s in steps) > 1
        none = Finding(Cause.NO_WALLS, 0, "no backbone: no scan shows a wall long enough")
        return [none] * blind, False
    share, spread = _share_followed(steps), geometry.spread_left(steps)
    wrong = []
    if share < orthogonal:
        wrong = [f"{share:.0%} of the wall seen follows two perpendicular directions"]
        wrong[0] += f", expected at least {orthogonal:.0%}"
    if spread > BENT_WALLS_RAD:
        wrong.append(f"the walls of a scan disagree by {np.degrees(spread):.1f} degrees")
    if wrong and orthogonal > 0:
        why = "(not an orthogonal building, or odometry too bad)"
        words = f"the assumption fails: {'; '.join(wrong)} {why}"
        return [Finding(Cause.NOT_ORTHOGONAL, share, words, doubtful=True)], True
    bend = _bend_corrected(steps)
    words = (
        f"the assumption is doubtful: straight stretches were turned by {np.degrees(bend):.1f} "
        f"degrees in {STRAIGHT_STRETCH_M:g} m (a gentle bend, or bad odometry)"
    )
    return [Finding(Cause.NOT_ORTHOGONAL, bend, words)] if bend > MOST_BEND_RAD else [], False


def _share_followed(steps: Sequence[BackboneStep]) -> float:
    """Largest share of the wall seen that follows a direction of the backbone or its normal."""
    looked = [s for s in steps if not s.skipped and len(s.segments)]
    if not looked:
        return 1.0
    laid = np.concatenate([transform(s.pose, s.segments) for s in looked])
    angles, weight = angle_of(laid), length(laid)
    off = np.abs(axial_difference(2 * angles, 2 * steps[-1].known[:, None])) / 2
    return float(((off < ALONG_AXIS_RAD) @ weight).max() / weight.sum())


def _bend_corrected(steps: Sequence[BackboneStep]) -> float:
    """Median over whole stretches of the sum of rotations while not turning, radians."""
    poses: Array = np.array([s.pose for s in steps])
    way = np.append(0.0, np.cumsum(np.hypot(*np.diff(poses[:, :2], axis=0).T)))
    straight = [0.0 if s.unmatched is Unmatched.TURNING else s.rotation for s in steps]
    sums = np.bincount((way // STRAIGHT_STRETCH_M).astype(int), straight)[
        : int(way[-1] // STRAIGHT_STRETCH_M)
    ]
    return float(np.median(np.abs(sums))) if len(sums) else 0.0
