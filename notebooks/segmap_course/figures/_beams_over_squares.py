"""A robot, the ends of its beams, and the squares of a quadtree that its beams cross (B 4.4)."""

from __future__ import annotations

from math import floor
from typing import NamedTuple

import numpy as np
import traitlets
from matplotlib.axes import Axes
from numpy.typing import ArrayLike

from segmap import arrays
from segmap.arrays import Metres, checked

from ..drawings import draw_counts
from ..literal.quadtrees.quadtree import (
    Cell,
    Square,
    count_ray,
    crossed_cells,
    leaf_of,
    quarters,
    split,
)
from ._drag_figure import DragFigure, module_text


class Crossed(NamedTuple):
    """Leaves -> rays that crossed and ends; how many were crossed; beams through others' ends."""

    leaves: dict[Square, tuple[int, int]]
    crossed: int
    through: int


class DragBeams(DragFigure):
    """A robot, `(2,)`, and ends of its beams, `(n, 2)`, metres, over a root of so many cells.

    The robot and each end are dragged. Leaves are cut where beams end; a beam crosses the leaves
    that hold one of its cells, but for its end and the eight cells around it.

    Examples
    --------
    >>> figure = DragBeams((0.05, 0.05), [(0.75, 0.05), (0.75, 0.75)], cells=8)
    >>> figure
    DragBeams(3 of 16 leaves are crossed; 0 times a beam crosses a cell in which another ended)
    """

    module = "beams_over_squares"
    _esm = module_text(module)
    robot = traitlets.List(traitlets.Float()).tag(sync=True)
    ends = traitlets.List(traitlets.List(traitlets.Float())).tag(sync=True)
    #: Cells along a side of the root, a power of two.
    cells = traitlets.Int().tag(sync=True)
    #: Side of a cell, metres.
    resolution = traitlets.Float().tag(sync=True)

    @checked
    def __init__(
        self, robot: ArrayLike, ends: ArrayLike, *, cells: int = 32, resolution: Metres = 0.1
    ) -> None:
        super().__init__(
            robot=arrays.point(robot, "robot").round(4).tolist(),
            ends=arrays.points(ends, "ends").round(4).tolist(),
            cells=cells,
            resolution=resolution,
        )

    def measure(self) -> Crossed:
        """What the beams cross from here."""
        root = 0, 0, self.cells
        leaves = dict.fromkeys(quarters(root), (0, 0))
        ends = [self._cell(end) for end in self.ends]
        for end in ends:
            split(leaves, root, end)
        for end in ends:
            leaf = leaf_of(leaves, root, end)
            leaves[leaf] = 0, leaves[leaf][1] + 1
        for end in ends:
            count_ray(leaves, root, crossed_cells(self._cell(self.robot), end))
        crossed = sum(rays > 0 for rays, _ in leaves.values())
        return Crossed(leaves, crossed, sum(rays for rays, hits in leaves.values() if hits))

    def _cell(self, place: list[float]) -> Cell:
        x, y = (min(self.cells - 1, max(0, floor(v / self.resolution))) for v in place)
        return x, y

    def __repr__(self) -> str:
        now = self.measure()
        return (
            f"DragBeams({now.crossed} of {len(now.leaves)} leaves are crossed; "
            f"{now.through} times a beam crosses a cell in which another ended)"
        )

    def draw(self, ax: Axes) -> None:
        """Draw what was crossed white, what was hit black, all else grey; and the beams."""
        pairs = np.array([[self.robot, end] for end in self.ends])
        shown = {
            leaf: (20 * rays * (not hits) + hits, hits)
            for leaf, (rays, hits) in self.measure().leaves.items()
        }
        draw_counts(shown, beams=pairs, resolution=self.resolution, ax=ax)
