"""Beams that see what rides with the robot: its own body, a cable, people who walk along.

The end point of a beam that sees a wall is seen again from elsewhere, by another beam. One that
rides keeps its range, and from elsewhere the laser looks through where a wall would be.
"""

from __future__ import annotations

from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import minimum_filter1d

from ...arrays import Array
from ...poses.motions import between, compose, inverse, wrap
from ...scans import LaserScan, Log
from ...scans.causes import Cause, Finding
from ._blind_steps import Steps, blind_steps

#: Scans from which pairs are sought by the odometry, spread evenly over the log.
STARTS = 100
#: Ways from the first scan of a pair to the second; a turn counts as that of a point so far ahead.
WAYS_M, AHEAD_M = (0.15, 0.3, 0.6), 0.6
#: A shorter way tells nothing, and a longer one is none.
LEAST_WAY_M, MOST_WAY_M = 0.1, 1.5
#: So many pairs are needed, and so many times that a direction is compared.
ENOUGH = 12
#: Nothing that rides is farther than this.
NEAR_M = 3.0
#: A range that changes by less is the same; by more, it is another; people keep theirs to this.
SAME_M, ANOTHER_M, PEOPLE_M = 0.04, 0.15, 0.3
#: A laser looks through a point where all beams go on for so much that pass it within this angle:
#: along a wall a heading that errs by so much moves points into the room.
THROUGH_M, ABOUT_RAD = 0.15, np.radians(3)
#: A point is seen again within this, and this share of its distance.
AGAIN_M, AGAIN = 0.1, 0.03
#: Motions are wrong where more of them are contradicted in all but this share of the directions.
LEAST_RIGHT = 0.1
#: What is seen in a direction is the robot's from this share of the pairs on; most elsewhere: 0.31,
#: behind glass 0.69. People keep their distance in so many; most elsewhere: 0.53, glass 0.96 ...
RIDES, FOLLOWS = 0.7, 0.65
#: ... and keep it to 4 cm in fewer of these; people who follow: 0 to 0.57, glass: 0.65 and more.
RESTLESS = 0.6
#: A body fills neighbours that ride so often ...
BESIDE = 0.4
#: ... and those whose range is constant in so many scans, within this, and goes on from the next.
CONSTANT, SMOOTH_M = 0.8, 0.05
#: A strip of floor lies on a line across, within this, and is longer than a robot is wide.
STRAIGHT_M, WIDE_M = 0.05, 0.8


class Directions(NamedTuple):
    """Columns of equal directions all round, for the beams of one laser."""

    first: float  # radians
    step: float  # radians, negative where the laser turns clockwise
    columns: int

    def of(self, scan: LaserScan) -> NDArray[np.int64]:
        """The column of each beam, `(n,)`."""
        turned = (scan.angles - self.first) * np.sign(self.step) % (2 * np.pi)
        return np.rint(turned / abs(self.step)).astype(np.int64) % self.columns

    @property
    def angles(self) -> Array:
        """The direction of each column, `(columns,)`, radians."""
        return np.asarray(self.first + self.step * np.arange(self.columns), np.float64)

    def ranges(self, log: Log) -> Array:
        """`(k, columns)`, metres; inf where nothing was met, NaN where nothing is known."""
        table = np.full((len(log), self.columns), np.nan)
        for row, scan in zip(table, log, strict=True):
            met = np.where(scan.ranges >= scan.max_range, np.inf, scan.ranges)
            row[self.of(scan)] = np.where(met > 0, met, np.nan)
        return table


class Evidence(NamedTuple):
    """How often pairs of scans say something of each direction, `(n,)`."""

    rides: NDArray[np.int64]  # it has the same range, and its point is looked through
    follows: NDArray[np.int64]  # it has nearly the same range, and its point is looked through
    another: NDArray[np.int64]  # it has another range
    far: NDArray[np.int64]  # it has quite another range
    again: NDArray[np.int64]  # it has another range, and its point is seen again
    against: NDArray[np.int64]  # it has the same range, and its point is not where it should be

    def right(self) -> bool:
        """Whether the motions between the scans are right for some of what is seen."""
        known = self.again + self.against >= ENOUGH / 2
        return bool((self.again > self.against)[known].sum() > LEAST_RIGHT * known.sum())


def without_body(log: Log, steps: Steps) -> Log:
    """A log without the beams that see what rides with the robot: they are NaN in every scan.

    Pairs of scans are those of the odometry, if the scans do not contradict it, else the matched
    `steps`. Walls along which the robot drives keep their range too: where neither way nor turn is
    known, nothing is left out, and it is told if something seems to ride.
    """
    places: dict[bytes, list[int]] = {}
    for k, scan in enumerate(log):
        places.setdefault(scan.sensor_pose.tobytes(), []).append(k)
    scans, causes = list(log.scans), list(log.causes)
    for own in map(np.array, places.values()):
        angles = max((log[int(k)].angles for k in own), key=len)
        step = float(np.median(np.diff(angles))) if len(angles) > 2 else 0.0
        if step == 0:
            continue
        directions = Directions(float(angles[0]), step, round(2 * np.pi / abs(step)))
        reach, told = _riding(log[own], _within(steps, own), directions)
        causes += told
        for k in own if reach.any() else ():
            scans[k] = _without(log[int(k)], reach, directions)
    if len(causes) == len(log.causes):
        return log
    return replace(log, scans=tuple(scans), causes=tuple(causes))


def _riding(log: Log, steps: Steps, directions: Directions) -> tuple[Array, list[Finding]]:
    """How far what rides reaches in each column of one laser, `(n,)`, metres, and what is told."""
    nothing = np.zeros(directions.columns)
    for pairs in (_odometry_pairs(log.odometry), steps):
        if (found := _by_pairs(log, pairs, directions)) is not None:
            return found
    if (_way(steps.motion) < LEAST_WAY_M).sum() < ENOUGH:
        return nothing, []
    # Either the robot stands, or something that rides holds the scans: match without it
    ranges = directions.ranges(log[np.unique(np.r_[steps.first, steps.second])])
    still = _constant(ranges) & (_median(ranges) < NEAR_M)
    hidden = np.where(still, np.inf, 0.0)
    bare = tuple(_without(scan, hidden, directions) for scan in log)
    freed = blind_steps(replace(log, scans=bare))
    if (found := _by_pairs(log, freed, directions)) is not None:
        return found
    if not len(freed.first) or np.median(_way(freed.motion)) < LEAST_WAY_M:
        return nothing, []
    words = "something near stands still for the laser while the rest of the scans moves"
    why = "it may be the robot itself, and neither odometry nor turns tell"
    return nothing, [Finding(Cause.BODY, int(still.sum()), f"{words}: {why}", doubtful=True)]


def _by_pairs(log: Log, pairs: Steps, directions: Directions) -> tuple[Array, list[Finding]] | None:
    """What pairs of scans make of this; None where they are too few, or wrong."""
    way = _way(pairs.motion)
    tells = (way > LEAST_WAY_M) & (way < MOST_WAY_M)
    if tells.sum() < ENOUGH:
        return None
    used, rows = np.unique(np.stack([pairs.first[tells], pairs.second[tells]]), return_inverse=True)
    place, ranges = log[0].sensor_pose, directions.ranges(log[used])
    motion = compose(compose(inverse(place), pairs.motion[tells]), place)
    first, second = rows.reshape(2, -1)
    seen = _evidence(ranges[first], ranges[second], motion, directions)
    if not seen.right():
        return None
    # 1. A body, and the neighbours that it fills; half of a beam beside it may see it too
    rides, median = _share(seen.rides, seen.another), _median(ranges)
    smooth = np.isclose(median, np.roll(median, -1), 0, SMOOTH_M)  # with the next column
    constant, body, narrow = _constant(ranges), rides > RIDES, np.zeros(len(median), bool)
    while (body != narrow).any():
        narrow, after, before = body, np.roll(body, 1), np.roll(body, -1)
        filled = constant & (after & np.roll(smooth, 1) | before & smooth)
        body = body | filled | (after | before) & (rides > BESIDE)
    body = body | np.roll(body, 1) | np.roll(body, -1)
    # 2. People, who keep their distance, and their direction, by so much
    people = ~body & (_share(seen.follows, seen.far) > FOLLOWS)
    people &= seen.rides < RESTLESS * seen.follows
    angles, reach = directions.angles, np.where(body, np.inf, 0.0)
    for angle, far in zip(angles[people], median[people], strict=True):
        about = np.abs(wrap(angles - angle)) < PEOPLE_M / far
        reach = np.where(about, np.fmax(reach, far + PEOPLE_M), reach)
    # 3. What is told
    known, told = (~np.isnan(ranges)).any(0), []
    floor = _is_floor(median[narrow], angles[narrow])
    for which, what in (
        (narrow, "a strip of floor ahead: the laser is tilted" if floor else "the robot itself"),
        ((reach > 0) & ~body, "people who move along with the robot"),
    ):
        if count := int((which & known).sum()):
            words = f"{count} of {int(known.sum())} beams see {what}"
            told.append(Finding(Cause.BODY, count, words, "--keep-body keeps them"))
    return reach, told


def _evidence(own: Array, other: Array, motion: Array, directions: Directions) -> Evidence:
    """What pairs of ranges `(p, n)` say, with the pose `(p, 3)` of the other laser in the own."""
    counts = np.zeros((6, directions.columns), np.int64)
    width = 1 + 2 * round(ABOUT_RAD / abs(directions.step))
    for one, two, pose in ((own, other, inverse(motion)), (other, own, motion)):
        near = one < NEAR_M
        x, y, turn = (column[:, None] for column in pose.T)
        seen = np.where(near, one, 0.0)
        x = x + seen * np.cos(directions.angles + turn)
        y = y + seen * np.sin(directions.angles + turn)
        at = (np.arctan2(y, x) - directions.first) / directions.step
        below = np.floor(at).astype(np.int64) % directions.columns
        about = np.stack([below, (below + 1) % directions.columns])
        rows, far = np.arange(len(two))[:, None], np.hypot(x, y)
        beyond = two[rows, about] - far
        off = np.where(near, np.abs(two - seen), np.nan)
        nearest = minimum_filter1d(np.where(np.isnan(two), np.inf, two), width, mode="wrap")
        through = (nearest[rows, about] - far > THROUGH_M).all(0) & ~np.isnan(beyond).any(0)
        again = (np.abs(beyond) < AGAIN_M + AGAIN * far).any(0)
        counts += [
            (through & (off < SAME_M)).sum(0),
            (through & (off < PEOPLE_M)).sum(0),
            (off > ANOTHER_M).sum(0),
            (off > PEOPLE_M).sum(0),
            ((off > ANOTHER_M) & again).sum(0),
            ((off < SAME_M) & (np.abs(beyond) > THROUGH_M).all(0)).sum(0),
        ]
    return Evidence(*counts)


def _odometry_pairs(rows: Array) -> Steps:
    """Pairs of rows `(k, 3)` between which the robot moved some way, by the odometry."""
    known = np.flatnonzero(np.isfinite(rows).all(1))
    way = np.r_[0.0, np.cumsum(_way(between(rows[known[:-1]], rows[known[1:]])))]
    start = np.unique(np.linspace(0, len(known) - 1, STARTS).astype(np.int64))[: len(known)]
    first = np.tile(start, len(WAYS_M))
    second = np.searchsorted(way, np.concatenate([way[start] + far for far in WAYS_M]))
    first, second = known[first[second < len(known)]], known[second[second < len(known)]]
    return Steps(first, second, between(rows[first], rows[second]))


def _within(steps: Steps, own: NDArray[np.int64]) -> Steps:
    """Those steps that begin and end at scans `own` of the log, in places among these."""
    at = np.searchsorted(own, steps[:2]) % len(own)
    kept = (own[at] == np.stack(steps[:2])).all(0)
    return Steps(at[0, kept], at[1, kept], steps.motion[kept])


def _without(scan: LaserScan, reach: Array, directions: Directions) -> LaserScan:
    """A scan with NaN where a range is nearer than that of its column, `(n,)`, metres."""
    nearer = scan.ranges < reach[directions.of(scan)]
    return replace(scan, ranges=np.where(nearer, np.nan, scan.ranges))


def _way(motion: Array) -> Array:
    """How far motions `(m, 3)` go, turns included, `(m,)`, metres."""
    return np.hypot(motion[:, 0], motion[:, 1]) + AHEAD_M * np.abs(motion[:, 2])


def _share(those: NDArray[np.int64], others: NDArray[np.int64]) -> Array:
    """Those among both, `(n,)`; 0 where there are too few."""
    return np.where(those + others >= ENOUGH, those / np.maximum(those + others, 1), 0.0)


def _median(ranges: Array) -> Array:
    """Of each column of ranges `(k, n)`, `(n,)`, metres; inf where nothing is met."""
    return np.median(np.where(np.isnan(ranges), np.inf, ranges), 0)


def _constant(ranges: Array) -> NDArray[np.bool_]:
    """Which columns of ranges `(k, n)` hardly change, `(n,)`."""
    return np.isclose(ranges, _median(ranges), 0, SMOOTH_M).mean(0) >= CONSTANT


def _is_floor(ranges: Array, angles: Array) -> bool:
    """Whether ranges `(m,)` lie on a line across, in front of the laser."""
    ahead, aside = ranges * np.cos(angles), ranges * np.sin(angles)
    if not len(ranges) or np.median(ahead) < 0 or np.ptp(aside) < WIDE_M:
        return False
    return bool(np.quantile(np.abs(ahead - np.median(ahead)), 0.9) < STRAIGHT_M)
