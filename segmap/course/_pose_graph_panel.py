"""A pose graph as it grows: scans, loops that close, and how far they would stay open."""

from dataclasses import replace

import ipywidgets as W
import numpy as np
from matplotlib.figure import Figure
from numpy.typing import NDArray

from ..alignment import Alignment, pose_graph, solve_graph
from ..arrays import Array
from ..panels import Panel, slider, text
from ..plotting import draw_alignment
from ..poses import between
from ..scans import Log

#: Wheels err by so much from one key frame to the next, loops by so much: metres and radians.
BY_WHEELS = np.linalg.inv(np.diag([0.05, 0.05, np.radians(2)]) ** 2)
BY_LOOPS = np.linalg.inv(np.diag([0.02, 0.02, np.radians(0.3)]) ** 2)
#: Metres around the way of the robot that are shown.
MARGIN = 6.0


class PoseGraphPanel(Panel):
    """A log scan by scan with what its pose graph knows by then; loops can be left out.

    Parameters
    ----------
    log : Log
        At least one scan.
    alignment : Alignment or None
        Of that log, with a graph; None: `alignment.pose_graph(log)`.

    Attributes
    ----------
    scan : slider
        The last scan that has been taken.
    play : play button, which moves the slider
    loops : checkbox
        Whether the loops found so far count.
    wheels : checkbox
        Take the motion from key frame to key frame from the odometry, not from the scans; all by
        plain least squares, since loops contradict the wheels.
    count, gap : labels
        Of the key frames and loops; the largest distance that a loop is left open by.
    poses : (k, 3) array, metres and radians
        Of the scans so far.

    Raises
    ------
    ValueError
        Where there is no scan, or the alignment has no graph or another number of scans.

    Examples
    --------
    >>> from segmap import load
    >>> panel = PoseGraphPanel(load("corridor"))
    >>> panel.loops.value, panel.wheels.value = False, True
    >>> panel.count.value.split(", ")[1], panel.gap.value[:-3]
    ('4 loops not used', 'loops stay open by up to 2.3')
    """

    poses: Array

    def __init__(self, log: Log, alignment: Alignment | None = None) -> None:
        found = pose_graph(log) if alignment is None else alignment
        if not len(log) or found.graph is None or len(found) != len(log):
            got = f"{len(log)} scans and {found!r}"
            raise ValueError(f"log and alignment must share a graph, got {got}")
        self.log, self.alignment, self.graph = log, found, found.graph
        self.scan = slider("scan", len(log) - 1, 0, len(log) - 1, 1, "")
        self.play = W.Play(min=0, max=len(log) - 1, step=3, interval=250)
        self._link = W.jslink((self.play, "value"), (self.scan, "value"))
        self.loops = W.Checkbox(value=True, description="loops")
        known = bool(np.isfinite(log.odometry).all())
        self.wheels = W.Checkbox(description="wheels in place of scans", disabled=not known)
        self.count, self.gap = text(), text()
        ways = [found.poses[:, :2], *([log.odometry[:, :2]] if known else [])]
        low, high = (f([f(way, axis=0) for way in ways], axis=0) for f in (np.min, np.max))
        self._limits = np.array([low - MARGIN, high + MARGIN])
        rows = (self.loops, self.wheels), (self.count, self.gap)
        self._assemble((self.play, self.scan), *rows, height=400)

    def _draw(self, figure: Figure) -> None:
        k, graph = self.scan.value + 1, self.graph
        known = graph.edges.max(axis=1) < k
        counted = known & (self.loops.value | ~graph.loop)
        self.poses = (
            self._by_wheels(k, counted) if self.wheels.value else self._by_scans(k, counted)
        )
        frames, closed = len(np.unique(graph.edges[known])) or 1, known & graph.loop
        unused = "" if self.loops.value or not closed.any() else " not used"
        self.count.value = f"{frames} key frames, {closed.sum()} loops{unused}"
        self.gap.value = f"loops stay open by up to {self._gap(closed):.2f} m"
        seen = [r for r in graph.rejected if max(r.first, r.second) < k]
        so_far = replace(
            self.alignment,
            poses=self.poses,
            used=self.alignment.used[:k],
            graph=replace(
                graph, edges=graph.edges[counted], loop=graph.loop[counted], rejected=tuple(seen)
            ),
        )
        ax = draw_alignment(self.log[:k], so_far, ax=figure.subplots())
        ax.set(xlim=self._limits[:, 0], ylim=self._limits[:, 1])

    def _by_scans(self, k: int, counted: NDArray[np.bool_]) -> Array:
        """Poses of the first scans by the edges that count, as they were measured."""
        graph, start = self.graph, self.alignment.poses[:k]
        weights = None if graph.information is None else graph.information[counted]
        return solve_graph(
            start, graph.edges[counted], graph.relative[counted], information=weights
        )

    def _by_wheels(self, k: int, counted: NDArray[np.bool_]) -> Array:
        """The same with the steps of the odometry between key frames."""
        graph, start = self.graph, self.log.odometry[:k]
        edges, loop = graph.edges[counted], graph.loop[counted, None]
        steps = between(start[edges[:, 0]], start[edges[:, 1]])
        motions = np.where(loop, graph.relative[counted], steps)
        weights = np.where(loop[..., None], BY_LOOPS, BY_WHEELS)
        return solve_graph(start, edges, motions, information=weights, scale=np.inf)

    def _gap(self, closed: NDArray[np.bool_]) -> float:
        """How far the poses leave the worst loop open, metres."""
        first, second = self.graph.edges[closed].T
        found = between(self.poses[first], self.poses[second])
        rest = between(self.graph.relative[closed], found)
        return float(np.hypot(rest[:, 0], rest[:, 1]).max(initial=0.0))

    def __repr__(self) -> str:
        by = "wheels" if self.wheels.value else "scans"
        return (
            f"PoseGraphPanel(scan {self.scan.value} by {by}: {self.count.value}, {self.gap.value})"
        )
