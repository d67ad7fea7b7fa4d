"""A quadtree map that grows scan by scan."""

from __future__ import annotations

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from .. import arrays
from ..arrays import Metres, checked
from ..plotting import draw_quadtree
from ..quadtree import QuadtreeMap, build_map
from ..scans import Log
from ._base import Panel, player, slider, text

#: Corners of cells: from the finest to sixteen times as wide.
CELL_DOUBLINGS = 4


class QuadtreePanel(Panel):
    """The map of a log's first scans, with cells of several sides, and what it takes.

    Without poses the log's truth is taken. `scans` and its `play` button choose how many scans,
    `doublings` how often the side of the smallest leaves, `resolution`, is doubled; `leaves` and
    `bytes` tell of `map`, which is drawn.

    Examples
    --------
    >>> from segmap import load
    >>> panel = QuadtreePanel(load("room"))
    >>> panel.scans.value = 3
    >>> panel.leaves.value
    '1279 leaves of 0.05 m and more'
    """

    map: QuadtreeMap

    @checked
    def __init__(
        self, log: Log, poses: ArrayLike | None = None, *, resolution: Metres = 0.05
    ) -> None:
        if not len(arrays.instance(log, "log", Log)):
            raise ValueError("log must hold one scan at least, got none")
        given = log.truth
        if poses is not None:
            given = arrays.poses(poses, count=len(log), missing=True)
        if given is None:
            raise ValueError(f"log {log.name!r} has no truth: give poses")
        self.log, self.poses, self.resolution = log, given, resolution
        self.scans = slider("scans", len(log), 1, len(log), 1, "")
        self.play = player(self.scans)
        self.doublings = slider("doublings", 0, 0, CELL_DOUBLINGS, 1, "")
        self.leaves, self.bytes = text(), text()
        self._assemble((self.play, self.scans), self.doublings, (self.leaves, self.bytes))

    def _draw(self, figure: Figure) -> None:
        count, side = self.scans.value, self.resolution * 2.0**self.doublings.value
        self.map = build_map(self.log[:count], self.poses[:count], resolution=side)
        self.leaves.value = f"{len(self.map.leaves().x)} leaves of {side:.3g} m and more"
        grid = round(self.map.side / side) ** 2
        self.bytes.value = f"{self.map.nbytes / 1e3:.0f} kB; a grid {8 * grid / 1e3:.0f} kB"
        known = self.poses[:count][np.isfinite(self.poses[:count]).all(1)]
        robot = known[-1] if len(known) else None
        draw_quadtree(self.map, ax=figure.subplots(), robot=robot)

    def __repr__(self) -> str:
        return f"QuadtreePanel({self.scans.value} scans: {self.leaves.value})"
