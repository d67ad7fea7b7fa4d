"""Alignments, and how one scan is laid on another."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.colors import ListedColormap
from matplotlib.patches import Ellipse
from numpy.typing import ArrayLike

from ..alignment import Alignment, Candidate, Match, PointStep
from ..arrays import Array
from ..poses import transform
from ..scans import Log
from ._scans import draw_cloud, draw_path
from ._segments import draw_segments
from ._style import ERROR, GROUPS, RAW, RESULT, axes_or_new, dressed

#: Lines from points to walls; more cannot be told apart.
MOST_LINES = 120
#: What may come of a start -> its colour.
OUTCOMES = {"no match": "#e8e8e8", "right": RESULT, "free": GROUPS[0], "wrong": ERROR}


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
    return dressed(ax)


def draw_step(reference: ArrayLike, step: PointStep, *, ax: Axes | None = None) -> Axes:
    """Draw a scan as point ICP sees it: points with red lines to their places on the wall.

    Of many points every second or third has a line.

    Parameters
    ----------
    reference : (n, 2) array, metres
        Points of the walls; drawn grey, those of the scan blue.
    step : PointStep
        From `alignment.point_steps`: lines of little weight are thin.
    ax : matplotlib Axes or None

    Returns
    -------
    Axes

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> from segmap.alignment import point_steps
    >>> wall = np.array([(0.1 * k, 0) for k in range(30)])
    >>> step = point_steps(wall, wall - (0, 0.2))[0]
    >>> len(draw_step(wall, step, ax=Figure().subplots()).collections[0].get_segments())
    30
    """
    ax, walls = axes_or_new(ax), np.asarray(reference, float).reshape(-1, 2)
    ax.plot(*walls.T, ".", color=RAW, markersize=4, markeredgewidth=0)
    some = slice(None, None, 1 + len(step.points) // MOST_LINES)
    lines, widths = np.stack([step.points, step.feet], 1)[some], 0.2 + step.weights[some]
    ax.add_collection(LineCollection(list(lines), colors=ERROR, linewidths=widths))
    ax.plot(*step.points.T, ".", color=RESULT, markersize=4, markeredgewidth=0)
    return dressed(ax)


def draw_uncertainty(match: Match, *, ax: Axes | None = None, deviations: float = 2.0) -> Axes:
    """Draw where a matched scan may be: the ellipse of its covariance in x and y.

    Parameters
    ----------
    match : Match
    ax : matplotlib Axes or None
    deviations : float
        Half axes in standard deviations.

    Returns
    -------
    Axes

    Raises
    ------
    ValueError
        Where nothing matched: there the covariance is infinite.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> match = Match(np.zeros(3), np.diag([0.04, 0.01, 0.0]), True)
    >>> ellipse = draw_uncertainty(match, ax=Figure().subplots()).patches[0]
    >>> np.round(sorted([ellipse.width, ellipse.height]), 6)
    array([0.4, 0.8])
    """
    if not match.matched:
        raise ValueError(f"match must be one that was found, got {match!r}")
    ax = axes_or_new(ax)
    variance, axes = np.linalg.eigh(match.covariance[:2, :2])
    width, height = 2 * deviations * np.sqrt(np.maximum(variance, 0))
    turn = float(np.degrees(np.arctan2(axes[1, 0], axes[0, 0])))
    x, y = match.pose[:2]
    ax.add_patch(Ellipse((x, y), width, height, angle=turn, color=RESULT, alpha=0.3))
    ax.plot([x], [y], "+", color=RESULT)
    return dressed(ax)


def draw_candidate(
    first: ArrayLike, second: ArrayLike, guess: Candidate, *, ax: Axes | None = None, color: str
) -> Axes:
    """Draw two scans, one laid on the other as a candidate of angle correspondence says.

    Parameters
    ----------
    first, second : (n, 2, 2) array, metres
        Segments of two scans, each in its own frame; the first black.
    guess : Candidate
        From `alignment.angle_candidates`; the title tells what speaks for it and against it.
    ax : matplotlib Axes or None
    color : str
        Of the second: `RESULT` where the candidate is believed, else `ERROR`.

    Returns
    -------
    Axes

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> from segmap.rooms import rectangular_room
    >>> from segmap.alignment import angle_candidates
    >>> walls = rectangular_room()
    >>> best = angle_candidates(walls, walls, rng=np.random.default_rng(0))[0]
    >>> draw_candidate(walls, walls, best, ax=Figure().subplots(), color=RESULT).get_title()
    '14.0 m agree, 0.0 m seen through walls'
    """
    ax = draw_segments(first, ax=ax, width=2.5)
    draw_segments(transform(guess.pose, second), ax=ax, color=color, width=1.5)
    ax.set_title(f"{guess.value:.1f} m agree, {guess.hidden:.1f} m seen through walls")
    return ax


def draw_basin(outcomes: ArrayLike, x: ArrayLike, y: ArrayLike, *, ax: Axes | None = None) -> Axes:
    """Draw what comes of each start of a descent: the basin of attraction is blue.

    Parameters
    ----------
    outcomes : (m, n) array of str
        One of `OUTCOMES` for each start: "no match" is light grey, "right" blue, "free" (along one
        direction) orange, "wrong" red.
    x : (n,) array
        Where the columns start, in any unit.
    y : (m,) array
        Where the rows start.
    ax : matplotlib Axes or None

    Returns
    -------
    Axes

    Raises
    ------
    ValueError
        For other words, or another shape.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> ax = draw_basin([["right", "wrong"]], [0.0, 0.1], [0.0], ax=Figure().subplots())
    >>> ax.collections[0].get_array().tolist()
    [[1, 3]]
    """
    words, shape = np.asarray(outcomes), (np.size(y), np.size(x))
    if words.shape != shape or not np.isin(words, list(OUTCOMES)).all():
        got = f"{words.shape} of {sorted(map(str, np.unique(words)))}"
        raise ValueError(f"outcomes must be {shape} of {list(OUTCOMES)}, got {got}")
    ax, colors = axes_or_new(ax), ListedColormap(list(OUTCOMES.values()))
    numbers = (words[..., None] == np.array(list(OUTCOMES))).argmax(-1)
    ax.pcolormesh(np.asarray(x), np.asarray(y), numbers, cmap=colors, vmin=0, vmax=3)
    return ax


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
