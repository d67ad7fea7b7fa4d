"""Stepping through a log as the backbone method does."""

import ipywidgets as W
import numpy as np
from matplotlib.figure import Figure

from ..alignment import BackboneStep, backbone_steps
from ..panels import Panel, slider, text
from ..plotting import RESULT, draw_path
from ..scans import Log
from ._draw_backbones import draw_backbone

#: Metres around the way of the robot that are shown.
MARGIN = 3.0


class BackbonePanel(Panel):
    """A log, scan by scan: the lines of the backbone, and how the scan is turned and laid on them.

    Lines are black, the relevant segments red where odometry would lay them and blue where they
    were laid, the way so far blue.

    Parameters
    ----------
    log : Log
        At least one scan.
    min_length : float, metres
        Segments longer than this are relevant, at first.

    Attributes
    ----------
    scan, min_length : sliders
    play : play button, which moves the slider of the scans
    state, turned : labels
        Whether the scan was used, or why not; by how much it was turned.
    step : BackboneStep
        What is drawn.

    Examples
    --------
    >>> from segmap import load
    >>> panel = BackbonePanel(load("corridor")[:60])
    >>> panel.scan.value = 50
    >>> panel.state.value, panel.turned.value
    ('taken while turning', 'turned by -2.30 deg, 3 lines')
    """

    step: BackboneStep

    def __init__(self, log: Log, *, min_length: float = 1.0) -> None:
        if not len(log):
            raise ValueError("log must hold at least one scan, got none")
        self.log = log
        self.scan = slider("scan", 0, 0, len(log) - 1, 1, "")
        self.min_length = slider("min_length", min_length, 0.2, 3.0, 0.1)
        self.play = W.Play(min=0, max=len(log) - 1, interval=250)
        self._link = W.jslink((self.play, "value"), (self.scan, "value"))
        self.state, self.turned = text(), text()
        self._known: dict[float, list[BackboneStep]] = {}
        self._assemble((self.play, self.scan), self.min_length, (self.state, self.turned))

    def _draw(self, figure: Figure) -> None:
        k, steps = self.scan.value, self._steps()
        self.step = steps[k]
        self.state.value = self.step.reason or "used"
        turned = f"turned by {np.degrees(self.step.rotation):.2f} deg"
        self.turned.value = f"{turned}, {len(self.step.lines.angle)} lines"
        way = np.array([s.pose for s in steps])
        ax = draw_backbone(self.step, ax=figure.subplots())
        draw_path(way[: k + 1], ax=ax, color=RESULT)
        low, high = way[:, :2].min(0) - MARGIN, way[:, :2].max(0) + MARGIN
        ax.set(title=f"scan {k}", xlim=(low[0], high[0]), ylim=(low[1], high[1]))

    def _steps(self) -> list[BackboneStep]:
        """The steps with the threshold chosen, computed once for each."""
        length = self.min_length.value
        if length not in self._known:
            self._known[length] = backbone_steps(self.log, min_length=length)
        return self._known[length]

    def __repr__(self) -> str:
        chosen = f"scan {self.scan.value}, min_length {self.min_length.value:.1f} m"
        return f"BackbonePanel({chosen}: {self.state.value}; {self.turned.value})"
