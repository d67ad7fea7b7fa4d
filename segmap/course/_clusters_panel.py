"""Distance clusters of a scan, with the gap on a slider and both line fits."""

import ipywidgets as W
from matplotlib.figure import Figure

from ..arrays import Array
from ..extraction import extract_clusters
from ..panels import Panel, slider, text
from ..plotting import RESULT, draw_scan, draw_segments
from ..scans import LaserScan
from ..segments import length


class ClusterPanel(Panel):
    """A scan cut at gaps, one line a cluster: corners are not cut, and one fit is biased (A 3.2).

    Parameters
    ----------
    scan : LaserScan
    gap : float, metres
        Distance of neighbours at which a cluster ends, at first.

    Attributes
    ----------
    gap : slider, metres
    fit : buttons, 'total' or 'algebraic'
    count, covered : labels
    segments : (n, 2, 2) array, metres
        What is drawn, in the robot's frame.

    Examples
    --------
    >>> panel = ClusterPanel(LaserScan([1.0, 1.0, 3.0, 3.0], [0.0, 0.1, 0.2, 0.22]))
    >>> panel.count.value
    '2 segments from 4 points'
    >>> panel.gap.value = 2.5
    >>> panel.count.value
    '1 segment from 4 points'
    """

    segments: Array

    def __init__(self, scan: LaserScan, *, gap: float = 0.30) -> None:
        self.scan = scan
        self.gap = slider("gap", gap, 0.05, 3.0, 0.05)
        self.fit = W.ToggleButtons(options=("total", "algebraic"), description="line fit")
        self.count, self.covered = text(), text()
        self._assemble(self.gap, self.fit, (self.count, self.covered))

    def _draw(self, figure: Figure) -> None:
        points = self.scan.points()
        self.segments = extract_clusters(points, gap=self.gap.value, fit=self.fit.value)
        n = len(self.segments)
        self.count.value = f"{n} segment{'s' * (n != 1)} from {len(points)} points"
        self.covered.value = f"{length(self.segments).sum():.2f} m of wall"
        ax = draw_scan(self.scan, ax=figure.subplots())
        draw_segments(self.segments, ax=ax, color=RESULT, width=1.8)

    def __repr__(self) -> str:
        return f"ClusterPanel(gap {self.gap.value:.2f} m, {self.fit.value}: {self.count.value})"
