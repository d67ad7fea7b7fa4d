"""Exercises of the chapters on the quadtree: cells, growth, occupancy, rays, and exported pictures.

`ray_cells` is the walk of B as its prose says it; the map walks leaf by leaf and takes the same.
"""

from math import floor
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ._exercise import Case, Exercise, Mistake, numbers

Cell = tuple[int, int]
Cells = NDArray[np.int64]


# ------------------------------------------------------------------------------ cells
def _cell_of(x: float, corner: float, resolution: float) -> int:
    return floor((x - corner) / resolution)


check_cell_of = Exercise(
    "cell_of",
    "cell_of(x, corner, resolution) -> int: the column that holds x, counted from the corner",
    _cell_of,
    tuple(
        Case(f"x = {x}, corner {c}, cells of {r} m", (x, c, r))
        for x, c, r in (
            *((0.26, 0.0, 0.1), (-0.05, 0.0, 0.1), (-0.31, 0.0, 0.1)),
            *((1.0, 0.0, 0.1), (0.3, 0.0, 0.1), (2.9, 2.0, 0.25)),
        )
    ),
    (
        Mistake(
            "towards zero",
            lambda x, c, r: int((x - c) / r),
            "int() cuts towards zero: -0.5 becomes 0, so two columns share one number; use floor",
        ),
        Mistake(
            "floor division",
            lambda x, c, r: int((x - c) // r),
            "1.0 // 0.1 is 9, as 0.1 is a little more than a tenth: divide first, then take floor",
        ),
        Mistake(
            "inverse",
            lambda x, c, r: floor((x - c) * (1 / r)),
            "0.3 * (1 / 0.1) is 3, and 0.3 / 0.1 is a little less: divide, do not multiply",
        ),
        Mistake(
            "nearest",
            lambda x, c, r: round((x - c) / r),
            "a cell begins at its left edge: floor, and not the nearest whole number",
        ),
        Mistake(
            "corner forgotten",
            lambda x, c, r: floor(x / r),
            "columns are counted from the corner: subtract it first",
        ),
    ),
)


# ----------------------------------------------------------------------------- growth
def _grown(root: tuple[int, int, int], cell: Cell) -> tuple[int, int, int]:
    x, y, side = root
    return x - side * (cell[0] < x), y - side * (cell[1] < y), 2 * side


def _down_unless_above(root: tuple[int, int, int], cell: Cell) -> tuple[int, int, int]:
    x, y, side = root
    return x - side * (cell[0] < x), y - side * (not cell[1] >= y + side), 2 * side


check_grown = Exercise(
    "grown",
    "grown(root, cell) -> (x, y, side): root (x, y, side), doubled once towards a cell outside it",
    _grown,
    tuple(
        Case(f"root {root} and cell {cell}", (root, cell))
        for root, cell in (
            *(((0, 0, 8), (3, 8)), ((0, 0, 8), (8, 3)), ((0, 0, 8), (-1, 3))),
            *(((4, -4, 4), (5, -9)), ((0, 0, 8), (-3, 20)), ((-8, -8, 16), (100, -100))),
        )
    ),
    (
        Mistake(
            "down unless above",
            _down_unless_above,
            "for a cell beside the root this grows downwards for ever, as the thesis does: "
            "down only where the cell lies below",
        ),
        Mistake(
            "always up",
            lambda root, cell: (*root[:2], 2 * root[2]),
            "a cell to the left or below is never reached this way: move the corner by one side",
        ),
        Mistake(
            "side kept",
            lambda root, cell: (*_grown(root, cell)[:2], root[2]),
            "the root doubles: the new side is twice the old one",
        ),
        Mistake(
            "moved by the new side",
            lambda root, cell: (
                root[0] - 2 * root[2] * (cell[0] < root[0]),
                root[1] - 2 * root[2] * (cell[1] < root[1]),
                2 * root[2],
            ),
            "the old root must stay one quarter of the new: the corner moves by the old side",
        ),
    ),
)


# -------------------------------------------------------------------------- occupancy
def _occupancy(vis: int, occ: int, bias: int) -> float:
    return occ / vis if occ else max(0.5 * (bias - vis) / bias, 0.0)


check_occupancy = Exercise(
    "occupancy",
    "occupancy(vis, occ, bias) -> float in [0, 1], 0.5 where nothing is known",
    _occupancy,
    tuple(
        Case(f"vis = {v}, occ = {o}, bias = {b}", (v, o, b))
        for v, o, b in ((0, 0, 20), (5, 0, 20), (20, 0, 20), (90, 0, 20), (4, 1, 20), (7, 7, 20))
        + ((3, 0, 4), (2, 2, 4))
    ),
    (
        Mistake(
            "ratio alone",
            lambda v, o, b: o / v if v else 0.5,
            "one ray would make a cell surely free: without hits it sinks slowly, over `bias` rays",
        ),
        Mistake(
            "below zero",
            lambda v, o, b: o / v if o else 0.5 * (b - v) / b,
            "after `bias` rays it is 0 and stays there",
        ),
        Mistake(
            "from one",
            lambda v, o, b: o / v if o else max((b - v) / b, 0.0),
            "nothing known is 0.5, not 1: half of this",
        ),
        Mistake(
            "bias for hits",
            lambda v, o, b: o / max(v, b) if o else max(0.5 * (b - v) / b, 0.0),
            "the bias is for cells that were never hit: with hits it is occ / vis at once",
        ),
    ),
)


# ------------------------------------------------------------------------------- rays
def ray_cells(start: Cell, end: Cell) -> Cells:
    """Cells of a ray from cell to cell, both included, as B's loop takes them (B 4.4.1).

    Parameters
    ----------
    start, end : (2,) int
        Column and row.

    Returns
    -------
    (n, 2) int array
        One for each step along the longer axis, in increasing order.

    Examples
    --------
    >>> ray_cells((0, 0), (-3, 1)).tolist()
    [[-3, 1], [-2, 1], [-1, 0], [0, 0]]
    """
    return _walk(start, end)


def _walk(start: Cell, end: Cell, *, swap: bool = True, last: int = 1, late: bool = True) -> Cells:
    """The loop, and with other options what goes wrong in it."""
    (x0, y0), (x1, y1) = start, end
    steep = swap and abs(y1 - y0) > abs(x1 - x0)
    if steep:
        x0, y0, x1, y1 = y0, x0, y1, x1
    if x1 < x0:
        x0, y0, x1, y1 = x1, y1, x0, y0
    dx, dy, y, found = x1 - x0, abs(y1 - y0), y0, []
    error = -(dx // 2)
    for x in range(x0, x1 + last):
        found.append((y, x) if steep else (x, y))
        error += dy
        if error > 0 or (not late and error == 0 and dy):
            y += 1 if y1 > y0 else -1
            error -= dx
    return np.array(found, np.int64).reshape(-1, 2)


def _from_the_start(start: Cell, end: Cell) -> Cells:
    """Always from the start: the same cells as their mirror image, which B's are not."""
    away = np.array(end) - start
    sign = np.where(away < 0, -1, 1)
    (dx, dy), offset = abs(away).tolist(), np.array(start)
    return offset + sign * _walk((0, 0), (dx, dy))


def _same_cells(found: Any, expected: Any) -> bool:
    """Whether both hold the same cells, in any order."""
    a, b = numbers(found), numbers(expected)
    if a is None or b is None or a.shape != b.shape or a.ndim != 2:
        return False
    return sorted(a.tolist()) == sorted(b.tolist())


check_ray_cells = Exercise(
    "ray_cells",
    "ray_cells(start, end) -> (n, 2) cells (x, y), both ends included, by Bresenham's loop (B 4.4)",
    ray_cells,
    tuple(
        Case(f"from {start} to {end}", (start, end))
        for start, end in (
            *(((0, 0), (4, 1)), ((0, 0), (7, 3)), ((4, 1), (0, 0)), ((0, 0), (1, 4))),
            *(((2, 1), (-3, 3)), ((1, 7), (-1, -6)), ((3, 3), (3, 3)), ((0, 0), (-5, -5))),
        )
    ),
    (
        Mistake(
            "end left out",
            lambda start, end: _walk(start, end, last=0),
            "the last x belongs to the ray too: range ends one before its end",
        ),
        Mistake(
            "steep rays broken",
            lambda start, end: _walk(start, end, swap=False),
            "where the ray is steeper than 45 degrees x and y must change places, else it has gaps",
        ),
        Mistake(
            "from the start",
            _from_the_start,
            "B walks towards larger x whichever way the ray runs: swap the ends where x decreases",
        ),
        Mistake(
            "one step early",
            lambda start, end: _walk(start, end, late=False),
            "y moves where the error is above 0: at 0 it stays",
        ),
    ),
    _same_cells,
)


# -------------------------------------------------------------------- exported pictures
def _pixel(x: float, y: float, origin: tuple[float, float], side: float, rows: int) -> Cell:
    return rows - 1 - floor((y - origin[1]) / side), floor((x - origin[0]) / side)


check_pixel = Exercise(
    "pixel",
    "pixel(x, y, origin, side, rows) -> (row, column) of a ROS map's picture, row 0 at the top",
    _pixel,
    tuple(
        Case(f"({x}, {y}), origin {o}, pixels of {side} m, {rows} rows", (x, y, o, side, rows))
        for x, y, o, side, rows in (
            (0.1, 0.1, (0.0, 0.0), 0.5, 6),
            (1.3, 0.1, (0.0, 0.0), 0.5, 6),
            (1.3, 2.9, (-1.0, 0.25), 0.5, 8),
            (-0.9, 1.1, (-1.0, -2.0), 0.25, 20),
        )
    ),
    (
        Mistake(
            "row 0 lowest",
            lambda x, y, origin, side, rows: (
                floor((y - origin[1]) / side),
                floor((x - origin[0]) / side),
            ),
            "the picture's first row is the top one: count rows from there",
        ),
        Mistake(
            "one row off",
            lambda x, y, origin, side, rows: (
                rows - floor((y - origin[1]) / side),
                floor((x - origin[0]) / side),
            ),
            "the lowest row has number rows - 1",
        ),
        Mistake(
            "column first",
            lambda x, y, origin, side, rows: _pixel(x, y, origin, side, rows)[::-1],
            "row first, then column: y decides on the row",
        ),
        Mistake(
            "origin at the top",
            lambda x, y, origin, side, rows: (
                floor((origin[1] - y) / side),
                floor((x - origin[0]) / side),
            ),
            "the origin is the lower left corner of the lower left pixel, not of the upper left",
        ),
    ),
)
