"""Panels on rays and rays that fail (B 4.4), on maps for others, and on ways through a map."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Circle
from matplotlib.path import Path
from numpy.typing import ArrayLike, NDArray

from segmap import arrays
from segmap.arrays import Array, Segments
from segmap.exports import Classes, ros_classes
from segmap.matching import NoRoute, route
from segmap.plotting import ERROR, RESULT, TRUTH, draw_quadtree, draw_segments
from segmap.poses import transform
from segmap.quadtree import QuadtreeMap, build_map, extent, frontiers
from segmap.scans import Log
from segmap.simulation import Sensor, circular_room, simulate

from .._storage import compare_with_walls, represent
from ..drawings import draw_classes, draw_ends, draw_frontiers
from ..literal import cell_of, ray_cells
from ._lesson import LessonPanel, keyword, note, slide, tick

if TYPE_CHECKING:
    import pandas as pd

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

    With `touched` a ray has, instead of Bresenham's cells, all that the segment between both cells'
    corners touches: B's coordinates are whole centimetres (B fig. 4.5). The `mask` leaves out the
    end cell's eight neighbours (B 4.4.2); the end cell always is. The map, which has no
    `free_resolution`, counts more scans than one.

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
    x_min, y_min = map.corner.tolist()
    return cell_of(x, x_min, map.resolution), cell_of(y, y_min, map.resolution)


def _leaves_crossed(map: QuadtreeMap, start: Cell, end: Cell, touched: bool, mask: bool) -> Array:
    """A place in each leaf that holds a cell of a ray, `(n, 2)`, metres."""
    cells = np.array(touched_cells(start, end) if touched else ray_cells(start, end))
    seen = cells[abs(cells - end).max(1) > int(mask)]
    leaf, first = np.unique(map.tree.leaves_at(seen - map.tree.corner), return_index=True)
    return map.corner + (seen[first[leaf >= 0]] + 0.5) * map.resolution


def touched_cells(start: Cell, end: Cell) -> Cells:
    """Cells `(n, 2)` whose square, with its border, meets the segment between two cell corners."""
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


class EndsPanel(LessonPanel):
    """Where the beams of a log's first scans ended, in a quadtree with cells of several sides.

    `doublings` says how often the side of the smallest leaves, 5 cm, is doubled.
    """

    map: QuadtreeMap
    scans = slide(lambda p: len(p.log), 1, lambda p: len(p.log), 1, "")
    doublings = slide(0, 0, 4, 1, "")
    leaves = note()
    rows = ("scans", "doublings", "leaves")
    words = "{scans} scans: {leaves}"

    def __init__(self, log: Log, poses: ArrayLike) -> None:
        self.log, self.poses = log, arrays.poses(poses, count=len(log), missing=True)
        self._begin()

    def _draw(self, figure: Figure) -> None:
        count, side = self.scans.value, _SIDE * 2.0**self.doublings.value
        self.map = build_map(self.log[:count], self.poses[:count], resolution=side)
        self.leaves.value = f"{len(self.map.leaves().x)} leaves of {side:.3g} m and more"
        draw_ends(self.map, ax=figure.subplots())


class RayPanel(LessonPanel):
    """A room seen once or more, with the cells of its rays chosen well or badly (B 4.4).

    `walls_kept` says how many of the cells that were hit still look occupied. The walls are a
    closed chain, without any a round room of 2 m radius.
    """

    map: QuadtreeMap
    touched = tick("all cells touched")
    mask = tick("mask", True)
    beams = slide(360, 90, 1080, 90, "")
    bias = slide(20, 1, 60, 1, "")
    walls_kept = outside = note()
    rows = ("touched mask", "beams", "bias", "walls_kept outside")
    words = "{walls_kept}, {outside}"

    def __init__(
        self, walls: ArrayLike | None = None, poses: ArrayLike = ((2.05, 1.93, 0.0),)
    ) -> None:
        self.walls = circular_room(2.0) if walls is None else np.asarray(walls, float)
        self.poses = np.asarray(poses, float).reshape(-1, 3)
        self._begin()

    def _draw(self, figure: Figure) -> None:
        size = {"size": 128 * _SIDE, "bias": self.bias.value}
        self.map = QuadtreeMap(resolution=_SIDE, corner=(-1.21, -1.21), **size)
        count, ways = self.beams.value, {"touched": self.touched.value, "mask": self.mask.value}
        sensor = Sensor("all round", count, -np.pi, 2 * np.pi / count, max_range=20.0)
        log = simulate(self.walls, self.poses, sensor=sensor, rng=np.random.default_rng(0))
        for pose, scan in zip(self.poses, log, strict=True):
            insert_variant(self.map, pose[:2], transform(pose, scan.points()), **ways)
        leaves, value = self.map.leaves(), self.map.leaf_occupancy()
        hit = leaves.occ > 0
        share = (value[hit] > 0.5).mean()
        self.walls_kept.value = f"{100 * share:.0f} % of {hit.sum()} hit cells above 0.5"
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


class ClassesPanel(LessonPanel):
    """The picture that a robot would get of a map, with both thresholds on sliders.

    A cell above the one is occupied, up to the other free. `doublings` says how often the side of a
    pixel is doubled.
    """

    classes: Classes
    occupied = slide(0.5, 0.5, 0.95, 0.05, "", label="occupied above")
    free = slide(0.25, 0.0, 0.45, 0.05, "", label="free up to")
    doublings = slide(0, 0, lambda p: min(4, p.map.tree.level), 1, "")
    counts = size = note()
    rows = ("occupied", "free", "doublings", "counts size")
    words = "{counts}"

    def __init__(self, map: QuadtreeMap) -> None:
        self.map = map
        self._begin()

    def _draw(self, figure: Figure) -> None:
        cells = self.classes = ros_classes(
            self.map,
            resolution=self.map.resolution * 2.0**self.doublings.value,
            occupied=self.occupied.value,
            free=self.free.value,
        )
        rows, columns = cells.greys.shape
        free, unknown, occupied = ((cells.greys == grey).sum() for grey in (254, 205, 0))
        self.counts.value = f"{free} free, {unknown} unknown, {occupied} occupied"
        self.size.value = f"{columns} x {rows} pixels of {cells.side:.3g} m"
        draw_classes(cells, ax=figure.subplots())


class StoragePanel(LessonPanel):
    """An aligned log kept as reduced segments and as a quadtree (A and B of one building).

    One of the two is drawn under the true walls in green. The tolerance is that of Fusion, which
    reduces the segments.

    Examples
    --------
    >>> from segmap_course import room_walk, room_walls
    >>> log = room_walk(20)
    >>> StoragePanel(log, log.truth, room_walls()).segments.value
    '12 segments, 0.4 kB, 0.9 mm off'
    """

    #: Of `compare_with_walls`.
    compared: pd.DataFrame
    resolution = slide(5.0, 1.0, 20.0, 0.5, "cm", label="cells")
    tolerance = slide(4.0, 1.0, 20.0, 0.5, "cm")
    tree = tick("draw the quadtree", True)
    segments = squares = note()
    rows = ("resolution", "tolerance", "tree", "segments squares")
    words = "{segments}; {squares}"

    def __init__(self, log: Log, poses: ArrayLike, walls: Segments) -> None:
        self.log, self.poses, self.walls = log, poses, arrays.segments(walls)
        self._begin()

    def _draw(self, figure: Figure) -> None:
        sizes = {"resolution": self.resolution.meant(), "tolerance": self.tolerance.meant()}
        forms = represent(self.log, self.poses, **sizes)
        self.compared = compare_with_walls(forms, self.walls)
        texts = (
            (self.segments, "reduced segments", "segments"),
            (self.squares, "quadtree", "leaves"),
        )
        for text, way, parts in texts:
            row: Any = self.compared.loc[way]
            taken = f"{int(row['parts'])} {parts}, {row['nbytes'] / 1e3:.1f} kB"
            text.value = f"{taken}, {1e3 * row['error']:.1f} mm off"
        ax = figure.subplots()
        if self.tree.value:
            draw_quadtree(forms["quadtree"].map, ax=ax)
        else:
            draw_segments(forms["reduced segments"].map, ax=ax, color=RESULT, width=2.5)
        draw_segments(self.walls, ax=ax, color=TRUTH, width=0.8)


class RoutePanel(LessonPanel):
    """The way of a robot to a goal that is moved, and the frontiers of the map.

    `told` is the length of the way, or why there is none; `way` is the way, `(k, 2)`, or None.

    Examples
    --------
    >>> tree = QuadtreeMap(resolution=0.1, size=3.2, free_resolution=0.1)
    >>> tree.insert_scan((0.5, 0.5), [(0.1, 0.1), (2.5, 0.5), (0.5, 2.5)])
    >>> RoutePanel(tree, (0.5, 0.5), (1.5, 0.5)).told.value
    'a way of 1.00 m, 0 corners'
    """

    method = route
    way: Array | None
    goal_x = slide(lambda p: p.goal[0], lambda p: p.box[0], lambda p: p.box[2], 0.1, label="goal x")
    goal_y = slide(lambda p: p.goal[1], lambda p: p.box[1], lambda p: p.box[3], 0.1, label="goal y")
    radius = keyword(0.05, 0.6, 0.05, value=0.25)
    told = open = note()
    rows = ("goal_x", "goal_y", "radius", "told", "open")
    words = "to ({goal_x:.1f}, {goal_y:.1f}) m with {radius:.2f} m: {told}"

    def __init__(self, map: QuadtreeMap, start: ArrayLike, goal: ArrayLike) -> None:
        self.map, self.start, self.goal = map, arrays.point(start), arrays.point(goal, "goal")
        self.box, self.frontiers = extent(map), frontiers(map)
        self._begin()

    def _draw(self, figure: Figure) -> None:
        ax = draw_quadtree(self.map, ax=figure.subplots(), outlines=False, robot=self.start)
        draw_frontiers(self.frontiers, ax=ax)
        goal, radius = (self.goal_x.value, self.goal_y.value), self.radius.meant()
        try:
            self.way = route(self.map, self.start, goal, radius=radius)
            length = np.hypot(*np.diff(self.way, axis=0).T).sum()
            self.told.value = f"a way of {length:.2f} m, {len(self.way) - 2} corners"
            ax.plot(*self.way.T, color=RESULT, linewidth=2)
        except NoRoute as why:
            self.way, self.told.value = None, str(why)
        ax.add_patch(Circle(goal, radius, fill=False, color=ERROR))
        ax.add_patch(Circle(tuple(self.start), radius, fill=False, color=RESULT))
        metres = sum(border.size for border in self.frontiers)
        self.open.value = f"{len(self.frontiers)} frontiers, {metres:.1f} m (dark yellow)"
