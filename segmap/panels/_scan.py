"""Stepping through a log."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from .. import arrays
from ..plotting import ERROR, RESULT, TRUTH, draw_path, draw_scan
from ..poses import transform
from ..scans import LaserScan, Log
from ._base import Panel, player, slider, text

#: Points of all scans together that are drawn behind the current one.
MOST_POINTS = 4000


class ScanPanel(Panel):
    """A log, scan by scan, each at its pose: what the robot saw, and from where.

    Without poses the log's truth is taken, or its odometry where it has none; scans whose pose is
    NaN are left out. The path is green for truth, orange for odometry, blue for poses given here.
    `step` and its `play` button move among the scans that have a pose; `index` and `valid` tell of
    `scan`, which is drawn.

    Examples
    --------
    >>> scans = [LaserScan([1.0, 2.0], [0.0, 1.0], odometry=(x, 0, 0)) for x in (0, 1)]
    >>> panel = ScanPanel(Log("two", scans))
    >>> panel.step.value = 1
    >>> panel.index.value, panel.valid.value
    ('scan 1 of 2, after 0.00 s', '2 of 2 beams valid')
    """

    scan: LaserScan

    def __init__(self, log: Log, poses: ArrayLike | None = None) -> None:
        self.log = arrays.instance(log, "log", Log)
        own = (log.odometry, ERROR) if log.truth is None else (log.truth, TRUTH)
        chosen, self._color = own if poses is None else (poses, RESULT)
        self.poses = arrays.poses(chosen, missing=True)
        self.known = np.flatnonzero(np.isfinite(self.poses).all(1))
        if len(self.poses) != len(log) or not len(self.known):
            raise ValueError(
                f"poses must be ({len(log)}, 3), at least one of them finite, "
                f"got {self.poses.shape} with {len(self.known)} finite"
            )
        cloud = np.concatenate([transform(self.poses[k], log[int(k)].points()) for k in self.known])
        self._cloud = cloud[:: 1 + len(cloud) // MOST_POINTS]
        self.step = slider("scan", 0, 0, len(self.known) - 1, 1, "")
        self.play = player(self.step)
        self.index, self.valid = text(), text()
        self._assemble((self.play, self.step), (self.index, self.valid))

    def _draw(self, figure: Figure) -> None:
        k = int(self.known[self.step.value])
        self.scan = self.log[k]
        after = self.scan.time - self.log[0].time
        self.index.value = f"scan {k} of {len(self.log)}, after {after:.2f} s"
        self.valid.value = f"{int(self.scan.valid.sum())} of {len(self.scan)} beams valid"
        ax = figure.subplots()
        ax.plot(*self._cloud.T, ".", color="#cccccc", markersize=1)
        draw_path(self.poses[self.known], ax=ax, color=self._color)
        draw_scan(self.scan, self.poses[k], ax=ax, color=RESULT)

    def __repr__(self) -> str:
        return f"ScanPanel({self.index.value}: {self.valid.value})"
