"""An extended Kalman filter on walls: equal to least squares, consistent, and fooled as it must."""

from dataclasses import replace

import numpy as np
import pytest
from conftest import shared_file, slow

from segmap import Log, alignment, load, read, reduction
from segmap.extraction import build_map, extract_polylines
from segmap.matching import localize_ekf
from segmap.poses import compose, inverse, transform
from segmap.segments import SegmentMap, angle, midpoint, point_distance
from segmap.simulation import (
    SICK_LMS200,
    URG_04LX,
    OdometryNoise,
    Sensor,
    box,
    drive,
    rectangular_room,
    simulate,
)

ROOM = np.concatenate([rectangular_room(6.0, 4.0), box(0.8, 0.5, (4.5, 2.8, 0.3))])
PATH = drive([(1, 1), (5, 1), (5, 2), (1.5, 3)], step=0.2)
RING = Sensor("ring", 360, -np.pi, np.radians(1), max_range=30.0, sigma=0.01)
SPREAD = np.diag([0.1, 0.1, 0.03]) ** 2


def rng(seed):
    return np.random.default_rng(seed)


def seen(path=PATH, sensor=RING, seed=1, walls=ROOM):
    return simulate(walls, path, sensor=sensor, rng=rng(seed))


def tracked(walls, log, start, spread=SPREAD, **options):
    exact = {"odometry_noise": OdometryNoise(), "wall_sigma": 0.0}
    return list(localize_ekf(SegmentMap(walls), log, start, spread, **exact | options))


def off(pose, scan, state):
    """Of each pair its turn and offset, at any pose: the residuals that the filter makes small."""
    segments = transform(pose, extract_polylines(scan.points(), closed=scan.whole_turn))[
        state.pairs[:, 0]
    ]
    walls = ROOM[state.pairs[:, 1]]
    turn = (angle(segments) - angle(walls) + np.pi / 2) % np.pi - np.pi / 2
    (dx, dy), (x, y) = (walls[:, 1] - walls[:, 0]).T, (midpoint(segments) - walls[:, 0]).T
    return np.concatenate([turn, (dx * y - dy * x) / np.hypot(dx, dy)])


@pytest.mark.parametrize("mount", [(0, 0, 0), (0.3, -0.1, 0.5)])
def test_one_scan_corrects_as_least_squares_with_a_prior_do(mount):
    """From a heading past a turn.

    Catches a wrong sign or lever arm, variances for deviations, a sensor taken for the robot.
    """
    (scan,) = seen(PATH[12:13])
    beams = simulate(ROOM, compose(PATH[12], mount)[None], sensor=RING, rng=rng(1))[0]
    scan = replace(scan, ranges=beams.ranges, sensor_pose=mount)
    start = PATH[12] + (0.05, -0.04, 0.02)
    (state,) = tracked(ROOM, [scan], start + (0, 0, 2 * np.pi))
    assert len(state.pairs) >= 5 and state.unmatched <= 1
    found = extract_polylines(scan.points(), closed=scan.whole_turn)[state.pairs[:, 0]]
    count = (point_distance(scan.points()[:, None], found) < 0.03).sum(0)
    size = np.hypot(*(found[:, 1] - found[:, 0]).T)
    weight = np.concatenate([np.sqrt(count / 12) * size, np.sqrt(count)]) / 0.01
    steps = 1e-6 * np.eye(3)
    slope = np.stack([off(start + d, scan, state) - off(start - d, scan, state) for d in steps], 1)
    rows = np.concatenate([slope / 2e-6 * weight[:, None], np.linalg.inv(np.sqrt(SPREAD))])
    right = np.r_[-off(start, scan, state) * weight, 0, 0, 0]
    move = np.linalg.lstsq(rows, right, rcond=None)[0]
    assert state.pose == pytest.approx(start + move, abs=1e-6)
    assert state.covariance == pytest.approx(np.linalg.inv(rows.T @ rows), rel=1e-4)
    assert state.innovations.T.ravel() == pytest.approx(off(start, scan, state), abs=1e-9)


@pytest.mark.parametrize("seeds", [range(6), slow(range(50))])
@pytest.mark.parametrize("sensor", [URG_04LX, SICK_LMS200, RING], ids=lambda s: s.name)
def test_it_is_as_sure_as_it_may_be_on_true_walls(sensor, seeds):
    """Catches noise of the wheels or of the lines forgotten or counted twice: NEES is 3 then."""
    found, ends = [], []
    for seed in seeds:
        log = seen(sensor=sensor, seed=seed)
        start = log.truth[0] + rng(seed).normal(0, (0.1, 0.1, 0.03))
        states = tracked(ROOM, log, start)
        found += [s.nees(t) for s, t in zip(states[1:], log.truth[1:], strict=True)]
        ends.append(np.hypot(*(states[-1].pose - log.truth[-1])[:2]))
    assert 1.5 < np.mean(found) < 3.6  # noise lies along the beams, of which a part is across
    assert max(ends) < 0.01


def test_walls_may_be_named_otherwise():
    """Catches a normal or a bound along the wall that hangs on which end comes first."""
    log, order = seen(seed=3)[:20], rng(1).permutation(len(ROOM))
    start = log.truth[0] + (0.05, 0.02, -0.02)
    for one, other in zip(
        *(tracked(walls, log, start) for walls in (ROOM, ROOM[order][:, ::-1])), strict=True
    ):
        assert np.allclose(one.pose, other.pose, atol=1e-9)
        assert one.covariance == pytest.approx(other.covariance, abs=1e-12)
        assert (order[other.pairs[:, 1]] == one.pairs[:, 1]).all()


def test_what_the_map_does_not_have_is_left_out():
    """Catches a gate that lets everything in, and a wall that counts beyond its ends."""
    crate = box(0.6, 0.6, (2.5, 2.0, 0.4))
    log = seen(PATH[:15], walls=np.concatenate([ROOM, crate]))
    states = tracked(ROOM, log, log.truth[0])
    assert min(s.unmatched for s in states) >= 1
    assert max(s.distances.max() for s in states) <= 9.22  # of two numbers, one in a hundred more
    assert np.hypot(*(states[-1].pose - log.truth[-1])[:2]) < 0.01
    short = ROOM.copy()
    short[0, 1] = short[0, 0] + 0.1 * (short[0, 1] - short[0, 0])
    assert all(0 not in s.pairs[:, 1] for s in tracked(short, log, log.truth[0])[:1])


def test_a_wrong_pair_makes_it_sure_of_a_wrong_place():
    """The counter-example of the chapter: two walls 0.3 m apart, a start that is 0.3 m off."""
    walls = np.array([[(0, 0), (8, 0)], [(0, 3), (8, 3)], [(0, 3.3), (8, 3.3)]], float)
    log = simulate(walls[:2], drive([(2, 1), (5, 1)], step=0.2), sensor=RING, rng=rng(1))
    states = tracked(walls[1:], log, log.truth[0] + (0, 0.3, 0), np.diag([0.1, 0.3, 0.02]) ** 2)
    last = states[-1]
    assert (last.pairs[:, 1] == 1).all() and last.distances.max() < 9.3
    assert last.pose[1] - log.truth[-1, 1] == pytest.approx(0.3, abs=0.02)
    assert np.sqrt(last.covariance[1, 1]) < 0.01 and last.nees(log.truth[-1]) > 500


def test_a_scan_that_sees_nothing_leaves_what_odometry_says():
    """Catches a filter that stays where it is, and one that grows no less sure."""
    log = seen(PATH[:4])
    blind = [replace(s, ranges=np.full(len(s), np.inf)) for s in log]
    states = tracked(ROOM, blind, log.truth[0])
    way = compose(inverse(log[0].odometry), log[3].odometry)
    assert states[-1].pose == pytest.approx(compose(log.truth[0], way), abs=1e-9)
    grown = [np.linalg.det(s.covariance) for s in states]
    assert np.allclose(states[0].covariance, SPREAD) and (np.diff(grown) > 0).all()
    (none,) = localize_ekf(SegmentMap(np.zeros((0, 2, 2))), log[:1], log.truth[0], SPREAD)
    assert none.unmatched > 3 and none.pose == pytest.approx(log.truth[0])


def test_wheels_and_walls_that_err_make_it_less_sure():
    """Catches a deviation that is read and not used."""
    log = seen(PATH[:6])

    def sureness(**options):
        last = tracked(ROOM, log, log.truth[0], **options)[-1]
        return 1 / np.linalg.det(last.covariance)

    usual = sureness()
    assert sureness(odometry_noise=OdometryNoise().ideal()) > 2 * usual
    assert 2 * sureness(wall_sigma=0.02) < usual > 2 * sureness(sigma=0.03)


def on_real(log, poses):
    """Errors in metres, NEES and lost at each scan, on the log's own walls."""
    walls = SegmentMap(reduction.least_cost(build_map(log, poses)).segments)
    states = list(localize_ekf(walls, log, poses[0], np.diag([0.05, 0.05, 0.02]) ** 2))
    off = [np.hypot(*(s.pose - p)[:2]) for s, p in zip(states, poses, strict=True)]
    nees = [s.nees(p) for s, p in zip(states, poses, strict=True)]
    return np.array(off), np.array(nees), np.array([s.lost for s in states])


def test_it_keeps_to_real_walls_and_knows_how_well():
    """Malaga. Catches a motion without noise across the way, which stays 0.2 m to the side."""
    log = load("malaga")
    off, nees, lost = on_real(log, alignment.pose_graph(log).poses)
    assert off.mean() < 0.05 and np.median(nees) / 3 < 1 and nees.mean() / 3 < 10
    assert lost.mean() < 0.05


def test_it_is_lost_soon_after_it_has_left_the_walls():
    """Intel, whose wheels slip by metres. Catches a filter that is sure of a wrong place."""
    log = read(shared_file("data/intel.log.gz"))[:1000]
    off, _, lost = on_real(Log("intel", list(log), log.truth), log.truth)
    begins = np.flatnonzero((off > 0.5) & (np.r_[0.0, off[:-1]] <= 0.5))
    for k in begins:  # lost, or back on the walls, within ten scans
        assert lost[k : k + 11].any() or (off[k : k + 11] <= 0.5).any(), k
    assert len(begins) and lost[off < 0.3].mean() < 0.2
