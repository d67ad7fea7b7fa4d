"""Panels of the chapters on rays and on maps for others, and rays that fail (B 4.4)."""

from __future__ import annotations

import ipywidgets as W
import numpy as np
from matplotlib.figure import Figure
from matplotlib.path import Path
from numpy.typing import ArrayLike, NDArray

from segmap.arrays import Array
from segmap.exports import Classes, ros_classes
from segmap.panels import Panel, slider, text
from segmap.plotting import draw_quadtree
from segmap.poses import transform
from segmap.quadtree import QuadtreeMap
from segmap.simulation import Sensor, circular_room, simulate

from ..drawings import draw_classes
from ..literal import cell_of, ray_cells

Cell = tuple[int, int]
Cells = NDArray[np.int64]

#: Nearer than this to a line of the grid, in cells, is on it.
_TOUCH = 1e-9


def insert_variant(
    map: QuadtreeMap,
    sensor_xy: ArrayLike,
    points: ArrayLike,
    *,
    touched: bool = False,
    mask: bool = True,
) -> None:
    """Insert a scan as `map.insert_scan` does, or with one of the thesis' two failures.

    Parameters
    ----------
    map : QuadtreeMap
        Without `free_resolution`. It counts more scans than one.
    sensor_xy : (2,) array, metres
    points : (n, 2) array, metres
    touched : bool
        Instead of Bresenham's cells, all that the segment between both cells' corners touches: B's
        coordinates are whole centimetres (B fig. 4.5).
    mask : bool
        Whether the end cell's eight neighbours are left out (B 4.4.2); the end cell always is.

    Examples
    --------
    >>> maps = [QuadtreeMap(resolution=0.1) for _ in range(2)]
    >>> maps[0].insert_scan((1, 1), [(2, 1.3), (2, 1.4)])
    >>> insert_variant(maps[1], (1, 1), [(2, 1.3), (2, 1.4)])
    >>> bool((maps[0].leaves().vis == maps[1].leaves().vis).all())
    True
    """
    ends = np.asarray(points, float)
    map.insert_scan(sensor_xy, [])  # the root grows towards the sensor first
    for end in ends:  # each end from its own cell, which the mask spares
        map.insert_scan(end, [end])
    start, *last = (_cell(map, point) for point in (sensor_xy, *ends))
    crossed = np.concatenate([_leaves_crossed(map, start, end, touched, mask) for end in last])
    for leaf, rays in zip(*np.unique(crossed, axis=0, return_counts=True), strict=True):
        map.insert_scan(leaf, [], np.tile(leaf, (rays, 1)))  # rays of a single cell


def _cell(map: QuadtreeMap, point: ArrayLike) -> Cell:
    x, y = np.asarray(point, float).tolist()
    left, low = map.corner.tolist()
    return cell_of(x, left, map.resolution), cell_of(y, low, map.resolution)


def _leaves_crossed(map: QuadtreeMap, start: Cell, end: Cell, touched: bool, mask: bool) -> Array:
    """A place in each leaf that holds a cell of a ray, `(n, 2)`, metres."""
    cells = np.array(touched_cells(start, end) if touched else ray_cells(start, end))
    seen = cells[abs(cells - end).max(1) > int(mask)]
    leaf, first = np.unique(map.tree.leaves_at(seen - map.tree.corner), return_index=True)
    return map.corner + (seen[first[leaf >= 0]] + 0.5) * map.resolution


def touched_cells(start: Cell, end: Cell) -> Cells:
    """Cells whose square, border included, meets the segment between two cells' corners.

    Parameters
    ----------
    start, end : (2,) int

    Returns
    -------
    (n, 2) int array

    Examples
    --------
    >>> touched_cells((0, 0), (1, 1)).tolist()
    [[-1, -1], [-1, 0], [0, -1], [0, 0], [0, 1], [1, 0], [1, 1]]
    """
    a, b = np.array(start, float), np.array(end, float)
    cuts = np.unique(np.concatenate([_cuts(a[i], b[i]) for i in (0, 1)]))
    part = np.concatenate([cuts, (cuts[:-1] + cuts[1:]) / 2])
    points = a + part[:, None] * (b - a)
    low, high = np.floor(points - _TOUCH), np.floor(points + _TOUCH)
    corners = [
        np.stack([x, y], -1) for x in (low[:, 0], high[:, 0]) for y in (low[:, 1], high[:, 1])
    ]
    return np.unique(np.concatenate(corners).astype(np.int64), axis=0)


def _cuts(a: float, b: float) -> Array:
    """Shares of the way from a to b at which a coordinate is a whole number, with both ends."""
    lines = np.arange(min(a, b), max(a, b) + 1)
    return np.append((lines - a) / (b - a), (0.0, 1.0)) if a != b else np.array([0.0, 1.0])


#: Side of the smallest leaves, metres.
_SIDE = 0.05


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
        self.map = QuadtreeMap(resolution=_SIDE, size=128 * _SIDE, corner=(-1.21, -1.21))
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


class ClassesPanel(Panel):
    """The picture that a robot would get of a map, with both thresholds on sliders.

    Parameters
    ----------
    map : QuadtreeMap

    Attributes
    ----------
    occupied, free : sliders
        A cell above the one is occupied, up to the other free.
    doublings : slider
        How often the side of a pixel is doubled.
    counts, size : labels
    classes : Classes
        What is drawn.

    Examples
    --------
    >>> map = QuadtreeMap(resolution=0.5, size=4, bias=1)
    >>> map.insert_scan((0.2, 0.2), [(1.2, 0.2)])
    >>> panel = ClassesPanel(map)
    >>> panel.counts.value
    '15 free, 0 unknown, 1 occupied'
    """

    classes: Classes

    def __init__(self, map: QuadtreeMap) -> None:
        self.map = map
        self.occupied = slider("occupied above", 0.5, 0.5, 0.95, 0.05, "")
        self.free = slider("free up to", 0.25, 0.0, 0.45, 0.05, "")
        self.doublings = slider("doublings", 0, 0, min(4, map.tree.level), 1, "")
        self.counts, self.size = text(), text()
        self._assemble(self.occupied, self.free, self.doublings, (self.counts, self.size))

    def _draw(self, figure: Figure) -> None:
        found = self.classes = ros_classes(
            self.map,
            resolution=self.map.resolution * 2.0**self.doublings.value,
            occupied=self.occupied.value,
            free=self.free.value,
        )
        rows, columns = found.greys.shape
        free, unknown, occupied = ((found.greys == grey).sum() for grey in (254, 205, 0))
        self.counts.value = f"{free} free, {unknown} unknown, {occupied} occupied"
        self.size.value = f"{columns} x {rows} pixels of {found.side:.3g} m"
        draw_classes(found, ax=figure.subplots())

    def __repr__(self) -> str:
        return f"ClassesPanel({self.counts.value})"
