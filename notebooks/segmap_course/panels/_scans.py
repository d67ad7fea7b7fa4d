"""Panels of the chapters on simulated scans and on extraction."""

from __future__ import annotations

from dataclasses import replace

import ipywidgets as W
import numpy as np
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from segmap.arrays import Array, Segments, segments
from segmap.extraction import extract_clusters, extract_polylines
from segmap.plotting import ERROR, MAP, RAW, RESULT, draw_scan, draw_segments
from segmap.poses import compose, transform
from segmap.poses.motions import arc
from segmap.scans import LaserScan
from segmap.scans.motion import motion_compensated
from segmap.segments import length, point_distance
from segmap.simulation import URG_04LX, Sensor, simulate

from ._lesson import LessonPanel, keyword, note, pick, slide, tick


class RoomPanel(LessonPanel):
    """One scan of a room by a sensor that can be made better and worse.

    The robot stands at the pose. The sensor keeps its field of view when the number of beams
    changes, and the seed of the noise is the same for every position of the sliders.
    """

    scan: LaserScan
    beams = slide(lambda p: p.sensor.beams, 11, 1081, 10, "")
    noise = slide(lambda p: round(1e3 * p.sensor.sigma), 0, 100, 5, "mm")
    turn = slide(0, -180, 180, 5, "degrees")
    valid = spread = note()
    rows = ("beams", "noise", "turn", "valid spread")
    words = "{noise} mm of noise: {valid}"

    def __init__(
        self, walls: Segments, pose: ArrayLike, *, sensor: Sensor = URG_04LX, seed: int = 1
    ) -> None:
        self.walls, self.pose, self.sensor, self.seed = walls, np.array(pose, float), sensor, seed
        self._begin()

    def _draw(self, figure: Figure) -> None:
        pose = self.pose + (0, 0, self.turn.meant())
        sensor = replace(
            self.sensor,
            beams=self.beams.value,
            step=self.sensor.step * (self.sensor.beams - 1) / (self.beams.value - 1),
            sigma=self.noise.meant(),
            resolution=0.0 if self.noise.value == 0 else self.sensor.resolution,
        )
        self.scan, exact = (
            simulate(self.walls, pose[None], sensor=each, rng=np.random.default_rng(self.seed))[0]
            for each in (sensor, sensor.ideal())
        )
        both = self.scan.valid & exact.valid
        error = self.scan.ranges[both] - exact.ranges[both]
        self.valid.value = f"{int(self.scan.valid.sum())} of {len(self.scan)} beams valid"
        root = 1e3 * np.sqrt(np.mean(error**2)) if len(error) else 0.0
        self.spread.value = f"range error {root:.1f} mm (root mean square)"
        ax = draw_segments(self.walls, ax=figure.subplots(), color=MAP)
        draw_scan(self.scan, pose, ax=ax, color=RESULT)


class MovingPanel(LessonPanel):
    """One scan of a laser that turns while the robot drives, as measured and carried back.

    The robot starts at the pose, sees the walls without noise, and drives on an arc.
    """

    scan: LaserScan
    speed = slide(0.3, 0.0, 2.0, 0.1, "m/s")
    turn = slide(60, -180, 180, 10, "degrees/s")
    rate = slide(5.5, 1.0, 40.0, 0.5, "turns/s")
    deskewed = tick("carry each beam to the start", says=("as measured", "carried back"))
    moved = off = note()
    rows = ("speed", "turn", "rate", "deskewed", "moved off")
    words = "{speed:.1f} m/s, {turn} degrees/s, {rate:.1f} turns/s, {deskewed}: {off}"

    def __init__(self, walls: Segments, pose: ArrayLike) -> None:
        self.walls, self.pose = segments(walls, "walls"), np.array(pose, float)
        self._begin()

    def _draw(self, figure: Figure) -> None:
        period = 1 / self.rate.value
        laser = Sensor("turning", 360, 0.0, np.radians(1), max_range=30.0, period=period)
        motion = np.array([self.speed.value, 0.0, np.radians(self.turn.value)])
        path = np.stack([self.pose, compose(self.pose, arc(motion * period))])
        rng = np.random.default_rng(1)
        self.scan = simulate(self.walls, path, sensor=laser, rng=rng, moving=True)[0]
        if self.deskewed.value and self.scan.delays is not None:
            self.scan = motion_compensated(self.scan, arc(motion * self.scan.delays[:, None]))
        points = transform(self.pose, self.scan.points())
        far = point_distance(points[:, None], self.walls).min(axis=1)
        degrees, centimetres = abs(self.turn.value) * period, 100 * self.speed.value * period
        self.moved.value = f"moved by {degrees:.1f} degrees and {centimetres:.1f} cm in a scan"
        self.off.value = f"up to {100 * far.max():.1f} cm off the walls"
        ax = draw_segments(self.walls, ax=figure.subplots(), color=RAW, width=0.8)
        draw_scan(self.scan, self.pose, ax=ax, color=RESULT if self.deskewed.value else ERROR)


class ExtractionPanel(LessonPanel):
    """A scan and the segments that a method finds in it, in the robot's frame."""

    segments: Array
    count = covered = note()

    def __init__(self, scan: LaserScan, **first: float) -> None:
        self.scan = scan
        self._begin(**first)

    def _draw(self, figure: Figure) -> None:
        self.segments = self.method(self.scan.points(), **self.chosen())
        n, points = len(self.segments), int(self.scan.valid.sum())
        self.count.value = f"{n} segment{'s' * (n != 1)} from {points} points"
        self.covered.value = f"{length(self.segments).sum():.2f} m of wall"
        ax = draw_scan(self.scan, ax=figure.subplots())
        draw_segments(self.segments, ax=ax, color=RESULT, width=1.8)


class ClusterPanel(ExtractionPanel):
    """A scan cut at gaps, one line a cluster: corners are not cut, and one fit is biased (A 3.2).

    Examples
    --------
    >>> panel = ClusterPanel(LaserScan([1.0, 1.0, 3.0, 3.0], [0.0, 0.1, 0.2, 0.22]))
    >>> panel.count.value
    '2 segments from 4 points'
    >>> panel.gap.value = 2.5
    >>> panel.count.value
    '1 segment from 4 points'
    """

    method = staticmethod(extract_clusters)
    gap = keyword(0.05, 3.0, 0.05)
    fit = pick(("total", "algebraic"), "line fit", W.ToggleButtons)
    rows = ("gap", "fit", "count covered")
    words = "gap {gap:.2f} m, {fit}: {count}"

    def chosen(self) -> dict[str, object]:
        """With the fit that the buttons say."""
        return {**super().chosen(), "fit": self.fit.value}


class PolylinePanel(ExtractionPanel):
    """A scan and the polylines through it.

    A small tolerance cuts noise into pieces, a large one cuts corners off.

    Examples
    --------
    >>> a = np.radians(range(-60, 61))
    >>> bend = LaserScan(np.where(a < 0, 1 / np.cos(a), 1 / np.cos(a - 0.35)), a)
    >>> panel = PolylinePanel(bend, tolerance=0.5)
    >>> panel.tolerance.value = 0.02
    >>> panel.count.value
    '2 segments from 121 points'
    """

    method = staticmethod(extract_polylines)
    tolerance = keyword(0.005, 0.50, 0.005)
    rows = ("tolerance", "count covered")
    words = "tolerance {tolerance:.3f} m: {count}"
