"""Polylines of a scan, with their tolerance on a slider."""

from matplotlib.figure import Figure

from ..arrays import Array
from ..extraction import extract_polylines
from ..panels import Panel, slider, text
from ..plotting import RESULT, draw_scan, draw_segments
from ..scans import LaserScan
from ..segments import length


class PolylinePanel(Panel):
    """A scan and the polylines through it: a small tolerance cuts noise into pieces, a large one
    cuts corners off.

    Parameters
    ----------
    scan : LaserScan
    tolerance : float, metres
        Farthest that a point may lie from its segment, at first.

    Attributes
    ----------
    tolerance : slider, metres
    count, covered : labels
    segments : (n, 2, 2) array, metres
        What is drawn, in the robot's frame.

    Examples
    --------
    >>> import numpy as np
    >>> a = np.radians(range(-60, 61))
    >>> bend = LaserScan(np.where(a < 0, 1 / np.cos(a), 1 / np.cos(a - 0.35)), a)
    >>> panel = PolylinePanel(bend, tolerance=0.5)
    >>> panel.tolerance.value = 0.02
    >>> panel.count.value
    '2 segments from 121 points'
    """

    segments: Array

    def __init__(self, scan: LaserScan, *, tolerance: float = 0.03) -> None:
        self.scan = scan
        self.tolerance = slider("tolerance", tolerance, 0.005, 0.50, 0.005)
        self.count, self.covered = text(), text()
        self._assemble(self.tolerance, (self.count, self.covered))

    def _draw(self, figure: Figure) -> None:
        points = self.scan.points()
        self.segments = extract_polylines(points, tolerance=self.tolerance.value)
        n = len(self.segments)
        self.count.value = f"{n} segment{'s' * (n != 1)} from {len(points)} points"
        self.covered.value = f"{length(self.segments).sum():.2f} m of wall"
        ax = draw_scan(self.scan, ax=figure.subplots())
        draw_segments(self.segments, ax=ax, color=RESULT, width=1.8)

    def __repr__(self) -> str:
        return f"PolylinePanel(tolerance {self.tolerance.value:.3f} m: {self.count.value})"
