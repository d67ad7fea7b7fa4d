"""Two segments, and the three terms of their distance."""

import numpy as np
from matplotlib.figure import Figure

from ..arrays import Array
from ..metrics import distance_terms, segment_distance
from ..panels import Panel, slider, text
from ..plotting import MAP, RESULT, draw_segments
from ..poses import transform

#: Length of the wall that stays, metres.
WALL = 2.0


class DistancePanel(Panel):
    """A wall of 2 m and a second segment to turn, shift and shorten: what each term punishes.

    Attributes
    ----------
    angle : slider, degrees
        Between the two, about the middle of the second.
    offset, along : sliders, metres
        Of the middle of the second: across the wall and along it.
    length : slider, metres
    angular, across, apart, distance : labels
    segments : (2, 2, 2) array, metres
        What is drawn.

    Examples
    --------
    >>> panel = DistancePanel()
    >>> panel.offset.value = 0.10
    >>> panel.across.value, panel.apart.value, panel.distance.value
    ('across 0.050 m', 'apart 0.100 m', 'distance 0.0295 m')
    """

    segments: Array

    def __init__(self) -> None:
        self.angle = slider("angle", 0, -90, 90, 1, "degrees")
        self.offset = slider("offset", 0.0, -1.0, 1.0, 0.01)
        self.along = slider("along", 0.0, -2.0, 2.0, 0.05)
        self.length = slider("length", WALL, 0.1, 2.0, 0.1)
        self.angular, self.across, self.apart = text(), text(), text()
        self.distance = text()
        sliders = (self.angle, self.offset, self.along, self.length)
        self._assemble(*sliders, (self.angular, self.across), (self.apart, self.distance))

    def _draw(self, figure: Figure) -> None:
        pose = (self.along.value, self.offset.value, np.radians(self.angle.value))
        half = self.length.value / 2
        wall = np.array([(-WALL / 2, 0.0), (WALL / 2, 0.0)])
        self.segments = np.stack([wall, transform(pose, [(-half, 0.0), (half, 0.0)])])
        terms = distance_terms(*self.segments)
        labels = {"angular": self.angular, "across": self.across, "apart": self.apart}
        for (name, label), term in zip(labels.items(), terms, strict=True):
            label.value = f"{name} {term:.3f} m"
        self.distance.value = f"distance {segment_distance(*self.segments):.4f} m"
        ax = draw_segments(self.segments[:1], ax=figure.subplots(), color=MAP, width=2)
        draw_segments(self.segments[1:], ax=ax, color=RESULT, width=2)
        ax.set(xlim=(-3.1, 3.1), ylim=(-2.1, 2.1))

    def __repr__(self) -> str:
        where = f"{self.angle.value} degrees, {self.offset.value:.2f} m across"
        return f"DistancePanel({where}: {self.distance.value})"
