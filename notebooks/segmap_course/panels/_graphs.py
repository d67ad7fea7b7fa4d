"""Panels of the chapters on point ICP and pose graphs."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import scipy
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from numpy.typing import ArrayLike, NDArray

from segmap.alignment import (
    Alignment,
    match_points,
    point_steps,
    pose_graph,
    solve_graph,
)
from segmap.alignment.points import PointStep
from segmap.arrays import Array
from segmap.plotting import RAW, RESULT, draw_alignment
from segmap.poses import between, transform
from segmap.scans import Log

from ..drawings import draw_icp_step
from ._lesson import LessonPanel, note, play, slide, tick

#: Pale blue: points of the moving scan that find no partner.
_PALE = "#a6cbe3"
#: Around the moving scan, metres.
_EDGE = 0.5


class IcpPanel(LessonPanel):
    """Two scans, and how ICP moves one onto the other from a wrong start (A 2.5.1).

    The first scan is grey. The moving one is blue where it has a partner within reach, and pale
    where it has none; all of it is always in the picture. Orange lines lead to the partners.

    The scans are at least six points each, `(n, 2)` and `(m, 2)` in metres, in its own frame. The
    current one belongs nearly at the pose: the match from there is taken as the truth. Partners are
    searched as far as `reach`, metres, at first.

    Examples
    --------
    >>> corner = np.array([(0.1 * k, 0) for k in range(30)] + [(0, 0.1 * k) for k in range(30)])
    >>> panel = IcpPanel(corner, corner)
    >>> panel.step.value = 60
    >>> panel.error.value
    '0.000 m and 0.0 degrees from the match'
    """

    steps: list[PointStep]
    x = slide(0.3, -2.0, 2.0, 0.1, label="start off in x")
    y = slide(0.3, -2.0, 2.0, 0.1, label="start off in y")
    turn = slide(0, -45, 45, 5, "degrees", label="and turned")
    step = slide(0, 0, 60, 1, "")
    play = play("step", interval=400)
    count = error = note()
    rows = ("x", "y", "turn", "play step", "count error")
    words = "from {x:+.1f} m, {y:+.1f} m, {turn:+d} degrees: {count}, {error}"
    pixels = {"height": 390}  # noqa: RUF012

    def __init__(
        self,
        reference: ArrayLike,
        current: ArrayLike,
        pose: ArrayLike = (0.0, 0.0, 0.0),
        *,
        reach: float = 0.6,
    ) -> None:
        self.reference, self.current = np.asarray(reference, float), np.asarray(current, float)
        if min(len(self.reference), len(self.current)) < 6:
            counts = f"{len(self.reference)} and {len(self.current)}"
            raise ValueError(f"the two scans must have at least 6 points each, got {counts}")
        self.reach = reach
        self.pose = match_points(self.reference, self.current, pose, reach=reach).pose
        self._limits = np.percentile(self.reference, (3, 97), axis=0) + [[-1], [1]]
        self._begin()

    def _draw(self, figure: Figure) -> None:
        start = self.pose + [self.x.value, self.y.value, self.turn.meant()]
        self.steps = point_steps(self.reference, self.current, start, reach=self.reach)
        k = min(self.step.value, len(self.steps) - 1)
        now = self.steps[k]
        x, y, heading = between(self.pose, now.pose)
        self.count.value = f"step {k} of {len(self.steps) - 1}: {len(now.points)} points"
        turned = f"{abs(np.degrees(heading)):.1f} degrees"
        self.error.value = f"{np.hypot(x, y):.3f} m and {turned} from the match"
        ax = draw_icp_step(self.reference, now, ax=figure.subplots())
        placed = transform(now.pose, self.current)
        for some, color in ((placed, _PALE), (placed[partnered(placed, now.points)], RESULT)):
            ax.plot(*some.T, ".", color=color, markersize=4, markeredgewidth=0, zorder=1)
        low = np.minimum(self._limits[0], placed.min(0) - _EDGE)
        high = np.maximum(self._limits[1], placed.max(0) + _EDGE)
        ax.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]))
        kinds = {"first scan": RAW, "moving, with a partner": RESULT, "without": _PALE}
        dots = [Line2D([], [], ls="", marker="o", ms=4, color=c, label=k) for k, c in kinds.items()]
        ax.legend(
            handles=dots, loc="upper center", bbox_to_anchor=(0.5, -0.15), ncols=3, frameon=False
        )


def partnered(placed: Array, points: Array) -> NDArray[np.bool_]:
    """Which points of a scan, `(n,)`, are those with a partner, or lie between two of them.

    In large scans ICP seeks partners of every second or third point only.
    """
    partner = np.zeros(len(placed), bool)
    if not len(points):
        return partner
    index = scipy.spatial.cKDTree(placed).query(points)[1]
    partner[index] = True
    apart = max(int(np.gcd.reduce(index)), 1)
    return partner | (np.convolve(partner, np.ones(2 * apart - 1), "same") > 1)


#: Inverse covariances: 5 cm and 2 degrees from one key frame to the next by odometry, 2 cm and
#: 0.3 degrees for a loop.
_BY_ODOMETRY = np.linalg.inv(np.diag([0.05, 0.05, np.radians(2)]) ** 2)
_BY_LOOPS = np.linalg.inv(np.diag([0.02, 0.02, np.radians(0.3)]) ** 2)
#: Margin around the path of the robot, metres.
_MARGIN = 3.0


class PoseGraphPanel(LessonPanel):
    """A log scan by scan, with its pose graph so far; `loops` can be left out.

    With `odometry` the motion from key frame to key frame is that of the odometry, not of the
    scans; all by plain least squares, since loops contradict the odometry. `gap` is the largest
    distance that a loop stays open. The alignment is one of that log, with a graph; without one it
    is `alignment.pose_graph(log)`.
    """

    #: Of the scans so far.
    poses: Array
    scan = slide(lambda p: len(p.log) - 1, 0, lambda p: len(p.log) - 1, 1, "")
    play = play("scan", step=3)
    loops = tick("loops", True)
    odometry = tick("odometry, not scans", says=("scans", "odometry"))
    count = gap = note()
    rows = ("play scan", "loops odometry", "count gap")
    words = "scan {scan} by {odometry}: {count}, {gap}"
    pixels = {"height": 400}  # noqa: RUF012

    def __init__(self, log: Log, alignment: Alignment | None = None) -> None:
        aligned = pose_graph(log) if alignment is None else alignment
        if not len(log) or aligned.graph is None or len(aligned) != len(log):
            got = f"{len(log)} scans and {aligned!r}"
            raise ValueError(f"log and alignment must share a graph, got {got}")
        self.log, self.alignment, self.graph = log, aligned, aligned.graph
        has_wheels = bool(np.isfinite(log.odometry).all())
        ways = [aligned.poses[:, :2], *([log.odometry[:, :2]] if has_wheels else [])]
        low, high = (f([f(way, axis=0) for way in ways], axis=0) for f in (np.min, np.max))
        self._limits = np.array([low - _MARGIN, high + _MARGIN])
        self._begin()
        self.odometry.disabled = not has_wheels

    def _draw(self, figure: Figure) -> None:
        k, graph = self.scan.value + 1, self.graph
        past = graph.edges.max(axis=1) < k
        counted = past & (self.loops.value | ~graph.loop)
        self.poses = self._solved(k, counted)
        frames, closed = len(np.unique(graph.edges[past])) or 1, past & graph.loop
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

    def _solved(self, k: int, counted: NDArray[np.bool_]) -> Array:
        """Poses of the first k scans by the edges that count: as they were measured, or as the
        odometry has it between key frames."""
        graph, edges = self.graph, self.graph.edges[counted]
        relative, weights = graph.relative[counted], graph.information
        if not self.odometry.value:
            weights = None if weights is None else weights[counted]
            return solve_graph(self.alignment.poses[:k], edges, relative, information=weights)
        start, loop = self.log.odometry[:k], graph.loop[counted, None]
        steps = np.where(loop, relative, between(start[edges[:, 0]], start[edges[:, 1]]))
        weights = np.where(loop[..., None], _BY_LOOPS, _BY_ODOMETRY)
        return solve_graph(start, edges, steps, information=weights, scale=np.inf)

    def _gap(self, closed: NDArray[np.bool_]) -> float:
        """How far the poses leave the worst loop open, metres."""
        first, second = self.graph.edges[closed].T
        relative = between(self.poses[first], self.poses[second])
        rest = between(self.graph.relative[closed], relative)
        return float(np.hypot(rest[:, 0], rest[:, 1]).max(initial=0.0))
