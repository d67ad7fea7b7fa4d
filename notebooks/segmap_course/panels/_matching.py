"""Panels of the chapters on scores and on matchers."""

from __future__ import annotations

import ipywidgets as W
import numpy as np
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from segmap.arrays import Array
from segmap.matching import MATCHERS, SCORES, DistanceField, Score
from segmap.panels import Panel, player, slider, text
from segmap.quadtree import QuadtreeMap, build_map
from segmap.scans import Log

from .._landscapes import Landscape, heading_profile, landscape, peaks
from ..drawings import draw_climb, draw_landscape, draw_profile


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
        Error of its heading.
    peaks, best : labels
        Local maxima within 30 cm; where the highest lies.
    land : Landscape
        What is drawn.

    Examples
    --------
    >>> from segmap_course import room_walk
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


class MatcherPanel(Panel):
    """A scan that starts from a wrong pose, and how a matcher moves it (B 4.3).

    Parameters
    ----------
    map : QuadtreeMap
    points : (n, 2) array, metres
    pose : (3,) array, metres and radians
        Where the scan belongs.

    Attributes
    ----------
    matcher, score : drop-downs
        Of `matching.MATCHERS` and `matching.SCORES`.
    x, y : sliders, centimetres
    turn : slider, degrees
        Offset of the start from the right pose.
    step : slider
        An accepted move of hill climbing, a round of sampling; beyond the last it stays there.
    play : play button, which moves the slider
    count, error : labels
    poses : list of (k, 3) arrays, metres and radians
        After each step; of sampling all poses that were tried in that round, the best one last.

    Examples
    --------
    >>> from segmap_course import room_walk
    >>> from segmap.quadtree import build_map
    >>> log = room_walk(40)
    >>> map = build_map(log[:10], log.truth[:10], resolution=0.01)
    >>> panel = MatcherPanel(map, log[10].points(), log.truth[10])
    >>> panel.step.value = 60
    >>> panel.error.value
    '0.2 cm and 0.2 degrees off'
    """

    poses: list[Array]

    def __init__(self, map: QuadtreeMap, points: ArrayLike, pose: ArrayLike) -> None:
        self.map, self.points = map, np.asarray(points, float)
        self.pose = np.asarray(pose, float)
        self._lands: dict[str, Landscape] = {}
        self.matcher = W.Dropdown(options=list(MATCHERS), description="matcher")
        self.score = W.Dropdown(options=list(SCORES), description="score")
        self.x, self.y = (slider(f"start off in {k}", 10, -25, 25, 1, "cm") for k in "xy")
        self.turn = slider("and turned", 3, -20, 20, 1, "degrees")
        self.step = slider("step", 0, 0, 60, 1, "")
        self.play = player(self.step, interval=300)
        self.count, self.error = text(), text()
        chosen, start = (self.matcher, self.score), (self.x, self.y, self.turn)
        texts = (self.count, self.error)
        self._assemble(chosen, *start, (self.play, self.step), texts, width=400, height=380)

    def _draw(self, figure: Figure) -> None:
        off = self.x.value / 100, self.y.value / 100, np.radians(self.turn.value)
        climbs = self.matcher.value.startswith("hill")
        self.poses = self._climb(self.pose + off) if climbs else self._sample(self.pose + off)
        k = min(self.step.value, len(self.poses) - 1)
        now = self.poses[k][-1]
        name = "move" if climbs else "round"
        self.count.value = f"{name} {k} of {len(self.poses) - 1}"
        x, y, heading = now - self.pose
        turned = f"{abs(np.degrees(heading)):.1f} degrees"
        self.error.value = f"{100 * np.hypot(x, y):.1f} cm and {turned} off"
        ax = draw_landscape(self._land(), ax=figure.subplots(), tops=False)
        way = np.concatenate(self.poses[: k + 1]) if climbs else self.poses[k]
        draw_climb(way - self.pose, ax=ax, joined=climbs)

    def _land(self) -> Landscape:
        """The landscape of the score chosen, computed once for each."""
        name = self.score.value
        if name not in self._lands:
            scan = self.map, self.points, self.pose
            self._lands[name] = landscape(*scan, score=SCORES[name], step=0.015)
        return self._lands[name]

    def _asked(self, start: Array) -> Score:
        """The score chosen; for "field" one distance field serves all calls."""
        if self.score.value == "field":
            field = DistanceField.around(self.map, self.points, start)
            return lambda map, points, poses: field.score(points, poses)
        return SCORES[self.score.value]

    def _climb(self, start: Array) -> list[Array]:
        """Poses after 0, 1, 2 ... accepted moves, `(1, 3)` each."""
        score, best, found = self._asked(start), -np.inf, [start]

        def watched(map: QuadtreeMap, points: ArrayLike, poses: ArrayLike) -> Array:
            """Scores, `(n,)`; a pose `(3,)` that beats all before is a move."""
            nonlocal best
            values = score(map, points, poses)
            if values.max() > best:
                best = float(values.max())
                found.append(np.asarray(poses)[int(values.argmax())])
            return values

        matcher = MATCHERS[self.matcher.value](np.random.default_rng(0))
        matcher(self.map, self.points, start, score=watched)
        return [pose[None] for pose in found[1:]]

    def _sample(self, start: Array) -> list[Array]:
        """The start, then all poses of each round, the best so far last."""
        score, best, rounds = self._asked(start), (-np.inf, start), [start[None]]

        def watched(map: QuadtreeMap, points: ArrayLike, poses: ArrayLike) -> Array:
            """Scores, `(n,)`; all poses asked at once, `(n, 3)`, are a round."""
            nonlocal best
            tried, values = np.asarray(poses, float), score(map, points, poses)
            if values.max() > best[0]:
                best = float(values.max()), tried[int(values.argmax())]
            rounds.append(np.concatenate([tried, best[1][None]]))
            return values

        matcher = MATCHERS[self.matcher.value](np.random.default_rng(64))
        matcher(self.map, self.points, start, score=watched)
        return rounds

    def __repr__(self) -> str:
        pair = f"{self.matcher.value}, {self.score.value}"
        return f"MatcherPanel({pair}: {self.count.value}, {self.error.value})"
