"""Point ICP from any start, step by step."""

import ipywidgets as W
import numpy as np
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from ..alignment import PointStep, match_points, point_steps
from ..panels import Panel, slider, text
from ..poses import between
from ._draw_matches import draw_step


class IcpPanel(Panel):
    """Two scans, and how one descends onto the other from a start that is wrong (A 2.5.1, [41]).

    Parameters
    ----------
    reference, current : (n, 2) and (m, 2) arrays, metres
        Points of the two scans, each in its own frame.
    pose : (3,) array, metres and radians
        Where the current scan belongs, or nearly so: the match from there is held for right.
    reach : float, metres
        How far partners are sought at first.

    Attributes
    ----------
    x, y : sliders, metres
    turn : slider, degrees
        By these the start is wrong.
    step : slider
        Beyond the last step it stays there.
    play : play button, which moves the slider
    count, error : labels
    steps : list of PointStep

    Raises
    ------
    ValueError
        For fewer than six points in either scan, and as `match_points`.

    Examples
    --------
    >>> corner = np.array([(0.1 * k, 0) for k in range(30)] + [(0, 0.1 * k) for k in range(30)])
    >>> panel = IcpPanel(corner, corner)
    >>> panel.step.value = 60
    >>> panel.error.value
    '0.000 m and 0.0 degrees from the match'
    """

    steps: list[PointStep]

    def __init__(
        self,
        reference: ArrayLike,
        current: ArrayLike,
        pose: ArrayLike = (0.0, 0.0, 0.0),
        *,
        reach: float = 0.6,
    ) -> None:
        self.reference, self.current = np.asarray(reference, float), np.asarray(current, float)
        if min(len(self.reference), len(self.current)) < 6:
            counts = f"{len(self.reference)} and {len(self.current)}"
            raise ValueError(f"the two scans must have at least 6 points each, got {counts}")
        self.reach = reach
        self.pose = match_points(self.reference, self.current, pose, reach=reach).pose
        self._limits = np.percentile(self.reference, (3, 97), axis=0) + [[-1], [1]]
        self.x, self.y = (slider(f"start off in {k}", 0.3, -2.0, 2.0, 0.1) for k in "xy")
        self.turn = slider("and turned", 0, -45, 45, 5, "degrees")
        self.step = slider("step", 0, 0, 60, 1, "")
        self.play = W.Play(min=0, max=60, interval=400)
        self._link = W.jslink((self.play, "value"), (self.step, "value"))
        self.count, self.error = text(), text()
        row = (self.count, self.error)
        self._assemble(self.x, self.y, self.turn, (self.play, self.step), row)

    def _draw(self, figure: Figure) -> None:
        off = self.x.value, self.y.value, np.radians(self.turn.value)
        start = self.pose + np.array(off)
        self.steps = point_steps(self.reference, self.current, start, reach=self.reach)
        k = min(self.step.value, len(self.steps) - 1)
        now = self.steps[k]
        x, y, heading = between(self.pose, now.pose)
        self.count.value = f"step {k} of {len(self.steps) - 1}: {len(now.points)} points"
        turned = f"{abs(np.degrees(heading)):.1f} degrees"
        self.error.value = f"{np.hypot(x, y):.3f} m and {turned} from the match"
        ax = draw_step(self.reference, now, ax=figure.subplots())
        ax.set(xlim=self._limits[:, 0], ylim=self._limits[:, 1])

    def __repr__(self) -> str:
        start = f"{self.x.value:+.1f} m, {self.y.value:+.1f} m, {self.turn.value:+d} degrees"
        return f"IcpPanel(from {start}: {self.count.value}, {self.error.value})"
