"""Places that look alike: equal offices are told apart, and the odometry has its word on a turn."""

import numpy as np
import pytest
from conftest import slow
from segmap_course import equal_offices

from segmap.alignment import LiveGraph, LoopClosing, pose_graph, position_errors
from segmap.angles import wrap
from segmap.poses import between
from segmap.scans import Log
from segmap.simulation import OdometryNoise, Sensor, polyline, simulate

LASER = Sensor("laser", 181, -np.pi / 2, np.pi / 180, max_range=12.0, sigma=0.01)
#: Teeth of a round hall, degrees from one to the next, and its radius and their depth, metres.
PITCH, RADIUS, TEETH = 8.0, 5.0, 0.3


def turning_in_a_hall_of_teeth(seed: int, step: float) -> Log:
    """A robot turns on the spot where a turn by 8 degrees shows the same walls again."""
    at, count = np.radians(np.arange(0, 360, PITCH / 2)), round(400 / step)
    far = np.where(np.arange(len(at)) % 2, RADIUS, RADIUS + TEETH)
    walls = polyline(np.stack([far * np.cos(at), far * np.sin(at)], -1), closed=True)
    k = np.arange(count)
    path = np.stack([0.05 * np.cos(k), 0.05 * np.sin(k), wrap(np.radians(step) * k)], -1)
    rng = np.random.default_rng(seed)
    return simulate(walls, path, sensor=LASER, rng=rng, odometry_noise=OdometryNoise())


@pytest.mark.parametrize("step", [20.0, 30.0])
@pytest.mark.parametrize("seed", [1, 2])
def test_where_a_turn_fits_as_well_the_odometry_has_its_word(seed, step):
    """Catches a scan that is turned back, by 8 to 40 degrees, to where it sees nothing new.

    Of half a round a turn of 30 degrees shows a sixth that no scan has seen: there the true heading
    fits less than a false one, though the odometry errs by 3 degrees at most. Where it errs by more
    than half the pitch, nothing tells.
    """
    log = turning_in_a_hall_of_teeth(seed, step)
    steps = [between(p[:-1], p[1:])[:, 2] for p in (log.truth, log.odometry, pose_graph(log).poses)]
    wheels, found = (np.degrees(np.abs(wrap(each - steps[0]))) for each in steps[1:])
    assert (wheels < PITCH / 2).mean() > 0.9
    assert found[wheels < 3].max() < 1


def false_loops(graph, log: Log) -> int:
    """How many loops are wrong by more than a metre."""
    i, j = graph.edges[graph.loop].T
    wrong = between(graph.relative[graph.loop], between(log.truth[i], log.truth[j]))
    return int((np.hypot(*wrong[:, :2].T) > 1).sum())


def live(log: Log, **options) -> LiveGraph:
    graph = LiveGraph(**options)
    graph.extend(log)
    return graph


@pytest.mark.parametrize("seed", [0, *map(slow, (1, 2, 4, 5))])
def test_the_defences_keep_false_loops_out_of_equal_offices(seed):
    """Chapters 56 and 11: no false loop, after the drive and during it."""
    log = equal_offices(seed)
    after, during = pose_graph(log), live(log)
    for graph, poses in ((after.graph, after.poses), (during.graph, during.poses)):
        assert graph.loop.sum() > 20 and false_loops(graph, log) == 0
        assert position_errors(poses, log.truth).max() < 0.11
    assert after.sure.all()


@pytest.mark.parametrize("seed", [*map(slow, (0, 1, 2, 4, 5))])
def test_a_window_that_is_too_wide_folds_equal_offices(seed):
    """Chapters 56 and 11: most loops are false; at the end they are dropped, or it is doubtful."""
    log = equal_offices(seed)
    folded = pose_graph(log, drift=0.3)
    off = position_errors(folded.poses, log.truth, best=True).max()
    assert off < 0.5 or folded.verdict.grade == "doubtful"
    wide = live(log, closing=LoopClosing(reach=5.0))
    assert false_loops(wide.graph, log) > 30
    assert position_errors(wide.poses, log.truth).max() > 3.9
