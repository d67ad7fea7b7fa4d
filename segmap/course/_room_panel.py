"""A sensor in a simulated room, with its number of beams and its noise on sliders."""

from dataclasses import replace

import numpy as np
from matplotlib.figure import Figure
from numpy.typing import ArrayLike

from ..arrays import Segments
from ..panels import Panel, slider, text
from ..plotting import MAP, RESULT, draw_scan, draw_segments
from ..scans import LaserScan
from ..simulation import URG_04LX, Sensor, simulate


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
        self.scan = self._scan(pose, sensor)
        exact = self._scan(pose, sensor.ideal())
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

    def _scan(self, pose: np.ndarray, sensor: Sensor) -> LaserScan:
        rng = np.random.default_rng(self.seed)
        return simulate(self.walls, pose[None], sensor=sensor, rng=rng)[0]

    def __repr__(self) -> str:
        return f"RoomPanel({self.noise.value} mm of noise: {self.valid.value})"
