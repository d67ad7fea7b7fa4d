"""What robots measure with: laser scanners and odometry, and how each goes wrong."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike

from .. import arrays
from ..angles import wrap
from ..arrays import Array, Count, Quantity, Seconds, Settings, Share, at_most, checked
from ..poses import between

#: No scanner has more beams in one scan.
MOST_SENSOR_BEAMS = 1_000_000
#: No odometry is worse: a hundred radians a radian, a hundred metres a metre.
MOST_NOISE = 100.0

Direction = Annotated[float, Quantity("radians")]
Error = Annotated[float, Quantity("metres", least=0)]
Noise = Annotated[float, Quantity("", least=0, most=MOST_NOISE)]


@dataclass(frozen=True)
class Sensor(Settings):
    """A laser scanner: where its beams point and what it gets wrong.

    Parameters
    ----------
    first : float
        Direction of the first beam, counter-clockwise from straight ahead.
    step : float
        From one beam to the next.
    max_range : float
        Beams that meet nothing nearer come back as `inf`.
    min_range : float
        Anything nearer is an error of the sensor and comes back as NaN.
    sigma : float
        Standard deviation of a range.
    range_share : float
        What each metre of range adds to it: 0.006 for an RPLidar, whose sigma is 0.005.
    resolution : float
        Ranges are rounded to multiples of it; 0 leaves them as they are.
    dropout : float
        Share of the beams that are lost by chance and come back as `inf`.
    grazing : float
        A beam that meets a wall at a smaller angle is lost: too little light comes back.
    period : float
        From one scan to the next.

    Examples
    --------
    >>> Sensor("three beams", 3, -np.pi / 2, np.pi / 2, max_range=8.0).angles.round(6)
    array([-1.570796,  0.      ,  1.570796])
    """

    name: str
    beams: Annotated[Count, at_most(MOST_SENSOR_BEAMS)]
    first: Direction
    step: Direction
    max_range: Annotated[float, Quantity("metres", above=0, most=np.inf)]
    min_range: Error = 0.0
    sigma: Error = 0.0
    resolution: Error = 0.0
    dropout: Share = 0.0
    grazing: Annotated[float, Quantity("radians", least=0)] = 0.0
    period: Seconds = 0.1
    range_share: Share = 0.0

    @property
    def angles(self) -> Array:
        """Directions of the beams in the sensor's frame, (beams,) array, radians."""
        return self.first + self.step * np.arange(self.beams, dtype=np.float64)

    def ideal(self) -> Sensor:
        """The same beams (directions in radians, ranges in metres) without any fault."""
        beams = self.beams, self.first, self.step
        return Sensor(self.name, *beams, self.max_range, period=self.period)


#: SICK LMS 200 in its centimetre mode: 80 m, 10 mm steps, about 10 mm of noise; 181 beams from -90
#: to 90 degrees. Over a serial line at 38 400 baud it delivers about five scans a second.
SICK_LMS200 = Sensor(
    "SICK LMS 200", beams=181, first=-np.pi / 2, step=np.pi / 180,
    max_range=80.0, sigma=0.010, resolution=0.010, period=0.2,
)  # fmt: skip

#: Hokuyo URG-04LX: steps 44 to 725 of 1024 a turn, step 384 ahead; 20 mm to 4 m, 10 mm of noise,
#: rounded to 1 mm, ten scans a second (B 5.1.1). Chosen here: one beam in a hundred is lost, and so
#: is whatever meets a wall at less than 5 degrees.
URG_04LX = Sensor(
    "Hokuyo URG-04LX", beams=682, first=(44 - 384) * 2 * np.pi / 1024, step=2 * np.pi / 1024,
    max_range=4.0, min_range=0.020, sigma=0.010, resolution=0.001,
    dropout=0.01, grazing=float(np.radians(5)), period=0.1,
)  # fmt: skip


@checked
def measure(
    ranges: ArrayLike, incidence: ArrayLike, *, sensor: Sensor, rng: np.random.Generator
) -> Array:
    """What a sensor makes of exact ranges.

    The generator gives the same number of values whatever the beams meet and however good the
    sensor is, so that scans of two sensors differ by their faults alone.

    Parameters
    ----------
    ranges : (n,) array, metres
        `inf` where nothing is met.
    incidence : (n,) array, radians
        Angle between beam and wall, in `[0, pi/2]`; NaN where nothing is met.

    Returns
    -------
    (n,) array, metres
        `inf` where nothing came back, NaN where the wall was too near.

    Examples
    --------
    >>> coarse = Sensor("coarse", 3, 0.0, 0.1, max_range=8.0, min_range=0.5, resolution=0.25)
    >>> measure([0.3, 1.2, 9.0], [1.5, 1.5, 1.5], sensor=coarse, rng=np.random.default_rng(1))
    array([ nan, 1.25,  inf])
    """
    arrays.instance(sensor, "sensor", Sensor)
    true, angle = arrays.ranges(ranges), arrays.numbers(incidence, "incidence")
    if true.ndim != 1 or angle.shape != true.shape:
        raise ValueError(f"ranges and incidence must both be (n,), got {true.shape}, {angle.shape}")
    sigma = sensor.sigma + sensor.range_share * np.where(np.isfinite(true), true, 0.0)
    noisy = true + sigma * rng.standard_normal(true.shape)
    if sensor.resolution > 0:
        with np.errstate(over="ignore"):  # infinite is beyond every sensor's range
            noisy = np.round(noisy / sensor.resolution) * sensor.resolution
    lost = (rng.random(true.shape) < sensor.dropout) | (angle < sensor.grazing)
    noisy = np.where(noisy < sensor.min_range, np.nan, noisy)
    return np.where(lost | (noisy >= sensor.max_range), np.inf, noisy)


@dataclass(frozen=True)
class OdometryNoise(Settings):
    """How odometry goes wrong: mostly when the robot turns.

    Turning is where a small error of the wheel base or a slipping wheel shows. Random errors grow
    with the root of the distance, so that they do not depend on how finely the path is cut.

    Parameters
    ----------
    turn_bias : float, radians a radian
        Standard deviation of the factor by which all turns of one run are misjudged: the wheel
        base is never known to better than a few per cent.
    turn_noise : float, radians a root of radian
        Standard deviation of the heading after turning by one radian.
    heading_noise : float, radians a root of metre
        Standard deviation of the heading after one metre straight on.
    distance_noise : float, metres a root of metre
        Standard deviation of the distance measured after one metre.

    Examples
    --------
    >>> OdometryNoise().ideal()
    OdometryNoise(turn_bias=0.0, turn_noise=0.0, heading_noise=0.0, distance_noise=0.0)
    """

    turn_bias: Noise = 0.03
    turn_noise: Noise = 0.03
    heading_noise: Noise = 0.005
    distance_noise: Noise = 0.01

    def ideal(self) -> OdometryNoise:
        """No noise at all: the odometry then equals the truth, in metres and radians."""
        return OdometryNoise(0.0, 0.0, 0.0, 0.0)


#: A robot with cheap wheels, in `data/clinic`: a turn is 5 % wrong, and 1 m turns it by a degree.
CHEAP_WHEELS = OdometryNoise(turn_bias=0.05, turn_noise=0.05, heading_noise=0.02)


@checked
def drifting_odometry(
    path: ArrayLike, *, odometry_noise: OdometryNoise, rng: np.random.Generator
) -> Array:
    """The odometry that a robot reports on a path: it starts where the path starts, then drifts.

    `path` holds the true poses, `(k, 3)`, metres and radians, as the result does.

    Examples
    --------
    >>> square = [(0, 0, 0), (1, 0, 0), (1, 0, np.pi / 2), (1, 1, np.pi / 2)]
    >>> still, rng = OdometryNoise().ideal(), np.random.default_rng(1)
    >>> np.allclose(drifting_odometry(square, odometry_noise=still, rng=rng), square)
    True
    """
    true, noise = arrays.poses(path, "path"), odometry_noise
    arrays.instance(noise, "odometry_noise", OdometryNoise)
    motion = between(true[:-1], true[1:])
    way, turn = np.hypot(motion[:, 0], motion[:, 1]), np.abs(motion[:, 2])
    bias = noise.turn_bias * rng.standard_normal()
    chance = rng.standard_normal((3, len(motion)))
    stretch = 1 + noise.distance_noise * chance[0] / np.sqrt(np.where(way > 0, way, np.inf))
    turned = motion[:, 2] * (1 + bias) + noise.turn_noise * np.sqrt(turn) * chance[1]
    turned += noise.heading_noise * np.sqrt(way) * chance[2]
    heading = np.cumsum(np.r_[true[:1, 2], turned])
    c, s = np.cos(heading[:-1]), np.sin(heading[:-1])
    ahead, aside = (motion[:, :2] * stretch[:, None]).T
    x = np.cumsum(np.r_[true[:1, 0], c * ahead - s * aside])
    y = np.cumsum(np.r_[true[:1, 1], s * ahead + c * aside])
    return np.stack([x, y, wrap(heading)], -1)
