"""Curves of experiments: reduction against quality, and time against scans."""

from __future__ import annotations

from typing import TYPE_CHECKING

from matplotlib.axes import Axes
from matplotlib.ticker import PercentFormatter

from .. import arrays
from ..experiments import front
from ..reduction import METHODS
from ._style import GROUPS, axes_or_new

if TYPE_CHECKING:
    import pandas as pd

#: Colour, marker and line of each method, in the order of the registry.
METHOD_STYLES = (
    ("#c47f00", "o", "-"),
    ("#2299c4", "s", "--"),
    ("#cc79a7", "^", "-"),
    ("#999933", "D", "-"),
    ("#0072b2", "v", "-"),
    ("#882255", "X", "--"),
    ("#332288", "*", "--"),
    ("#009e73", "p", "-"),
    ("#d55e00", "h", "--"),
    ("#117733", "P", "-"),
    ("#000000", "d", "-"),
    ("#cc3311", ".", "-"),
    ("#4477aa", ">", "--"),
    ("#a08a00", "H", "-"),
    ("#663300", "8", "--"),
    ("#aa4499", "<", "-"),
)


def draw_curves(
    frame: pd.DataFrame, *, ax: Axes | None = None, quality: float | None = None
) -> Axes:
    """Draw reduction against quality: a dot for each run, a line along the best of each method.

    The runs are of `experiments.sweep`, on one map, all filtered alike: others cannot be compared
    (A 6.2.3), and are refused. `quality` is where to draw an upright line.

    Examples
    --------
    >>> from matplotlib.figure import Figure
    >>> from segmap.experiments import load_records, select
    >>> runs = select(load_records("malaga"), filtered=False)
    >>> len(draw_curves(runs, ax=Figure().subplots()).lines)
    32
    """
    arrays.frame(frame, ["map", "method"], ["filtered", "quality", "reduction"])
    if len(settings := frame[["map", "filtered"]].drop_duplicates()) > 1:
        rows = settings.to_numpy().tolist()
        raise ValueError(f"frame must hold runs on one map, with one filter, got {rows}")
    ax = axes_or_new(ax)
    if quality is not None:
        at = arrays.number(quality, "quality", least=0, most=1)
        ax.axvline(at, color="#666666", linewidth=1, linestyle=":")
    for k, (method, runs) in enumerate(frame.groupby("method", sort=False)):
        color, marker, line = method_style(str(method), k)
        points = runs[["quality", "reduction"]].to_numpy(float)
        ax.plot(*points.T, marker, color=color, markersize=4, alpha=0.5)
        ax.plot(*front(points).T, line, color=color, linewidth=2, label=method)
    for axis in (ax.xaxis, ax.yaxis):
        axis.set_major_formatter(PercentFormatter(1.0, decimals=0))
    ax.set(xlabel="quality", ylabel="reduction")
    return ax


def method_style(method: str, index: int) -> tuple[str, str, str]:
    """Colour, marker and line by the place in `METHODS`; another method takes the next colour."""
    own = dict(zip(METHODS, METHOD_STYLES, strict=False))
    return own.get(method, (GROUPS[index % len(GROUPS)], "P", "-."))
