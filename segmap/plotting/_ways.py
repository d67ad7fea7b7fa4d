"""Several ways of one log: side by side, and how far each is from the truth."""

from collections.abc import Mapping

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import ArrayLike

from ..alignment import Alignment, position_errors
from ..arrays import Array
from ..scans import Log
from ._alignments import draw_alignment
from ._maps import axes_grid
from ._scans import draw_log
from ._style import ERROR, RAW, RESULT, axes_or_new


def draw_logs(
    log: Log, ways: Mapping[str, ArrayLike | Alignment], *, size: tuple[float, float] = (4.5, 4.5)
) -> list[Axes]:
    """Draw a log along several ways side by side, on one scale.

    The way is red where the poses are the log's odometry, else blue; an alignment is drawn with its
    loops and its legend, as `draw_alignment` does.

    Parameters
    ----------
    log : Log
    ways : mapping from title to (k, 3) array, metres and radians, or Alignment
        Of this log.
    size : (width, height) in inches
        Of one picture.

    Returns
    -------
    list of Axes
        One a way, in a new figure, all with the same limits.

    Raises
    ------
    ValueError
        Where a way is not of this log.

    Examples
    --------
    >>> from segmap import load
    >>> log = load("room")
    >>> left, right = draw_logs(log, {"By wheels": log.odometry, "In truth": log.truth})
    >>> left.lines[1].get_color() == ERROR, right.get_title()
    (True, 'In truth')
    """
    row = axes_grid(list(ways), len(ways), size)
    for ax, way in zip(row, ways.values(), strict=True):
        if isinstance(way, Alignment):
            draw_alignment(log, way, ax=ax)
        else:
            by_wheels = np.array_equal(np.asarray(way, float), log.odometry)
            draw_log(log, way, ax=ax, path=ERROR if by_wheels else None)
    return row


def draw_drift(
    log: Log, ways: Mapping[str, ArrayLike | Alignment], *, ax: Axes | None = None
) -> Axes:
    """Draw how far ways are from the truth, scan by scan, where the truth is known.

    Parameters
    ----------
    log : Log
        With truth for some of its scans.
    ways : mapping from str to ((k, 3) array, metres and radians, or Alignment)
        Label -> way. The last is blue, the one before it red and dashed, others grey and dotted.
    ax : matplotlib Axes or None

    Returns
    -------
    Axes
        With a legend.

    Raises
    ------
    ValueError
        For a log without truth.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> from segmap import load
    >>> log = load("room")
    >>> ax = draw_drift(log, {"odometry": log.odometry}, ax=Figure().subplots())
    >>> ax.get_ylabel(), len(ax.lines[0].get_ydata()) == len(log)
    ('away from the truth [m]', True)
    """
    if log.truth is None:
        raise ValueError(f"log must have truth, got {log!r}")
    ax, known = axes_or_new(ax), np.isfinite(log.truth).all(1)
    for rest, (label, way) in enumerate(ways.items(), 1 - len(ways)):
        poses = _poses(way)
        scans = np.flatnonzero(known & np.isfinite(poses).all(1))
        color, style = ((RESULT, "-"), (ERROR, "--"), (RAW, ":"))[min(-rest, 2)]
        ax.plot(scans, position_errors(poses, log.truth), style, color=color, label=label)
    ax.set(xlabel="scan", ylabel="away from the truth [m]")
    ax.legend()
    return ax


def _poses(way: ArrayLike | Alignment) -> Array:
    return np.asarray(way.poses if isinstance(way, Alignment) else way, float)
