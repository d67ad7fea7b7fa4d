"""The occupancy map in a quadtree that grows by itself (B 4)."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from .._display import Pictured
from ..arrays import Array
from . import _loops as loops
from ._arguments import check_finite, check_whole, level_of, levels_of, point
from ._arguments import points as pairs
from ._file import read_map, write_map
from ._leaves import Leaves, counted
from ._tree import Tree
from ._whole_loops import painted

if TYPE_CHECKING:
    import pandas as pd


class QuadtreeMap(Pictured):
    """Occupancy map of square leaves, small where ends of beams lie and large elsewhere (B 4).

    Each leaf counts the rays that crossed it (`vis`) and those that ended in it (`occ`). The root
    doubles when something lies outside it.

    Parameters
    ----------
    resolution : float, metres
        Side of the smallest leaves.
    size : float, metres, or None
        Side of the root at first, 512 cells by default; a power of two of cells, at least 4.
    corner : (2,) array, metres
        Lower left corner of the root at first; cells are counted from here for ever.
    max_size : float, metres, or None
        Side that the root never exceeds, 65 536 cells by default; `size` times a power of two.
    bias : int
        Rays that have to cross a leaf until it counts as surely free.
    free_resolution : float, metres, or None
        Where given, space counts as free only where rays went, to this side: rays too split leaves
        larger than it (step 3, before any is counted), all splits hand their counts on to the
        children instead of resetting them, and after the scan four children that hold no end
        and as many rays each join again. A power of two of cells.

    Raises
    ------
    ValueError
        For sizes that do not fit together, a bias below 1, a corner that is not finite.

    Examples
    --------
    >>> map = QuadtreeMap(resolution=0.01)
    >>> map.insert_scan((1.0, 1.0), [(2.0, 1.0), (2.0, 1.5)])
    >>> map
    QuadtreeMap(5.12 m, 49 leaves of 0.01 m and more, 1 scan)
    >>> map.occupancy([(2.0, 1.0), (9.0, 9.0)])
    array([1. , 0.5])
    """

    def __init__(
        self,
        *,
        resolution: float = 0.01,
        size: float | None = None,
        corner: ArrayLike = (0.0, 0.0),
        max_size: float | None = None,
        bias: int = 20,
        free_resolution: float | None = None,
    ) -> None:
        level, largest = levels_of(resolution, size, max_size, loops.DEPTH - 1)
        self.resolution, self.scans = float(resolution), 0
        self.bias = check_whole("bias", bias, 2**31 - 1)
        self.corner = point("corner", corner)
        check_finite(corner=self.corner)
        self.free_resolution = free_resolution
        finest = resolution if free_resolution is None else free_resolution
        self._free = level_of("free_resolution", finest, resolution)
        self.tree = Tree(level, largest)

    def insert_scan(
        self, sensor_xy: ArrayLike, points: ArrayLike, free_points: ArrayLike | None = None
    ) -> None:
        """Add the rays of one scan, taken from a known place (B 4.2 to 4.4).

        Parameters
        ----------
        sensor_xy : (2,) array, metres
            Where the sensor was, in the map's frame.
        points : (n, 2) array, metres
            Ends of the beams that met something.
        free_points : (m, 2) array, metres, or None
            Ends of the beams that met nothing: their rays cross their last cell too.

        Raises
        ------
        ValueError
            For other shapes, coordinates that are not finite or lie beyond `max_size`; the map is
            then as it was.

        Examples
        --------
        >>> map = QuadtreeMap(resolution=1, size=4)
        >>> map.insert_scan((0.5, 0.5), [(3.5, 0.5)], free_points=[(0.5, 3.5)])
        >>> map.occupancy([(3.5, 0.5), (0.5, 3.5), (3.5, 3.5)])
        array([1.   , 0.475, 0.5  ])
        """
        cells = self.cells_of_scan(sensor_xy, points, free_points)
        try:
            self._insert(*cells)
        except BaseException:  # interrupted: half a scan may be in, but in a tree
            self.tree.mend()
            raise

    def _insert(self, sensor: loops.Cells, ends: loops.Cells, free: loops.Cells) -> None:
        tree, split_free = self.tree, self.free_resolution is not None
        # Steps 1 and 2: end points, each in a cell of its own
        tree.split_to(ends, inherit=split_free)
        tree.count_ends(ends)
        # Step 3: rays, on the tree as it is now; those that ended leave out their last two steps
        if split_free:
            tree.split_along(sensor, ends, 2, self._free)
            tree.split_along(sensor, free, 0, self._free)
        tree.count_rays(sensor, ends, 2)
        tree.count_rays(sensor, free, 0)
        if split_free:
            tree.join()
        self.scans += 1

    def occupancy(self, points: ArrayLike) -> Array:
        """How sure it is that something stands at each point, `(n,)` in [0, 1] (B 4.1).

        Parameters
        ----------
        points : (n, 2) array, metres

        Returns
        -------
        (n,) array
            `occ / vis` where ends were seen; else from 0.5 (unknown) down to 0 (surely free).

        Raises
        ------
        ValueError
            For another shape, or values that are not finite.
        """
        leaf = self.tree.leaves_at(self._cells(points=pairs("points", points))[0])
        inside = leaf >= 0
        return np.where(inside, self._occupancy(np.where(inside, leaf, 0)), 0.5)

    def leaves(self) -> Leaves:
        """All leaves: lower left corners and sides, metres, both counts (B 4.1)."""
        node, cell, level = self.tree.leaves()
        left, low = (self.corner + (cell + self.tree.corner) * self.resolution).T
        side = np.ldexp(self.resolution, level)
        return Leaves(left, low, side, self.tree.vis[node], self.tree.occ[node])

    def leaf_occupancy(self) -> Array:
        """Occupancy of all leaves, (n,) array in [0, 1], in the order of `leaves()` (B 4.1)."""
        return self._occupancy(self.tree.leaves()[0])

    def to_grid(self, resolution: float | None = None) -> Array:
        """Occupancy on a grid over the whole root, `(rows, columns)`, row 0 lowest.

        Parameters
        ----------
        resolution : float, metres, or None
            The map's own by default, or this times a power of two: then the largest occupancy of
            each cell counts, so that no obstacle gets lost.

        Raises
        ------
        ValueError
            For a resolution that is no power of two of cells, or larger than the map.

        Examples
        --------
        >>> map = QuadtreeMap(resolution=1, size=4)
        >>> map.insert_scan((0.5, 0.5), [(3.5, 0.5)])
        >>> map.to_grid(2)
        array([[0.475, 1.   ],
               [0.5  , 0.5  ]])
        """
        k = self.level_of(resolution)
        node, cell, level = self.tree.leaves()
        side = 1 << (self.tree.level - k)
        return painted(side, side, cell >> k, level - k, self._occupancy(node))

    def level_of(self, resolution: float | None) -> int:
        """How often the map's cells double up to this side, metres; errors as `to_grid`."""
        wanted = self.resolution if resolution is None else resolution
        k = level_of("resolution", wanted, self.resolution)
        if k > self.tree.level:
            raise ValueError(f"resolution {resolution} is larger than the map, {self.side:.6g} m")
        return k

    def statistics(self) -> pd.DataFrame:
        """Leaves by side, and the bytes that they and a grid of single bytes take.

        Examples
        --------
        >>> QuadtreeMap(resolution=0.5, size=2).statistics()
                         count
        leaves of 1 m        4
        leaves               4
        bytes               32
        bytes of a grid     16
        """
        level = self.tree.leaves()[2]
        return counted(level, self.resolution, self.nbytes, self.tree.level)

    @property
    def nbytes(self) -> int:
        """Bytes that the tree uses: two counts of 4 bytes a node."""
        return 32 * self.tree.used

    @property
    def side(self) -> float:
        """Side of the root now, metres."""
        return float(np.ldexp(self.resolution, self.tree.level))

    @property
    def bounds(self) -> tuple[float, float, float, float]:
        """Left, low, right and high edge of the root now, metres."""
        left, low = (self.corner + self.tree.corner * self.resolution).tolist()
        return left, low, left + self.side, low + self.side

    def save(self, path: str | Path) -> None:
        """Write the map as NPZ, through a temporary file: whole or not at all.

        Raises
        ------
        OSError
            For a folder that does not exist, or cannot be written to.

        Examples
        --------
        >>> import tempfile
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     QuadtreeMap(resolution=0.5, size=2).save(f"{folder}/it.npz")
        ...     QuadtreeMap.load(f"{folder}/it.npz")
        QuadtreeMap(2 m, 4 leaves of 0.5 m and more, 0 scans)
        """
        write_map(Path(path), self)

    @classmethod
    def load(cls, path: str | Path) -> QuadtreeMap:
        """Read what `save` wrote; an example is there.

        Raises
        ------
        ValueError
            For a file that is damaged or foreign, saying what is wrong with it.
        FileNotFoundError
        """
        return read_map(Path(path), cls)

    def __repr__(self) -> str:
        leaves, count = 3 * self.tree.used + 1, f"{self.scans} scan" + "s" * (self.scans != 1)
        return (
            f"QuadtreeMap({self.side:.6g} m, {leaves} leaves of {self.resolution:.6g} m and more, "
            f"{count})"
        )

    def cells_of_scan(
        self, sensor_xy: ArrayLike, points: ArrayLike, free_points: ArrayLike | None = None
    ) -> tuple[loops.Cells, loops.Cells, loops.Cells]:
        """Cells of the sensor and of both kinds of ends, in a root that holds them all."""
        sensor = point("sensor_xy", sensor_xy)[None]
        ends, last = pairs("points", points), pairs("free_points", free_points)
        cells, inside = self._cells(sensor_xy=sensor, points=ends, free_points=last)
        cells = cells if inside else cells + self._grow(cells)
        return cells[0], cells[1 : len(ends) + 1], cells[len(ends) + 1 :]

    def _cells(self, **named: Array) -> tuple[loops.Cells, bool]:
        """Cells of points `(n, 2)`, counted from the root's, and whether it holds them all."""
        root = self.tree.corner, 1 << self.tree.level
        together = np.concatenate(list(named.values()))
        cells, finite, inside = loops.cells_of(together, self.corner, self.resolution, *root)
        if not finite:
            check_finite(**named)
        return cells, inside

    def _grow(self, cells: loops.Cells) -> loops.Cells:
        """Grow to hold cells `(n, 2)`; returns `(2,)`, how much further the root's corner is."""
        before = self.tree.corner
        try:
            self.tree.grow(cells)
        except ValueError as error:
            most = np.ldexp(self.resolution, self.tree.largest)
            raise ValueError(
                f"the scan reaches beyond max_size, {most:.6g} m, with {error} of "
                f"{self.resolution:.6g} m: the map is as it was"
            ) from None
        return before - self.tree.corner

    def _occupancy(self, node: loops.Cells) -> Array:
        vis, occ = self.tree.vis[node], self.tree.occ[node]
        empty = np.maximum(0.5 * (self.bias - vis) / self.bias, 0.0)
        return np.where(occ > 0, occ / np.maximum(vis, 1), empty)
