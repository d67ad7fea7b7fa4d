"""The front end of a pose graph: each scan laid on a map of the last key frames."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array, Count, Metres, Positive, Radians, Settings
from ...poses.motions import between, compose
from ...scans import LaserScan
from ...scans.causes import Cause, Finding
from ...threads import in_threads
from .._result import SURE_M, Match, Outcome, Trail, no_match
from ..graph import (
    NEARBY,
    REAL_ERRORS,
    Edge,
    Graph,
    Rejected,
    deviations,
    groups,
    place_deviations,
    stacked,
)
from ..points import PointMap, in_range
from ._breaks import breaks
from ._key_frames import KeyFrames
from ._wheels import Wheels

#: From a map, a scan's points `(m, 2)` and a guess `(3,)` to the match.
Matcher = Callable[[PointMap, Array, Array], Match]

#: Without odometry a step is looked for anew where at most this share of the scan lies on the map.
SURE_OVERLAP = 0.7
#: The place that is found must hold so much more of the scan: below it false places match.
OVERLAP_GAIN = 0.1
#: The search for a lost scan reaches at least so far about the last place, metres.
LEAST_SEARCH_M = 1.5
#: It reaches so many times the last step, for each scan that was lost before ...
SEARCH_STEPS = 1.5
#: ... and no farther than this, metres.
FARTHEST_SEARCH_M = 6.0
#: Two places whose scores differ by less are equally likely, ...
ALIKE_SCORES = 0.05
#: ... if they lie so far apart, metres, ...
OTHER_PLACE_M = 0.5
#: ... or are turned by so much, radians.
OTHER_PLACE_RAD = np.radians(15)
#: Along a corridor no larger turn is believed, radians.
CORRIDOR_TURN_RAD = np.radians(60)
#: After so many lost scans in a row a map begins anew.
LOST_IN_A_ROW = 2
#: Standard deviations of the step to it: metres, metres and radians.
BREAK = (1.5, 1.5, np.radians(60))
#: Without odometry a match is a guess where no more than this share of the scan lies on the map:
#: in drives through plans of buildings such matches are wrong by metres one time in fifteen and
#: more, others one in six hundred.
GUESSED_OVERLAP = 0.5
#: It is a guess too where it has turned by more than this, radians, ...
GUESSED_TURN_RAD = np.radians(45)
#: ... and less than this share of the scan lies on the map.
NEARLY_WHOLE_OVERLAP = 0.9
#: A descent that goes farther from where the search began, metres, is no match: it slides along
#: walls.
MOST_SLIDE_M = 0.3
#: Nor is one that turns by more, radians.
MOST_SLIDE_RAD = 0.2
#: Standard deviation of the odometry along a direction that a match leaves free, metres.
ALONG_ERROR = 0.2
#: At last each scan is laid on the map of so many key frames ...
FINAL_NEIGHBOURS = 15
#: ... within so many metres, of all passes, since the loops have brought these together.
FINAL_NEIGHBOURHOOD_M = 4.0
#: Loops that stay open by this many standard deviations contradict the rest.
OPEN = 5.0
#: Why a scan is not used although it matched.
LOOSE = "neither walls nor odometry say how far it went"
UNTIED = "no match ties it to the rest"


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
    """

    frames: Count = 10
    overlap: Positive = 0.4
    step_error: Metres = 0.5
    turn_error: Radians = np.pi / 9  # 20 degrees
    match_error: Metres = REAL_ERRORS[0]
    match_turn_error: Radians = REAL_ERRORS[1]


class FrontEnd:
    """Tracks a robot scan by scan: the matcher lays each on the map of the last key frames."""

    def __init__(self, first: LaserScan, matcher: Matcher, rules: Tracking) -> None:
        self.scans, self.points = [first], _points_in_range(first)  # and the points of the last one
        blind = "" if len(self.points) else "too few points"
        self.trail, self.matcher, self.rules = Trail([first], reason=blind), matcher, rules
        least = np.diag([rules.match_error, rules.match_error, rules.match_turn_error]) ** 2
        self.frames = KeyFrames(self.points, self.trail.poses[0], least)
        self.key_frame_of_scan = [0]  # the key frame of each scan,
        self.pose_in_key_frame = [np.zeros(3)]  # and its pose there
        self.overlap = [np.nan]  # share of each scan on the map before it; NaN where lost
        self.free_along_corridor = [False]  # whether nothing says how far it went along the walls
        self.along = [0.0]  # its standard deviation then, metres; 0 where the match tells
        self.driven = [False]  # whether the odometry outweighed its match
        self.tied = [True]  # of each key frame: whether a match fixes the step to it
        self.wheels = Wheels()
        self.begins = [0]  # key frames at which a map began anew
        self.lost = 0  # scans in a row without odometry and match
        self.local = self.frames.map_of([0], 0)

    def track(self, scan: LaserScan) -> Match:
        """Lay a scan on the local map, or carry it by the expected step: in the last key frame."""
        points, before = _points_in_range(scan), self.pose_in_key_frame[-1]
        self.trail.add(scan)
        measured = self.measured()
        self.wheels.drive(self.trail.step() if measured else np.full(3, np.nan))
        # A motion that goes on from match to false match grows until it is many metres a scan:
        # without odometry the robot stands after a scan that did not match
        lost = self.trail.reasons[-1] not in ("", LOOSE)
        step = np.zeros(3) if lost and not measured else self.trail.step()
        guess, map = compose(before, step), self.local
        loose, along, driven = False, 0.0, False
        if map is None or len(points) < 6:
            match = no_match(guess, "too few points")
        else:
            match = self.matcher(map, points, guess)
            if not measured and not (match.matched and match.overlap > SURE_OVERLAP):
                match = self._regained(map, points, guess, match)
            weighed = self.wheels.weighed(map, points, match)
            driven, match = weighed is not match, weighed
            if (match.free is not None or match.turns) and not measured:
                loose = len(map.unfixed(points, match.pose)) > 0
                along = float(np.sqrt(np.linalg.eigvalsh(match.covariance[:2, :2])[-1]))
        self.lost = 0 if match.matched or measured else self.lost + 1
        self.scans.append(scan)
        self.points = points
        self.key_frame_of_scan.append(len(self.frames) - 1)
        self.pose_in_key_frame.append(match.pose)
        self.free_along_corridor.append(loose)
        self.along.append(along)
        self.driven.append(driven)
        self.overlap.append(match.overlap if match.matched or measured else np.nan)
        reason = LOOSE if loose else match.reason
        self.trail.place(compose(self.trail.poses[-1], between(before, match.pose)), reason)
        return match

    def _regained(self, map: PointMap, points: Array, guess: Array, match: Match) -> Match:
        """Without odometry: the match, or a better one at any heading about the last place."""
        last = self.pose_in_key_frame[-1]
        reach = max(LEAST_SEARCH_M, SEARCH_STEPS * float(np.hypot(*self.trail.step()[:2])))
        found: list[tuple[float, Match]] = []
        for quarter in range(4):
            about = last + (0.0, 0.0, quarter * np.pi / 2)
            far = min(reach * (1 + self.lost), FARTHEST_SEARCH_M)
            start, score = map.search(points, about, reach=far, turn=np.pi / 4, least=0.45)
            if start is None:
                continue
            other = map.register(points, start, overlap=SURE_OVERLAP)
            x, y, heading = np.abs(between(start, other.pose))
            if other.matched and np.hypot(x, y) <= MOST_SLIDE_M and heading <= MOST_SLIDE_RAD:
                found.append((score, other))
        if not found:
            return match
        best, chosen = max(found, key=lambda each: each[0])
        for score, other in found:
            x, y, heading = np.abs(between(chosen.pose, other.pose))
            if score > best - ALIKE_SCORES and (
                np.hypot(x, y) > OTHER_PLACE_M or heading > OTHER_PLACE_RAD
            ):
                return match
        if match.matched and not chosen.overlap > match.overlap + OVERLAP_GAIN:
            return match
        if chosen.free is not None:
            if match.matched or abs(between(last, chosen.pose)[2]) > CORRIDOR_TURN_RAD:
                return match
            along = chosen.free @ (guess[:2] - chosen.pose[:2]) * chosen.free
            chosen = replace(chosen, pose=chosen.pose + (*along, 0.0))
        return chosen

    def measured(self) -> bool:
        """Whether odometry says how the robot came to the scan that is laid now."""
        return self.trail.measured(len(self.scans))

    def needs_frame(self, step: float, turn: float) -> bool:
        """Whether the last scan is farther from its key frame, or the first to have points."""
        x, y, heading = self.pose_in_key_frame[-1]
        moved = np.hypot(x, y) > step or abs(heading) > turn
        anew = self.lost >= LOST_IN_A_ROW and len(self.points) >= 6
        return bool(moved or anew or (self.local is None and len(self.points)))

    def add_frame(self, match: Match) -> None:
        """Make the last scan the newest key frame, at its match."""
        scan = len(self.scans) - 1
        step, turn = self.rules.step_error, self.rules.turn_error
        covariance = match.covariance if match.matched else np.diag([step, step, turn]) ** 2
        if self.lost >= LOST_IN_A_ROW:  # nothing ties it to the map before but a guess
            self.lost, covariance = 0, np.diag(BREAK) ** 2
            self.begins.append(len(self.frames))
        elif match.matched and self._guessed(match):
            covariance = covariance + np.diag(BREAK) ** 2
        if match.matched and match.free is not None and self.trail.measured(scan):
            along = np.array([*match.free, 0.0]) / ALONG_ERROR
            covariance = np.linalg.inv(np.linalg.inv(covariance) + np.outer(along, along))
        self.frames.add(scan, self.points, match.pose, covariance)
        self.tied.append(match.matched and not self.free_along_corridor[scan])
        last = len(self.frames) - 1
        self.key_frame_of_scan[scan], self.pose_in_key_frame[scan] = last, np.zeros(3)
        self.wheels.begin()
        self.see_last_frames()

    def _guessed(self, match: Match) -> bool:
        """Whether the match of the last scan may be any: no odometry nor wall led to it."""
        scan = len(self.scans) - 1
        if self.trail.measured(scan):
            return False
        turned = abs(between(self.pose_in_key_frame[-2], match.pose)[2])
        if match.overlap < (NEARLY_WHOLE_OVERLAP if turned > GUESSED_TURN_RAD else GUESSED_OVERLAP):
            return True
        return any(self.along[self.frames.scan[-1] : scan])

    def see_last_frames(self) -> None:
        """Make the local map anew, of the last key frames."""
        last = len(self.frames) - 1
        first = max(last - self.rules.frames + 1, self.begins[-1])
        self.local = self.frames.map_of(range(first, last + 1), last)

    def refine(self) -> None:
        """Lay each scan between key frames on the map of all that are near, whenever those were."""
        keys, own = np.array(self.frames.scan), np.array(self.key_frame_of_scan)
        others = np.flatnonzero((keys[own] != np.arange(len(own))) & ~np.array(self.driven))
        around = self.frames.neighbourhoods(FINAL_NEIGHBOURS, FINAL_NEIGHBOURHOOD_M)

        def refined(scans: NDArray[np.int64]) -> list[Array]:
            """Poses of scans of one key frame in it, by the map of those around it."""
            frame, found = self.key_frame_of_scan[scans[0]] if len(scans) else 0, []
            map = self.frames.map_of(around(frame), frame)
            for scan in scans:
                points, offset = _points_in_range(self.scans[scan]), self.pose_in_key_frame[scan]
                if map is not None and len(points) >= 6:
                    match = map.register(points, offset, overlap=self.rules.overlap)
                    offset = match.pose if match.matched else offset
                found.append(offset)
            return found

        by_frame = np.split(others, np.flatnonzero(np.diff(own[others])) + 1)
        laid = in_threads(refined, by_frame, "laying each scan once more")
        for scans, found in zip(by_frame, laid, strict=True):
            for scan, offset in zip(scans, found, strict=True):
                self.pose_in_key_frame[scan] = offset

    def poses(self) -> Array:
        """Poses of all scans so far, `(k, 3)` array, metres and radians."""
        return compose(self.frames.poses[self.key_frame_of_scan], np.array(self.pose_in_key_frame))

    def pose(self) -> Array:
        """Pose of the last scan, (3,) array, metres and radians."""
        return compose(self.frames.poses[self.key_frame_of_scan[-1]], self.pose_in_key_frame[-1])

    def graph(self, rejected: Sequence[Rejected] = ()) -> Graph | None:
        """Edges between key frames, by the scans' indices; None before there is one."""
        frames = self.frames
        if not frames.edges:
            return None
        edges = stacked(frames.edges)
        ends = np.array(frames.scan)[np.stack([edges.first, edges.second], -1)]
        left, motion = deviations(frames.poses, edges), edges.relative
        return Graph(ends, motion, edges.loop, left, tuple(rejected), edges.information)

    def outcome(self, rejected: Sequence[Rejected] = ()) -> Outcome:
        """Poses, reasons and standard deviations of all scans, the graph, and what it doubts."""
        graph, frame, reasons = (
            self.graph(rejected),
            np.array(self.key_frame_of_scan),
            self.trail.reasons,
        )
        far, near, left = np.zeros(len(frame)), np.zeros(len(frame)), np.zeros(0)
        if graph is not None:
            weight = np.bincount(frame, minlength=len(self.frames)).astype(float)
            far, near = place_deviations(self.frames.poses, stacked(self.frames.edges), weight)
            far, near = far[frame], near[frame]
            seeing = np.array([not own for own in reasons], float)
            matched = np.bincount(frame, seeing, len(self.frames)).astype(float)
            apart = untied(self.tied, self.frames.edges, matched)[frame]
            both = zip(reasons, apart, strict=True)
            reasons = [own or (UNTIED if alone else "") for own, alone in both]
            left = graph.residuals[graph.loop]
        far, near = np.hypot(far, self.along), np.hypot(near, self.along)
        torn = breaks(np.array(self.trail.odometry), self.poses(), np.array(self.overlap))
        causes = torn + findings(reasons, far, left, near=near, converged=self.frames.converged)
        return Outcome(self.poses(), reasons, graph, causes, far, near)


def _points_in_range(scan: LaserScan) -> Array:
    """Points of a scan, `(m, 2)`, metres, that a laser can have seen."""
    return in_range(scan.points())


def untied(tied: Sequence[bool], edges: Sequence[Edge], weight: Array) -> NDArray[np.bool_]:
    """Which of n poses no edge that a match made ties to the largest group of them.

    `tied` says so of the step to each pose; loops always do. `weight` counts the scans of each
    that matched: a robot that stands blind for long is no map.
    """
    sure = [edge for edge in edges if edge.loop or tied[edge.second]]
    first, second = np.reshape([edge[:2] for edge in sure], (-1, 2)).T.astype(np.int64)
    group = groups(first, second, len(tied))
    return np.asarray(group != np.argmax(np.bincount(group, weight)))


def findings(
    reasons: Sequence[str],
    far: Array,
    left: Array,
    *,
    near: Array | None = None,
    converged: bool = True,
) -> list[Finding]:
    """What to doubt of the whole, with numbers.

    `far` and `near` are the standard deviations of all places in the whole and relative to those
    within 20 m, `left` is what the solution leaves of each loop, `(m,)`, in standard deviations.
    """
    count, found = len(reasons), []

    def add(cause: Cause, value: int, words: str) -> None:
        """One more finding; `Alignment.verdict` weighs the scans themselves."""
        found.append(Finding(cause, value, words))

    if loose := sum(reason == LOOSE for reason in reasons):
        add(Cause.NO_DISTANCE, loose, f"at {loose} of {count} scans {LOOSE}")
    if apart := sum(reason == UNTIED for reason in reasons):
        add(Cause.UNTIED, apart, f"no match ties {apart} of {count} scans to the rest")
    if vague := int((far > SURE_M).sum()):
        words = f"{vague} of {count} scans may be more than {2 * SURE_M} m off, {_worst(far)}"
        if near is not None:
            close = int((near > SURE_M).sum())
            most = f"{close} of {count}, {_worst(near)}" if close else "none"
            words += f"; relative to those within {NEARBY:g} m {most}"
        add(Cause.VAGUE, vague, words)
    if wide := int((left > OPEN).sum()):
        words = f"{wide} of {len(left)} loops stay open by over {OPEN:g} standard deviations"
        add(Cause.OPEN_LOOPS, wide, words)
    if not converged:
        add(Cause.NOT_SOLVED, 1, "the solver stopped before it came to an end")
    return found


def _worst(far: Array) -> str:
    """The scan that is known least, by two standard deviations."""
    return f"scan {np.argmax(far)} by {2 * far.max():.1f} m"
