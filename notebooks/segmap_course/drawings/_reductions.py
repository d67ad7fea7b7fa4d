"""Drawings of the chapters on reduction: small cases, growth on-line, rates over a threshold."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from segmap import arrays
from segmap.arrays import Segments
from segmap.plotting import (
    DPI,
    ERROR,
    GROUPS,
    MAP,
    RAW,
    RESULT,
    TRUTH,
    axes_or_new,
    axes_row,
    draw_segments,
    map_axes,
)
from segmap.reduction import Reduction

#: Colours of clusters that lie on each other: none looks like another of the first five.
CLUSTERS = tuple(GROUPS[k] for k in (0, 3, 2, 5, 6, 1, 7, 8))


def draw_cases(
    maps: Mapping[str, Segments], method: Callable[[Any], Segments], *, height: float = 3.6
) -> list[Axes]:
    """Draw what a method makes of small maps, each in a picture of its own with its title.

    A map is thin and black, and lies over what the method leaves, thick and blue. Scales of x and y
    differ, so that what is near can be told apart. The pictures of the new figure have the y axis
    in common; its height is in inches.

    Examples
    --------
    >>> from segmap.reduction import fusion
    >>> twice = np.array([[(0, 0), (1, 0)], [(0, 0.01), (1, 0.01)]])
    >>> ax = draw_cases({"Two faces": twice}, fusion)[0]
    >>> [len(lines.get_segments()) for lines in ax.collections]
    [1, 2]
    """
    axes = axes_row(len(maps), (9.0, height), shared="y")
    for ax, (title, map) in zip(axes, maps.items(), strict=True):
        draw_segments(method(map), ax=ax, color=RESULT, width=4.0)
        draw_segments(map, ax=ax, width=1.2)
        ax.set(title=title, aspect="auto")
        ax.label_outer()
    return axes


def say_stretch(*axes: Axes) -> None:
    """Write below the pictures of a figure which axis is drawn larger, and how many times.

    Examples
    --------
    >>> axes = draw_cases({"a wall": [[(0, 0), (0.1, 3)]]}, lambda map: map)
    >>> say_stretch(*axes)
    >>> axes[0].texts[0].get_text()
    'x drawn 100 times\\nlarger than y'
    >>> say_stretch(*(lying := draw_cases({"a wall": [[(0, 0), (3, 0.1)]]}, lambda map: map)))
    >>> lying[0].texts[0].get_text().split("\\n")[1]
    'larger than x'
    """
    below = partial(Axes.annotate, xycoords="axes fraction", textcoords="offset points")
    notes = [below(ax, "x\ny", (0.5, 0), xytext=(0, -32), ha="center", va="top") for ax in axes]
    figure = axes[0].get_figure(root=True)
    if figure is not None:
        figure.draw_without_rendering()
    for ax, note in zip(axes, notes, strict=True):
        box, (x_min, x_max), (y_min, y_max) = ax.bbox, ax.get_xlim(), ax.get_ylim()
        times = box.width / (x_max - x_min) / (box.height / (y_max - y_min))
        larger, other, times = ("x", "y", times) if times > 1 else ("y", "x", 1 / times)
        note.set_text(f"{larger} drawn {float(f'{times:.2g}'):g} times\nlarger than {other}")


def draw_leaning(lengths: Sequence[float], eps: float) -> list[Axes]:
    """Draw segments of these lengths, black, each with the line that leans most, orange.

    The line has all that it stands for within eps of the segment, the grey strip; metres. The
    figure is new, and y is drawn larger.

    Examples
    --------
    >>> [ax.get_title() for ax in draw_leaning([1.0, 2.0], 0.01)]
    ['1 m: leans by 1.15 degrees', '2 m: leans by 0.57 degrees']
    """
    row = axes_row(len(lengths), (9.0, 3.5), shared="xy")
    for ax, size in zip(row, lengths, strict=True):
        ax.fill_between((0, size), -eps, eps, color=RAW, alpha=0.4, linewidth=0)
        draw_segments([[(0, 0), (size, 0)]], ax=ax, color=MAP, width=2)
        draw_segments([[(0, -eps), (size, eps)]], ax=ax, color=ERROR, width=2)
        turn = np.degrees(np.arcsin(2 * eps / size))
        ax.set(aspect="auto", title=f"{size:g} m: leans by {turn:.2f} degrees")
        ax.label_outer()
    say_stretch(*row)
    return row


def draw_closer(maps: Mapping[str, Segments], window: ArrayLike) -> list[Axes]:
    """Draw maps side by side, each with two metres or so of one wall beside it, larger.

    The first map is black, as it was before; others are blue. The window is left, low, right and
    top of what is larger, metres. All maps have one scale, and so have all windows, in which the
    short side is drawn larger than the long one, so that looks of one wall can be told apart.

    Examples
    --------
    >>> twice = np.array([[(0, 0), (3, 0)], [(0, 0.01), (3, 0.01)]])
    >>> [ax.get_title() for ax in draw_closer({"before": twice, "after": twice[:1]}, (1, -1, 2, 1))]
    ['before', 'closer', 'after', 'closer']
    """
    x_min, y_min, x_max, y_max = np.asarray(window, float)
    ends = np.concatenate([arrays.segments(map).reshape(-1, 2) for map in maps.values()])
    (x0, y0), (x1, y1) = ends.min(axis=0) - 0.2, ends.max(axis=0) + 0.2
    wide = (x1 - x0) / (y1 - y0)
    thin = 0.45 if x_max - x_min < y_max - y_min else 0.8
    height = min(4.5, 8.4 / (wide + thin) / len(maps))
    size = (wide + thin) * height * len(maps) + 0.8, max(3.5, height + 0.6)
    figure = plt.figure(figsize=size, dpi=DPI, layout="constrained")
    axes = figure.subplots(1, 2 * len(maps), width_ratios=[wide, thin] * len(maps))
    for k, (title, map) in enumerate(maps.items()):
        whole, closer = axes[2 * k : 2 * k + 2]
        for ax, width in ((whole, 0.8), (closer, 1.2)):
            draw_segments(map, ax=ax, color=RESULT if k else MAP, width=width)
            ax.set_ylabel("")
        outline = [(x_min, y_min), (x_max, y_min), (x_max, y_max), (x_min, y_max), (x_min, y_min)]
        whole.plot(*np.transpose(outline), color=ERROR, linewidth=1.2)
        whole.set(title=title, xlim=(x0, x1), ylim=(y0, y1))
        closer.set(title="closer", xlim=(x_min, x_max), ylim=(y_min, y_max), aspect="auto")
        closer.tick_params(colors=ERROR)
        closer.locator_params(axis="x", nbins=3)
        closer.spines[:].set_color(ERROR)
    axes[0].set_ylabel("y [m]")
    say_stretch(*axes[1::2])
    return list(axes)


def draw_moved(looks: Segments, moved: Segments, window: ArrayLike) -> list[Axes]:
    """Draw looks beside where they were moved to, blue, as `draw_closer` does.

    In the last window lie below them, grey, the looks as they were seen.

    Examples
    --------
    >>> wall = np.array([[(0, 0), (3, 0)]])
    >>> len(draw_moved(wall, wall + 0.1, (1, -1, 2, 1))[-1].lines)
    1
    """
    axes = draw_closer({"as seen": looks, "moved": moved}, window)
    seen = axes[-1].plot(*arrays.segments(looks).T, color=RAW, linewidth=1.2, zorder=0)
    lines, words = (seen[0], axes[-1].collections[0]), ("looks as seen", "the same looks, moved")
    figure = axes[0].get_figure(root=True)
    assert figure is not None
    figure.legend(lines, words, loc="outside lower center", ncols=2)
    return axes


def merge_frames(states: Sequence[Segments]) -> Iterator[Figure]:
    """Figures of merges for a film: blue is as in the figure before, orange is new.

    Dots are the ends of the first state, so that the last figure still tells what was merged. All
    have one view.
    """
    arrays_of = [arrays.segments(state) for state in states]
    (x0, y0), (x1, y1) = (f(arrays_of[0].reshape(-1, 2), axis=0) for f in (np.min, np.max))
    for before, after in zip([arrays_of[0], *arrays_of], arrays_of, strict=False):
        same = (after[:, None] == before).all(axis=(2, 3)).any(axis=1)
        ax = axes_or_new(None, (5.0, 4.0))
        draw_segments(after[same], ax=ax, color=RESULT, width=3.0, label="as before")
        draw_segments(after[~same], ax=ax, color=ERROR, width=4.0, label="merged just now")
        ax.plot(*arrays_of[0].reshape(-1, 2).T, ".", color=MAP, label="ends of all pieces")
        ax.legend(loc="upper right")
        ax.set(title=f"{len(after)} segments", xlim=(x0 - 0.4, x1 + 0.4), ylim=(y0 - 0.4, y1 + 0.4))
        figure = ax.get_figure(root=True)
        assert figure is not None
        yield figure


def draw_costs(looks: Segments, lines: Segments, costs: ArrayLike) -> list[Axes]:
    """Draw looks at a wall along y, and below them the cost of each line over the x of its middle.

    The line of least cost is thick and blue. A line of infinite cost is left out. The figure is
    new; scales of x and y differ.

    Examples
    --------
    >>> twice = np.array([[(0, 0), (0, 3)], [(0.1, 0), (0.1, 3)]])
    >>> draw_costs(twice, twice, [0.2, 0.3])[1].get_ylabel()
    'cost [m]'
    """
    array, values = arrays.segments(lines), np.asarray(costs, float)
    figure = plt.figure(figsize=(6.0, 4.6), dpi=DPI, layout="constrained")
    wall, curve = figure.subplots(2, sharex=True)
    draw_segments(array[[values.argmin()]], ax=wall, color=RESULT, width=4.0)
    draw_segments(looks, ax=wall, width=1.2)
    curve.plot(array[:, :, 0].mean(axis=1), values, color=RESULT)
    wall.set(title="The looks, and the cheapest of these lines", aspect="auto", xlabel="")
    curve.set(title="What a line costs that stands here", xlabel="x [m]", ylabel="cost [m]")
    curve.set_ylim(0)
    say_stretch(wall)
    return [wall, curve]


def draw_clusters(looks: Segments, clusters: Mapping[float, Sequence[Any]]) -> list[Axes]:
    """Draw the clusters of looks that each penalty, in metres, leaves: each in a colour of its own.

    A cluster is the numbers of its looks, its line, which is thick, and its cost. The figure is
    new; scales of x and y differ.

    Examples
    --------
    >>> twice = np.array([[(0, 0), (0, 3)], [(0.1, 0), (0.1, 3)]])
    >>> draw_clusters(twice, {0.5: [((0, 1), twice[0], 0.3)]})[0].get_title()
    'penalty 0.5 m: 1 left'
    """
    array = arrays.segments(looks)
    axes = axes_row(len(clusters), (9.0, 3.6), shared="xy")
    for ax, (penalty, parts) in zip(axes, clusters.items(), strict=True):
        for k, (members, line, _) in enumerate(parts):
            color = CLUSTERS[k % len(CLUSTERS)]
            draw_segments([line], ax=ax, color=color, width=4.0)
            draw_segments(array[list(members)], ax=ax, color=color, width=1.2)
        ax.set(title=f"penalty {penalty:g} m: {len(parts)} left", aspect="auto")
        ax.label_outer()
    say_stretch(*axes)
    return axes


def draw_sweep(walls: Segments, tolerance: float, totals: ArrayLike, best: float) -> list[Axes]:
    """Draw at which shifts a strip of Fusion holds each wall, and the length of its chain below.

    Walls lie along x. The totals belong to shifts at equal steps, from minus the tolerance to plus
    the tolerance; orange marks the best one. All are in metres, the shifts drawn in millimetres.
    The figure is new.

    Examples
    --------
    >>> twice = np.array([[(0, 0), (3, 0)], [(1, 0.05), (2, 0.05)]])
    >>> draw_sweep(twice, 0.04, [3, 4], 0.01)[1].get_ylabel()
    'length of the chain [m]'
    """
    across = 1000 * arrays.segments(walls)[..., 1]
    enters, leaves = across.max(axis=1) - 1000 * tolerance, across.min(axis=1) + 1000 * tolerance
    shifts = 1000 * np.linspace(-tolerance, tolerance, np.size(totals))
    figure = plt.figure(figsize=(6.0, 4.2), dpi=DPI, layout="constrained")
    bars, curve = figure.subplots(2, sharex=True, height_ratios=[2, 3])
    rows = np.arange(1, len(across) + 1)
    bars.hlines(rows, enters, leaves, color=MAP, linewidth=4)
    curve.plot(shifts, totals, color=RESULT)
    for ax in (bars, curve):
        ax.axvline(1000 * best, color=ERROR)
    bars.set(title="The strip holds each segment along its bar", ylabel="segment")
    bars.set(yticks=rows, ylim=(0.5, len(across) + 0.5), xlim=(shifts[0] - 2, shifts[-1] + 2))
    title = f"Of the longest chains, the least shift wins: {1000 * best:.0f} mm"
    curve.set(title=title, xlabel="shift of the strip [mm]", ylabel="length of the chain [m]")
    return [bars, curve]


def draw_live(reductions: Mapping[str, Reduction], *, ax: Axes | None = None) -> Axes:
    """Draw how many segments the map of each on-line reduction holds after each scan.

    Raises
    ------
    ValueError
        Where a reduction is off-line.
    """
    ax = axes_or_new(ax, (6.4, 3.6))
    for k, (name, reduction) in enumerate(reductions.items()):
        if reduction.scan_live is None:
            raise ValueError(f"{name!r} must be an on-line reduction, got {reduction}")
        ax.plot(reduction.scan_live, label=name, color=GROUPS[k], linestyle=("-", "--", ":")[k % 3])
    ax.set(title="The map while the robot drives", xlabel="scan", ylabel="segments in the map")
    ax.legend()
    return ax


def draw_pieces(
    cases: Mapping[str, Sequence[Any]],
    lines: Sequence[Any],
    pieces_of: Callable[..., Sequence[tuple[float, float, int, float]]],
) -> list[Axes]:
    """Draw walls that lie along x, green with their numbers, and who owns each piece of a line.

    A case is walls, by its title, and has one line; blue is a piece that shows a wall, orange one
    that shows none. The figure is new, and scales of x and y differ.

    Examples
    --------
    >>> wall, whole = ((0, 0), (2, 0)), lambda *given: [(0, 1, 0, 0)]
    >>> (ax,) = draw_pieces({"a wall": [wall]}, [wall], whole)
    >>> [text.get_text() for text in ax.texts]
    ['wall 0', 'of wall 0']
    """
    row = axes_row(len(cases), (9.0, 3.5), shared="y")
    for ax, (title, walls), line in zip(row, cases.items(), lines, strict=True):
        draw_segments(walls, ax=ax, color=TRUTH, width=3)
        for k, wall in enumerate(walls):
            ax.annotate(f"wall {k}", wall[0], (2, -14), textcoords="offset points")
        start, way = np.array(line[0], float), np.subtract(line[1], line[0])
        for a, b, owner, _ in pieces_of(walls, line, 0.10, np.radians(5)):
            piece = np.array([start + a * way, start + b * way])
            ax.plot(*piece.T, color=ERROR if owner < 0 else RESULT, linewidth=2)
            label = "of none" if owner < 0 else f"of wall {owner}"
            ax.annotate(label, piece.mean(axis=0), (0, 5), textcoords="offset points", ha="center")
        map_axes(ax).set(title=title, aspect="auto", ylim=(-0.1, 0.2))
        ax.label_outer()
    return row
