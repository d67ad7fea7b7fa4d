"""Rays inserted as the thesis does in the end, and in the two ways that fail."""

import ipywidgets as W
import numpy as np
from matplotlib.figure import Figure
from matplotlib.path import Path
from numpy.typing import ArrayLike

from ..arrays import Array
from ..panels import Panel, slider, text
from ..plotting import draw_quadtree
from ..poses import transform
from ..quadtree import QuadtreeMap
from ..simulation import Sensor, circular_room, simulate
from ._ray_variants import insert_variant

#: Side of the smallest leaves, metres.
SIDE = 0.05


class RayPanel(Panel):
    """A room seen once or more, with the cells of its rays chosen well or badly (B 4.4).

    Parameters
    ----------
    walls : (n, 2, 2) array, metres, or None
        A closed chain of walls; None takes a round room of 2 m radius.
    poses : (k, 3) array, metres and radians

    Attributes
    ----------
    touched, mask : boxes to tick
    beams : slider
        In each full turn.
    walls_kept, outside : labels
        Of the cells that were hit, those that still look occupied; how much looks free outside.
    map : QuadtreeMap
        What is drawn.

    Examples
    --------
    >>> panel = RayPanel()
    >>> panel.walls_kept.value
    '100 % of 265 hit cells above 0.5'
    >>> panel.mask.value = False
    >>> panel.walls_kept.value
    '94 % of 265 hit cells above 0.5'
    """

    map: QuadtreeMap

    def __init__(
        self, walls: ArrayLike | None = None, poses: ArrayLike = ((2.05, 1.93, 0.0),)
    ) -> None:
        self.walls = circular_room(2.0) if walls is None else np.asarray(walls, float)
        self.poses = np.asarray(poses, float).reshape(-1, 3)
        self.touched = W.Checkbox(value=False, description="all cells touched")
        self.mask = W.Checkbox(value=True, description="mask")
        self.beams = slider("beams", 360, 90, 1080, 90, "")
        self.walls_kept, self.outside = text(), text()
        self._assemble((self.touched, self.mask), self.beams, (self.walls_kept, self.outside))

    def _draw(self, figure: Figure) -> None:
        self.map = QuadtreeMap(resolution=SIDE, size=128 * SIDE, corner=(-1.21, -1.21))
        for pose, points in self._scans():
            ways = {"touched": self.touched.value, "mask": self.mask.value}
            insert_variant(self.map, pose[:2], points, **ways)
        leaves, value = self.map.leaves(), self.map.leaf_occupancy()
        hit = leaves.occ > 0
        kept = (value[hit] > 0.5).mean()
        self.walls_kept.value = f"{100 * kept:.0f} % of {hit.sum()} hit cells above 0.5"
        self.outside.value = f"{self.free_outside():.2f} m² free outside"
        draw_quadtree(self.map, ax=figure.subplots(), robot=self.poses[-1])

    def free_outside(self) -> float:
        """Area of leaves beyond the walls that look free (occupancy at most 0.25), m2."""
        leaves, room = self.map.leaves(), Path(self.walls[:, 0])
        parts = [(i, j) for i in (0, 0.5, 1) for j in (0, 0.5, 1)]
        within = [
            room.contains_points(
                np.stack([leaves.x + i * leaves.side, leaves.y + j * leaves.side], -1)
            )
            for i, j in parts
        ]
        free = (self.map.leaf_occupancy() <= 0.25) & ~np.any(within, axis=0)
        return float((leaves.side[free] ** 2).sum())

    def _scans(self) -> list[tuple[Array, Array]]:
        """Pose and end points of each scan, in the map's frame."""
        count = self.beams.value
        sensor = Sensor("all round", count, -np.pi, 2 * np.pi / count, max_range=20.0)
        log = simulate(self.walls, self.poses, sensor=sensor, rng=np.random.default_rng(0))
        return [(pose, transform(pose, log[k].points())) for k, pose in enumerate(self.poses)]

    def __repr__(self) -> str:
        return f"RayPanel({self.walls_kept.value}, {self.outside.value})"
