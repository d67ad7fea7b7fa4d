"""The picture of a live map: drawn in a few milliseconds, however large the map has become."""

from __future__ import annotations

import io
from math import ceil, floor, log2
from typing import Any

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from PIL import Image  # matplotlib brings it

from ..arrays import Array
from ..plotting import ERROR, RAW, RESULT
from ..poses import compose, transform
from ..quadtree import QuadtreeMap, extent
from ..scans import LaserScan
from ._base import PANEL_DPI, PANEL_HEIGHT, PANEL_WIDTH

#: Of 0 to 9: little larger than the best, in a tenth of its time.
PACKING = 1
#: Where the axes are, in parts of the figure: left, low, width and height.
AXES = (0.09, 0.12, 0.89, 0.86)
#: Numbers at each axis, at most: text is what takes time in a frame.
MOST_AXIS_NUMBERS = 5
#: Space around what was seen, as a part of the larger of width and height.
MARGIN = 0.08
#: Cells that are drawn are at least about so large a part of a pixel.
PIXEL = 0.7
#: Edges of the view lie at multiples of so many cells, so that it seldom changes.
VIEW_STEP_CELLS = 16

Bounds = tuple[float, float, float, float]


class LivePicture:
    """One figure whose parts are moved; frame and numbers are drawn only where they change."""

    def __init__(self) -> None:
        self.figure = Figure((PANEL_WIDTH / PANEL_DPI, PANEL_HEIGHT / PANEL_DPI), dpi=PANEL_DPI)
        self.canvas: Any = FigureCanvasAgg(self.figure)
        self.axes = self.figure.add_axes(AXES, aspect="equal")
        self.axes.set(xlabel="x [m]", ylabel="y [m]", facecolor="#808080")
        self.axes.locator_params(nbins=MOST_AXIS_NUMBERS)
        self.points = self.axes.plot([], [], ".", color=RAW, markersize=2)[0]
        self.walls = self.axes.plot([], [], color=RESULT, linewidth=2)[0]
        self.reduced = self.axes.plot([], [], color=RESULT, linewidth=1)[0]
        self.robot = self.axes.plot([], [], "o", color=ERROR, markersize=6)[0]
        self.parts = (self.points, self.walls, self.reduced, self.robot)
        self.greys, self.moved = Greys(), True

    def show(
        self,
        map: QuadtreeMap,
        scan: LaserScan,
        pose: Array,
        segments: Array,
        reduced: Array | None = None,
    ) -> None:
        """Map grey, scan grey dots, segments blue, the reduced map thin and blue, sensor orange."""
        ends, sensor = transform(pose, scan.points()), compose(pose, scan.sensor_pose)[:2]
        if self.greys.update(map, np.vstack([sensor, ends])):
            x_min, y_min, x_max, y_max = self.greys.view
            self.axes.set(xlim=(x_min, x_max), ylim=(y_min, y_max))
            self.moved = True
        self.points.set_data(*ends.T)
        self.walls.set_data(*as_broken_line(segments))
        self.reduced.set_data(*as_broken_line(segments[:0] if reduced is None else reduced))
        self.robot.set_data(*sensor[:, None])

    def png(self) -> bytes:
        """The picture; packed quickly rather than well."""
        if self.moved:
            self.canvas.draw()
            self._place()
            self.moved = False
        pixels = np.asarray(self.canvas.buffer_rgba())[..., :3]
        pixels[self.window] = (255 * (1 - self.greys.grid[self.cells]) + 0.5)[..., None]
        for part in self.parts:
            self.axes.draw_artist(part)
        packed = io.BytesIO()
        Image.fromarray(pixels).save(packed, "png", compress_level=PACKING)
        return packed.getvalue()

    def _place(self) -> None:
        """Find the pixels within the axes, and the cell of the grid about the middle of each."""
        first, last = self.axes.bbox.get_points().round().astype(int)
        top, bottom = self.figure.bbox.height - np.array([last[1], first[1]])
        self.window = slice(int(top), int(bottom)), slice(first[0], last[0])
        middles = self.axes.transData.inverted().transform([first + 0.5, last - 0.5])
        cell = (middles - self.greys.view[:2]) / self.greys.side
        most = np.array(self.greys.grid.shape[::-1]) - 1
        column, row = (
            np.linspace(cell[0, k], cell[1, k], last[k] - first[k]).astype(int).clip(0, most[k])
            for k in (0, 1)
        )
        self.cells = np.ix_(row[::-1], column)


def as_broken_line(segments: Array) -> Array:
    """Segments `(n, 2, 2)` as x and y of one line, `(2, 3 n)`, that is broken after each."""
    return np.insert(segments, 2, np.nan, axis=1).reshape(-1, 2).T


class Greys:
    """Occupancy of a map where it is drawn; in one view only what a scan can change is asked again.

    `view` is left, low, right and high edge of what is drawn: multiples of some cells, so that it
    changes only when the map has grown by as much. `side` is that of a cell of `grid`, lowest row
    first: that of the map, or twice, four times ... as much in a large one.
    """

    def __init__(self) -> None:
        self.tree: object = None
        self.view: Bounds = (0.0, 0.0, 0.0, 0.0)
        self.side, self.grid = 1.0, np.full((1, 1), 0.5)

    def update(self, map: QuadtreeMap, seen: Array) -> bool:
        """Take in a scan, its sensor and ends `(n, 2)`, metres; True where the view has changed."""
        cells = map.corner + map.resolution * np.floor((seen - map.corner) / map.resolution)
        around = *cells.min(0), *(cells.max(0) + map.resolution)
        before = self.view, self.side
        if anew := map.tree is not self.tree:  # another map, or one that was made again
            self.tree, self.hit = map.tree, extent(map, margin=0)
        elif len(seen) > 1:
            low, high = np.minimum(self.hit[:2], around[:2]), np.maximum(self.hit[2:], around[2:])
            self.hit = *low.tolist(), *high.tolist()
        self.view, self.side = _view_of(self.hit, map.resolution)
        if changed := (self.view, self.side) != before:
            x_min, y_min, x_max, y_max = self.view
            self.grid = np.empty(
                (round((y_max - y_min) / self.side), round((x_max - x_min) / self.side))
            )
        self._ask(map, self.view if changed or anew else around)
        return changed

    def _ask(self, map: QuadtreeMap, around: Bounds) -> None:
        """Ask again where rays went: leaves that they split are at most as large as this margin."""
        margin = map.free_resolution or map.side
        reach = (around[0] - margin, around[1] - margin, around[2] + margin, around[3] + margin)
        first = [max(floor((reach[k] - self.view[k]) / self.side), 0) for k in (1, 0)]
        last = [ceil((reach[k + 2] - self.view[k]) / self.side) for k in (1, 0)]
        part = self.grid[first[0] : last[0], first[1] : last[1]]
        corner = self.view[0] + first[1] * self.side, self.view[1] + first[0] * self.side
        part[:] = occupancy(map, corner, part.shape, self.side)


def _view_of(hit: Bounds, resolution: float) -> tuple[Bounds, float]:
    """What is drawn of a map, by what was hit, and the side of a cell that is drawn, metres."""
    x_min, y_min, x_max, y_max = hit
    space = MARGIN * max(x_max - x_min, y_max - y_min)
    x_min, y_min, x_max, y_max = x_min - space, y_min - space, x_max + space, y_max + space
    wide, tall = x_max - x_min, y_max - y_min
    pixel = max(wide / (AXES[2] * PANEL_WIDTH), tall / (AXES[3] * PANEL_HEIGHT))
    side = resolution * 2 ** max(ceil(log2(PIXEL * pixel / resolution)), 0)
    step = VIEW_STEP_CELLS * side
    x_min, y_min = step * floor(x_min / step), step * floor(y_min / step)
    return (x_min, y_min, step * ceil(x_max / step), step * ceil(y_max / step)), side


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
        with map.lock:
            window = np.concatenate([low, low + size]) - np.tile(map.tree.corner, 2)
            cells = map.tree.occupied_cells(window) + map.tree.corner
        centres = map.corner + map.resolution * (cells + 0.5)
        column, row = np.floor((centres - corner) / side).astype(int).T
        inside = (column >= 0) & (column < columns) & (row >= 0) & (row < rows)
        np.maximum.at(grid, (row[inside], column[inside]), map.occupancy(centres[inside]))
    return grid
