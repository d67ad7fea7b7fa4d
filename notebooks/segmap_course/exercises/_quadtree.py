"""Exercises of the chapters on the quadtree: cells, growth, occupancy, rays, exported pictures.

The answers are those of `segmap_course.literal`.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from inspect import getsource
from math import ceil, floor
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from ..literal import cell_of, grown, occupancy, ray_cells
from ..literal.quadtrees import quadtree
from ._answers import same_cells
from ._exercise import Exercise
from .draws import grids as draws_grids

Cell = tuple[int, int]
Cells = NDArray[np.int64]
#: The line that `segmap_course.literal` begins with.
FUTURE = "from __future__ import annotations"


# ------------------------------------------------------------------------------ cells
check_cell_of = Exercise(
    "cell_of(x, corner, resolution) -> int: the column that holds x, counted from the corner",
    cell_of,
    {
        f"x = {x}, corner {c}, cells of {r} m": (x, c, r)
        for x, c, r in (
            *((0.26, 0.0, 0.1), (-0.05, 0.0, 0.1), (-0.31, 0.0, 0.1)),
            *((1.0, 0.0, 0.1), (0.3, 0.0, 0.1), (2.9, 2.0, 0.25), (0.24, 0.0, 0.1)),
        )
    },
    {
        "int() cuts towards zero: -0.5 becomes 0, so two columns share one number; use floor": (
            lambda x, c, r: int((x - c) / r)
        ),
        "1.0 // 0.1 is 9, as 0.1 is a little more than a tenth: divide first, then take floor": (
            lambda x, c, r: int((x - c) // r)
        ),
        "0.3 * (1 / 0.1) is 3, and 0.3 / 0.1 is a little less: divide, do not multiply": (
            lambda x, c, r: floor((x - c) * (1 / r))
        ),
        "a cell begins at its left edge: floor, and not the nearest whole number": (
            lambda x, c, r: round((x - c) / r)
        ),
        "columns are counted from the corner: subtract it first": lambda x, c, r: floor(x / r),
        "a cell begins at its left edge: floor, and not ceil": (lambda x, c, r: ceil((x - c) / r)),
        "cells have a side of `resolution` metres: divide by it": (
            lambda x, c, r: floor((x - c) * r)
        ),
    },
    draw=draws_grids.cell_of,
    own=(quadtree,),
)


# ----------------------------------------------------------------------------- growth
def _down_unless_above(root: tuple[int, int, int], cell: Cell) -> tuple[int, int, int]:
    x, y, side = root
    return x - side * (cell[0] < x), y - side * (not cell[1] >= y + side), 2 * side


def _until_inside(root: tuple[int, int, int], cell: Cell) -> tuple[int, int, int]:
    x, y, side = root
    inside = x <= cell[0] < x + side and y <= cell[1] < y + side
    return root if inside else _until_inside(grown(root, cell), cell)


check_grown = Exercise(
    "grown(root, cell) -> (x, y, side): root (x, y, side), doubled once towards a cell outside it",
    grown,
    {
        f"root {root} and cell {cell}": (root, cell)
        for root, cell in (
            *(((0, 0, 8), (3, 8)), ((0, 0, 8), (8, 3)), ((0, 0, 8), (-1, 3))),
            *(((4, -4, 4), (5, -9)), ((0, 0, 8), (-3, 20)), ((-8, -8, 16), (100, -100))),
        )
    },
    {
        "for a cell beside the root this grows downwards for ever, as the thesis does: down only "
        "where the cell lies below": _down_unless_above,
        "a cell to the left or below is never reached this way: move the corner by one side": (
            lambda root, cell: (*root[:2], 2 * root[2])
        ),
        "the root doubles: the new side is twice the old one": (
            lambda root, cell: (*grown(root, cell)[:2], root[2])
        ),
        "the old root must stay one quarter of the new: the corner moves by the old side": (
            lambda root, cell: 2 * np.array(grown(root, cell)) - (root[0], root[1], 2 * root[2])
        ),
        "the corner moves to the left only for a cell to the left, and down only for one below": (
            lambda root, cell: (root[0] - root[2], root[1] - root[2], 2 * root[2])
        ),
        "one doubling is asked for, though the cell may still lie outside": _until_inside,
    },
    draw=draws_grids.grown,
    own=(quadtree,),
)


# -------------------------------------------------------------------------- occupancy
check_occupancy = Exercise(
    "occupancy(vis, occ, bias) -> float in [0, 1], 0.5 where nothing is known",
    occupancy,
    {
        f"vis = {v}, occ = {o}, bias = {b}": (v, o, b)
        for v, o, b in (
            *((0, 0, 20), (5, 0, 20), (20, 0, 20), (90, 0, 20), (4, 1, 20)),
            *((7, 7, 20), (3, 0, 4), (2, 2, 4)),
        )
    },
    {
        "one ray would make a cell surely free: without hits it sinks slowly, over `bias` rays": (
            lambda v, o, b: o / v if v else 0.5
        ),
        "after `bias` rays it is 0 and stays there": (
            lambda v, o, b: o / v if o else 0.5 * (b - v) / b
        ),
        "nothing known is 0.5, not 1: half of this": (
            lambda v, o, b: o / v if o else max((b - v) / b, 0.0)
        ),
        "the bias is for cells that were never hit: with hits it is occ / vis at once": (
            lambda v, o, b: o / max(v, b) if o else max(0.5 * (b - v) / b, 0.0)
        ),
        "vis counts all rays through the cell, those that ended there too": (
            lambda v, o, b: o / (v + o) if o else max(0.5 * (b - v) / b, 0.0)
        ),
        "this is how surely it is free: without hits occupancy sinks, with hits it is occ / vis": (
            lambda v, o, b: 1 - occupancy(v, o, b)
        ),
    },
    draw=draws_grids.occupancy,
    own=(quadtree,),
)


# ------------------------------------------------------------------------------- rays
def _changed(line: str, other: str) -> Callable[[Cell, Cell], Cells]:
    """The literal walk with one of its lines changed."""

    @cache
    def changed() -> Callable[[Cell, Cell], list[Cell]]:
        scope: dict[str, Any] = {}
        exec(f"{FUTURE}\n{getsource(ray_cells)}".replace(line, other), scope)  # our own source
        return cast(Callable[[Cell, Cell], list[Cell]], scope["ray_cells"])

    return lambda start, end: np.array(changed()(start, end), np.int64).reshape(-1, 2)


_end_left_out = _changed("x1 + 1)", "x1)")
_never_steep = _changed("abs(y1 - y0) > abs(x1 - x0)", "False")
_one_early = _changed("error > 0", "error >= 0")


def _from_the_start(start: Cell, end: Cell) -> list[Cell]:
    """Always from the start: the same cells as their mirror image, which B's are not."""
    (x0, y0), (x1, y1) = start, end
    right, up = (-1 if x1 < x0 else 1), (-1 if y1 < y0 else 1)
    cells = ray_cells((0, 0), (abs(x1 - x0), abs(y1 - y0)))
    return [(x0 + right * x, y0 + up * y) for x, y in cells]


_from_zero = _changed("error = -(dx // 2)", "error = 0")


def _rounded(start: Cell, end: Cell) -> Cells:
    """Evenly along the longer axis, rounded."""
    steps = max(abs(end[0] - start[0]), abs(end[1] - start[1])) + 1
    return np.round(np.linspace(start, end, steps)).astype(np.int64)


check_ray_cells = Exercise(
    "ray_cells(start, end) -> (n, 2) cells (x, y), both ends included, by Bresenham's loop (B 4.4)",
    ray_cells,
    {
        f"from {start} to {end}": (start, end)
        for start, end in (
            *(((0, 0), (4, 1)), ((0, 0), (7, 3)), ((4, 1), (0, 0)), ((0, 0), (1, 4))),
            *(((2, 1), (-3, 3)), ((1, 7), (-1, -6)), ((3, 3), (3, 3)), ((0, 0), (-5, -5))),
            ((0, 0), (4, 2)),
        )
    },
    {
        "the last x belongs to the ray too: range ends one before its end": _end_left_out,
        "where the ray is steeper than 45 degrees x and y must change places, else it has gaps": (
            _never_steep
        ),
        "B walks towards larger x whichever way the ray runs: swap the ends where x decreases": (
            _from_the_start
        ),
        "y moves where the error is above 0: at 0 it stays": _one_early,
        "B's error starts at minus half of dx, rounded down: rounding y in each column decides "
        "otherwise where a ray runs right between two cells": _rounded,
        "the error starts at -(dx // 2), not at 0: the ray begins in the middle of its cell": (
            _from_zero
        ),
    },
    same_cells,
    draw=draws_grids.ray_cells,
    own=(quadtree,),
)


# ------------------------------------------------------------------ exported pictures
def _pixel(x: float, y: float, origin: tuple[float, float], side: float, rows: int) -> Cell:
    return rows - 1 - floor((y - origin[1]) / side), floor((x - origin[0]) / side)


check_pixel = Exercise(
    "pixel(x, y, origin, side, rows) -> (row, column) of a ROS map's picture, row 0 at the top",
    _pixel,
    {
        f"({x}, {y}), origin {o}, pixels of {side} m, {rows} rows": (x, y, o, side, rows)
        for x, y, o, side, rows in (
            *((0.1, 0.1, (0.0, 0.0), 0.5, 6), (1.3, 0.1, (0.0, 0.0), 0.5, 6)),
            *((1.3, 2.9, (-1.0, 0.25), 0.5, 8), (-0.9, 1.1, (-1.0, -2.0), 0.25, 20)),
        )
    },
    {
        "the picture's first row is the top one: count rows from there": (
            lambda x, y, o, side, rows: (floor((y - o[1]) / side), floor((x - o[0]) / side))
        ),
        "the lowest row has number rows - 1": (
            lambda x, y, o, side, rows: _pixel(x, y, o, side, rows + 1)
        ),
        "row first, then column: y decides on the row": (
            lambda x, y, o, side, rows: _pixel(x, y, o, side, rows)[::-1]
        ),
        "the origin is the lower left corner of the lower left pixel, not of the upper left": (
            lambda x, y, o, side, rows: (floor((o[1] - y) / side), floor((x - o[0]) / side))
        ),
        "a pixel begins at its edges: floor, and not the nearest whole number": (
            lambda x, y, o, side, rows: (
                rows - 1 - round((y - o[1]) / side),
                round((x - o[0]) / side),
            )
        ),
        "count from the origin: subtract it first": (
            lambda x, y, o, side, rows: _pixel(x, y, (0.0, 0.0), side, rows)
        ),
    },
    draw=draws_grids.pixel,
)
