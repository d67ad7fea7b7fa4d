"""Panels of the chapters on ground truth, on segments laid on segments, and on the backbone."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from segmap.alignment import (
    Alignment,
    Match,
    angle_candidates,
    backbone,
    backbone_steps,
    global_segments,
    ground_truth,
    match_angles,
    match_segments,
)
from segmap.alignment.angle_correspondence import Candidate
from segmap.alignment.backbone import BackboneStep
from segmap.extraction import extract_polylines
from segmap.plotting import ERROR, MAP, RESULT, TRUTH, draw_alignment, draw_path, draw_segments
from segmap.poses import between, transform
from segmap.scans import Log

from ..drawings import draw_backbone
from ._lesson import LessonPanel, keyword, note, play, slide

#: Margin around the path of the robot, metres.
MARGIN = 3.0


class GroundTruthPanel(LessonPanel):
    """A log placed by some of its true poses: what interpolation puts between them (A 3.3.3).

    Only every so many-th true pose is given; the others tell how wrong the placed scans are. Scans
    without a place are orange crosses, the poses given green dots. The log has a truth for some of
    its scans; between two known poses farther apart than `max_gap`, seconds, nothing is claimed.

    Examples
    --------
    >>> from segmap import load
    >>> panel = GroundTruthPanel(load("malaga"))
    >>> panel.count.value, panel.error.value
    ('191 of 225 scans placed', 'wrong by 0.000 m on average')
    >>> panel.every.value = 4
    >>> panel.count.value
    '25 of 225 scans placed'
    """

    alignment: Alignment
    method = staticmethod(ground_truth)
    every = slide(1, 1, 16, 1, "", label="true pose, every")
    max_gap = keyword(0.2, 10.0, 0.2, value=1.0, label="longest gap")
    late = slide(0.0, -0.5, 0.5, 0.05, "s", label="clock late by")
    count = error = note()
    rows = ("every", "max_gap", "late", "count error")
    words = "every {every}., gaps to {max_gap:.1f} s, {late:+.2f} s: {count}, {error}"

    def __init__(self, log: Log, **first: float) -> None:
        if log.truth is None or not np.isfinite(log.truth).all(1).any():
            raise ValueError(f"log must hold true poses, got {log!r}")
        self.log, self._truth = log, log.truth
        self._known = np.flatnonzero(np.isfinite(log.truth).all(1))
        self._begin(**first)

    def _draw(self, figure: Figure) -> None:
        entries = self._known[:: self.every.value]
        times, poses = self.log.times[entries] + self.late.value, self._truth[entries]
        self.alignment = ground_truth(
            self.log, times=times, poses=poses, missing="drop", **self.chosen()
        )
        self.count.value = f"{self.alignment.used.sum()} of {len(self.log)} scans placed"
        placed = self._known[self.alignment.used[self._known]]
        self.error.value = "none of them is known"
        if len(placed):
            away = np.hypot(*(self.alignment.poses[placed, :2] - self._truth[placed, :2]).T)
            self.error.value = f"wrong by {away.mean():.3f} m on average"
        ax = draw_alignment(self.log, self.alignment, ax=figure.subplots())
        ax.plot(*poses[:, :2].T, ".", color=TRUTH, markersize=2)


class AnglePanel(LessonPanel):
    """Pairs of scans, and the candidates of angle correspondence by rank (A 3.3.1).

    The walls of the first scan are black. Those of the second are placed by the candidate, of which
    1 is the best: blue where it is the match, orange where it is rejected. Of a log of at least two
    scans the pair is at first `scan` and the one so many scans later, at most the last.
    """

    candidates: list[Candidate]
    match: Match
    method = staticmethod(angle_candidates)
    scan = slide(lambda p: p.first, 0, lambda p: len(p.log) - 2, 1, "", label="first scan")
    apart = slide(
        lambda p: p.later, 1, lambda p: max(2, min(40, len(p.log) - 1)), 1, "", label="scans apart"
    )
    rank = slide(1, 1, 10, 1, "", label="candidate")
    heuristic = keyword()
    distance = keyword(0.01, 0.30, 0.01, label="T_p")
    far = keyword(0.02, 0.60, 0.02)
    found = verdict = note()
    rows = ("scan", "apart", "rank", "heuristic", "distance", "far", "found verdict")

    def __init__(self, log: Log, *, scan: int = 0, apart: int = 1) -> None:
        if len(log) < 2:
            raise ValueError(f"log must hold at least two scans, got {len(log)}")
        self.log, self.first, self.later = log, scan, apart
        self._begin()

    def _draw(self, figure: Figure) -> None:
        first = self.scan.value
        second = min(first + self.apart.value, len(self.log) - 1)
        walls, others = (extract_polylines(self.log[k].points()) for k in (first, second))
        places = (self.log[first].sensor_pose[:2], self.log[second].sensor_pose[:2])
        chosen = {**self.chosen(), "viewpoints": places}
        self.candidates = angle_candidates(walls, others, rng=np.random.default_rng(0), **chosen)
        self.match = match_angles(walls, others, rng=np.random.default_rng(0), **chosen)
        ax = draw_segments(walls, ax=figure.subplots(), color=MAP)
        ax.set_title(f"scan {second} on scan {first}")
        match = self.match.matched
        self.verdict.value = f"match, overlap {self.match.overlap:.2f}" if match else "no match"
        self.found.value = "no candidate"
        if self.candidates:
            rank = min(self.rank.value, len(self.candidates))
            best = self.candidates[rank - 1]
            color = RESULT if match and rank == 1 else ERROR
            draw_segments(transform(best.pose, others), ax=ax, color=color)
            metres = f"{best.value:.2f} m match, {best.hidden:.2f} m hidden"
            self.found.value = f"{rank} of {len(self.candidates)}: {metres}"

    def __repr__(self) -> str:
        pair = f"scans {self.scan.value} and {self.scan.value + self.apart.value}"
        return f"AnglePanel({pair}: {self.found.value}; {self.verdict.value})"


class SegmentIcpPanel(LessonPanel):
    """Two scans as segments, and how segment ICP moves one onto the other from a wrong start.

    The scans of a log are `scan` and the one so many scans later; the start is off from where the
    second belongs, by the truth, or by the odometry where no truth is known. The walls of the first
    are black; those of the second are orange at the start, and blue at the end if there is a match.

    Examples
    --------
    >>> from segmap import load
    >>> panel = SegmentIcpPanel(load("room"), scan=3, apart=2)
    >>> panel.verdict.value
    'match, overlap 0.77'
    """

    match: Match
    method = staticmethod(match_segments)
    scan = slide(lambda p: p.first, 0, lambda p: len(p.log) - 2, 1, "", label="first scan")
    x = slide(0.2, -2.0, 2.0, 0.1, label="start off in x")
    y = slide(0.2, -2.0, 2.0, 0.1, label="start off in y")
    turn = slide(5, -45, 45, 1, "degrees", label="and turned")
    angle = keyword(1, 45, 1)
    distance = keyword(0.05, 1.0, 0.05)
    share = keyword(0.05, 1.0, 0.05)
    verdict = error = note()
    rows = ("scan", "x", "y", "turn", "angle", "distance", "share", "verdict error")
    words = "scan {scan}, {distance:.2f} m, {angle} degrees: {verdict}; {error}"

    def __init__(self, log: Log, *, scan: int = 0, apart: int = 1, **first: float) -> None:
        if len(log) < 2:
            raise ValueError(f"log must hold at least two scans, got {len(log)}")
        self.log, self.first, self.apart = log, scan, apart
        self._truth = log.odometry if log.truth is None else log.truth
        self._begin(**first)

    def _draw(self, figure: Figure) -> None:
        k = self.scan.value
        later = min(k + self.apart, len(self.log) - 1)
        walls, others = (extract_polylines(self.log[i].points()) for i in (k, later))
        true = np.isfinite(self._truth[[k, later]]).all()
        real_poses = self._truth if true else self.log.odometry
        real = between(real_poses[k], real_poses[later])
        start = real + [self.x.value, self.y.value, self.turn.meant()]
        self.match = match = match_segments(walls, others, start, **self.chosen())
        x, y, turn = between(real, match.pose)
        text = f"match, overlap {match.overlap:.2f}" if match.matched else f"none: {match.reason}"
        self.verdict.value = text
        self.error.value = f"{100 * np.hypot(x, y):.1f} cm, {abs(np.degrees(turn)):.1f} degrees off"
        ax = draw_segments(walls, ax=figure.subplots(), color=MAP, label=f"scan {k}")
        at_start = transform(start, others)
        draw_segments(at_start, ax=ax, color=ERROR, width=0.8, label=f"scan {later}, start")
        if match.matched:
            at_end = transform(match.pose, others)
            draw_segments(at_end, ax=ax, color=RESULT, label=f"scan {later}, end")
        ax.legend(loc="upper center", bbox_to_anchor=(0.5, -0.12), ncols=3, frameon=False)


class GlobalPanel(LessonPanel):
    """A log aligned by its segments all at once, for what counts as similar (A 2.5.1).

    `similar` and `angle` say which segments may be one wall, `spread` (A's sigma squared) how fast
    a pair loses weight with its distance. The truth, where it is known, is green.
    """

    alignment: Alignment
    method = staticmethod(global_segments)
    similar = keyword(0.05, 0.60, 0.05)
    angle = keyword(2, 45, 1)
    spread = keyword(0.005, 0.50, 0.005)
    count = error = note()
    rows = ("similar", "angle", "spread", "count error")
    words = "similar {similar:.2f} m, spread {spread:.3f} m: {count}, {error}"

    def __init__(self, log: Log, **first: float) -> None:
        if log.truth is None or not np.isfinite(log.odometry).all():
            raise ValueError(f"log {log.name!r} must have odometry, and the truth of each scan")
        self.log, self.truth = log, log.truth
        self._begin(**first)

    def _draw(self, figure: Figure) -> None:
        self.alignment = match = global_segments(self.log, **self.chosen())
        self.count.value = f"{match.used.sum()} of {len(self.log)} scans used"
        off = np.hypot(*(match.poses - self.truth)[:, :2].T)
        self.error.value = f"{off[-1]:.2f} m off at the end, {off.max():.2f} m at most"
        ax = figure.subplots()
        ax.plot(*self.truth[:, :2].T, color=TRUTH, linewidth=1, zorder=3, label="truth")
        draw_alignment(self.log, match, ax=ax)


class BackbonePanel(LessonPanel):
    """A log, scan by scan: the lines of the backbone, and how the scan is turned and placed.

    Lines are black. The relevant segments, longer than `min_length`, are orange where odometry
    would place them and blue where the method placed them. The path so far is blue. `state` says
    whether the scan was used, or why not.
    """

    now: BackboneStep
    method = staticmethod(backbone)
    scan = slide(0, 0, lambda p: len(p.log) - 1, 1, "")
    play = play("scan")
    min_length = keyword(0.2, 3.0, 0.1)
    distance = keyword(0.05, 1.0, 0.05, label="delta: distance")
    angle = keyword(1, 45, 1, label="theta: angle")
    step = keyword(0.05, 2.0, 0.05, label="eps: step")
    rotation = keyword(5, 120, 5, label="gamma: rotation")
    state = turned = note()
    rows = ("play scan", "min_length", "distance", "angle", "step", "rotation", "state turned")
    words = "scan {scan}, min_length {min_length:.1f} m: {state}; {turned}"

    def __init__(self, log: Log, **first: float) -> None:
        if not len(log):
            raise ValueError("log must hold at least one scan, got none")
        self.log = log
        self._known: dict[tuple[float, ...], list[BackboneStep]] = {}
        self._begin(**first)

    def _draw(self, figure: Figure) -> None:
        k, chosen = self.scan.value, self.chosen()
        asked = tuple(chosen.values())
        if asked not in self._known:
            self._known[asked] = backbone_steps(self.log, **chosen)
        steps = self._known[asked]
        self.now = steps[k]
        self.state.value = self.now.reason or "used"
        turned = f"turned by {np.degrees(self.now.rotation):.2f} deg"
        self.turned.value = f"{turned}, {len(self.now.lines.angle)} lines"
        way = np.array([s.pose for s in steps])
        ax = draw_backbone(self.now, ax=figure.subplots())
        draw_path(way[: k + 1], ax=ax, color=RESULT)
        low, high = way[:, :2].min(0) - MARGIN, way[:, :2].max(0) + MARGIN
        ax.set(title=f"scan {k}", xlim=(low[0], high[0]), ylim=(low[1], high[1]))
