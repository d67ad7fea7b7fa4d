"""The occupancy map in a quadtree that grows by itself (B 4)."""

from __future__ import annotations

import copy
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from numpy.typing import ArrayLike

from .. import arrays
from ..arrays import LIMIT, Array, Count, Quantity, at_most, checked
from ..display import Pictured
from ..files import escape, read_npz, write_npz
from ..threads import Locked, locked
from . import _kernels as kernels
from ._tree import COORDINATES_UNIT, SMALLEST_CELL_M, Leaves, Tree, level_of, point_pairs

#: What a file calls itself, with the version of its layout.
FORMAT = "segmap quadtree 1"
#: What it holds: block, level, largest, x and y of the corner, bias, scans; resolution, x and y of
#: the corner, free resolution or 0, metres; both counts.
STORED = "state", "lengths", "vis", "occ"
NO_POINTS = np.empty((0, 2))
Resolution = Annotated[float, Quantity("metres", least=SMALLEST_CELL_M, most=LIMIT)]
#: A length that must fit the cells, see `level_of`.
Side = Annotated[float, Quantity("metres", most=1e300)]


class QuadtreeMap(Pictured, Locked):
    """Occupancy map of square leaves, small where ends of beams lie and large elsewhere (B 4).

    Each leaf counts the rays that crossed it (`vis`) and those that ended in it (`occ`). The root
    doubles when something lies outside it.

    Parameters
    ----------
    resolution : float
        Side of the smallest leaves.
    size : float or None
        Side of the root at first, 512 cells by default; a power of two of cells, at least 4.
    corner : (2,) array, metres
        Lower left corner of the root at first; cells are counted from here for ever.
    max_size : float or None
        Side that the root never exceeds, 65 536 cells by default; `size` times a power of two.
    bias : int
        Rays that have to cross a leaf until it counts as surely free.
    free_resolution : float or None
        Where given, space counts as free only where rays went, to this side: rays too split leaves
        larger than it, children keep the count of a leaf that is split, and after the scan four
        children that hold no end and as many rays each join again. A power of two of cells.

    Examples
    --------
    >>> tree = QuadtreeMap(resolution=0.01)
    >>> tree.insert_scan((1.0, 1.0), [(2.0, 1.0), (2.0, 1.5)])
    >>> tree
    QuadtreeMap(5.12 m, 49 leaves of 0.01 m and more, 1 scan)
    >>> tree.occupancy([(2.0, 1.0), (9.0, 9.0)])
    array([1. , 0.5])
    """

    @checked
    def __init__(
        self,
        *,
        resolution: Resolution = 0.01,
        size: Side | None = None,
        corner: ArrayLike = (0.0, 0.0),
        max_size: Side | None = None,
        bias: Annotated[Count, at_most(kernels.MOST_COUNT)] = 20,
        free_resolution: Side | None = None,
    ) -> None:
        cell = resolution
        level = 9 if size is None else level_of("size", size, cell, least=2)
        largest = max(level, 16) if max_size is None else level_of("max_size", max_size, cell)
        if not level <= largest < kernels.DEPTH:
            raise ValueError(
                f"max_size must not be below the size, {np.ldexp(cell, level):.6g} m, nor have "
                f"more than 2^{kernels.DEPTH - 1} cells a side, got {max_size}"
            )
        self.bias, self.corner = bias, arrays.point(corner, "corner")
        self.free_resolution, self._finest = free_resolution, None
        if free_resolution is not None:
            self._finest = level_of("free_resolution", free_resolution, cell)
        self.resolution, self.tree, self.scans = cell, Tree(level, largest), 0

    @locked
    def insert_scan(
        self, sensor_xy: ArrayLike, points: ArrayLike, free_points: ArrayLike | None = None
    ) -> None:
        """Add the rays of one scan, taken from a known place (B 4.2 to 4.4).

        All are places in the map's frame, metres: of the sensor, `(2,)`, of the ends of beams that
        met something, `(n, 2)`, and of those that met nothing, whose rays cross their last cell
        too. What lies beyond `max_size` is a ValueError, and the map stays as it is.

        Examples
        --------
        >>> tree = QuadtreeMap(resolution=1, size=4)
        >>> tree.insert_scan((0.5, 0.5), [(3.5, 0.5)], free_points=[(0.5, 3.5)])
        >>> tree.occupancy([(3.5, 0.5), (0.5, 3.5), (3.5, 3.5)])
        array([1.   , 0.475, 0.5  ])
        """
        sensor = sensor_xy
        if not (arrays.ready(sensor) and sensor.shape == (2,)):
            sensor = np.array(arrays.point(sensor, "sensor_xy", limit=np.inf))
        free = NO_POINTS if free_points is None else point_pairs("free_points", free_points)
        scan = kernels.Scan(sensor[None], point_pairs("points", points), free)
        arguments = scan, (self.corner, self.resolution), self._finest
        try:
            if not self.tree.insert(*arguments):
                arrays.point(sensor, "sensor_xy", limit=np.inf)
                cells = self._cells(sensor_xy=scan.sensor, points=scan.points, free_points=free)
                self.tree.grow(cells, self.resolution)
                self.tree.insert(*arguments)
            self.scans += 1
        except ValueError:  # refused, and the map is as it was
            raise
        except BaseException:  # interrupted: half a scan may be in, but in a tree
            self.tree.mend()
            raise

    @locked
    def occupancy(self, points: ArrayLike) -> Array:
        """How sure it is that something stands at points `(n, 2)`, metres; `(n,)` in 0..1 (B 4.1).

        `occ / vis` where ends were seen; else from 0.5 (unknown) down to 0 (surely free).
        """
        leaf = self.tree.leaves_at(self._cells(points=point_pairs("points", points)))
        inside = leaf >= 0
        return np.where(inside, self._occupancy(np.where(inside, leaf, 0)), 0.5)

    @locked
    def leaves(self) -> Leaves:
        """All leaves: lower left corners and sides, metres, both counts (B 4.1)."""
        node, cell, level = self.tree.leaves()
        x, y = (self.corner + (cell + self.tree.corner) * self.resolution).T
        side = np.ldexp(self.resolution, level)
        return Leaves(x, y, side, self.tree.vis[node], self.tree.occ[node])

    @locked
    def leaf_occupancy(self) -> Array:
        """Occupancy of all leaves, (n,) array in [0, 1], in the order of `leaves()` (B 4.1)."""
        return self._occupancy(self.tree.leaves()[0])

    @locked
    @checked
    def to_grid(
        self, resolution: float | None = None, *, value: Literal["max", "mean", "variance"] = "max"
    ) -> Array:
        """Occupancy on a grid over the whole root, `(rows, columns)`, row 0 lowest.

        Its cells are those of the map by default, or these times a power of two, up to the map's
        side. Then the largest occupancy of each counts, so that no obstacle gets lost; or the mean
        over its area, or the variance there: that of the four children, by the law of total
        variance from level to level (Kraetzschmar, Pages Gassull and Uhl 2004, in B 2.1). It is 0
        within a leaf.

        Examples
        --------
        >>> tree = QuadtreeMap(resolution=1, size=4)
        >>> tree.insert_scan((0.5, 0.5), [(3.5, 0.5)])
        >>> tree.to_grid(2)
        array([[0.475, 1.   ],
               [0.5  , 0.5  ]])
        >>> tree.to_grid(2, value="mean")[0]
        array([0.475  , 0.60625])
        """
        if value == "max":
            return self.rasterize(self.leaf_occupancy(), resolution=resolution)[0]
        k = self._level(resolution)
        _, cell, level = self.tree.leaves()
        mean = self.leaf_occupancy()
        variance = np.zeros(len(mean))
        for below in range(k):  # the four of a square come one after the other
            low = level == below
            four, spread = mean[low].reshape(-1, 4), variance[low].reshape(-1, 4)
            above, stay = four.reshape(-1, 2, 2).mean(2).mean(1), ~low
            stay[np.flatnonzero(low)[::4]] = True
            level[low], mean[low] = below + 1, np.repeat(above, 4)
            variance[low] = np.repeat((spread + (four - above[:, None]) ** 2).mean(1), 4)
            cell, level, mean, variance = cell[stay], level[stay], mean[stay], variance[stay]
        first = cell >> k
        last, grid = first + (1 << level - k)[:, None], np.zeros((1 << self.tree.level - k,) * 2)
        kernels.paint(first, last, mean if value == "mean" else variance, grid)
        return grid

    @locked
    def rasterize(
        self, values: ArrayLike, *, shown: ArrayLike | None = None, resolution: float | None = None
    ) -> tuple[Array, float, float, float]:
        """Values of the leaves, `(n,)`, on a grid: of several in one cell the largest counts.

        The grid `(rows, columns)`, row 0 lowest, holds the leaves that are `shown`, (n,) bool
        array, or the whole root. Returned with it are its lower left corner and the side of a cell,
        metres; `resolution` is as in `to_grid`.

        Examples
        --------
        >>> tree = QuadtreeMap(resolution=1, size=4)
        >>> tree.rasterize([0, 1, 2, 3], shown=[0, 0, 1, 1])
        (array([[2., 2., 3., 3.],
               [2., 2., 3., 3.]]), 0.0, 2.0, 1.0)
        """
        k = self._level(resolution)
        _, cell, level = self.tree.leaves()
        value = np.full(level.shape, arrays.numbers(values, "values"))
        part = np.full(level.shape, arrays.numbers(1 if shown is None else shown, "shown") != 0)
        if not part.any():
            raise ValueError("shown must hold at least one leaf, got none")
        first, last = cell >> k, ((cell + (1 << level)[:, None] - 1) >> k) + 1
        start, end = first[part].min(0), last[part].max(0)
        grid = np.full((end - start)[::-1], -np.inf)
        first, last = (np.clip(edge, start, end) - start for edge in (first, last))
        kernels.paint(first, last, value, grid)
        corner = self.corner + (self.tree.corner + (start << k)) * self.resolution
        return grid, *corner.tolist(), float(np.ldexp(self.resolution, k))

    @locked
    def cropped(self, left: float, low: float, right: float, high: float) -> QuadtreeMap:
        """What lies in a rectangle, metres, to the nearest cell; the rest becomes unknown.

        Examples
        --------
        >>> tree = QuadtreeMap(resolution=1, size=4)
        >>> tree.insert_scan((0.5, 0.5), [(3.5, 0.5)])
        >>> tree.cropped(1, 0, 3, 1).occupancy([(0.5, 0.5), (1.5, 0.5), (2.5, 0.5), (3.5, 0.5)])
        array([0.5  , 0.475, 0.475, 0.5  ])
        """
        corners = arrays.rectangle(left, low, right, high)
        cells = np.rint((corners - self.corner) / self.resolution) - self.tree.corner
        map = copy.deepcopy(self)
        map.tree.crop(cells.astype(np.int64))
        return map

    @property
    def nbytes(self) -> int:
        """Bytes that the tree uses: two counts of 4 bytes a node."""
        return 32 * self.tree.used

    @property
    def side(self) -> float:
        """Side of the root now, metres."""
        return float(np.ldexp(self.resolution, self.tree.level))

    @property
    @locked
    def bounds(self) -> tuple[float, float, float, float]:
        """Left, low, right and high edge of the root now, metres."""
        x_min, y_min = (self.corner + self.tree.corner * self.resolution).tolist()
        return x_min, y_min, x_min + self.side, y_min + self.side

    @locked
    def save(self, path: str | Path) -> None:
        """Write the map as NPZ, through a temporary file: whole or not at all.

        Examples
        --------
        >>> import tempfile
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     QuadtreeMap(resolution=0.5, size=2).save(f"{folder}/it.npz")
        ...     QuadtreeMap.load(f"{folder}/it.npz")
        QuadtreeMap(2 m, 4 leaves of 0.5 m and more, 0 scans)
        """
        tree = self.tree
        state = [tree.block, tree.level, tree.largest, *tree.corner, self.bias, self.scans]
        lengths = [self.resolution, *self.corner, self.free_resolution or 0.0]
        nodes = tree.vis[: 4 * tree.used], tree.occ[: 4 * tree.used]
        counts = dict(zip(STORED, (np.array(state), np.array(lengths), *nodes), strict=True))
        write_npz(arrays.file(path), FORMAT, counts)

    @classmethod
    def load(cls, path: str | Path) -> QuadtreeMap:
        """Read what `save` wrote.

        A ValueError says what is wrong with a file that is damaged or foreign, or unpacks to more
        than 1 MB and 50 times its size.
        """
        stored = read_npz(arrays.file(path), FORMAT)
        if set(stored) != set(STORED):
            raise ValueError(f"{escape(path)}: damaged, it holds {sorted(stored)}")
        state, lengths, vis, occ = (stored[name] for name in STORED)
        resolution, x, y, free = lengths.tolist()
        block, level, largest, *corner, bias, scans = state.tolist()
        sizes = {"size": np.ldexp(resolution, level), "max_size": np.ldexp(resolution, largest)}
        sizes |= {"corner": (x, y), "bias": bias, "free_resolution": free or None}
        map = cls(resolution=resolution, **sizes)
        map.scans, map.tree.vis, map.tree.occ, map.tree.used = scans, vis, occ, len(vis) // 4
        map.tree.block, map.tree.corner = block, np.array(corner)
        return map

    @locked
    def __repr__(self) -> str:
        leaves = f"{3 * self.tree.used + 1} leaves of {self.resolution:.6g} m and more"
        scans = f"{self.scans} scan" + "s" * (self.scans != 1)
        return f"QuadtreeMap({self.side:.6g} m, {leaves}, {scans})"

    def _level(self, resolution: float | None) -> int:
        """Level of the squares of a grid; the root's is the highest."""
        k = 0 if resolution is None else level_of("resolution", resolution, self.resolution)
        if k > self.tree.level:
            raise ValueError(f"resolution {resolution} is larger than the map, {self.side:.6g} m")
        return k

    def _cells(self, **named: Array) -> kernels.Cells:
        """Cells of points `(n, 2)`, counted from the root's; all must be finite."""
        together = np.concatenate(list(named.values()))
        cells = np.empty(together.shape, np.int64)
        root = self.tree.corner, 1 << self.tree.level
        frame = kernels.Frame(self.corner, self.resolution, *root)
        if kernels.cells_of(together, frame, cells) == 2:
            for name, points in named.items():
                arrays.table(points, name, 2, unit=COORDINATES_UNIT, limit=np.inf)
        return cells

    def _occupancy(self, node: kernels.Cells) -> Array:
        vis, occ = self.tree.vis[node], self.tree.occ[node]
        empty = np.maximum(0.5 * (self.bias - vis) / self.bias, 0.0)
        return np.where(occ > 0, occ / np.maximum(vis, 1), empty)
