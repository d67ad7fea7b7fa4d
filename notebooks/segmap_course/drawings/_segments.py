"""Drawings of the chapters on segments: the terms of a distance, merging, strips, centres."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Rectangle
from numpy.typing import ArrayLike

from segmap import arrays
from segmap.angles import axial_difference, axial_mean_of_two
from segmap.arrays import Array, Segments
from segmap.kernels import ACROSS_WEIGHT, ANGULAR_WEIGHT, APART_WEIGHT
from segmap.metrics import distance_terms
from segmap.plotting import (
    ERROR,
    GROUPS,
    MAP,
    RAW,
    RESULT,
    TRUTH,
    axes_grid,
    axes_or_new,
    axes_row,
    draw_maps,
    draw_robot,
    draw_segments,
    map_axes,
)
from segmap.poses import transform
from segmap.reduction import hough
from segmap.segments import angle, length, midpoint

#: Runs of which each has its number in a picture, at most.
MOST_NUMBERED = 12


def draw_distance_terms(u: ArrayLike, v: ArrayLike) -> list[Axes]:
    """Draw, orange, where the three terms of the distance between two segments are measured.

    *Turned* is the mean length of two orange lines, each from the end of a segment to the dotted
    parallel of the line midway, which is grey. *Shifted* and *apart* are one orange line each. The
    segments must not cross or be perpendicular.

    Examples
    --------
    >>> u, v = [(0, 0), (2, 0)], [(0, 0.1), (2, 0.1)]
    >>> [ax.get_title() for ax in draw_distance_terms(u, v)]
    ['Turned: 0.00 m', 'Shifted: 0.05 m', 'Apart: 0.10 m']
    """
    both = np.asarray([u, v], float)
    # the line midway, both segments with equal weights
    middle, mean = midpoint(both).mean(0), float(axial_mean_of_two(*angle(both)))
    along = np.array([np.cos(mean), np.sin(mean)])
    # from the end of each, across it, to the parallel to the line midway through its start
    across = np.stack([both[:, 0, 1] - both[:, 1, 1], both[:, 1, 0] - both[:, 0, 0]], -1)
    tops = both[:, 1] + np.tan(mean - angle(both))[:, None] * across
    turns = np.stack([both[:, 1], tops], 1)
    # from the end point farthest from the line midway to its foot there
    points = both.reshape(-1, 2)
    feet = middle + ((points - middle) @ along)[:, None] * along
    worst = int(np.argmax(np.hypot(*(points - feet).T)))
    shift = np.array([points[worst], feet[worst]])
    # from the end point nearest to the other segment to its foot there
    ends = [_to_segment(p, s) for s, q in (both, both[::-1]) for p in q]
    gap = min(ends, key=lambda line: float(length(line)))
    sizes = float(length(turns).mean()), float(length(shift)), float(length(gap))
    names = ("Turned", "Shifted", "Apart")
    titles = [f"{name}: {size:.2f} m" for name, size in zip(names, sizes, strict=True)]
    row, half = axes_grid(titles, 3, (3.6, 3.6)), 1.1 * float(length(both).max()) * along
    for ax, marks in zip(row, (turns, [shift], [gap]), strict=True):
        draw_segments([[middle - half, middle + half]], ax=ax, color=RAW)
        draw_segments(both, ax=ax, color=MAP, width=2)
        draw_segments(np.asarray(marks), ax=ax, color=ERROR, width=2.5)
    for s, top in zip(both, tops, strict=True):
        row[0].plot(*np.array([s[0], top]).T, ":", color=ERROR)
    return row


def draw_distance_curves(distance: Callable[[Array, Array], float]) -> list[Axes]:
    """Draw what a distance `distance(u, v)` between a wall of 2 m and its copy makes of a move.

    The copy is turned about its middle, moved across the wall, and moved along it. Thin lines are
    what each of the three terms adds.

    Examples
    --------
    >>> from segmap.metrics import segment_distance
    >>> [ax.get_title() for ax in draw_distance_curves(segment_distance)]
    ['Turn about the middle', 'Move across', 'Move along']
    """
    wall = np.array([(-1.0, 0.0), (1.0, 0.0)])
    moves = {
        "Turn about the middle": [(k, (0, 0, np.radians(k))) for k in np.linspace(0, 89, 90)],
        "Move across": [(k, (0, k, 0)) for k in np.linspace(0, 1)],
        "Move along": [(k, (k, 0, 0)) for k in np.linspace(0, 4, 81)],
    }
    counts = {"turned": ANGULAR_WEIGHT, "shifted": ACROSS_WEIGHT, "apart": APART_WEIGHT}
    row = axes_row(3, (9.0, 3.6), shared="y")
    for ax, (name, steps) in zip(row, moves.items(), strict=True):
        way, copies = [k for k, _ in steps], [transform(pose, wall) for _, pose in steps]
        ax.plot(way, [float(distance(wall, copy)) for copy in copies], color=RESULT, label="D")
        terms = np.stack(distance_terms(wall, np.array(copies)))
        parts = zip(counts.items(), terms, ("--", ":", "-."), (ERROR, MAP, GROUPS[2]), strict=True)
        for (term, count), values, style, color in parts:
            label = f"{count} {term}"
            ax.plot(way, count * values, style, color=color, linewidth=1.2, label=label)
        ax.set(title=name, xlabel="angle [degrees]" if name.startswith("Turn") else "way [m]")
    row[0].set_ylabel("D and its parts [m]")
    row[-1].legend()
    return row


def _to_segment(point: Array, s: Array) -> Array:
    d = s[1] - s[0]
    share = np.clip((point - s[0]) @ d / max(float(d @ d), 1e-12), 0.0, 1.0)
    return np.array([point, s[0] + share * d])


def draw_marked(
    segments: Segments,
    marked: ArrayLike,
    *,
    ax: Axes | None = None,
    color: str = RAW,
    width: float = 2.0,
) -> Axes:
    """Draw segments, and the marked ones over them, thicker and orange.

    Colour is that of the rest, and width, in points, that of the marked ones.
    """
    array, which = arrays.segments(segments), np.asarray(marked, bool)
    if which.shape != (len(array),):
        raise ValueError(f"marked must have shape ({len(array)},), got {which.shape}")
    ax = draw_segments(array[~which], ax=ax, color=color)
    return draw_segments(array[which], ax=ax, color=ERROR, width=width)


def draw_match(a: ArrayLike, b: ArrayLike, *, ax: Axes | None = None) -> Axes:
    """Draw two segments, black, the distances of their end points, dotted, and the least, orange.

    The title tells this distance and the angle between both.
    """
    ends = np.asarray([a, b], float)
    pairs = np.array([(p, q) for p in ends[0] for q in ends[1]])
    least = int(np.argmin(length(pairs)))
    ax = draw_segments(np.delete(pairs, least, 0), ax=axes_or_new(ax, (6.0, 3.5)), color=RAW)
    ax.collections[-1].set_linestyle(":")
    draw_segments(pairs[[least]], ax=ax, color=ERROR, width=2.5)
    turn = abs(float(axial_difference(*angle(ends))))
    words = f"{length(pairs[least]):.2f} m apart, turned by {np.degrees(turn):.0f} degrees"
    ax.set_title(words)
    return draw_segments(ends, ax=ax, color=MAP, width=2.0)


def draw_match_value(u: ArrayLike, v: ArrayLike, *, ax: Axes | None = None) -> Axes:
    """Draw two segments, orange what they cover of each other, and dotted how far v is from u."""
    both, ax = np.asarray([u, v], float), axes_or_new(ax, (6.5, 3.5))
    draw_segments(both, ax=ax, width=2)
    for name, s, other, above in (("u", *both, -14), ("v", *both[::-1], 8)):
        along = (s[1] - s[0]) / length(s)
        low, high = np.sort((other - s[0]) @ along).clip(0, length(s))
        part = s[0] + np.outer((low, high), along)
        draw_segments([part], ax=ax, color=ERROR, width=5)
        ax.annotate(f"{high - low:.2f} m of {name} covered", part.mean(0), (0, above),
                    textcoords="offset points", ha="center")  # fmt: skip
    pair = max((_to_segment(p, both[0]) for p in both[1]), key=length)
    ax.plot(*pair.T, ":", color=MAP, marker="o", markersize=4)
    ax.annotate(f"  {length(pair):.2f} m", pair.mean(0), va="center")
    ax.margins(x=0.1, y=0.7)
    return map_axes(ax)


def draw_merge(
    parts: Segments, wall: ArrayLike, *, ax: Axes | None = None, color: str = RESULT
) -> Axes:
    """Draw the one segment that takes the place of several, and how their ends fall on its line.

    The wall is thick, its parts are thin and black, and a dotted line leads from each of their ends
    to its foot on the line of the wall.
    """
    ax, line = axes_or_new(ax, (6.0, 3.5)), np.asarray(wall, float)
    ends, along = arrays.segments(parts).reshape(-1, 2), line[1] - line[0]
    feet = line[0] + ((ends - line[0]) @ along / (along @ along))[:, None] * along
    draw_segments(np.stack([ends, feet], 1), ax=ax, color=RAW, width=1.5)
    ax.collections[-1].set_linestyle(":")
    draw_segments([line], ax=ax, color=color, width=3.0, label="merged")
    return draw_segments(parts, ax=ax, width=1.5, label="its parts")


def draw_runs(
    runs: Sequence[ArrayLike], segments: Segments = (), *, ax: Axes | None = None
) -> Axes:
    """Draw runs of points of a scan, numbered in their order, and black segments over them.

    The orange triangle is the robot at (0, 0); a point that is alone is an orange cross.
    """
    ax, single = axes_or_new(ax, (6.0, 4.2)), [len(np.asarray(run)) == 1 for run in runs]
    for k, run in enumerate(runs):
        points, color = np.asarray(run, float), GROUPS[(0, 3, 2, 5, 6)[k % 5]]
        if single[k]:
            ax.plot(*points[0], "x", color=ERROR, markersize=7)
        else:
            ax.plot(*points.T, ".", color=color, markersize=5)
        if len(runs) - sum(single) <= MOST_NUMBERED:
            ax.annotate(f"{k + 1}", points[0], (4, 4), textcoords="offset points", fontsize=9)
    draw_robot((0.0, 0.0, 0.0), ax=ax)
    draw_segments(segments, ax=ax, color=MAP, width=1.5)
    return ax


def draw_fits(points: ArrayLike, lines: Mapping[str, ArrayLike], *, ax: Axes | None = None) -> Axes:
    """Draw points with their mean, a cross, and lines by their names: first blue, then orange.

    A line is a point of it and its unit direction: x, y, dx, dy. A dotted line leads from each
    point to the first one.
    """
    ax, array = axes_or_new(ax, (6.0, 3.6)), np.asarray(points, float)
    for (name, line), color in zip(lines.items(), (RESULT, ERROR), strict=False):
        x, y, dx, dy = np.asarray(line, float)
        ax.axline((x, y), (x + dx, y + dy), color=color, label=name, linewidth=2)
        if color == RESULT:
            feet = (x, y) + ((array - (x, y)) @ (dx, dy))[:, None] * (dx, dy)
            ax.plot(*np.moveaxis(np.stack([array, feet]), -1, 0), ":", color=RAW)
    ax.plot(*array.T, ".", color=MAP, markersize=4)
    middle, reach = array.mean(axis=0), np.ptp(array, axis=0).max()
    ax.plot(*middle, "+", color=MAP, markersize=14, label="mean")
    ax.legend(loc="upper left")
    around = reach * np.array((0.7, 0.3))
    (x_min, y_min), (x_max, y_max) = middle - around, middle + around
    map_axes(ax).set(xlim=(x_min, x_max), ylim=(y_min, y_max))
    return ax


def draw_missed(
    looks: Segments, line: ArrayLike, *, distance: float = 0.05, ax: Axes | None = None
) -> Axes:
    """Draw a line, thick and blue, for some looks; what it misses and what it invents is orange.

    A look that leaves the grey band is missed: there it ends more than `distance` off, in metres.
    Metres of the line in gaps longer than `distance` between the other looks are invented. Scales
    of x and y differ.
    """
    array, ends = arrays.segments(looks), np.asarray(line, float)
    whole = np.hypot(*(ends[1] - ends[0]))
    along = (ends[1] - ends[0]) / whole
    normal = np.array([-along[1], along[0]])
    missed = (abs((array - ends[0]) @ normal) > distance).any(axis=1)
    low, high = np.sort(np.sort((array[~missed] - ends[0]) @ along), axis=0).T
    gaps = np.column_stack([np.append(0, np.maximum.accumulate(high)), np.append(low, whole)])
    gaps = gaps[gaps[:, 1] - gaps[:, 0] > distance]
    ax = draw_segments([ends], ax=axes_or_new(ax, (6.0, 3.6)), color=RESULT, width=4.0)
    draw_segments(ends[0] + gaps[:, :, None] * along, ax=ax, color=ERROR, width=4.0)
    band = [*(ends + distance * normal), *(ends - distance * normal)[::-1]]
    ax.fill(*np.transpose(band), color=RAW, alpha=0.3, linewidth=0)
    draw_marked(array, missed, ax=ax, color=MAP, width=1.2)
    metres = np.hypot(*(array[missed, 1] - array[missed, 0]).T).sum(), (gaps @ (-1, 1)).sum()
    title = f"Orange: {metres[0]:.1f} m missed, {metres[1]:.1f} m invented"
    ax.set(aspect="auto", title=title)
    return ax


def draw_strip(
    walls: Segments,
    shift: float,
    tolerance: float,
    *,
    chain: ArrayLike | None = None,
    ax: Axes | None = None,
) -> Axes:
    """Draw walls along x and a strip of Fusion: what is in it is black, the rest orange (A 4.4.1).

    The middle of the grey strip is the line y = `shift`; the tolerance is half its width. Where the
    rows of a chain are given, these are black, and blue is the segment that takes their place.
    """
    ax, array = axes_or_new(ax, (6.0, 3.5)), arrays.segments(walls)
    ax.axhspan(shift - tolerance, shift + tolerance, color=RAW, alpha=0.4, linewidth=0)
    outside = (abs(array[..., 1] - shift) > tolerance + 1e-9).any(axis=1)
    if chain is not None:
        outside = ~np.isin(np.arange(len(array)), chain)
        ends = array[~outside, :, 0]
        wall = [(ends.min(), shift), (ends.max(), shift)]
        draw_segments([wall], ax=ax, color=RESULT, width=6.0)
        count = f"{np.sum(~outside)} of {len(array)} segments in the chain"
        ax.set_title(f"Shift {1000 * shift:.0f} mm: {count}")
    draw_segments(array[~outside], ax=ax, color=MAP, width=1.5)
    draw_segments(array[outside], ax=ax, color=ERROR, width=1.5)
    ax.set(aspect="auto", xlabel="along [m]", ylabel="across [m]")
    ax.margins(y=0.15)
    return ax


def draw_normals(
    walls: Segments, *, at: ArrayLike = (0.0, 0.0), box: tuple[float, float] | None = None
) -> list[Axes]:
    """Draw walls with the normals of their lines from a point; and each line in Hough space.

    A wall, its normal, dashed, and its line in Hough space have one colour; dotted is the line from
    the foot of the normal to the wall. The box, a distance in metres and an angle in radians, holds
    what agrees with the first line. The figure is new.
    """
    array, point = arrays.segments(walls), np.asarray(at, float)
    near = hough(array[0] - point)[1]
    rho, theta = hough(array - point, np.full(len(array), near)).T
    walls_ax, hough_ax = axes_row(2, (9.0, 3.8))
    for k, wall in enumerate(array):
        color = GROUPS[(3, 0, 2, 5, 6)[k % 5]]
        foot = point + rho[k] * np.array([np.cos(theta[k]), np.sin(theta[k])])
        walls_ax.plot(*np.stack([point, foot]).T, "--", color=color)
        walls_ax.plot(*np.stack([foot, wall.mean(axis=0)]).T, ":", color=color, linewidth=1.5)
        draw_segments([wall], ax=walls_ax, color=color, width=3.0)
        hough_ax.plot(np.degrees(theta[k]), rho[k], "o", color=color)
    walls_ax.plot(*point, "+", color=MAP, markersize=14)
    walls_ax.set_title("Walls, and normals of their lines")
    hough_ax.set(title="Hough space", xlabel="theta [degrees]", ylabel="rho [m]")
    hough_ax.margins(0.2)
    if box is not None:
        distance, turn = box[0], np.degrees(box[1])
        corner = np.degrees(near) - turn, rho[0] - distance
        hough_ax.add_patch(Rectangle(corner, 2 * turn, 2 * distance, fill=False))
    return [walls_ax, hough_ax]


def draw_sector(
    wall: ArrayLike,
    sensor: ArrayLike,
    looks: Mapping[str, Array],
    *,
    kept: Sequence[Any] = (),
    ax: Axes | None = None,
) -> Axes:
    """Draw the sector of a wall, grey, from a sensor, and looks by their words, with their rays.

    The first look is blue, then one is green and one orange; rays, dotted, reach the wall or the
    look, whichever is farther. Black is the wall, or what is kept of it, thick.
    """
    ax, ends, at = axes_or_new(ax, (6.5, 4.4)), np.asarray(wall, float), np.asarray(sensor, float)
    ax.fill(*np.transpose([at, *(at + 1.5 * (ends - at))]), color=RAW, alpha=0.2, linewidth=0)
    normal = np.array([ends[0, 1] - ends[1, 1], ends[1, 0] - ends[0, 0]])
    for (word, look), color in zip(looks.items(), (RESULT, TRUTH, ERROR), strict=False):
        draw_segments(look[None], ax=ax, color=color, width=4, label=word)
        for way in look - at:
            reach = max(1, normal @ (ends[0] - at) / (normal @ way))
            ax.plot(*np.transpose([at, at + reach * way]), ":", color=color, linewidth=1)
    draw_segments(ends[None], ax=ax, label="wall")
    draw_segments(kept, ax=ax, width=4, label="kept" if kept else None)
    ax.plot(*at, "^", color=MAP)
    ax.legend(loc="lower left")
    return map_axes(ax)


def draw_splits(run: ArrayLike, splits: Mapping[float, Sequence[Any]]) -> list[Axes]:
    """Draw what is left of a run of points with each tolerance, metres, which is drawn to scale.

    Examples
    --------
    >>> run = [(0, 0), (1, 0.2), (2, 0)]
    >>> draw_splits(run, {0.3: [[(0, 0), (2, 0)]]})[0].texts[0].get_text()
    'tolerance 0.3 m'
    """
    points = np.asarray(run, float)
    titled = {f"{tolerance:g} m: {len(s)} pieces": s for tolerance, s in splits.items()}
    axes = draw_maps(titled, size=(3.3, 3.6))
    (x_min, y_min), (_, y_max) = points.min(axis=0), points.max(axis=0)
    y = y_min + 0.8 * (y_max - y_min)
    for ax, tolerance in zip(axes, splits, strict=True):
        ax.plot(*points.T, ".", color=RAW, markersize=4, zorder=0)
        ax.plot((x_min, x_min + tolerance), (y, y), "|-", color=ERROR)
        label = f"tolerance {tolerance:g} m"
        ax.annotate(label, (x_min, y), (0, 6), textcoords="offset points", color=ERROR)
    return axes
