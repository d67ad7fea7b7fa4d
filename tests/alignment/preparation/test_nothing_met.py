"""One number in many beams, which a driver writes where nothing was met, is no wall."""

from dataclasses import replace
from functools import cache

import alignment_logs as logs
import numpy as np
import pytest

from segmap import load
from segmap.alignment import pose_graph, position_errors, prepared
from segmap.scans import LaserScan, Log
from segmap.scans.causes import Cause
from segmap.simulation import OdometryNoise, box, circular_room, simulate

#: A hall most of which lies farther off than the laser reaches.
HALL = np.concatenate(
    [box(40, 25, (20, 12.5, 0)), *(box(1, 1, (x, y, 0)) for x, y in [(10, 5), (15, 12), (30, 18)])]
)


@cache
def hall() -> Log:
    """Across the hall, with the odometry of good wheels."""
    share = np.linspace(0, 1, 80)
    path = np.stack([6 + 24 * share, 6 + 9 * share, np.full(80, 0.36)], 1)
    rng = np.random.default_rng(3)
    return simulate(HALL, path, sensor=logs.AROUND, rng=rng, odometry_noise=OdometryNoise())


def written(log: Log, number: float, jitter: float = 0.0) -> Log:
    """The log of a driver that writes a number of metres where nothing was met, and no reach."""
    rng = np.random.default_rng(4)

    def filled(scan: LaserScan) -> LaserScan:
        off = jitter * rng.standard_normal(len(scan))
        ranges = np.where(scan.ranges == np.inf, number + off, scan.ranges)
        return replace(scan, ranges=ranges, max_range=np.inf)

    return replace(log, scans=tuple(map(filled, log)))


@pytest.mark.filterwarnings("ignore:half of the ranges")
@pytest.mark.parametrize(
    ("number", "jitter"),
    [(9999.0, 0.0), (8.0, 0.004), (12.0, 0.0), (65.533, 0.004)],
)
def test_a_number_in_most_beams_is_no_wall(number, jitter):
    """Catches a number in reach that is kept, walls that go with it, a false length or share."""
    log = hall()
    found = prepared(written(log, number, jitter))
    (finding,) = found.causes
    assert finding.cause is Cause.NOTHING_MET and not finding.doubtful
    assert f"{number:.4g}" in finding.words and "means nothing met" in finding.words
    share = np.mean([scan.ranges == np.inf for scan in log])
    assert jitter or f"{100 * share:.2g} % of all" in finding.words
    for now, before in zip(found, log, strict=True):
        nothing = before.ranges == np.inf
        assert (now.ranges[nothing] == np.inf).all()
        at_it = np.abs(before.ranges - number) < max(0.1, 0.02 * number * (jitter > 0))
        assert np.array_equal(now.ranges[~nothing & ~at_it], before.ranges[~nothing & ~at_it])
    assert log.truth is not None
    assert position_errors(pose_graph(found).poses, log.truth, best=True).max() < 0.1


def test_a_post_of_one_range_is_the_body_of_the_robot():
    """Catches a number that means nothing met where a post rides along, to the millimetre."""
    log = hall()
    scans = [replace(s, ranges=np.where(np.arange(len(s)) // 20 == 5, 0.6, s.ranges)) for s in log]
    (finding,) = prepared(replace(log, scans=tuple(scans))).causes
    assert finding.cause is Cause.BODY and finding.value == 20


def test_each_finding_stays_beside_the_others():
    """Catches a step of the preparation that forgets what the ones before it have found."""
    log = written(hall(), 9.999)
    times = 0.2 * np.arange(len(log)) - 50.0 * (np.arange(len(log)) > 40)
    found = prepared(logs.changed(log, odometry=log.odometry / (0.3048, 0.3048, 1), times=times))
    assert {Cause.CLOCK, Cause.NOTHING_MET, Cause.UNIT} <= {each.cause for each in found.causes}


def with_limit(log: Log, limit: float, noise: float) -> Log:
    """The log of a simulator that lays its noise on the limit too."""
    rng = np.random.default_rng(6)

    def noisy(scan: LaserScan) -> LaserScan:
        ranges = np.minimum(scan.ranges, limit) * (1 + noise * rng.standard_normal(len(scan)))
        return replace(scan, ranges=ranges, max_range=np.inf)

    return replace(log, scans=tuple(map(noisy, log)))


def test_beams_that_end_at_a_noisy_limit_met_nothing():
    """Catches a ring that moves with the robot, taken for walls: GOOD, and metres off."""
    log = with_limit(hall(), 5.6, 0.01)
    found = prepared(log)
    (finding,) = found.causes
    assert finding.cause is Cause.NOTHING_MET and abs(finding.value - 5.6) < 0.05
    ends = sum(int((scan.ranges > 5.3).sum()) for scan in log)
    assert sum(int((scan.ranges == np.inf).sum()) for scan in found) > 0.95 * ends
    bare = logs.without_odometry(log)
    (finding,) = prepared(bare).causes
    assert finding.cause is Cause.NOTHING_MET and finding.doubtful


def test_a_driver_may_have_several_numbers():
    """Catches a search that ends with the first."""
    log = written(hall(), 65.533)
    rng = np.random.default_rng(5)
    scans = (replace(s, ranges=np.where(rng.random(len(s)) < 0.1, 65.535, s.ranges)) for s in log)
    found = prepared(replace(log, scans=tuple(scans)))
    assert max(np.max(s.ranges, where=np.isfinite(s.ranges), initial=0) for s in found) < 13


def standing(walls: np.ndarray, pose: tuple[float, float, float], step: float) -> Log:
    """Sixty scans of one place whose ranges come in steps of so many metres."""
    sensor = replace(logs.AROUND, resolution=step, sigma=0.002)
    return simulate(walls, np.tile(pose, (60, 1)), sensor=sensor, rng=np.random.default_rng(1))


MEASURED = {
    "before a wall": lambda: standing(box(16, 10, (8, 5, 0)), (8, 4, 0), 0.01),
    "in the middle of a round room": lambda: standing(circular_room(8.0), (8, 8, 0), 0.01),
    "hall": hall,
    "in steps of 10 cm": lambda: replace(
        hall(), scans=tuple(replace(s, ranges=np.round(s.ranges, 1)) for s in hall())
    ),
    "corridor": lambda: load("corridor"),
    "room": lambda: load("room"),
}


@pytest.mark.parametrize("name", MEASURED)
def test_walls_at_one_distance_are_walls(name):
    """Catches a wall before which the robot stands, or which is round, taken for a number."""
    found = prepared(MEASURED[name]())
    assert Cause.NOTHING_MET not in {finding.cause for finding in found.causes}
