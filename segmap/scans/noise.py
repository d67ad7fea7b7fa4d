"""The noise of a laser's ranges: a model of two figures and a step, and its estimate from a log."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike

from .. import arrays
from ..arrays import Array, Quantity, Settings, Share
from ..poses.motions import between
from ._scans import LaserScan, Log

#: Standard deviation of a range of the lasers that thresholds were chosen for, metres.
USUAL_SIGMA_M = 0.01
#: A laser with up to so many times that deviation is such a one: an estimate is not better.
USUAL_FACTOR = 1.35
#: If the noise of a given sensor and of its log differ by more than this factor, it is another
#: sensor. Noise below 1 cm counts as 1 cm.
OTHER_FACTOR = 2.0
#: At least so many scans are used, or pairs of scans between which the robot stands.
LEAST_SCANS = 20
#: Of a long log one scan of so many is used.
ONE_SCAN_OF = 10
#: Neighbours whose ends are farther apart lie on two things, metres.
MOST_STEP_M = 0.3
#: A robot whose wheels moved less stands, metres and radians.
STILL = 0.0005, 0.0005, 0.0003
#: Ends of classes of range, metres, and their middles.
CLASSES_M = 2.0 ** np.arange(-2, 6.5, 0.5)
MIDDLES_M = np.concatenate([[0.2], CLASSES_M * 2**0.25])
#: A standard deviation is at most so many of its standard errors above its estimate.
SURE = 3.0
#: Smallest standard deviation that an estimate may have, metres.
LEAST_M = 1e-6
#: Steps in which lasers tell their ranges, metres.
STEPS_M = 0.05, 0.01, 0.005, 0.001

Deviation = Annotated[float, Quantity("metres", least=0, most=10.0)]


@dataclass(frozen=True)
class SensorNoise(Settings):
    """Standard deviation of the ranges of a laser: `range_m + range_share * range`.

    Parameters
    ----------
    range_m : float, metres
        Of a range of nothing, rounding included.
    range_share : float
        What each metre of range adds, metres.
    step_m : float, metres
        Ranges are multiples of it; 0 where they are of none.

    Examples
    --------
    An RPLidar A2 at 1 and at 10 m:

    >>> SensorNoise(0.005, 0.006).sigma([1, 10]).round(3)
    array([0.011, 0.065])
    """

    range_m: Deviation = USUAL_SIGMA_M
    range_share: Share = 0.0
    step_m: Deviation = 0.0

    def sigma(self, ranges: ArrayLike) -> Array:
        """Standard deviation of ranges, of any shape, metres."""
        return self.range_m + self.range_share * np.asarray(ranges, float)

    def __str__(self) -> str:
        share = f" and {self.range_share:.2%} of the range" if self.range_share else ""
        step = f", in steps of {1000 * self.step_m:g} mm" if self.step_m else ""
        return f"{1000 * self.range_m:.1f} mm{share}{step}"


def sensor_noise(log: Log) -> SensorNoise:
    """Estimate the noise from what neighbouring beams, and beams of a robot at rest, differ by.

    On a straight wall the inverse range of a beam follows from those of its two neighbours. And
    while the robot stands a beam measures the same again. All else, corners and leaves and people,
    only adds, and no laser is better farther off: so the noise of a class of range is no more than
    a farther one, or a robot at rest, has at most. (Of ten estimates the least is one of few beams,
    and too small; at most is three standard errors above it.) A line of two figures, none negative,
    is fitted to that. What is near to 1 cm, as that of most lasers, is told as 1 cm.

    Examples
    --------
    >>> from segmap import load
    >>> print(sensor_noise(load("room")))
    10.0 mm, in steps of 1 mm
    """
    arrays.instance(log, "log", Log)
    every = max(1, min(ONE_SCAN_OF, len(log) // LEAST_SCANS))
    ranges, errors = _errors_between_neighbours(log.scans[::every])
    sigmas, most, counts = _sigmas(ranges, errors)
    if np.isnan(sigmas).all():
        return SensorNoise()
    step = _range_step(ranges)
    rounding = step / float(np.sqrt(12))
    most = np.fmin(most, _sigmas(*_errors_at_rest(log))[1])
    least = np.fmin(sigmas, np.fmin.accumulate(most[::-1])[::-1]).clip(max(rounding, LEAST_M))
    valid = np.isfinite(least)
    weight = np.sqrt(counts[valid])
    rows = np.stack([0 * least + 1, MIDDLES_M], -1)[valid] * (weight / least[valid])[:, None]
    a, b = np.linalg.lstsq(rows, weight, rcond=None)[0]
    if min(a, b) < 0:  # the other one alone
        a, b = (rows.T @ weight / (rows**2).sum(0)) * ([1, 0] if b < 0 else [0, 1])
    far = float(a + b * np.quantile(ranges, 0.95))
    if far <= USUAL_FACTOR * USUAL_SIGMA_M:
        a, b = min(far, USUAL_SIGMA_M), 0.0
    return SensorNoise(round(max(float(a), rounding), 6), round(float(b), 6), step)


def warn_if_other_sensor(sensor: SensorNoise, measured: SensorNoise) -> None:
    """Warn where a sensor that was given is not the one that measured a log, near or far."""
    for metres in (1.0, 4.0):
        stated, actual = (max(float(s.sigma(metres)), USUAL_SIGMA_M) for s in (sensor, measured))
        if not 1 / OTHER_FACTOR <= stated / actual <= OTHER_FACTOR:
            warnings.warn(
                f"sensor has {1000 * stated:.0f} mm of noise at {metres:g} m, and this log has "
                f"{1000 * actual:.0f}: leave sensor out to take what the log says",
                stacklevel=3,
            )
            return


def robust_sigma(values: Array) -> float:
    """Standard deviation of values about 0, most of which are normal; others count no more.

    Examples
    --------
    >>> normal = np.random.default_rng(0).normal(0, 2, 1000)
    >>> round(robust_sigma(np.append(normal, np.full(100, 50.0))))
    2
    """
    sizes, count = abs(values), 0
    sigma = 1.4826 * float(np.median(sizes))
    for _ in range(10):  # what the cut at 2.5 takes away is given back
        inliers = sizes[sizes <= 2.5 * sigma]
        if len(inliers) == count:
            break
        sigma, count = float(np.sqrt((inliers**2).mean() / 0.9113)), len(inliers)
    return sigma


def _errors_between_neighbours(scans: Sequence[LaserScan]) -> tuple[Array, Array]:
    """Ranges of beams, and by how much neighbours differ, in standard deviations of one; metres."""
    gap = [np.nan]
    seen = (row for s in scans for row in (np.where(s.valid, s.ranges, np.nan), gap))
    r = np.concatenate([gap, *seen])
    a = np.concatenate([gap, *(row for s in scans for row in (s.angles, gap))])
    x, y = r * np.cos(a), r * np.sin(a)
    step = np.hypot(np.diff(x), np.diff(y))
    k = np.flatnonzero((step[:-1] < MOST_STEP_M) & (step[1:] < MOST_STEP_M)) + 1
    before, here, after = 1 / r[k - 1], 1 / r[k], 1 / r[k + 1]
    turn_before, turn_after = np.sin(a[k] - a[k - 1]), np.sin(a[k + 1] - a[k])
    across = np.sin(a[k + 1] - a[k - 1])
    off = before * turn_after + after * turn_before - here * across
    size = (before**2 * turn_after) ** 2 + (after**2 * turn_before) ** 2 + (here**2 * across) ** 2
    good = size > 0
    return r[k][good], (off / np.sqrt(np.where(good, size, 1.0)))[good]


def _errors_at_rest(log: Log) -> Array:
    """The same of each beam against itself, between scans from one place; a (2, n) array."""
    poses = log.odometry
    still = np.flatnonzero((np.abs(between(poses[:-1], poses[1:])) < STILL).all(1))
    rows = [np.empty((2, 0))]
    for k in still[:: max(1, len(still) // LEAST_SCANS)]:
        one, other = log[k], log[k + 1]
        if len(one) == len(other) and not np.array_equal(one.ranges, other.ranges, equal_nan=True):
            both = one.valid & other.valid
            apart = (one.ranges[both] - other.ranges[both]) / np.sqrt(2)
            rows.append(np.stack([one.ranges[both], apart]))
    return np.concatenate(rows, 1)


def _sigmas(ranges: Array, errors: Array) -> tuple[Array, Array, Array]:
    """Standard deviation of each class of range, and what it is at most, metres; number of beams.

    NaN for a class of few beams. Neighbours share beams: so a standard error is the deviation
    divided by the root of n, not of 2 n.
    """
    of = np.searchsorted(CLASSES_M, ranges)
    counts = np.bincount(of, minlength=len(MIDDLES_M)).astype(float)
    sigmas = np.full(len(MIDDLES_M), np.nan)
    for k in np.flatnonzero(counts > SURE**2):
        sigmas[k] = robust_sigma(errors[of == k])
    return sigmas, sigmas / (1 - SURE / np.sqrt(np.maximum(counts, 1))), counts


def _range_step(ranges: Array) -> float:
    """The largest of the usual steps of which nearly all ranges are multiples, metres, or 0."""
    part = ranges[:, None] / STEPS_M
    whole = (np.abs(part - np.rint(part)) < 1e-4).mean(0) > 0.99
    return float((whole * STEPS_M).max())
