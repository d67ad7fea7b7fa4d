"""Exercises on the quadtree: cells, leaves of rays, exported pictures."""

from __future__ import annotations

from math import floor
from typing import Any

import numpy as np
from numpy.typing import NDArray

from segmap.arrays import Array

from ..literal.quadtrees.quadtree import (
    Square,
    cell_of,
    crossed_cells,
    crossed_leaves,
    quarters,
    split,
)
from ._answers import Cases
from ._exercise import Exercise, Rng, changed, edited, listed

Cell = tuple[int, int]
Leaves = dict[Square, tuple[int, int]]


# ------------------------------------------------------------------------------ cells
def _cells(points: Any, corner: Any, resolution: float) -> Any:
    return np.floor((points - corner) / resolution).astype(int)


def _scans(rng: Rng) -> Cases:
    """Points on all sides of the corner, and on edges where floor divisions round wrongly.

    On an edge where x / r itself is a little off, rounded answers are as right: there is none.
    """
    r = float(rng.choice([0.05, 0.1, 0.2, 0.25]))
    corner = rng.uniform(0.5, 3, 2).round(1) * (1, -1)
    cells = rng.integers(3, 40, (4, 2)) * [(1, 1), (-1, 1), (-1, -1), (1, -1)]
    near = np.array([(-1, 0), (0, -1)])
    edges = [(round(i * s, 2), s) for s in (0.05, 0.1, 0.2) for i in range(1, 200)]
    floored = [(x, s) for x, s in edges if x // s != floor(x / s) == round(x / s)]
    x, side = floored[int(rng.integers(len(floored)))]
    inside = rng.uniform(0.2, 0.4, (6, 2)) + np.array([0, 0.4, 0, 0.4, 0, 0.4])[:, None]
    return {
        "points on all sides of the corner": (
            corner + (np.concatenate([cells, near]) + inside) * r,
            corner,
            r,
        ),
        "points on edges of cells": (np.array([(x, 2 * side), (0.0, x)]), np.zeros(2), side),
    }


check_cell_of = Exercise(
    "cell_of(points, corner, resolution) -> (n, 2) whole numbers: column and row of each point "
    "(n, 2), counted from the corner (2,)",
    _cells,
    _scans,
    {
        "math.floor takes a single number, and this raises a TypeError: np.floor takes all points "
        "of a scan at once": cell_of,
        "to cut the digits off is no floor: -0.5 becomes 0, so two columns share one number": (
            lambda points, c, r: ((points - c) / r).astype(int)
        ),
        "1.0 // 0.1 is 9, as 0.1 is a little more than a tenth: divide first, then take floor": (
            lambda points, c, r: (points - c) // r
        ),
        "a cell begins at its left edge: floor, and not the nearest whole number": (
            lambda points, c, r: np.round((points - c) / r)
        ),
        "columns are counted from the corner: subtract it first": (
            lambda points, c, r: np.floor(points / r)
        ),
        "a cell begins at its left edge: floor, and not ceil": (
            lambda points, c, r: np.ceil((points - c) / r)
        ),
        "cells have `resolution` metres a side: divide by it": (
            lambda points, c, r: np.floor((points - c) * r)
        ),
        "x is counted from the corner's x, and y from its y": (
            lambda points, c, r: np.floor((points - c[0]) / r)
        ),
    },
)


# ------------------------------------------------------------------------------- rays
#: The largest leaf, in cells a side, that a ray may count in.
_LARGEST = 4


def _small_leaves(leaves: Leaves, root: Square, cells: list[Cell], side: int = _LARGEST) -> Any:
    for cell in cells:
        split(leaves, root, cell, side)
    return crossed_leaves(leaves, root, cells)


def _crossings(rng: Rng) -> Cases:
    """A tree that is not cut yet, and one that ends have cut, with a long ray in each."""
    cases = {}
    for words, ends in (("a tree without ends", 0), ("a tree that three ends cut", 3)):
        root: Square = (0, 0, 32)
        leaves: Leaves = dict.fromkeys(quarters(root), (0, 0))
        for x, y in rng.integers(0, 32, (ends, 2)).tolist():
            split(leaves, root, (x, y))
        (x0, y0), (x1, y1) = rng.integers(0, 10, 2).tolist(), rng.integers(20, 32, 2).tolist()
        cases[words] = leaves, root, crossed_cells((x0, y0), (x1, y1))
    return cases


check_crossed_leaves = Exercise(
    "crossed_leaves(leaves, root, cells) -> (n, 3) squares (column, row, side), sorted: the leaves "
    "that hold a cell of a ray, each once, after each such leaf is cut to at most 4 cells a side",
    _small_leaves,
    _crossings,
    {
        "a large leaf still counts the ray as a whole: cut it first, with split(leaves, root, "
        "cell, 4) for each cell of the ray": crossed_leaves,
        "4 cells a side are small enough, and single cells are a grid: split has a side as its "
        "last argument": lambda leaves, root, cells: _small_leaves(leaves, root, cells, 1),
        "4 is the side of a leaf in cells, and not how many cells it holds": (
            lambda leaves, root, cells: _small_leaves(leaves, root, cells, 2)
        ),
        "a leaf counts a ray once, however many of its cells the ray met": (
            edited(
                _small_leaves,
                (
                    "crossed_leaves(leaves, root, cells)",
                    "sorted(leaf_of(leaves, root, cell) for cell in cells)",
                ),
            )
        ),
        "every leaf on the way of the ray is cut, not only the first": (
            edited(_small_leaves, ("in cells:", "in cells[:1]:"))
        ),
    },
)


# ------------------------------------------------------------------ exported pictures
def _pictures(rng: Rng) -> Cases:
    def case() -> tuple[Any, ...]:
        side, rows = float(rng.choice([0.25, 0.5])), int(rng.integers(6, 30))
        origin = tuple(float(v) for v in rng.integers(-8, 9, 2) / 4)
        column, row = (int(v) for v in rng.integers(0, rows, 2))
        part = rng.uniform(0.1, 0.9, 2)
        x, y = origin[0] + (column + part[0]) * side, origin[1] + (row + part[1]) * side
        return round(x, 3), round(y, 3), origin, side, rows

    return listed([case() for _ in range(4)])


def _pixel(x: float, y: float, origin: tuple[float, float], side: float, rows: int) -> Cell:
    return rows - 1 - floor((y - origin[1]) / side), floor((x - origin[0]) / side)


check_pixel = Exercise(
    "pixel(x, y, origin, side, rows) -> (row, column) of a ROS map's picture, row 0 at the top",
    _pixel,
    _pictures,
    {
        "the picture's first row is the top one: count rows from there": (
            lambda x, y, o, side, rows: (floor((y - o[1]) / side), floor((x - o[0]) / side))
        ),
        "the lowest row has number rows - 1": edited(_pixel, ("rows - 1", "rows")),
        "row first, then column: y decides on the row": changed(_pixel, lambda cell: cell[::-1]),
        "the origin is the lower left corner of the lower left pixel, not of the upper left": (
            lambda x, y, o, side, rows: (floor((o[1] - y) / side), floor((x - o[0]) / side))
        ),
        "a pixel begins at its edges: floor, and not the nearest whole number": (
            edited(_pixel, ("floor", "round"))
        ),
        "count from the origin: subtract it first": (
            lambda x, y, o, side, rows: _pixel(x, y, (0.0, 0.0), side, rows)
        ),
    },
)


# -------------------------------------------------------------------------- frontiers
def _grids(rng: Rng) -> Cases:
    """Free, unknown and occupied cells at the edges, in the corners and in the middle."""

    def case(rows: int, columns: int) -> tuple[Any, ...]:
        return (rng.choice([0.0, 0.1, 0.45, 0.5, 0.5, 0.9], (rows, columns)),)

    lone = np.full((3, 3), 0.0)
    lone[tuple(rng.integers(0, 3, 2))] = 0.5
    return {
        "a wide grid": case(4, 7),
        "a high grid": case(6, 3),
        "a single row": case(1, 9),
        "one unknown cell": (lone,),
    }


def _frontier_cells(grid: Array) -> NDArray[np.bool_]:
    """The right answer, of which the mistakes change a part."""
    unknown = np.pad(grid == 0.5, 1)
    beside = unknown[:-2, 1:-1] | unknown[2:, 1:-1] | unknown[1:-1, :-2] | unknown[1:-1, 2:]
    return (grid < 0.5) & beside


def _rolled(grid: Array) -> NDArray[np.bool_]:
    unknown = grid == 0.5
    rolled = [np.roll(unknown, step, axis) for step in (-1, 1) for axis in (0, 1)]
    return (grid < 0.5) & np.any(rolled, axis=0)


def _with_diagonals(grid: Array) -> NDArray[np.bool_]:
    unknown, (rows, columns) = np.pad(grid == 0.5, 1), grid.shape
    parts = [unknown[i : i + rows, j : j + columns] for i in range(3) for j in range(3)]
    return (grid < 0.5) & np.any(parts, axis=0)


check_frontier_cells = Exercise(
    "frontier_cells(grid) -> bools like the grid (rows, columns) of occupancies: which cells are "
    "free, below 0.5, and have an unknown one, 0.5, beside them in their row or column",
    _frontier_cells,
    _grids,
    {
        "np.roll brings the cells of one edge to the other: nothing lies beyond an edge": _rolled,
        "cells that touch at a corner only are not beside each other": _with_diagonals,
        "what lies beyond the edge of the grid is no cell, so it is not unknown": (
            edited(_frontier_cells, ("0.5, 1)", "0.5, 1, constant_values=True)"))
        ),
        "the free cell is asked for, not the unknown one beside it": (
            edited(
                _frontier_cells,
                ("grid == 0.5", "grid < 0.5"),
                ("(grid < 0.5) &", "(grid == 0.5) &"),
            )
        ),
        "an occupied cell is no place to drive to: below 0.5 only": (
            edited(_frontier_cells, ("(grid < 0.5)", "(grid != 0.5)"))
        ),
        "an occupied cell is known: only 0.5 is unknown": (
            edited(_frontier_cells, ("np.pad(grid == 0.5, 1)", "np.pad(grid >= 0.5, 1)"))
        ),
        "rows count as well as columns: a cell has four beside it": (
            edited(_frontier_cells, ("unknown[:-2, 1:-1] | unknown[2:, 1:-1] | ", ""))
        ),
        "an unknown cell is not free itself": (
            edited(_frontier_cells, ("(grid < 0.5)", "(grid <= 0.5)"))
        ),
    },
)
