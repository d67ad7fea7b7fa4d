"""The picture of a live map: drawn in a few milliseconds, however large the map has become."""

from __future__ import annotations

import io
from math import ceil, floor
from typing import Any

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from PIL import Image

from ..arrays import Array
from ..plotting import ERROR, RAW, RESULT
from ..poses import compose, transform
from ..quadtree import QuadtreeMap, extent
from ..scans import LaserScan
from ._base import DPI, HEIGHT, WIDTH

#: Of 0 to 9: a third of the size of no packing, in a tenth of the time of the best.
PACKING = 2
#: A cell is a square of one grey.
SHARP: Any = {"interpolation": "nearest"}
#: Space around what was seen, as a part of the larger of width and height.
MARGIN = 0.08
#: Cells that are drawn are at least so large a part of a pixel.
PIXEL = 0.6

Bounds = tuple[float, float, float, float]


class LivePicture:
    """One figure whose parts are moved; frame and numbers are drawn only where they change."""

    def __init__(self) -> None:
        self.figure = Figure((WIDTH / DPI, HEIGHT / DPI), dpi=DPI)
        self.canvas: Any = FigureCanvasAgg(self.figure)
        self.axes = self.figure.add_axes((0.09, 0.12, 0.89, 0.86), aspect="equal")
        self.axes.set(xlabel="x [m]", ylabel="y [m]", facecolor="#808080")
        self.grey = self.axes.imshow(np.full((1, 1), 0.5), cmap="gray", vmin=0, vmax=1, **SHARP)
        self.points = self.axes.plot([], [], ".", color=RAW, markersize=2)[0]
        self.walls = LineCollection([], color=RESULT, linewidth=2)
        self.axes.add_collection(self.walls, autolim=False)
        self.reduced = LineCollection([], color=RESULT, linewidth=1)
        self.axes.add_collection(self.reduced, autolim=False)
        self.robot = self.axes.plot([], [], "o", color=ERROR, markersize=6)[0]
        self.parts = (self.grey, self.points, self.walls, self.reduced, self.robot)
        for part in self.parts:
            part.set_animated(True)
        self.greys = Greys()
        self.frame: Any = None

    def show(
        self,
        map: QuadtreeMap,
        scan: LaserScan,
        pose: Array,
        segments: Array,
        reduced: Array | None = None,
    ) -> None:
        """Map grey, scan grey dots, segments blue, the reduced map thin and blue, sensor red."""
        ends, sensor = transform(pose, scan.points()), compose(pose, scan.sensor_pose)[:2]
        if self.greys.update(map, np.vstack([sensor, ends])):
            left, low, right, high = self.greys.view
            self.axes.set(xlim=(left, right), ylim=(low, high))
            self.grey.set_extent(self.greys.extent)
            self.frame = None
        self.grey.set_data(1 - self.greys.grid[::-1])
        self.points.set_data(*ends.T)
        self.walls.set_segments(list(segments))
        self.reduced.set_segments([] if reduced is None else list(reduced))
        self.robot.set_data(*sensor[:, None])

    def png(self) -> bytes:
        """The picture; packed quickly rather than well."""
        if self.frame is None:
            self.canvas.draw()
            self.frame = self.canvas.copy_from_bbox(self.figure.bbox)
        self.canvas.restore_region(self.frame)
        for part in self.parts:
            self.axes.draw_artist(part)
        pixels = Image.fromarray(np.asarray(self.canvas.buffer_rgba())[..., :3].copy())
        target = io.BytesIO()
        pixels.save(target, format="png", compress_level=PACKING)
        return target.getvalue()


class Greys:
    """Occupancy of a map where it is drawn; only what the newest scan can change is asked again.

    Attributes
    ----------
    view : (4,) tuple, metres
        Left, low, right and high edge of what is drawn: whole metres, so that it changes only when
        the map grows.
    side : float, metres
        Of a cell of the grid: that of the map, or twice, four times ... as much in a large one.
    grid : (rows, columns) array, lowest row first
    """

    def __init__(self) -> None:
        self.tree: object = None
        self.view: Bounds = (0.0, 0.0, 0.0, 0.0)
        self.side, self.grid = 1.0, np.zeros((0, 0))

    def update(self, map: QuadtreeMap, seen: Array) -> bool:
        """Take in a scan, its sensor and ends `(n, 2)`, metres; True where the view has changed."""
        cells = map.corner + map.resolution * np.floor((seen - map.corner) / map.resolution)
        around = *cells.min(0), *(cells.max(0) + map.resolution)
        if map.tree is not self.tree:  # another map, or one that was made anew
            self.tree, self.hit = map.tree, extent(map, margin=0)
            return self._whole(map)
        self.hit = joined(self.hit, around) if len(seen) > 1 else self.hit
        if self._wanted() != self.view:
            return self._whole(map)
        self._part(map, around)
        return False

    @property
    def extent(self) -> tuple[float, float, float, float]:
        """Left, right, low and high edge of the grid, metres."""
        (left, low), (rows, columns) = self.view[:2], self.grid.shape
        return left, left + columns * self.side, low, low + rows * self.side

    def _wanted(self) -> Bounds:
        left, low, right, high = self.hit
        space = MARGIN * max(right - left, high - low)
        return floor(left - space), floor(low - space), ceil(right + space), ceil(high + space)

    def _whole(self, map: QuadtreeMap) -> bool:
        self.view, self.side = self._wanted(), map.resolution
        width, height = self.view[2] - self.view[0], self.view[3] - self.view[1]
        while self.side < PIXEL * max(width / WIDTH, height / HEIGHT):
            self.side *= 2
        shape = ceil(height / self.side - 1e-9), ceil(width / self.side - 1e-9)
        self.grid = occupancy(map, self.view[:2], shape, self.side)
        return True

    def _part(self, map: QuadtreeMap, around: Bounds) -> None:
        """Ask again where rays went: leaves that they split are at most as large as this margin."""
        margin = map.free_resolution or map.side
        left, low = self.view[:2]
        reach = (around[0] - margin, around[1] - margin, around[2] + margin, around[3] + margin)
        first = [max(floor((reach[k] - self.view[k]) / self.side), 0) for k in (1, 0)]
        last = [ceil((reach[k + 2] - self.view[k]) / self.side) for k in (1, 0)]
        row, column = first
        part = self.grid[row : last[0], column : last[1]]
        corner = left + column * self.side, low + row * self.side
        part[:] = occupancy(map, corner, part.shape, self.side)


def joined(a: Bounds, b: Bounds) -> Bounds:
    """The bounds that hold both: left, low, right and high."""
    return min(a[0], b[0]), min(a[1], b[1]), max(a[2], b[2]), max(a[3], b[3])


def occupancy(
    map: QuadtreeMap, corner: tuple[float, float], shape: tuple[int, ...], side: float
) -> Array:
    """Occupancy of square cells of a side from a lower left corner on, metres, lowest row first.

    That of about their middles; where cells of the map in one are occupied, the largest of theirs.
    """
    rows, columns = shape
    aside = map.resolution / 4 if side > map.resolution else 0.0  # off the edges of the map's cells
    x, y = (corner[k] + side * (np.arange(n) + 0.5) + aside for k, n in enumerate((columns, rows)))
    grid = map.occupancy(np.stack(np.meshgrid(x, y), -1).reshape(-1, 2)).reshape(rows, columns)
    if side > map.resolution and grid.size:
        low = np.floor((np.array(corner) - map.corner) / map.resolution).astype(int)
        size = np.ceil(side / map.resolution * np.array([columns, rows])).astype(int)
        window = np.concatenate([low, low + size]) - np.tile(map.tree.corner, 2)
        cells = map.tree.occupied_cells(window) + map.tree.corner
        centres = map.corner + map.resolution * (cells + 0.5)
        column, row = np.floor((centres - corner) / side).astype(int).T
        inside = (column >= 0) & (column < columns) & (row >= 0) & (row < rows)
        np.maximum.at(grid, (row[inside], column[inside]), map.occupancy(centres[inside]))
    return grid
