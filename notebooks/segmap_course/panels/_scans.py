"""Panels of the chapters on simulated scans, on extraction and on the distance of segments."""

from __future__ import annotations

from dataclasses import replace

import ipywidgets as W
import numpy as np
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from segmap.arrays import Array, Segments
from segmap.extraction import extract_clusters, extract_polylines
from segmap.metrics import distance_terms, segment_distance
from segmap.panels import Panel, slider, text
from segmap.plotting import MAP, RESULT, draw_scan, draw_segments
from segmap.poses import transform
from segmap.scans import LaserScan
from segmap.segments import length
from segmap.simulation import URG_04LX, Sensor, simulate


class RoomPanel(Panel):
    """One scan of a room by a sensor that can be made better and worse.

    Parameters
    ----------
    walls : (n, 2, 2) array, metres, or a map
    pose : (3,) array, metres and radians
        Where the robot stands.
    sensor : Sensor
        Its field of view is kept when the number of beams changes.
    seed : int
        Of the noise: the same for every position of the sliders.

    Attributes
    ----------
    beams : slider
    noise : slider, millimetres
        Standard deviation of a range.
    turn : slider, degrees
        Of the robot, from its pose.
    valid, spread : labels
    scan : LaserScan
        What is drawn.

    Examples
    --------
    >>> from segmap.simulation import square_room
    >>> panel = RoomPanel(square_room(), (2, 2, 0))
    >>> panel.noise.value = 0
    >>> panel.spread.value
    'range error 0.0 mm (root mean square)'
    """

    scan: LaserScan

    def __init__(
        self, walls: Segments, pose: ArrayLike, *, sensor: Sensor = URG_04LX, seed: int = 1
    ) -> None:
        self.walls, self.pose, self.sensor, self.seed = walls, np.array(pose, float), sensor, seed
        self.beams = slider("beams", sensor.beams, 11, 1081, 10, "")
        self.noise = slider("noise", round(1e3 * sensor.sigma), 0, 100, 5, "mm")
        self.turn = slider("turn", 0, -180, 180, 5, "degrees")
        self.valid, self.spread = text(), text()
        self._assemble(self.beams, self.noise, self.turn, (self.valid, self.spread))

    def _draw(self, figure: Figure) -> None:
        pose = self.pose + (0, 0, np.radians(self.turn.value))
        sensor = self._sensor()
        self.scan, exact = (self._scan(pose, each) for each in (sensor, sensor.ideal()))
        both = self.scan.valid & exact.valid
        error = self.scan.ranges[both] - exact.ranges[both]
        self.valid.value = f"{int(self.scan.valid.sum())} of {len(self.scan)} beams valid"
        root = 1e3 * np.sqrt(np.mean(error**2)) if len(error) else 0.0
        self.spread.value = f"range error {root:.1f} mm (root mean square)"
        ax = draw_segments(self.walls, ax=figure.subplots(), color=MAP)
        draw_scan(self.scan, pose, ax=ax, color=RESULT)

    def _sensor(self) -> Sensor:
        view = self.sensor.step * (self.sensor.beams - 1)
        return replace(
            self.sensor,
            beams=self.beams.value,
            step=view / (self.beams.value - 1),
            sigma=self.noise.value / 1e3,
            resolution=0.0 if self.noise.value == 0 else self.sensor.resolution,
        )

    def _scan(self, pose: Array, sensor: Sensor) -> LaserScan:
        rng = np.random.default_rng(self.seed)
        return simulate(self.walls, pose[None], sensor=sensor, rng=rng)[0]

    def __repr__(self) -> str:
        return f"RoomPanel({self.noise.value} mm of noise: {self.valid.value})"


class _ExtractionPanel(Panel):
    """A scan and the segments `(n, 2, 2)`, metres, that are found in it, in the robot's frame."""

    segments: Array

    def __init__(self, scan: LaserScan) -> None:
        self.scan = scan
        self.count, self.covered = text(), text()

    def _show(self, segments: Array, figure: Figure) -> None:
        self.segments, n = segments, len(segments)
        points = int(self.scan.valid.sum())
        self.count.value = f"{n} segment{'s' * (n != 1)} from {points} points"
        self.covered.value = f"{length(segments).sum():.2f} m of wall"
        ax = draw_scan(self.scan, ax=figure.subplots())
        draw_segments(segments, ax=ax, color=RESULT, width=1.8)


class ClusterPanel(_ExtractionPanel):
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

    def __init__(self, scan: LaserScan, *, gap: float = 0.30) -> None:
        super().__init__(scan)
        self.gap = slider("gap", gap, 0.05, 3.0, 0.05)
        self.fit = W.ToggleButtons(options=("total", "algebraic"), description="line fit")
        self._assemble(self.gap, self.fit, (self.count, self.covered))

    def _draw(self, figure: Figure) -> None:
        points, chosen = self.scan.points(), {"gap": self.gap.value, "fit": self.fit.value}
        self._show(extract_clusters(points, **chosen), figure)

    def __repr__(self) -> str:
        return f"ClusterPanel(gap {self.gap.value:.2f} m, {self.fit.value}: {self.count.value})"


class PolylinePanel(_ExtractionPanel):
    """A scan and the polylines through it.

    A small tolerance cuts noise into pieces, a large one cuts corners off.

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
    >>> a = np.radians(range(-60, 61))
    >>> bend = LaserScan(np.where(a < 0, 1 / np.cos(a), 1 / np.cos(a - 0.35)), a)
    >>> panel = PolylinePanel(bend, tolerance=0.5)
    >>> panel.tolerance.value = 0.02
    >>> panel.count.value
    '2 segments from 121 points'
    """

    def __init__(self, scan: LaserScan, *, tolerance: float = 0.03) -> None:
        super().__init__(scan)
        self.tolerance = slider("tolerance", tolerance, 0.005, 0.50, 0.005)
        self._assemble(self.tolerance, (self.count, self.covered))

    def _draw(self, figure: Figure) -> None:
        self._show(extract_polylines(self.scan.points(), tolerance=self.tolerance.value), figure)

    def __repr__(self) -> str:
        return f"PolylinePanel(tolerance {self.tolerance.value:.3f} m: {self.count.value})"


class DistancePanel(Panel):
    """A wall of 2 m and a second segment to turn, shift and shorten: what each term measures.

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
        self.length = slider("length", 2.0, 0.1, 2.0, 0.1)
        self.angular, self.across, self.apart, self.distance = (text() for _ in range(4))
        sliders = (self.angle, self.offset, self.along, self.length)
        self._assemble(*sliders, (self.angular, self.across), (self.apart, self.distance))

    def _draw(self, figure: Figure) -> None:
        pose = (self.along.value, self.offset.value, np.radians(self.angle.value))
        wall, half = np.array([(-1.0, 0.0), (1.0, 0.0)]), self.length.value / 2
        self.segments = np.stack([wall, transform(pose, [(-half, 0.0), (half, 0.0)])])
        labels = {"angular": self.angular, "across": self.across, "apart": self.apart}
        for (name, label), term in zip(labels.items(), distance_terms(*self.segments), strict=True):
            label.value = f"{name} {term:.3f} m"
        self.distance.value = f"distance {segment_distance(*self.segments):.4f} m"
        ax = draw_segments(self.segments[:1], ax=figure.subplots(), color=MAP, width=2)
        draw_segments(self.segments[1:], ax=ax, color=RESULT, width=2)
        ax.set(xlim=(-3.1, 3.1), ylim=(-2.1, 2.1))

    def __repr__(self) -> str:
        where = f"{self.angle.value} degrees, {self.offset.value:.2f} m across"
        return f"DistancePanel({where}: {self.distance.value})"
