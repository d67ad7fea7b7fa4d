"""Panels of the chapters on ground truth, angle correspondence and the backbone."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from segmap.alignment import (
    Alignment,
    Match,
    angle_candidates,
    backbone,
    backbone_steps,
    ground_truth,
    match_angles,
)
from segmap.alignment.angle_correspondence import Candidate
from segmap.alignment.backbone import BackboneStep
from segmap.extraction import extract_polylines
from segmap.plotting import ERROR, MAP, RESULT, TRUTH, draw_alignment, draw_path, draw_segments
from segmap.poses import transform
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
        given = self._known[:: self.every.value]
        times, poses = self.log.times[given] + self.late.value, self._truth[given]
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
    0 is the best: blue where it is the match, orange where it is rejected. Of a log of at least two
    scans the pair is at first `scan` and the one so many scans later, at most the last.
    """

    candidates: list[Candidate]
    match: Match
    scan = slide(lambda p: p.first, 0, lambda p: len(p.log) - 2, 1, "", label="first scan")
    apart = slide(
        lambda p: p.later, 1, lambda p: max(2, min(40, len(p.log) - 1)), 1, "", label="scans apart"
    )
    rank = slide(0, 0, 9, 1, "", label="candidate")
    found = verdict = note()
    rows = ("scan", "apart", "rank", "found verdict")

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
        self.candidates = angle_candidates(
            walls, others, rng=np.random.default_rng(0), viewpoints=places
        )
        self.match = match_angles(walls, others, rng=np.random.default_rng(0), viewpoints=places)
        ax = draw_segments(walls, ax=figure.subplots(), color=MAP)
        ax.set_title(f"scan {second} on scan {first}")
        found = self.match.matched
        self.verdict.value = f"match, overlap {self.match.overlap:.2f}" if found else "no match"
        self.found.value = "no candidate"
        if self.candidates:
            rank = min(self.rank.value, len(self.candidates) - 1)
            best = self.candidates[rank]
            color = RESULT if found and rank == 0 else ERROR
            draw_segments(transform(best.pose, others), ax=ax, color=color)
            metres = f"{best.value:.2f} m match, {best.hidden:.2f} m hidden"
            self.found.value = f"{rank + 1} of {len(self.candidates)}: {metres}"

    def __repr__(self) -> str:
        pair = f"scans {self.scan.value} and {self.scan.value + self.apart.value}"
        return f"AnglePanel({pair}: {self.found.value}; {self.verdict.value})"


class BackbonePanel(LessonPanel):
    """A log, scan by scan: the lines of the backbone, and how the scan is turned and placed.

    Lines are black. The relevant segments, longer than `min_length`, are orange where odometry
    would place them and blue where the method placed them. The path so far is blue. `state` says
    whether the scan was used, or why not.
    """

    step: BackboneStep
    method = staticmethod(backbone)
    scan = slide(0, 0, lambda p: len(p.log) - 1, 1, "")
    play = play("scan")
    min_length = keyword(0.2, 3.0, 0.1)
    state = turned = note()
    rows = ("play scan", "min_length", "state turned")
    words = "scan {scan}, min_length {min_length:.1f} m: {state}; {turned}"

    def __init__(self, log: Log, **first: float) -> None:
        if not len(log):
            raise ValueError("log must hold at least one scan, got none")
        self.log = log
        self._known: dict[float, list[BackboneStep]] = {}
        self._begin(**first)

    def _draw(self, figure: Figure) -> None:
        k, length = self.scan.value, self.min_length.value
        if length not in self._known:
            self._known[length] = backbone_steps(self.log, min_length=length)
        steps = self._known[length]
        self.step = steps[k]
        self.state.value = self.step.reason or "used"
        turned = f"turned by {np.degrees(self.step.rotation):.2f} deg"
        self.turned.value = f"{turned}, {len(self.step.lines.angle)} lines"
        way = np.array([s.pose for s in steps])
        ax = draw_backbone(self.step, ax=figure.subplots())
        draw_path(way[: k + 1], ax=ax, color=RESULT)
        low, high = way[:, :2].min(0) - MARGIN, way[:, :2].max(0) + MARGIN
        ax.set(title=f"scan {k}", xlim=(low[0], high[0]), ylim=(low[1], high[1]))
