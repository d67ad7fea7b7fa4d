"""The noise of a laser, estimated and used: what is 1 cm changes nothing, what is noisier does."""

from dataclasses import replace

import numpy as np
import pytest

from segmap import load, metrics, simulation
from segmap.extraction import build_map, extract_polylines
from segmap.scans import LaserScan, Log, SensorNoise, sensor_noise

WALLS = np.concatenate([simulation.box(12, 5), simulation.box(1.0, 0.6, (2, 1, 0.3))])


def drive(range_m: float, share: float, seed: int = 7) -> Log:
    """A drive through a hall, by a laser of 450 beams a turn."""
    sensor = replace(simulation.URG_04LX, beams=450, first=-np.pi, step=np.radians(0.8))
    sensor, rng = replace(sensor.ideal(), max_range=12.0), np.random.default_rng(seed)
    path = simulation.drive([(-5, -1), (5, -1)], step=0.25)
    log = simulation.simulate(WALLS, path, sensor=sensor, rng=rng)
    sigmas = SensorNoise(range_m, share).sigma
    noisy = [replace(s, ranges=s.ranges + sigmas(s.ranges) * rng.normal(size=450)) for s in log]
    return Log("hall", noisy, log.truth)


@pytest.mark.parametrize("range_m, share", [(0.005, 0.006), (0.015, 0.0), (0.03, 0.0)])
def test_the_noise_of_a_log_is_estimated(range_m, share):
    """Catches an estimate that corners, or other ranges, spoil."""
    found = sensor_noise(drive(range_m, share))
    for metres in (1.0, 3.0, 6.0):
        assert found.sigma(metres) == pytest.approx(range_m + share * metres, rel=0.2)


def test_few_beams_do_not_decide():
    """Catches the least of many estimates, that of few beams: 1.5 cm was told as 1 cm."""
    sigmas = [sensor_noise(drive(0.015, 0.0, seed)).sigma(1.0) for seed in range(20)]
    assert sigmas == pytest.approx([0.015] * 20, rel=0.06)


@pytest.mark.parametrize("name", ["malaga", "room", "corridor"])
def test_a_laser_of_1_cm_keeps_its_map(name):
    """Catches a tolerance, a gap or a weight that moves a map for which 3 cm were chosen."""
    log = load(name)
    poses = log.odometry if log.truth is None else log.truth
    whole, fixed = build_map(log, poses), build_map(log, poses, tolerance=0.03)
    assert np.array_equal(whole.segments, fixed.segments)


def test_ranges_tell_their_step():
    """Catches a step that is a whole number of another one."""
    assert [sensor_noise(load(name)).step_m for name in ("malaga", "room")] == [0.01, 0.001]


def test_a_laser_without_noise_has_none():
    """Catches a division by a noise of nothing."""
    assert sensor_noise(drive(0.0, 0.0)).sigma(5.0) < 1e-4


def test_noise_that_grows_invents_no_walls():
    """Catches far points that draw what was seen from near, and chords across jumps."""
    log = drive(0.005, 0.006)
    seen = build_map(log, log.truth)
    invented = [
        metrics.against_walls(WALLS, map, seen=seen).invented
        for map in (build_map(log, log.truth, tolerance=0.03), seen)
    ]
    assert invented[1] < 0.3 * invented[0]
    assert len(seen) < 0.7 * len(build_map(log, log.truth, tolerance=0.03))


def test_points_count_by_their_variance():
    """Catches a line that noisy points turn as much as good ones."""
    x = np.linspace(1, 9, 81)
    points = np.stack([x, 0.5 + np.where(x > 5, 0.02 * (-1.0) ** np.arange(81) + 0.02, 0.0)], -1)
    noise = SensorNoise(0.0, 0.01)
    (segment,) = extract_polylines(points, sensor=noise)
    own = np.maximum(0.03, 0.03 + 4 * (noise.sigma(np.hypot(*points.T)) - 0.01))
    slope, offset = np.polyfit(*points.T, 1, w=1 / own)
    assert np.allclose(segment[:, 1], slope * segment[:, 0] + offset, atol=1e-4)
    assert not np.allclose(segment[:, 1], np.polyval(np.polyfit(*points.T, 1), segment[:, 0]), 1e-3)


def test_a_sensor_that_is_not_the_logs_is_told():
    log = load("room")[:20]
    with pytest.warns(UserWarning, match="leave sensor out"):
        build_map(log, log.truth, sensor=SensorNoise(0.03))


def test_few_beams_far_apart_are_no_wall():
    """Catches 477 mm of noise for twelve beams of a room, whose ends lie metres apart."""
    angles = np.radians(np.arange(0, 360, 30.0))
    ranges = 1.5 / np.maximum(np.abs(np.cos(angles)), np.abs(np.sin(angles)))
    assert sensor_noise(Log("few", [LaserScan(ranges, angles)] * 3)) == SensorNoise()
    assert sensor_noise(Log("none", [])) == SensorNoise()
