"""Ground truth between the times at which it is known, with gaps and a late clock on sliders."""

import numpy as np
from matplotlib.figure import Figure

from ..alignment import Alignment, ground_truth
from ..panels import Panel, slider, text
from ..plotting import TRUTH, draw_alignment
from ..scans import Log


class GroundTruthPanel(Panel):
    """A log placed by some of its true poses: what interpolation puts between them (A 3.3.3).

    Parameters
    ----------
    log : Log
        With truth for some of its scans.
    max_gap : float, seconds
        Between two known poses farther apart nothing is claimed, at first.

    Attributes
    ----------
    every : slider
        Only each so many-th true pose is given; the others tell how wrong the places are.
    max_gap : slider, seconds
    late : slider, seconds
        How much the clock of the truth is ahead of the laser's.
    count, error : labels
    alignment : Alignment
        What is drawn; scans without a place are red crosses, the poses given green dots.

    Raises
    ------
    ValueError
        For a log without truth.

    Examples
    --------
    >>> from segmap import load
    >>> panel = GroundTruthPanel(load("malaga"))
    >>> panel.count.value, panel.error.value
    ('191 of 225 scans placed', 'wrong by 0.000 m on average')
    >>> panel.every.value = 4
    >>> panel.count.value
    '25 of 225 scans placed'
    """

    alignment: Alignment

    def __init__(self, log: Log, *, max_gap: float = 1.0) -> None:
        if log.truth is None or not np.isfinite(log.truth).all(1).any():
            raise ValueError(f"log must hold true poses, got {log!r}")
        self.log, self._truth = log, log.truth
        self._known = np.flatnonzero(np.isfinite(log.truth).all(1))
        self.every = slider("true pose, every", 1, 1, 16, 1, "")
        self.max_gap = slider("longest gap", max_gap, 0.2, 10.0, 0.2, "s")
        self.late = slider("clock late by", 0.0, -0.5, 0.5, 0.05, "s")
        self.count, self.error = text(), text()
        self._assemble(self.every, self.max_gap, self.late, (self.count, self.error))

    def _draw(self, figure: Figure) -> None:
        given = self._known[:: self.every.value]
        times, poses = self.log.times[given] + self.late.value, self._truth[given]
        self.alignment = ground_truth(
            self.log, times=times, poses=poses, max_gap=self.max_gap.value, missing="drop"
        )
        self.count.value = f"{self.alignment.used.sum()} of {len(self.log)} scans placed"
        self.error.value = self._error()
        ax = draw_alignment(self.log, self.alignment, ax=figure.subplots())
        ax.plot(*poses[:, :2].T, ".", color=TRUTH, markersize=2)

    def _error(self) -> str:
        """How far the scans whose truth is known lie from it."""
        placed = self._known[self.alignment.used[self._known]]
        if not len(placed):
            return "none of them is known"
        away = self.alignment.poses[placed, :2] - self._truth[placed, :2]
        return f"wrong by {np.hypot(away[:, 0], away[:, 1]).mean():.3f} m on average"

    def __repr__(self) -> str:
        given = f"every {self.every.value}., gaps to {self.max_gap.value:.1f} s"
        late = f"{self.late.value:+.2f} s"
        return f"GroundTruthPanel({given}, {late}: {self.count.value}, {self.error.value})"
