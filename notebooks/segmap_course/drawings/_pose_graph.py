"""Drawings of the chapter on pose graphs: what edges leave open, and a loop that closes."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from segmap import arrays
from segmap.arrays import Segments
from segmap.plotting import (
    ERROR,
    GROUPS,
    MAP,
    RAW,
    RESULT,
    axes_grid,
    axes_or_new,
    draw_segments,
    map_axes,
)
from segmap.poses import compose, transform

#: A pose is a dot with a dash of this length in its direction.
_DASH_M = 0.25
#: Around the path of a film, metres.
_MARGIN_M = 1.5


def draw_edges(states: Mapping[str, ArrayLike], edges: Sequence[tuple[int, int, ArrayLike, object]]
               ) -> list[Axes]:  # fmt: skip
    """Draw poses `(n, 3)` side by side, by the title of each, and edges between them.

    An edge is the numbers of two poses, the motion measured from the first to the second, and its
    information. Grey it leads to where the measurement puts the second, which orange leads to the
    second itself. The figure is new.

    Examples
    --------
    >>> (ax,) = draw_edges({"off": [(0, 0, 0), (1, 0, 0)]}, [(0, 1, (1.2, 0, 0), None)])
    >>> ax.lines[1].get_xdata().tolist()
    [1.2, 1.0]
    """
    row = axes_grid(list(states), len(states), (max(3.8, 5 / len(states)), 3.6))
    for ax, state in zip(row, states.values(), strict=True):
        poses = arrays.poses(state)
        for i, j, relative, _ in edges:
            put = compose(poses[i], arrays.pose(relative))
            ax.plot(*np.stack([poses[i, :2], put[:2]]).T, color=RAW, linewidth=1.5)
            ax.plot(*np.stack([put[:2], poses[j, :2]]).T, color=ERROR, linewidth=2.5)
        for number, (x, y, turn) in enumerate(poses):
            ahead = _DASH_M * np.array([np.cos(turn), np.sin(turn)])
            ax.plot([x, x + ahead[0]], [y, y + ahead[1]], color=RESULT, linewidth=2)
            ax.plot([x], [y], "o", color=RESULT, markersize=8)
            ax.annotate(str(number), (x, y), (6, -14), textcoords="offset points")
        map_axes(ax)
        ax.margins(0.15)
    return row


def loop_frames(
    first: Segments, second: Segments, states: Sequence[ArrayLike],
    loop: tuple[int, int, ArrayLike, object],
) -> Iterator[Figure]:  # fmt: skip
    """Figures of a path while a loop closes, for a film: path blue, the gap of the loop orange.

    The loop is an edge, as `draw_edges` has it, between poses with scans of these walls, each in
    its own frame: black, and orange. A state is the poses of the path, `(n, 3)`.
    """
    i, j, relative, _ = loop
    all_poses = np.stack([arrays.poses(state) for state in states])
    low, high = all_poses[..., :2].min(axis=(0, 1)), all_poses[..., :2].max(axis=(0, 1))
    for poses in all_poses:
        ax = axes_or_new(None, (4.0, 4.0))
        draw_segments(transform(poses[i], arrays.segments(first)), ax=ax, color=MAP, width=2.0)
        draw_segments(transform(poses[j], arrays.segments(second)), ax=ax, color=ERROR, width=2.0)
        ax.plot(*poses[:, :2].T, color=RESULT, linewidth=1.5)
        put = compose(poses[i], arrays.pose(relative))
        ax.plot(*np.stack([put[:2], poses[j, :2]]).T, "o-", color=ERROR, linewidth=3)
        ax.set(xlim=(low[0] - _MARGIN_M, high[0] + _MARGIN_M))
        ax.set(ylim=(low[1] - _MARGIN_M, high[1] + _MARGIN_M))
        ax.set_axis_off()
        figure = ax.get_figure(root=True)
        assert figure is not None
        yield figure


def draw_method_errors(
    errors: Mapping[str, Mapping[str, float]], *, ax: Axes | None = None
) -> Axes:
    """Draw the error of each method, metres, a mark for each log: methods below each other.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> ax = draw_method_errors({"a log": {"pose_graph": 0.07}}, ax=Figure().subplots())
    >>> ax.get_xscale()
    'log'
    """
    ax = axes_or_new(ax, (7.2, 3.6))
    for (name, error_of), mark, color in zip(errors.items(), "so^D", GROUPS, strict=False):
        row = dict(error_of)
        ax.semilogx(list(row.values()), list(row), mark, color=color, label=name)
    ax.set(xlabel="mean error [m]", ylabel="method")
    ax.legend(loc="center left", bbox_to_anchor=(1, 0.5), frameon=False)
    return ax
