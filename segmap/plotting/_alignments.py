"""Alignments, and how one scan is laid on another."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection

from ..alignment import Alignment
from ..arrays import Array
from ..scans import Log
from ._scans import draw_cloud, draw_path
from ._style import ERROR, RESULT, axes_or_new, map_axes


def draw_alignment(log: Log, alignment: Alignment, *, ax: Axes | None = None) -> Axes:
    """Draw the way that a method found, the scans along it, and what it makes no use of.

    The points of the scans that were used are grey, the way is blue, scans that were not used are
    red crosses on it. Loops of a pose graph are thin blue lines between their two places, rejected
    ones dashed and red. A legend counts them.

    Parameters
    ----------
    log : Log
    alignment : Alignment
        Of that log.
    ax : matplotlib Axes or None

    Returns
    -------
    Axes

    Raises
    ------
    ValueError
        Where the alignment is one of another log.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> from segmap.scans import LaserScan
    >>> log = Log("two", [LaserScan([1.0], [0.0])] * 2)
    >>> found = Alignment(np.eye(3)[:2], np.array([True, False]), 0.0, "by hand", ("", "turning"))
    >>> ax = draw_alignment(log, found, ax=Figure().subplots())
    >>> [text.get_text() for text in ax.get_legend().get_texts()]
    ['by hand', '1 scan not used']
    """
    if len(log) != len(alignment):
        raise ValueError(
            f"alignment must be one of this log of {len(log)} scans, got one of {len(alignment)}"
        )
    ax = axes_or_new(ax)
    draw_cloud(log, alignment.trusted, ax)
    draw_way(alignment, ax)
    ax.legend(loc="upper center", bbox_to_anchor=(0.5, -0.15), ncols=2, frameon=False)
    return ax


def draw_way(alignment: Alignment, ax: Axes) -> Axes:
    """Draw the way of an alignment, `(k, 3)` poses, its loops and the scans that it leaves out."""
    _loops(alignment, ax)
    draw_path(alignment.poses, ax=ax, color=RESULT, label=alignment.method or "aligned")
    rest = alignment.poses[~alignment.used]
    if len(rest):
        named = _counted(len(rest), "scan") + " not used"
        ax.plot(*rest[:, :2].T, "x", color=ERROR, markersize=5, label=named)
    return map_axes(ax)


def _loops(alignment: Alignment, ax: Axes) -> None:
    graph, places = alignment.graph, alignment.poses[:, :2]
    if graph is None:
        return
    rejected = [(r.first, r.second) for r in graph.rejected]
    _chords(ax, places[graph.edges[graph.loop]], "loop", RESULT, "-")
    _chords(ax, places[np.array(rejected, int).reshape(-1, 2)], "rejected loop", ERROR, "--")


def _chords(ax: Axes, lines: Array, words: str, color: str, style: str) -> None:
    if len(lines):
        chords = LineCollection(list(lines), colors=color, linewidths=0.7, linestyles=style)
        chords.set_label(_counted(len(lines), words))
        ax.add_collection(chords)


def _counted(count: int, words: str) -> str:
    return f"{count} {words}{'s' * (count != 1)}"
