"""Beams that see what rides with the robot: its own body, a cable, people who walk along.

The end point of a beam that sees a wall is seen again from elsewhere, by another beam. One that
rides keeps its range, and from elsewhere the laser looks through where a wall would be.
"""

from __future__ import annotations

from dataclasses import replace
from functools import reduce
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array
from ...poses.motions import between, compose, inverse, wrap
from ...scans import LaserScan, Log
from ...scans.causes import Cause, Finding
from ...scans.odometry import Steps, odometry_against_steps
from ._blind_steps import blind_steps

#: Scans from which pairs are sought by the odometry, spread evenly over the log.
PAIR_STARTS = 100
#: Ways from the first scan of a pair to the second, metres.
PAIR_WAYS_M = (0.15, 0.3, 0.6)
#: A turn counts as the way of a point so far ahead, metres.
TURN_LEVER_M = 0.6
#: A shorter way tells nothing, metres.
LEAST_WAY_M = 0.1
#: A longer one is none, metres.
MOST_WAY_M = 1.5
#: So many pairs are needed.
LEAST_PAIRS = 12
#: A direction must be compared so many times.
LEAST_COMPARISONS = 30
#: A log is looked at as a whole, and in so many parts ...
LOG_PARTS = 4
#: ... of so many scans at least.
LEAST_PART_SCANS = 40
#: Nothing that rides is farther than this.
NEAR_M = 3.0
#: A range that changes by less is the same, metres.
SAME_RANGE_M = 0.04
#: One that changes by more is another, metres.
ANOTHER_RANGE_M = 0.15
#: People who follow keep their range to this, metres.
PEOPLE_RANGE_M = 0.3
#: A laser looks through a point where the beams that pass it go on for so many metres, ...
SEEN_THROUGH_M = 0.15
#: ... all that pass within this angle, radians: along a wall a heading that errs by so much moves
#: points into the room.
SEEN_THROUGH_RAD = np.radians(3)
#: A point is seen again within this, metres, ...
SEEN_AGAIN_M = 0.1
#: ... and this share of its distance.
SEEN_AGAIN_SHARE = 0.03
#: Motions are wrong where more of them are contradicted in all but this share of the directions.
LEAST_RIGHT_SHARE = 0.1
#: People are sought where this share of the directions that see no people agrees with the motions.
MOSTLY_RIGHT_SHARE = 0.5
#: Odometry that is off by such factors is no measure of what rides; near 0 the scans stand since
#: something does.
OFF = (0.1, 0.8, 1.25)
#: What is seen in a direction is the robot's from this share of the pairs on; most elsewhere: 0.31,
#: behind glass 0.69.
RIDES_SHARE = 0.7
#: People who follow keep their distance in this share; most elsewhere: 0.53, glass 0.96 ...
FOLLOWS_SHARE = 0.65
#: A part of a log tells less: people are not sought there, and glass may ride in over 0.7.
RIDES_IN_PART = 0.8
#: ... and keep it to 4 cm in fewer of these; people who follow: 0 to 0.57, glass: 0.65 and more.
RESTLESS = 0.6
#: A body fills neighbours that ride so often ...
BODY_NEIGHBOUR_SHARE = 0.4
#: ... and those whose range is constant in this share of the scans, ...
CONSTANT_SHARE = 0.8
#: ... within this, metres, and goes on from the next.
CONSTANT_RANGE_M = 0.05
#: A strip of floor lies on a line across, within this, metres, ...
FLOOR_LINE_M = 0.05
#: ... and is longer than a robot is wide, metres.
FLOOR_LEAST_M = 0.8


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

    def right(self, share: float, which: NDArray[np.bool_]) -> bool:
        """Whether the motions between the scans are right for such a share of some directions."""
        known = (self.again + self.against >= LEAST_PAIRS / 2) & which
        return bool((self.again > self.against)[known].sum() > share * known.sum())


class Looks(NamedTuple):
    """What pairs of scans say."""

    first: NDArray[np.int64]  # scan of each pair, `(p,)`
    second: NDArray[np.int64]
    says: NDArray[np.int8]  # how many scans of a pair say each thing of `Evidence`, `(6, p, n)`
    scans: NDArray[np.int64]  # all of them, `(k,)`
    ranges: Array  # of these scans, `(k, n)`, metres


#: How far what rides reaches in each direction, `(n,)`, metres, and what is told.
Riding = tuple[Array, list[Finding]]
#: Scans from the first to before the second.
Part = tuple[int, int]


def without_body(log: Log, steps: Steps) -> Log:
    """A log without the beams that see what rides with the robot: they are NaN.

    It is looked for in the whole log, and in parts that overlap by half. Pairs of scans are those
    of the odometry, if the scans do not contradict it, else the matched `steps`. Walls along which
    the robot drives keep their range too: where neither way nor turn is known, nothing is left out,
    and it is told if something seems to ride.
    """
    angles = max((scan.angles for scan in log), key=len, default=np.empty(0))
    step = float(np.median(np.diff(angles))) if len(angles) > 2 else 0.0
    if step == 0:
        return log
    directions = Directions(float(angles[0]), step, round(2 * np.pi / abs(step)))
    size = max(len(log) // LOG_PARTS, LEAST_PART_SCANS)
    half, whole = size // 2, (0, len(log))
    begins = range(0, len(log) - half, half) if len(log) > size else ()
    found = _riding(log, steps, directions, [whole, *((k, k + size) for k in begins)])
    scans, told = list(log.scans), [finding for _, some in found.values() for finding in some]
    for (begin, end), (reach, _) in found.items():
        around = slice(max(begin - half, 0), end + half)  # it came and went within another part
        if reach.any():
            scans[around] = [_without_nearer(scan, reach, directions) for scan in scans[around]]
    most = sorted(told, key=lambda finding: finding.value)[-1:]
    return replace(log, scans=tuple(scans), causes=(*log.causes, *most)) if told else log


def _riding(
    log: Log, steps: Steps, directions: Directions, parts: list[Part]
) -> dict[Part, Riding]:
    """What rides in parts of a log: by the odometry, or by the steps if that is in feet."""
    way = odometry_against_steps(log.odometry, steps).way
    trusted = not (OFF[0] < way < OFF[1] or way > OFF[2])
    for pairs in (_odometry_pairs(log.odometry), steps)[0 if trusted else 1 :]:
        looks = _looks(log, pairs, directions)
        found = {part: _by_pairs(looks, part, directions, whole=part == parts[0]) for part in parts}
        if found[parts[0]] is not None:
            break
    known = {part: answer for part, answer in found.items() if answer is not None}
    if np.isfinite(log.odometry).all(1).any():
        return known
    for part in parts:
        if part not in known and (
            still := _seem_to_ride(log[slice(*part)], steps, part, directions)
        ):
            words = "something near stands still for the laser while the rest of the scans moves"
            why = "it may be the robot itself, and neither odometry nor turns tell"
            told = Finding(Cause.BODY, still, f"{words}: {why}", doubtful=True)
            known[part] = np.zeros(directions.columns), [told]
    return known


def _seem_to_ride(log: Log, steps: Steps, part: Part, directions: Directions) -> int:
    """Directions of what is near and hardly changes, where a log stands, but moves without it."""
    within = (steps.first >= part[0]) & (steps.second < part[1])
    if (_way(steps.motion[within]) < LEAST_WAY_M).sum() < LEAST_PAIRS:
        return 0
    ranges = directions.ranges(log)
    reach = np.where(_constant(ranges) & (_median(ranges) < NEAR_M), np.inf, 0.0)
    freed = replace(log, scans=tuple(_without_nearer(scan, reach, directions) for scan in log))
    moves = np.median([0.0, *_way(blind_steps(freed).motion)]) > LEAST_WAY_M
    return int(np.isinf(reach).sum()) if moves else 0


def _by_pairs(looks: Looks, part: Part, directions: Directions, *, whole: bool) -> Riding | None:
    """What rides in a part, by the pairs within it; None where they are too few, or wrong."""
    own = (looks.first >= part[0]) & (looks.second < part[1])
    seen = Evidence(*looks.says[:, own].sum(1, np.int64))
    if own.sum() < LEAST_PAIRS or not seen.right(LEAST_RIGHT_SHARE, seen.again >= 0):
        return None
    ranges = looks.ranges[(looks.scans >= part[0]) & (looks.scans < part[1])]
    # 1. A body, and the neighbours that it fills; half of a beam beside it may see it too
    rides, median = _share_of_first(seen.rides, seen.another), _median(ranges)
    smooth = np.isclose(median, np.roll(median, -1), 0, CONSTANT_RANGE_M)  # with the next column
    constant, narrow = _constant(ranges), np.zeros(len(median), bool)
    body = rides > (RIDES_SHARE if whole else RIDES_IN_PART)
    while (body != narrow).any():
        narrow, after, before = body, np.roll(body, 1), np.roll(body, -1)
        filled = constant & (after & np.roll(smooth, 1) | before & smooth)
        body = body | filled | (after | before) & (rides > BODY_NEIGHBOUR_SHARE)
    body = body | np.roll(body, 1) | np.roll(body, -1)
    # 2. People, who keep their distance, and their direction, by so much
    people = ~body & (_share_of_first(seen.follows, seen.far) > FOLLOWS_SHARE)
    people &= seen.rides < RESTLESS * seen.follows
    if not seen.right(MOSTLY_RIGHT_SHARE, ~body & ~people):
        people[:] = False
    angles, reach = directions.angles, np.where(body, np.inf, 0.0)
    for angle, far in zip(angles[people], median[people], strict=True):
        about = np.abs(wrap(angles - angle)) < PEOPLE_RANGE_M / far
        reach = np.where(about, np.fmax(reach, far + PEOPLE_RANGE_M), reach)
    # 3. What is told
    known, told = (~np.isnan(ranges)).any(0), []
    floor = _is_floor(median[narrow], angles[narrow])
    for which, what in (
        (narrow, "a strip of floor ahead: the laser is tilted" if floor else "the robot itself"),
        ((reach > 0) & ~body, "people who move along with the robot"),
    ):
        if count := int((which & known).sum()):
            words = f"{count} of {int(known.sum())} beams see {what}"
            told.append(
                Finding(
                    Cause.BODY,
                    count,
                    words,
                    "--keep-body keeps them",
                    doubtful=floor and which is narrow,
                )
            )
    return reach, told


def _looks(log: Log, pairs: Steps, directions: Directions) -> Looks:
    """What those of some pairs say between which the robot moved."""
    way = _way(pairs.motion)
    tells = (way > LEAST_WAY_M) & (way < MOST_WAY_M)
    first, second, motion = pairs.first[tells], pairs.second[tells], pairs.motion[tells]
    scans, rows = np.unique(np.stack([first, second]), return_inverse=True)
    own, other = rows.reshape(2, -1)
    place = np.reshape([log[int(k)].sensor_pose for k in scans], (-1, 3))
    motion = compose(compose(inverse(place[own]), motion), place[other])
    ranges, n = directions.ranges(log[scans]), directions.columns
    says = np.zeros((len(Evidence._fields), len(first), n), np.int8)
    beside = round(SEEN_THROUGH_RAD / abs(directions.step))  # columns
    nearest = reduce(np.fmin, (np.roll(ranges, k, 1) for k in range(-beside, beside + 1)))
    for one, two, least, pose in (
        (ranges[own], ranges[other], nearest[other], inverse(motion)),
        (ranges[other], ranges[own], nearest[own], motion),
    ):
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
        through = (least[rows, about] - far > SEEN_THROUGH_M).all(0) & ~np.isnan(beyond).any(0)
        again = (np.abs(beyond) < SEEN_AGAIN_M + SEEN_AGAIN_SHARE * far).any(0)
        says += np.stack(
            [
                (through & (off < SAME_RANGE_M)),
                (through & (off < PEOPLE_RANGE_M)),
                (off > ANOTHER_RANGE_M),
                (off > PEOPLE_RANGE_M),
                ((off > ANOTHER_RANGE_M) & again),
                ((off < SAME_RANGE_M) & (np.abs(beyond) > SEEN_THROUGH_M).all(0)),
            ]
        )
    return Looks(first, second, says, scans, ranges)


def _odometry_pairs(rows: Array) -> Steps:
    """Pairs of rows `(k, 3)` between which the robot moved some way, by the odometry."""
    known = np.flatnonzero(np.isfinite(rows).all(1))
    way = np.r_[0.0, np.cumsum(_way(between(rows[known[:-1]], rows[known[1:]])))]
    starts = min(PAIR_STARTS, 1 + int(way[-1] / PAIR_WAYS_M[0]))
    start = np.unique(np.searchsorted(way, np.linspace(0, way[-1], starts)))
    first = np.tile(start, len(PAIR_WAYS_M))
    second = np.searchsorted(way, np.concatenate([way[start] + far for far in PAIR_WAYS_M]))
    first, second = known[first[second < len(known)]], known[second[second < len(known)]]
    return Steps(first, second, between(rows[first], rows[second]))


def _without_nearer(scan: LaserScan, reach: Array, directions: Directions) -> LaserScan:
    """A scan with NaN where a range is nearer than that of its column, `(n,)`, metres."""
    nearer = scan.ranges < reach[directions.of(scan)]
    return replace(scan, ranges=np.where(nearer, np.nan, scan.ranges))


def _way(motion: Array) -> Array:
    """How far motions `(m, 3)` go, turns included, `(m,)`, metres."""
    return np.hypot(motion[:, 0], motion[:, 1]) + TURN_LEVER_M * np.abs(motion[:, 2])


def _share_of_first(those: NDArray[np.int64], others: NDArray[np.int64]) -> Array:
    """Those among both, `(n,)`; 0 where there are too few."""
    return np.where(those + others >= LEAST_COMPARISONS, those / np.maximum(those + others, 1), 0.0)


def _median(ranges: Array) -> Array:
    """Of each column of ranges `(k, n)`, `(n,)`, metres; inf where nothing is met."""
    return np.median(np.where(np.isnan(ranges), np.inf, ranges), 0)


def _constant(ranges: Array) -> NDArray[np.bool_]:
    """Which columns of ranges `(k, n)` hardly change, `(n,)`."""
    return np.isclose(ranges, _median(ranges), 0, CONSTANT_RANGE_M).mean(0) >= CONSTANT_SHARE


def _is_floor(ranges: Array, angles: Array) -> bool:
    """Whether ranges `(m,)` lie on a line across, in front of the laser."""
    ahead, aside = ranges * np.cos(angles), ranges * np.sin(angles)
    if not len(ranges) or np.median(ahead) < 0 or np.ptp(aside) < FLOOR_LEAST_M:
        return False
    return bool(np.quantile(np.abs(ahead - np.median(ahead)), 0.9) < FLOOR_LINE_M)
