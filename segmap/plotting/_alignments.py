"""Alignments of a log: the scans along the poses found, loops, errors against the truth."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from numpy.typing import ArrayLike

from .. import arrays
from ..alignment import Alignment, position_errors
from ..arrays import Array
from ..display import plural
from ..scans import Log
from ._scans import draw_cloud, draw_log, draw_path
from ._style import ERROR, RAW, RESULT, axes_grid, axes_or_new, legend_below, map_axes, not_empty


def draw_alignment(log: Log, alignment: Alignment, *, ax: Axes | None = None) -> Axes:
    """Draw the path that a method found, the scans along it, and what it makes no use of.

    The points of the scans that were used are grey, the path is blue, scans that were not used are
    orange crosses on it. Loops of a pose graph are thin blue lines between their two places,
    rejected ones dashed and orange. A legend counts them.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> from segmap.scans import LaserScan
    >>> log = Log("two", [LaserScan([1.0], [0.0])] * 2)
    >>> used, reasons = np.array([True, False]), ("", "turning")
    >>> alignment = Alignment(np.eye(3)[:2], used, 0.0, "by hand", reasons)
    >>> ax = draw_alignment(log, alignment, ax=Figure().subplots())
    >>> [text.get_text() for text in ax.get_legend().get_texts()]
    ['by hand', '1 scan not used']
    """
    arrays.instance(log, "log", Log)
    if len(log) != len(arrays.instance(alignment, "alignment", Alignment)):
        raise ValueError(
            f"alignment must be one of this log of {len(log)} scans, got one of {len(alignment)}"
        )
    ax = axes_or_new(ax)
    draw_cloud(log, alignment.trusted, ax)
    draw_aligned_path(alignment, ax)
    legend_below(ax)
    return ax


def draw_aligned_path(alignment: Alignment, ax: Axes) -> Axes:
    """Draw the path of an alignment, its loops, and the scans that it leaves out."""
    if alignment.graph is not None:
        graph, places = alignment.graph, alignment.poses[:, :2]
        rejected = [(r.first, r.second) for r in graph.rejected]
        _chords(ax, places[graph.edges[graph.loop]], "loop", RESULT, "-")
        _chords(ax, places[np.array(rejected, int).reshape(-1, 2)], "rejected loop", ERROR, "--")
    draw_path(alignment.poses, ax=ax, color=RESULT, label=alignment.method or "aligned")
    rest = alignment.poses[~alignment.used]
    if len(rest):
        named = plural(len(rest), "scan") + " not used"
        ax.plot(*rest[:, :2].T, "x", color=ERROR, markersize=5, label=named)
    return map_axes(ax)


def draw_alignments(
    log: Log,
    alignments: Mapping[str, ArrayLike | Alignment],
    *,
    size: tuple[float, float] = (4.5, 4.5),
) -> list[Axes]:
    """Draw a log along several paths side by side, on one scale; `size` is inches of one.

    Paths are arrays `(k, 3)` or alignments. A path is orange where its poses are the log's
    odometry, else blue; an alignment is drawn with its loops and legend, as `draw_alignment` does.

    Examples
    --------
    >>> from segmap import load
    >>> log = load("room")
    >>> left, right = draw_alignments(log, {"Odometry": log.odometry, "Truth": log.truth})
    >>> left.lines[1].get_color() == ERROR, right.get_title()
    (True, 'Truth')
    """
    arrays.instance(log, "log", Log)
    by_title = not_empty(alignments, "alignments")
    paths = {title: _one_pose_a_scan(each, title, log) for title, each in by_title.items()}
    row = axes_grid(list(paths), len(paths), size)
    for ax, (title, poses) in zip(row, paths.items(), strict=True):
        if isinstance(each := by_title[title], Alignment):
            draw_alignment(log, each, ax=ax)
        else:
            raw = np.array_equal(poses, log.odometry)
            draw_log(log, poses, ax=ax, path=ERROR if raw else None)
    return row


def draw_position_errors(
    log: Log, alignments: Mapping[str, ArrayLike | Alignment], *, ax: Axes | None = None
) -> Axes:
    """Draw how far poses are from the truth, scan by scan, where the truth is known.

    Poses are arrays `(k, 3)` or alignments; the last is blue, the one before it orange and dashed,
    others are grey and dotted.

    Raises
    ------
    ValueError
        For a log without truth, and for poses that are not one a scan.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> from segmap import load
    >>> log = load("room")
    >>> ax = draw_position_errors(log, {"odometry": log.odometry}, ax=Figure().subplots())
    >>> ax.get_ylabel(), len(ax.lines[0].get_ydata()) == len(log)
    ('away from the truth [m]', True)
    """
    arrays.instance(log, "log", Log)
    if log.truth is None:
        raise ValueError(f"log must have truth, got {log!r}")
    not_empty(alignments, "alignments")
    ax, has_truth = axes_or_new(ax), np.isfinite(log.truth).all(1)
    for rest, (label, alignment) in enumerate(alignments.items(), 1 - len(alignments)):
        poses = _one_pose_a_scan(alignment, label, log)
        scans = np.flatnonzero(has_truth & np.isfinite(poses).all(1))
        color, style = ((RESULT, "-"), (ERROR, "--"), (RAW, ":"))[min(-rest, 2)]
        ax.plot(scans, position_errors(poses, log.truth), style, color=color, label=label)
    ax.set(xlabel="scan", ylabel="away from the truth [m]")
    ax.legend()
    return ax


def _one_pose_a_scan(found: ArrayLike | Alignment, title: str, log: Log) -> Array:
    """Poses, one a scan."""
    name = f"alignments[{title!r}]"
    return arrays.poses(found, name, count=len(log), missing=True)


def _chords(ax: Axes, lines: Array, words: str, color: str, style: str) -> None:
    if len(lines):
        chords = LineCollection(list(lines), colors=color, linewidths=0.7, linestyles=style)
        chords.set_label(plural(len(lines), words))
        ax.add_collection(chords)
