"""Curves of experiments: reduction against quality, and time against scans."""

from __future__ import annotations

from collections.abc import Iterable

from matplotlib.axes import Axes
from matplotlib.ticker import PercentFormatter

from ..experiments import Pace, Record, by_method, by_setting, front, number_words, points_of
from ..reduction import Reduction
from ._style import GROUPS, axes_or_new

#: Method -> colour, marker and line, the same in all pictures.
METHOD_STYLES = {
    "basic_offline": ("#e69f00", "o", "-"),
    "basic_online": ("#56b4e9", "s", "--"),
    "hybrid": ("#cc79a7", "^", "-"),
    "mean_shift": ("#999933", "D", "-"),
    "fusion": ("#0072b2", "v", "-"),
    "hybrid_fusion": ("#882255", "X", "--"),
}


def draw_curves(
    records: Iterable[Record], *, ax: Axes | None = None, quality: float | None = None
) -> Axes:
    """Draw reduction against quality: a dot for each run, a line along the best of each method.

    Parameters
    ----------
    records : iterable of Record
        Of one map, all filtered alike: others cannot be compared (A 6.2.3).
    ax : matplotlib Axes or None
    quality : float or None
        Where to draw an upright line.

    Returns
    -------
    Axes

    Raises
    ------
    ValueError
        For records of several maps, or filtered and unfiltered ones.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> from segmap.experiments import thesis_results
    >>> ax = draw_curves(thesis_results().select(map="usc", filtered=False), ax=Figure().subplots())
    >>> len(ax.lines)
    10
    """
    chosen = list(records)
    if len(settings := by_setting(chosen)) > 1:
        raise ValueError(f"records must be of one map, filtered or not, got {list(settings)}")
    ax = axes_or_new(ax)
    if quality is not None:
        ax.axvline(quality, color="#666666", linewidth=1, linestyle=":")
    for k, (method, part) in enumerate(by_method(chosen).items()):
        color, marker, line = method_style(method, k)
        points = points_of(part)
        ax.plot(*points.T, marker, color=color, markersize=4, alpha=0.5)
        ax.plot(*front(points).T, line, color=color, linewidth=2, label=method)
    for axis in (ax.xaxis, ax.yaxis):
        axis.set_major_formatter(PercentFormatter(1.0, decimals=0))
    ax.set(xlabel="quality", ylabel="reduction")
    return ax


def draw_online(runs: Iterable[Pace | Reduction], *, ax: Axes | None = None) -> Axes:
    """Draw how the time of on-line methods adds up as the scans come in.

    Parameters
    ----------
    runs : iterable of Pace or Reduction
        Of one log.
    ax : matplotlib Axes or None

    Returns
    -------
    Axes

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> from segmap import METHODS, SegmentMap
    >>> wall = SegmentMap([[(0, 0), (1, 0)], [(0, 0), (0, 1)]], [0, 1])
    >>> ax = draw_online([METHODS["hybrid"](wall)], ax=Figure().subplots())
    >>> ax.lines[0].get_xdata().tolist()
    [0, 1, 2]
    """
    ax = axes_or_new(ax)
    seen: dict[str, int] = {}
    for run in runs:
        pace = Pace.of(run, {}) if isinstance(run, Reduction) else run
        color, _, _ = method_style(pace.method, len(seen))
        nth = seen[pace.method] = seen.get(pace.method, -1) + 1
        words = ", ".join(f"{k} {number_words(v)}" for k, v in pace.thresholds.items())
        label = f"{pace.method}: {words}" if words else pace.method
        times = [0.0, *pace.seconds]
        ax.plot([0, *pace.scans], times, "-" if nth == 0 else "--", color=color, label=label)
    ax.set(xlabel="scans", ylabel="total time [s]")
    return ax


def method_style(method: str, index: int) -> tuple[str, str, str]:
    """Colour, marker and line of a method; one that is not known takes its turn."""
    return METHOD_STYLES.get(method, (GROUPS[index % len(GROUPS)], "P", "-."))
