"""Panels of the chapters on ground truth, angle correspondence and the backbone."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure

from segmap.alignment import (
    Alignment,
    BackboneStep,
    Candidate,
    Match,
    angle_candidates,
    backbone_steps,
    ground_truth,
    match_angles,
)
from segmap.extraction import extract_polylines
from segmap.panels import Panel, player, slider, text
from segmap.plotting import ERROR, MAP, RESULT, TRUTH, draw_alignment, draw_path, draw_segments
from segmap.poses import transform
from segmap.scans import Log

from ..drawings import draw_backbone


class GroundTruthPanel(Panel):
    """A log placed by some of its true poses: what interpolation puts between them (A 3.3.3).

    Parameters
    ----------
    log : Log
        With truth for some of its scans.
    max_gap : float, seconds
        Between two known poses farther apart nothing is claimed, at first.

    Attributes
    ----------
    every : slider
        Only every so many-th true pose is given; the others tell how wrong the placed scans are.
    max_gap : slider, seconds
    late : slider, seconds
        How much the clock of the truth is ahead of the laser's.
    count, error : labels
    alignment : Alignment
        What is drawn; scans without a place are red crosses, the poses given green dots.

    Raises
    ------
    ValueError
        For a log without truth.

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

    def __init__(self, log: Log, *, max_gap: float = 1.0) -> None:
        if log.truth is None or not np.isfinite(log.truth).all(1).any():
            raise ValueError(f"log must hold true poses, got {log!r}")
        self.log, self._truth = log, log.truth
        self._known = np.flatnonzero(np.isfinite(log.truth).all(1))
        self.every = slider("true pose, every", 1, 1, 16, 1, "")
        self.max_gap = slider("longest gap", max_gap, 0.2, 10.0, 0.2, "s")
        self.late = slider("clock late by", 0.0, -0.5, 0.5, 0.05, "s")
        self.count, self.error = text(), text()
        self._assemble(self.every, self.max_gap, self.late, (self.count, self.error))

    def _draw(self, figure: Figure) -> None:
        given = self._known[:: self.every.value]
        times, poses = self.log.times[given] + self.late.value, self._truth[given]
        self.alignment = ground_truth(
            self.log, times=times, poses=poses, max_gap=self.max_gap.value, missing="drop"
        )
        self.count.value = f"{self.alignment.used.sum()} of {len(self.log)} scans placed"
        self.error.value = self._error()
        ax = draw_alignment(self.log, self.alignment, ax=figure.subplots())
        ax.plot(*poses[:, :2].T, ".", color=TRUTH, markersize=2)

    def _error(self) -> str:
        """How far the scans whose truth is known lie from it."""
        placed = self._known[self.alignment.used[self._known]]
        if not len(placed):
            return "none of them is known"
        away = self.alignment.poses[placed, :2] - self._truth[placed, :2]
        return f"wrong by {np.hypot(away[:, 0], away[:, 1]).mean():.3f} m on average"

    def __repr__(self) -> str:
        given = f"every {self.every.value}., gaps to {self.max_gap.value:.1f} s"
        late = f"{self.late.value:+.2f} s"
        return f"GroundTruthPanel({given}, {late}: {self.count.value}, {self.error.value})"


class AnglePanel(Panel):
    """Pairs of scans, and the candidates of angle correspondence by rank (A 3.3.1).

    The walls of the first scan are black. Those of the second are placed by the candidate: blue
    where it is the match, red where it is rejected.

    Parameters
    ----------
    log : Log
        At least two scans.
    scan : int
        Index of the first scan of the pair, at first.
    apart : int
        How many scans later the second one is, at first; at most the last of the log is taken.

    Attributes
    ----------
    scan, apart, rank : sliders
        Of the pair, and of the candidate (0 is the best; at most the last there is).
    found, verdict : labels
    candidates : list of Candidate
    match : Match

    Examples
    --------
    >>> from segmap import load
    >>> panel = AnglePanel(load("room"), scan=0, apart=4)
    >>> panel.verdict.value, panel.found.value
    ('match, overlap 0.63', '1 of 5: 6.23 m match, 0.00 m hidden')
    """

    candidates: list[Candidate]
    match: Match

    def __init__(self, log: Log, *, scan: int = 0, apart: int = 1) -> None:
        if len(log) < 2:
            raise ValueError(f"log must hold at least two scans, got {len(log)}")
        self.log = log
        self.scan = slider("first scan", scan, 0, len(log) - 2, 1, "")
        self.apart = slider("scans apart", apart, 1, max(2, min(40, len(log) - 1)), 1, "")
        self.rank = slider("candidate", 0, 0, 9, 1, "")
        self.found, self.verdict = text(), text()
        self._assemble(self.scan, self.apart, self.rank, (self.found, self.verdict))

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
            self.found.value = (
                f"{rank + 1} of {len(self.candidates)}: {best.value:.2f} m match, "
                f"{best.hidden:.2f} m hidden"
            )

    def __repr__(self) -> str:
        pair = f"scans {self.scan.value} and {self.scan.value + self.apart.value}"
        return f"AnglePanel({pair}: {self.found.value}; {self.verdict.value})"


#: Margin around the path of the robot, metres.
_MARGIN = 3.0


class BackbonePanel(Panel):
    """A log, scan by scan: the lines of the backbone, and how the scan is turned and placed.

    Lines are black. The relevant segments are red where odometry would place them and blue where
    the method placed them. The path so far is blue.

    Parameters
    ----------
    log : Log
        At least one scan.
    min_length : float, metres
        Segments longer than this are relevant, at first.

    Attributes
    ----------
    scan, min_length : sliders
    play : play button, which moves the slider of the scans
    state, turned : labels
        Whether the scan was used, or why not; by how much it was turned.
    step : BackboneStep
        What is drawn.

    Examples
    --------
    >>> from segmap import load
    >>> panel = BackbonePanel(load("corridor")[:60])
    >>> panel.scan.value = 50
    >>> panel.state.value, panel.turned.value
    ('taken while turning', 'turned by -2.30 deg, 3 lines')
    """

    step: BackboneStep

    def __init__(self, log: Log, *, min_length: float = 1.0) -> None:
        if not len(log):
            raise ValueError("log must hold at least one scan, got none")
        self.log = log
        self.scan = slider("scan", 0, 0, len(log) - 1, 1, "")
        self.min_length = slider("min_length", min_length, 0.2, 3.0, 0.1)
        self.play = player(self.scan, interval=250)
        self.state, self.turned = text(), text()
        self._known: dict[float, list[BackboneStep]] = {}
        self._assemble((self.play, self.scan), self.min_length, (self.state, self.turned))

    def _draw(self, figure: Figure) -> None:
        k, steps = self.scan.value, self._steps()
        self.step = steps[k]
        self.state.value = self.step.reason or "used"
        turned = f"turned by {np.degrees(self.step.rotation):.2f} deg"
        self.turned.value = f"{turned}, {len(self.step.lines.angle)} lines"
        way = np.array([s.pose for s in steps])
        ax = draw_backbone(self.step, ax=figure.subplots())
        draw_path(way[: k + 1], ax=ax, color=RESULT)
        low, high = way[:, :2].min(0) - _MARGIN, way[:, :2].max(0) + _MARGIN
        ax.set(title=f"scan {k}", xlim=(low[0], high[0]), ylim=(low[1], high[1]))

    def _steps(self) -> list[BackboneStep]:
        """The steps with the threshold chosen, computed once for each."""
        length = self.min_length.value
        if length not in self._known:
            self._known[length] = backbone_steps(self.log, min_length=length)
        return self._known[length]

    def __repr__(self) -> str:
        chosen = f"scan {self.scan.value}, min_length {self.min_length.value:.1f} m"
        return f"BackbonePanel({chosen}: {self.state.value}; {self.turned.value})"
