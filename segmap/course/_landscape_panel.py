"""A score around the true pose, and turned about it."""

import ipywidgets as W
import numpy as np
from matplotlib.figure import Figure

from ..matching import SCORES
from ..panels import Panel, slider, text
from ..quadtree import QuadtreeMap, build_map
from ..scans import Log
from ._landscape_drawings import draw_landscape, draw_profile
from ._landscapes import Landscape, heading_profile, landscape, peaks


class LandscapePanel(Panel):
    """What a matcher could climb: a score over x and y, and over the heading (B 4.3).

    Parameters
    ----------
    log : Log
        With a truth for every scan.
    resolution : float, metres
        Of the map.

    Attributes
    ----------
    score : drop-down
        One of `matching.SCORES`.
    scan : slider
        That scan is laid on the map of those before it.
    turn : slider, degrees
        By so much its heading is wrong.
    peaks, best : labels
        Local maxima within 30 cm; where the highest lies.
    land : Landscape
        What is drawn.

    Examples
    --------
    >>> from segmap.course import room_walk
    >>> panel = LandscapePanel(room_walk(40))
    >>> panel.peaks.value
    '1 peak within 30 cm'
    >>> panel.score.value = "occupancy"
    >>> panel.peaks.value
    '101 peaks within 30 cm'
    """

    land: Landscape

    def __init__(self, log: Log, *, resolution: float = 0.01) -> None:
        truth = log.truth
        if truth is None or not np.isfinite(truth).all() or len(log) < 2:
            raise ValueError(f"log {log.name!r} must have two scans or more, each with its truth")
        self.log, self.truth, self.resolution = log, truth, resolution
        self._maps: dict[int, QuadtreeMap] = {}
        self.score = W.Dropdown(options=list(SCORES), description="score")
        self.scan = slider("scan", len(log) // 4, 1, len(log) - 1, 1, "")
        self.turn = slider("turned", 0, -20, 20, 1, "degrees")
        self.peaks, self.best = text(), text()
        self._assemble(self.score, self.scan, self.turn, (self.peaks, self.best), width=560)

    def _draw(self, figure: Figure) -> None:
        k, score = self.scan.value, SCORES[self.score.value]
        if k not in self._maps:
            poses = self.truth[:k]
            self._maps = {k: build_map(self.log[:k], poses, resolution=self.resolution)}
        scan = self._maps[k], self.log[k].points()
        pose = self.truth[k] + (0, 0, np.radians(self.turn.value))
        self.land = landscape(*scan, pose, score=score, step=0.015)
        found = peaks(self.land.values)
        self.peaks.value = f"{len(found)} peak{'s' * (len(found) != 1)} within 30 cm"
        y, x = self.land.offsets[found[0]]
        self.best.value = f"the highest {100 * np.hypot(x, y):.1f} cm off"
        left, right = figure.subplots(1, 2)
        draw_landscape(self.land, ax=left)
        turn, values = heading_profile(*scan, self.truth[k], score=score)
        draw_profile(turn, values, ax=right, tops=False).set_xticks((-180, -90, 0, 90, 180))

    def __repr__(self) -> str:
        return f"LandscapePanel({self.score.value}: {self.peaks.value}, {self.best.value})"
