"""What odometry says of a scan's pose, how far it errs, and where it is believed more than a match.

A person who walks beside the robot, or its own body, is at rest for the laser: where little else
fixes the motion, a match follows that, and contradicts wheels that err by a centimetre.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from ...arrays import Array
from ...poses.motions import between, compose, wrap
from .._result import Match
from ..points import LAST, LEAST_POINTS, SEARCH_CELL_M, PointMap
from ._key_frames import Undoable

#: Ordinary wheels err in place by at least this, metres (a standard deviation, as all below).
PLACE_ERROR_M = 0.01
#: Error in place for each metre driven, metres.
PLACE_ERROR_M_PER_M = 0.03
#: Error in place for each radian turned, metres.
PLACE_ERROR_M_PER_RAD = 0.05
#: Ordinary wheels err in heading by at least this, radians.
HEADING_ERROR_RAD = math.radians(0.5)
#: Error in heading for each metre driven, radians.
HEADING_ERROR_RAD_PER_M = 0.03
#: Error in heading for each radian turned, radians.
HEADING_ERROR_RAD_PER_RAD = 0.05
#: The last so many matches tell how much more these wheels err.
RECENT_MATCHES = 100
#: Fewer matches do not tell how these wheels err.
LEAST_MATCHES = 10
#: Quantile of their residuals that tells how much more these wheels err.
RESIDUAL_QUANTILE = 0.9
#: The same quantile of the length of three normal variables, which ordinary wheels have.
NORMAL_QUANTILE = 2.5
#: A match contradicts the odometry that is off by more standard deviations.
CONTRADICTION_SIGMAS = 5.0
#: A larger factor by which wheels err more than ordinary ones counts as this one: they slip.
MOST_WHEEL_FACTOR = 10.0
#: A point on a wall lies within this distance of it, metres: a scan's noise, and what is left of
#: the poses of the map.
ON_WALL_M = 0.05
#: Odometry wins if points that lie on a wall at its pose only, times its deviation in sigmas, are
#: more than this many times the points that do at the match only. Real logs: below 1.5 where the
#: wheels are wrong; people around a robot: above 1.9.
OUTWEIGHS = 1.8
#: A match that moves by less stands, metres: its own noise.
MATCH_STANDS_M = 0.03
#: A match that turns by less stands, radians: its own noise.
MATCH_STANDS_RAD = math.radians(0.6)
#: Where the match stands, the odometry is believed unless this share of the scan contradicts it:
#: people are less.
PEOPLE_SHARE = 0.3
#: Standard deviation of a place where odometry won, metres: what the rest of the graph may move.
WON_M = 0.2


class Wheels(Undoable):
    """The motion since the last key frame by odometry, and its standard deviations."""

    def __init__(self) -> None:
        self.off: list[float] = []  # deviation of each match, in sigmas of ordinary wheels
        self.free = False  # whether the last match left a direction free
        self.way = 0.0  # metres since the last key frame
        self.free_way = 0.0  # metres to it since walls fixed a place; NaN where not all is measured
        self.begin()

    def begin(self) -> None:
        """Begin at a new key frame."""
        self.free_way = self.free_way + self.way if self.free else 0.0
        self.motion, self.way, self.turn = np.zeros(3), 0.0, 0.0

    def drive(self, step: Array) -> None:
        """Go on by a step `(3,)`, metres and radians; NaN where the log does not say it."""
        self.motion = compose(self.motion, step)
        self.way += math.hypot(step[0], step[1])
        self.turn += abs(step[2])

    def complete(self, match: Match, guess: Array) -> Match:
        """A match that leaves a direction free, where the odometry's guess `(3,)` has it along it.

        Its covariance is that of these wheels. A match whose fixed directions contradict the wheels
        stays as it is. The error of a metre goes on in one direction until walls fix a place again:
        the deviation grows with the way, not with its root.
        """
        self.free = match.free is not None if match.matched else self.free
        usual, unknown = self._factor(MOST_WHEEL_FACTOR), math.isnan(self.free_way)
        if match.free is None or unknown or not self._offset(match) <= CONTRADICTION_SIGMAS * usual:
            return match
        along = np.array([*match.free, 0.0])
        before = PLACE_ERROR_M_PER_M * self.free_way
        noise = usual**2 * (self._sigmas()[0] ** 2 + 2 * before * PLACE_ERROR_M_PER_M * self.way)
        spread = along @ match.covariance @ along
        gain = match.covariance @ along / (spread + noise)
        moved = match.pose + gain * (along @ (guess - match.pose))
        covariance = match.covariance - np.outer(gain, along @ match.covariance)
        return replace(match, pose=moved, covariance=covariance)

    def weigh(self, map: PointMap, points: Array, match: Match) -> Match:
        """A match of a scan's points `(m, 2)`, or the place by odometry if both contradict.

        Where a match is right, nearly all points on which both places differ lie on a wall at its
        own. Where it follows people, the walls behind them speak for the odometry.
        """
        if not match.matched or not math.isfinite(off := self._offset(match)):
            return match
        usual = self._factor()
        if self.way > PLACE_ERROR_M and off > CONTRADICTION_SIGMAS * usual:
            driven = self._match_near_motion(map, points, match, usual)
            here, there = (map.is_near(points, one.pose, ON_WALL_M) for one in (match, driven))
            against, agree = (np.count_nonzero(a & ~b) for a, b in ((here, there), (there, here)))
            weight = agree * min(off / usual, MOST_WHEEL_FACTOR)
            x, y, heading = match.pose
            stands = math.hypot(x, y) < MATCH_STANDS_M and abs(heading) < MATCH_STANDS_RAD
            if (agree >= LEAST_POINTS and weight > OUTWEIGHS * against) or (
                stands and against < PEOPLE_SHARE * len(points)
            ):
                return driven
        if match.free is None and not match.turns:
            self.off.append(off)
        return match

    def _match_near_motion(self, map: PointMap, points: Array, match: Match, usual: float) -> Match:
        """The scan as it lies within the errors of ordinary wheels; else as the odometry has it."""
        place, _, heading = CONTRADICTION_SIGMAS * self._sigmas()
        start, _ = map.search(
            points, self.motion, reach=max(place, 2 * SEARCH_CELL_M), turn=heading
        )
        other = match if start is None else map.register(points, start, reach=LAST)
        if not other.matched or self._offset(other) > CONTRADICTION_SIGMAS:
            covariance = np.diag((usual * self._sigmas()) ** 2)
            other = Match(self.motion, covariance, matched=True)
        loose = other.covariance + np.diag([WON_M, WON_M, 0.0]) ** 2
        return replace(other, covariance=loose, overlap=match.overlap)

    def deviations(self) -> Array:
        """Standard deviations of the motion as these wheels err: place, place and heading."""
        return min(self._factor(), MOST_WHEEL_FACTOR) * self._sigmas()

    def compare(self, pose: Array) -> None:
        """Learn how far the motion is off from a pose `(3,)` that walls have fixed."""
        if math.isfinite(off := self._offset(Match(pose, np.eye(3), matched=True))):
            self.off.append(off)

    def _sigmas(self) -> Array:
        """Standard deviations of ordinary wheels in place, place and heading, `(3,)`."""
        place = PLACE_ERROR_M + PLACE_ERROR_M_PER_M * self.way + PLACE_ERROR_M_PER_RAD * self.turn
        heading = HEADING_ERROR_RAD + HEADING_ERROR_RAD_PER_M * self.way
        heading += HEADING_ERROR_RAD_PER_RAD * self.turn
        return np.array([place, place, heading])

    def _factor(self, unknown: float = 1.0) -> float:
        """How many times more than ordinary ones these wheels err, by steps that walls fix."""
        recent = sorted(self.off[-RECENT_MATCHES:])
        if len(recent) < LEAST_MATCHES:
            return unknown
        return max(recent[int(RESIDUAL_QUANTILE * len(recent))] / NORMAL_QUANTILE, 1.0)

    def _offset(self, match: Match) -> float:
        """How far what walls fix of a match is off, in deviations of ordinary wheels; maybe NaN."""
        pose = match.pose
        if match.free is not None:
            pose = pose + (*(match.free @ (self.motion - pose)[:2] * match.free), 0.0)
        x, y, heading = between(self.motion, pose)
        place, _, turn = self._sigmas()
        return math.sqrt((x * x + y * y) / place**2 + (wrap(heading) / turn) ** 2)
