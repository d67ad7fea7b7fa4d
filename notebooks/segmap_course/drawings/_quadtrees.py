"""Drawings of the chapters on quadtrees and matching: cells, rays, scores."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from numpy.typing import ArrayLike

from segmap.arrays import Array
from segmap.exports import Classes
from segmap.plotting import (
    ERROR,
    GROUPS,
    MAP,
    RAW,
    RESULT,
    TRUTH,
    axes_or_new,
    axes_row,
    draw_quadtree,
    map_axes,
    square_corners,
)
from segmap.quadtree import Frontier, QuadtreeMap, extent

from .._landscapes import Landscape, peaks, profile_peaks
from .._storage import occupied_centres
from ..literal import crossed_cells, occupancy
from ..literal.quadtrees.quadtree import Square
from ._charts import label_axes, set_ticks

#: Outlines of leaves below this part of the picture would hide what they surround.
_LEAST_PART = 1 / 90


def draw_leaves(
    leaves: Mapping[Square, int],
    *,
    corner: ArrayLike = (0.0, 0.0),
    resolution: float | None = None,
    marked: Sequence[Square] = (),
    points: Sequence[Any] | Array = (),
    limits: Sequence[float] | None = None,
    title: str = "",
    ax: Axes | None = None,
) -> Axes:
    """Draw leaves `(column, row, side)` in cells: black with ends in them, else as blue outlines.

    The axes count cells, or metres where a resolution is given. Squares that are `marked` have
    orange edges. `points` in metres are orange dots, and what is black else is grey below them.
    `limits` are left, right, low and high edge, by default those of all leaves.
    """
    ax, unit = axes_or_new(ax), resolution or 1.0

    def squares(which: Iterable[Square]) -> Any:
        x, y, side = np.reshape(list(which), (-1, 3)).T * unit
        return square_corners(x, y, side) + np.asarray(corner, float)

    edges = squares(leaves)
    low, high = edges.min((0, 1)), edges.max((0, 1))
    x_min, x_max, y_min, y_max = limits or (low[0], high[0], low[1], high[1])
    seen = [s for s in leaves if s[2] * unit >= _LEAST_PART * (x_max - x_min)]
    full = squares(square for square, ends in leaves.items() if ends)
    shade = "0.85" if len(points) else MAP
    ax.add_collection(PolyCollection(full, facecolor=shade, antialiased=False, linewidth=0))
    for chosen, color, width in ((seen, RESULT, 0.5), (marked, ERROR, 2.5)):
        lines = PolyCollection(squares(chosen), facecolor="none", edgecolor=color, linewidth=width)
        ax.add_collection(lines)
    ax.plot(*np.reshape(points, (-1, 2)).T, ".", color=ERROR, markersize=3)
    map_axes(ax).set(xlim=(x_min, x_max), ylim=(y_min, y_max))
    if resolution is None:
        ax.set(xlabel="column", ylabel="row")
    ax.set_title(title, fontsize=10)
    return ax


def draw_ends(map: QuadtreeMap, *, ax: Axes | None = None) -> Axes:
    """Draw the leaves of a map that counts ends: black where beams ended, and all outlines."""
    leaf, (x_min, y_min, x_max, y_max) = map.leaves(), extent(map)
    corner, side = map.bounds[:2], map.resolution
    squares = np.stack([leaf.x - corner[0], leaf.y - corner[1], leaf.side], axis=1) / side
    keys = np.round(squares).astype(int).tolist()
    leaves = {(x, y, cells): n for (x, y, cells), n in zip(keys, leaf.occ.tolist(), strict=True)}
    limits = x_min, x_max, y_min, y_max
    return draw_leaves(leaves, corner=corner, resolution=side, limits=limits, ax=ax)


def draw_counts(
    leaves: Mapping[Square, tuple[int, int]],
    *,
    beams: ArrayLike = (),
    resolution: float | None = None,
    numbers: bool = False,
    title: str = "",
    ax: Axes | None = None,
) -> Axes:
    """Draw leaves `(column, row, side)` by the rays and ends that they count: occupancy as a grey.

    White is free, black occupied, grey unknown. `beams` are pairs `(n, 2, 2)` of the robot and the
    end, in the units of the axes: cells, or metres where a resolution is given. `numbers` writes
    the rays of each leaf into it.
    """
    ax, unit = axes_or_new(ax), resolution or 1.0
    x, y, side = np.array(list(leaves), float).T * unit
    greys = [str(1 - occupancy(rays, ends)) for rays, ends in leaves.values()]
    squares = PolyCollection(
        square_corners(x, y, side), facecolors=greys, edgecolor=RESULT, linewidth=0.5
    )
    ax.add_collection(squares)
    pairs = np.reshape(np.asarray(beams, float), (-1, 2, 2))
    ax.add_collection(LineCollection(list(pairs), colors=ERROR, linewidths=0.8))
    ax.plot(*pairs[:1, 0].T, "o", color=ERROR, markersize=7)
    for x_min, y_min, size, (rays, ends) in zip(x, y, side, leaves.values(), strict=True):
        if numbers:
            color = "white" if ends else MAP
            middle: dict[str, Any] = {"ha": "center", "va": "center", "fontsize": 8, "color": color}
            ax.text(x_min + size / 2, y_min + size / 2, f"{rays}", **middle)
    low, high = (x.min(), y.min()), ((x + side).max(), (y + side).max())
    map_axes(ax).set(xlim=(low[0], high[0]), ylim=(low[1], high[1]))
    if resolution is None:
        ax.set(xlabel="column", ylabel="row")
    ax.set_title(title, fontsize=10)
    return ax


def draw_leaf_row(cases: Mapping[str, Mapping[Square, int]], **options: Any) -> list[Axes]:
    """Draw trees side by side, title -> leaves; the options are those of `draw_leaves`."""
    row = axes_row(len(cases), (max(5.5, 2.75 * len(cases)), 3.5))
    for ax, (title, leaves) in zip(row, cases.items(), strict=True):
        draw_leaves(leaves, ax=ax, title=title, **options)
    return row


def draw_cells_of_a_wall(cuts: Mapping[float, Mapping[Square, int]], **options: Any) -> list[Axes]:
    """Draw one wall in trees of several resolutions, metres, and say how many ends a cell has."""
    row = axes_row(len(cuts), (3.5 * len(cuts), 3.7))
    for ax, (side, leaves) in zip(row, cuts.items(), strict=True):
        full = np.array([ends for ends in leaves.values() if ends])
        title = f"{len(full)} cells of {100 * side:g} cm,\n{(full == 1).sum()} of them with one end"
        draw_leaves(leaves, resolution=side, title=title, ax=ax, **options)
    return row


def draw_sizes_of_halls(leaves: Mapping[float, int], *, ax: Axes | None = None) -> Axes:
    """Draw how many leaves halls have, length in metres -> leaves, beside equal squares of 5 cm."""
    ax, length = axes_or_new(ax), np.array(list(leaves))
    ax.loglog(length, 0.75 * (length / 0.05) ** 2, "o-", color=RAW, label="equal squares")
    ax.loglog(length, list(leaves.values()), "o-", color=RESULT, label="quadtree")
    set_ticks(ax, x=length)
    title = "The quadtree grows with the walls"
    return label_axes(ax, title, "length of the hall [m]", "squares of 5 cm and more")


def draw_equal_squares(ends: ArrayLike, side: float, **options: Any) -> Axes:
    """Draw the squares of a grid around ends of beams `(n, 2)`, m: black with ends in them.

    A blue cross marks the `corner` from which they are counted, where one is given.
    """
    corner = np.asarray(options.get("corner", (0.0, 0.0)), float)
    cells = np.floor((np.asarray(ends) - corner) / side).astype(int)
    (x_min, y_min), (x_max, y_max) = cells.min(0).tolist(), cells.max(0).tolist()
    full = set(map(tuple, cells.tolist()))
    columns, rows = range(x_min, x_max + 1), range(y_min, y_max + 1)
    squares = {(x, y, 1): int((x, y) in full) for x in columns for y in rows}
    title = f"{len(squares)} equal squares; something ended in {len(full)}"
    ax = draw_leaves(squares, resolution=side, **{"title": title} | options)
    if "corner" in options:
        ax.plot(*corner, "+", color=RESULT, markersize=18, markeredgewidth=4)
        x, y = corner.tolist()
        ax.text(x, y + 0.05 * side, "  corner", color=RESULT, va="bottom")
    return ax


def draw_cells(map: QuadtreeMap, cells: ArrayLike, *, ax: Axes | None = None) -> Axes:
    """Draw chosen cells of a map's grid as orange squares, over what the axes show already.

    The cells are `(n, n)` bools of `map.to_grid()`, or of a coarser one: row 0 is the lowest.
    """
    chosen = np.asarray(cells, bool)
    if chosen.ndim != 2 or chosen.shape[0] != chosen.shape[1]:
        raise ValueError(f"cells must be those of a square grid, got shape {chosen.shape}")
    ax, (x_min, y_min, _, _) = axes_or_new(ax), map.bounds
    side = map.side / max(len(chosen), 1)
    rows, columns = np.nonzero(chosen)
    squares = square_corners(x_min + columns * side, y_min + rows * side, np.full(len(rows), side))
    ax.add_collection(PolyCollection(squares, facecolor=ERROR, antialiased=False, linewidth=0))
    return map_axes(ax)


def draw_frontiers(found: Iterable[Frontier], *, ax: Axes | None = None) -> Axes:
    """Draw frontiers as dark yellow lines, over what the axes show already."""
    lines = [edge for frontier in found for edge in frontier.edges]
    ax = axes_or_new(ax)
    ax.add_collection(LineCollection(lines, color=GROUPS[0], linewidth=2.5))
    return map_axes(ax)


def draw_ray(start: ArrayLike, end: ArrayLike, *, ax: Axes | None = None) -> Axes:
    """Draw the cells of a ray (B 4.4): blue those that count it, grey the nine of the mask.

    Its ends are cells: column and row.
    """
    ax, ends = axes_or_new(ax), np.array([start, end], np.int64)
    (a, b), (c, d) = ends.tolist()
    mask = [(c + i, d + j) for i in (-1, 0, 1) for j in (-1, 0, 1)]
    for cells, color in ((crossed_cells((a, b), (c, d)), RESULT), (mask, RAW)):
        x, y = np.reshape(cells, (-1, 2)).T
        squares = square_corners(x, y, np.ones(len(x)))
        ax.add_collection(PolyCollection(squares, facecolor=color, linewidth=0))
    ax.plot(*(ends + 0.5).T, color=ERROR)
    (x_min, y_min), (x_max, y_max) = ends.min(0) - 1, ends.max(0) + 2
    ax.set(xlim=(x_min, x_max), ylim=(y_min, y_max), xlabel="column", ylabel="row", aspect="equal")
    ax.set(xticks=range(x_min, x_max + 1), yticks=range(y_min, y_max + 1))
    ax.grid(alpha=0.5)
    return ax


def draw_classes(classes: Classes, *, ax: Axes | None = None) -> Axes:
    """Draw what a robot is given: white is free, black occupied, grey unknown.

    From `exports.ros_classes`, or a picture read back, its rows turned so that 0 is the lowest.
    """
    ax, (rows, columns) = axes_or_new(ax), classes.greys.shape
    right, high = classes.left + columns * classes.side, classes.low + rows * classes.side
    edges = (classes.left, right, classes.low, high)
    ax.imshow(classes.greys, cmap="gray", vmin=0, vmax=254, origin="lower", extent=edges)
    return map_axes(ax)


def draw_ends_on_map(
    map: QuadtreeMap,
    ends: ArrayLike,
    window: Sequence[float] | None = None,
    *,
    nearest: bool = False,
    ax: Axes | None = None,
) -> Axes:
    """Draw ends of beams `(n, 2)`, m, on a map: blue in occupied cells, orange elsewhere.

    The window is left, low, right, high, m. `nearest` draws a line from each end to the centre of
    its nearest occupied cell.
    """
    from scipy.spatial import cKDTree

    ax, at = draw_quadtree(map, ax=ax, outlines=False), np.asarray(ends, float)
    hit, centres = map.occupancy(at) > 0.5, occupied_centres(map)
    if nearest:
        ways = np.stack([at, centres[cKDTree(centres).query(at)[1]]], axis=1)
        ax.add_collection(LineCollection(list(ways), colors=ERROR, linewidths=0.8))
    for some, color, words in ((at[hit], RESULT, "ends that hit"), (at[~hit], ERROR, "that miss")):
        ax.plot(*some.T, ".", color=color, markersize=3, label=words)
    if window is not None:
        ax.set(xlim=(window[0], window[2]), ylim=(window[1], window[3]))
    ax.legend(loc="lower left", bbox_to_anchor=(0, 1), ncols=2, markerscale=3)
    return ax


def draw_landscape(land: Landscape, *, ax: Axes | None = None, tops: bool = True) -> Axes:
    """Draw scores around a pose: white is best, a green cross the middle, orange dots the peaks.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> land = Landscape(np.array([-0.1, 0.0, 0.1]), np.array([[0, 0, 0], [0, 2, 0], [0, 0, 1]]))
    >>> draw_landscape(land, ax=Figure().subplots()).get_xlabel()
    'offset in x [m]'
    """
    ax = axes_or_new(ax)
    half = (land.offsets[1] - land.offsets[0]) / 2
    edges = land.offsets[0] - half, land.offsets[-1] + half
    ax.imshow(land.values, origin="lower", extent=(*edges, *edges), cmap="gray")
    if tops:
        rows, columns = peaks(land.values).T
        ax.plot(land.offsets[columns], land.offsets[rows], ".", color=ERROR, markersize=4)
    ax.plot(0, 0, "+", color=TRUTH, markersize=15, markeredgewidth=3)
    ax.set(xlabel="offset in x [m]", ylabel="offset in y [m]", aspect="equal")
    ax.set(xlim=edges, ylim=edges)
    return ax


def draw_landscapes(lands: Mapping[str, Landscape]) -> list[Axes]:
    """Draw landscapes side by side, name -> scores, and say how many peaks each has."""
    row = axes_row(len(lands), (4.5 * len(lands), 4.2))
    for ax, (name, land) in zip(row, lands.items(), strict=True):
        count = len(peaks(land.values))
        draw_landscape(land, ax=ax).set_title(f"{name}: {count} peak{'s' * (count != 1)}")
    return row


def draw_climb(offsets: ArrayLike, *, ax: Axes | None = None, joined: bool = True) -> Axes:
    """Draw the poses that a matcher visits, in blue over a landscape; the last one is larger.

    Their places, metres, are from the middle of the landscape, with a line through them in their
    order, or dots.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> ax = draw_climb([(0.1, 0.1), (0.0, 0.1)], ax=Figure().subplots())
    >>> len(ax.lines)
    2
    """
    ax, way = axes_or_new(ax), np.asarray(offsets, float)[:, :2]
    ax.plot(*way.T, "-o" if joined else ".", color=RESULT, markersize=3, linewidth=1)
    ax.plot(*way[-1], "o", color=RESULT, markersize=8, markeredgecolor="white")
    return ax


def draw_profile(
    turn: ArrayLike, values: ArrayLike, *, ax: Axes | None = None, tops: bool = True
) -> Axes:
    """Draw scores over the heading, radians from the true one: a blue line, orange dots at peaks.

    Both are from `heading_profile`.
    """
    ax, scores = axes_or_new(ax), np.asarray(values, float)
    degrees = np.degrees(np.asarray(turn, float))
    ax.plot(degrees, scores, color=RESULT)
    if tops:
        peak = profile_peaks(np.radians(degrees), scores)
        ax.plot(degrees[peak], scores[peak], "o", color=ERROR)
    ax.set(xlabel="heading off by [degrees]", ylabel="score")
    return ax
