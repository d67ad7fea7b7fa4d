"""The front end of a pose graph: each scan laid on a map of the last key frames."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from copy import copy
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array, Count, Metres, Positive, Radians, Settings
from ...poses.motions import arc, between, compose
from ...scans import LaserScan
from ...scans.causes import Unmatched
from ...threads import in_threads
from .._result import Laid, Match, Outcome, no_match
from ..graph import REAL_ERRORS, Graph, Rejected, deviations, stack
from ..points import LEAST_POINTS, PointMap, in_range, shows_no_place
from ._doubt import appraisal
from ._in_motion import at_mid_turn, even_motion, laid_in_motion, turn_of
from ._key_frames import KeyFrame, KeyFrames, Undoable, loose_poses
from ._pauses import elsewhere
from ._places import OVERLAP_GAIN
from ._wheels import Wheels

#: From a map, a scan's points `(m, 2)` and a guess `(3,)` to the match.
Matcher = Callable[[PointMap, Array, Array], Match]

#: Without odometry a step is looked for anew where at most this share of the scan lies on the map.
SURE_OVERLAP = 0.7
#: The search for a lost scan reaches at least so far about the last place, metres.
LEAST_SEARCH_M = 1.5
#: The search reaches so many times the last step, for each scan that was lost before.
SEARCH_STEPS = 1.5
#: The search for a lost scan reaches no farther than this, metres.
FARTHEST_SEARCH_M = 6.0
#: Two places that are not the same are equally likely where their scores differ by less.
ALIKE_SCORES = 0.05
#: Without odometry the last motion goes on for at most so many times as long as it took: stamps of
#: scans that waited for the recorder lie close together, and the next ones far apart.
MOST_TIMES = 2.0
#: Along a corridor no larger turn is believed, radians.
CORRIDOR_TURN_RAD = np.radians(60)
#: After so many lost scans in a row a map begins anew.
LOST_IN_A_ROW = 2
#: Standard deviations of the step to a map that begins anew: metres, metres and radians.
BREAK = (1.5, 1.5, np.radians(60))
#: Without odometry a match with no more than this share of the scan on the map is not trusted: in
#: drives through plans of buildings such matches are wrong by metres one time in fifteen and
#: more, others one in six hundred.
GUESSED_OVERLAP = 0.5
#: Without odometry a match that turned by more than this, radians, needs more overlap.
GUESSED_TURN_RAD = np.radians(45)
#: A match that turned so far is not trusted with less than this share of the scan on the map.
NEARLY_WHOLE_OVERLAP = 0.9
#: A descent that goes farther from where the search began, metres, is no match: it slides along
#: walls.
MOST_SLIDE_M = 0.3
#: A descent that turns by more, radians, is no match either.
MOST_SLIDE_RAD = 0.2
#: The first scan of a map is carried so often by the motion to the second.
FIRST_ROUNDS = 3
#: Key frames that make the map on which each scan is laid at last.
FINAL_NEIGHBOURS = 15
#: Key frames of the last map lie within this distance, metres, on any pass: loops join passes.
FINAL_NEIGHBOURHOOD_M = 4.0


@dataclass(frozen=True)
class Tracking(Settings):
    """How each scan is laid on the map of the last key frames.

    Parameters
    ----------
    frames
        Key frames of the local map: one holds too little of what the next scan sees.
    overlap
        Share of a scan's points that must lie on the map: less where many people walk about.
    step_error, turn_error
        Standard deviations of the odometry between key frames where nothing matched: less for good
        wheels.
    match_error, match_turn_error
        Standard deviations that every match is supposed to have at least, whatever its own
        covariance says: what matches in real buildings err by. Walls that are as flat as simulated
        ones allow a tenth. `Alignment.spread` grows with them.
    moving
        Whether the robot moves while a scan is measured: the match finds how, where beams have
        their times (`LaserScan.delays`), and the scan is carried to the middle of its turn. Not for
        a robot that stands for each scan: poses err by 2 cm then, where it turns by 10 degrees.
    """

    frames: Count = 10
    overlap: Positive = 0.4
    step_error: Metres = 0.5
    turn_error: Radians = np.pi / 9  # 20 degrees
    match_error: Metres = REAL_ERRORS[0]
    match_turn_error: Radians = REAL_ERRORS[1]
    moving: bool = False


@dataclass
class TrackedScan:
    """A scan that was laid: where it hangs, and what its match has told."""

    scan: LaserScan
    odometry: Array  # NaN where it has none
    frame: int  # its key frame
    pose: Array  # its pose in the key frame
    place: Array  # where it was laid when it came: loops do not move this one
    unmatched: Unmatched = Unmatched.NONE
    reason: str = ""
    overlap: float = np.nan  # share of the scan on the map before it; NaN where lost or blind
    corridor_sigma_m: float = 0.0  # standard deviation along the walls; 0 where the match fixes it
    odometry_wins: bool = False  # whether the odometry outweighed its match
    as_measured: LaserScan | None = None  # where `scan` is carried to the middle of its turn
    motion: Array = field(default_factory=lambda: np.zeros(7))  # of such a scan: `match_moving`

    @property
    def velocity(self) -> Array:
        """At the end of its turn, `(3,)`, metres and radians a second."""
        half = turn_of(self.as_measured or self.scan) / 2
        return self.motion[:3] + self.motion[3:6] * (half if np.isnan(self.motion[6]) else 1.0)

    @property
    def used(self) -> bool:
        """Whether a match tells where it lies."""
        return self.unmatched is Unmatched.NONE


class FrontEnd(Undoable):
    """Tracks a robot scan by scan: the matcher lays each on the map of the last key frames."""

    def __init__(self, matcher: Matcher, rules: Tracking) -> None:
        self.rows: list[TrackedScan] = []
        self.points = np.zeros((0, 2))  # of the last scan
        self.matcher, self.rules = matcher, rules
        least = np.diag([rules.match_error, rules.match_error, rules.match_turn_error]) ** 2
        self.frames, self.wheels = KeyFrames(least), Wheels()
        self.first_frame_of_map = 0  # the key frame at which the map began, or began anew
        self.lost_in_a_row = 0  # scans in a row without odometry and match
        self.local: PointMap | None = None
        #: The last two scans that saw something, and not the same.
        self.last_motion: tuple[TrackedScan, TrackedScan]
        self.redrawn = False  # whether the scan before the last has changed

    def track(self, scan: LaserScan) -> Match:
        """Lay a scan on the local map, or carry it by the expected step: in the last key frame."""
        points, self.redrawn = in_range(scan.points()), False
        points = self.points = points[:0] if shows_no_place(points) else points
        odometry = np.full(3, np.nan) if scan.odometry is None else scan.odometry
        start = odometry if np.isfinite(odometry).all() else np.zeros(3)
        row = TrackedScan(scan, odometry, len(self.frames) - 1, np.zeros(3), start)
        self.rows.append(row)
        if len(self.rows) == 1:
            row.unmatched = Unmatched.NONE if len(points) else Unmatched.TOO_LITTLE_SEEN
            self.last_motion = row, row
            return Match(start, np.eye(3), matched=True)
        before, measured, map = self.rows[-2], self.has_odometry(), self.local
        self.wheels.drive(self.step() if measured else np.full(3, np.nan))
        # A motion that goes on from match to false match grows until it is many metres a scan:
        # without odometry the robot stands after a scan that sees something and did not match
        goes_on = Unmatched.NONE, Unmatched.FREE_DIRECTION, Unmatched.TOO_LITTLE_SEEN
        step = self.step() if measured or before.unmatched in goes_on else np.zeros(3)
        guess = compose(before.pose, step)
        if map is None or len(points) < LEAST_POINTS:
            match = no_match(guess, Unmatched.TOO_LITTLE_SEEN)
        else:
            moving = self.rules.moving and turn_of(scan) > 0
            match = self.matcher(map, points, guess)
            if moving and not match.overlap > SURE_OVERLAP:
                carried = at_mid_turn(scan, np.r_[before.velocity, np.zeros(3), np.nan])
                other = self.matcher(map, in_range(carried.points()), guess)
                match = max(match, other, key=lambda each: each.matched * each.overlap)
            if moving and match.matched:
                match, points, map = self._in_motion(map, match)
            if not measured and not (match.matched and match.overlap > SURE_OVERLAP):
                other = self._regain(map, points, guess, match)
                if moving and other is not match:
                    other, points, map = self._in_motion(map, other)
                match = other
            match = self.wheels.complete(match, guess)
            winner = self.wheels.weigh(map, points, match)
            row.odometry_wins, match = winner is not match, winner
            row.overlap = match.overlap if match.matched or measured else np.nan
        row.unmatched, row.reason = match.unmatched, match.reason
        if map is not None and (match.free is not None or match.turns) and not measured:
            if len(map.free_motions(points, match.pose)):
                row.unmatched = Unmatched.FREE_DIRECTION
            row.corridor_sigma_m = float(np.sqrt(np.linalg.eigvalsh(match.covariance[:2, :2])[-1]))
        self.lost_in_a_row = 0 if match.matched else self.lost_in_a_row + 1
        row.pose = match.pose
        row.place = compose(before.place, between(before.pose, match.pose))
        _, later = self.last_motion
        is_copy = np.array_equal(scan.ranges, (later.as_measured or later.scan).ranges)
        if not is_copy and row.unmatched is not Unmatched.TOO_LITTLE_SEEN:
            self.last_motion = later, row
        return match

    def _in_motion(self, map: PointMap, match: Match) -> tuple[Match, Array, PointMap]:
        """The match of a scan as measured becomes one in the middle of its turn; points and map.

        The first scan of a map would bend all that follow: it is carried to its middle too.
        """
        row, before = self.rows[-1], self.rows[-2]
        scan = row.as_measured or row.scan
        apart = scan.time - (before.as_measured or before.scan).time
        seconds = max(turn_of(scan), apart)  # stamps may jitter: no turn is shorter
        motion = even_motion(before.pose, match.pose, seconds)
        steady = compose(before.pose, arc(before.velocity * seconds)), before.velocity
        if turn_of(before.scan) > 0 and self.frames.rows[-1].scan == len(self.rows) - 2:
            for _ in range(FIRST_ROUNDS):
                first = at_mid_turn(before.scan, motion)
                points = in_range(first.points())
                map = PointMap(points, np.zeros_like(points))
                laid = laid_in_motion(map, scan, match.pose, motion, steady, self.rules.overlap)
                motion = even_motion(before.pose, laid[0].pose, seconds)
            carried = replace(before, scan=first, as_measured=before.scan, motion=motion)
            frame = self.frames.rows[-1]._replace(points=points)
            self.rows = [*self.rows[:-2], carried, row]  # new lists: an error puts back the old
            self.frames.rows = [*self.frames.rows[:-1], frame]
            self.local, self.redrawn = map, True
        laid = laid_in_motion(map, scan, match.pose, motion, steady, self.rules.overlap)
        if laid[0].matched:
            row.as_measured, (match, row.scan, row.motion) = scan, laid
            self.points = in_range(row.scan.points())
        return match, self.points, map

    def step(self) -> Array:
        """Expected motion to the last scan, (3,) array, metres and radians.

        That of the odometry; without, the last motion goes on for the time that has passed.
        """
        if self.has_odometry():
            return between(self.rows[-2].odometry, self.rows[-1].odometry)
        earlier, later = self.last_motion
        took = later.scan.time - earlier.scan.time
        passed = self.rows[-1].scan.time - self.rows[-2].scan.time
        # Stamps since 1970 are whole steps of a quarter of a microsecond
        times = min(round(passed / took, 3), MOST_TIMES) if took > 0 and passed >= 0 else 1.0
        return times * between(earlier.place, later.place)

    def has_odometry(self) -> bool:
        """Whether odometry says how the robot came to the last scan."""
        return bool(np.isfinite([row.odometry for row in self.rows[-2:]]).all())

    def _regain(self, map: PointMap, points: Array, guess: Array, match: Match) -> Match:
        """Without odometry: the match, or a better one at any heading about the last place."""
        last = self.rows[-2].pose
        reach = max(LEAST_SEARCH_M, SEARCH_STEPS * float(np.hypot(*self.step()[:2])))
        candidates: list[tuple[float, Match]] = []
        far = min(reach * (1 + self.lost_in_a_row), FARTHEST_SEARCH_M)
        for quarter in range(4):
            about = last + (0.0, 0.0, quarter * np.pi / 2)
            other, score = self.search(map, points, about, far, np.pi / 4, 0.45)
            if other.matched and other.overlap >= SURE_OVERLAP:
                candidates.append((score, other))
        if not candidates:
            return match
        best, chosen = max(candidates, key=lambda each: each[0])
        alike = [other for score, other in candidates if score > best - ALIKE_SCORES]
        if any(elsewhere(between(chosen.pose, other.pose)) for other in alike):
            return match
        if match.matched and not chosen.overlap > match.overlap + OVERLAP_GAIN:
            return match
        if chosen.free is not None:
            if match.matched or abs(between(last, chosen.pose)[2]) > CORRIDOR_TURN_RAD:
                return match
            along = chosen.free @ (guess[:2] - chosen.pose[:2]) * chosen.free
            chosen = replace(chosen, pose=chosen.pose + (*along, 0.0))
        return chosen

    def search(
        self, map: PointMap, points: Array, guess: Array, reach: float, turn: float, least: float
    ) -> tuple[Match, float]:
        """The best place in a window about a guess, and its likelihood, at least the least.

        Half sides are in metres and radians. A descent from there that goes too far is no match.
        """
        start, score = map.search(points, guess, reach=reach, turn=turn, least=least)
        if start is None:
            return no_match(guess, Unmatched.NO_PLACE), score
        match = map.register(points, start, overlap=self.rules.overlap)
        x, y, heading = between(start, match.pose)
        if np.hypot(x, y) > MOST_SLIDE_M or abs(heading) > MOST_SLIDE_RAD:
            return no_match(start, Unmatched.SLIDES, overlap=match.overlap), score
        return match, score

    def needs_frame(self, step: float, turn: float) -> bool:
        """Whether the last scan is far from its key frame, or the first, or the first to see.

        With odometry a scan without a match becomes no key frame, unless several in a row see and
        do not match. Without, it does if it sees and has moved: there the chain of matches ends.
        """
        sees, lost = len(self.points) >= LEAST_POINTS, self.lost_in_a_row >= LOST_IN_A_ROW
        if self.local is None:
            return not len(self.frames) or len(self.points) > 0
        x, y, heading = self.rows[-1].pose
        moved = np.hypot(x, y) > step or abs(heading) > turn
        if self.has_odometry():
            return bool(sees and moved and (lost or not self.lost_in_a_row))
        return bool(sees and (moved or lost))

    def add_frame(self, match: Match) -> None:
        """Make the last scan the newest key frame, at its match."""
        row, new, measured = self.rows[-1], len(self.frames), self.has_odometry()
        step, turn = self.rules.step_error, self.rules.turn_error
        covariance = match.covariance if match.matched else np.diag([step, step, turn]) ** 2
        if self.lost_in_a_row >= LOST_IN_A_ROW:  # no match ties it to the map before
            self.first_frame_of_map = new
        if self.lost_in_a_row >= LOST_IN_A_ROW and not measured:  # only a guess does
            covariance = np.diag(BREAK) ** 2
        elif match.matched and new and self._is_guess(match):
            covariance = covariance + np.diag(BREAK) ** 2
        tied = match.matched and row.unmatched is not Unmatched.FREE_DIRECTION
        frame = KeyFrame(len(self.rows) - 1, self.points, tied, measured)
        self.frames.add(frame, match.pose, covariance)
        row.frame, row.pose, self.lost_in_a_row = new, np.zeros(3), 0
        self.wheels.begin()
        first = max(new + 1 - self.rules.frames, self.first_frame_of_map)
        self.local = self.frames.map_of(range(first, new + 1), new)

    def _is_guess(self, match: Match) -> bool:
        """Whether the match of the last scan may be any: no odometry nor wall led to it."""
        if self.has_odometry():
            return False
        turned = abs(between(self.rows[-2].pose, match.pose)[2])
        if match.overlap < (NEARLY_WHOLE_OVERLAP if turned > GUESSED_TURN_RAD else GUESSED_OVERLAP):
            return True
        return any(row.corridor_sigma_m for row in self.rows[self.frames.rows[-1].scan : -1])

    def register_again(self) -> None:
        """Lay each scan between key frames on the map of all that are near, whenever those were."""
        keys, own = self.frames.scans, self._key_frames()
        driven = np.array([row.odometry_wins for row in self.rows])
        others = np.flatnonzero((keys[own] != np.arange(len(own))) & ~driven)
        around = self.frames.neighbourhoods(FINAL_NEIGHBOURS, FINAL_NEIGHBOURHOOD_M)

        def refine(scans: NDArray[np.int64]) -> list[Array]:
            """Poses of scans of one key frame in it, by the map of those around it."""
            frame, offsets = self.rows[scans[0]].frame if len(scans) else 0, []
            map = self.frames.map_of(around(frame), frame)
            for scan in scans:
                points, offset = in_range(self.rows[scan].scan.points()), self.rows[scan].pose
                if map is not None and len(points) >= LEAST_POINTS:
                    match = map.register(points, offset, overlap=self.rules.overlap)
                    if not self.rows[scan].used:
                        other = self.matcher(map, points, offset)
                        match = max(match, other, key=lambda each: each.matched * each.overlap)
                    offset = match.pose if match.matched else offset
                offsets.append(offset)
            return offsets

        by_frame = np.split(others, np.flatnonzero(np.diff(own[others])) + 1)
        laid = in_threads(refine, by_frame, "laying each scan once more")
        for scans, offsets in zip(by_frame, laid, strict=True):
            for scan, offset in zip(scans, offsets, strict=True):
                self.rows[scan].pose = offset

    def poses(self) -> Array:
        """Poses of all scans so far, `(k, 3)` array, metres and radians."""
        there = np.reshape([row.pose for row in self.rows], (-1, 3))
        return compose(self.frames.poses[self._key_frames()], there)

    def pose(self) -> Array:
        """Pose of the last scan, (3,) array, metres and radians."""
        return compose(self.frames.poses[self.rows[-1].frame], self.rows[-1].pose)

    def key_odometry(self) -> Array:
        """Odometry of the key frames, `(n, 3)`; NaN where the log has none."""
        return np.reshape([self.rows[scan].odometry for scan in self.frames.scans], (-1, 3))

    def _key_frames(self) -> NDArray[np.int64]:
        """The key frame of each scan, `(k,)`."""
        return np.array([row.frame for row in self.rows], np.int64)

    def graph(self, rejected: Sequence[Rejected] = ()) -> Graph | None:
        """Edges between key frames, by the scans' indices; None before there is one."""
        frames = self.frames
        if not frames.edges:
            return None
        edges = stack(frames.edges)
        ends = frames.scans[np.stack([edges.first, edges.second], -1)]
        residual, motion = deviations(frames.poses, edges), edges.relative
        return Graph(ends, motion, edges.loop, residual, tuple(rejected), edges.information)

    def outcome(self, rejected: Sequence[Rejected] = ()) -> Outcome:
        """Poses and reasons of all scans, the graph, and how both are appraised."""
        frames, poses, frame = copy(self.frames), self.poses(), self._key_frames()
        rows, frames.rows = [copy(row) for row in self.rows], [*frames.rows]  # more may follow
        frames.edges = [*frames.edges]
        if frames.edges:
            used = [row.used for row in rows]
            matched = np.bincount(frame, used, len(frames)).astype(float)
            tied = [key.tied for key in frames.rows]
            for k in np.flatnonzero(loose_poses(tied, frames.edges, matched)[frame] & used):
                rows[k].unmatched, rows[k].reason = Unmatched.UNTIED, ""
        laid = [Laid(at, row.unmatched, row.reason) for row, at in zip(rows, poses, strict=True)]
        return Outcome(laid, self.graph(rejected), partial(appraisal, rows, frames))
