"""Scans of a laser that turns in a moving hand: pose and motion come out of one match."""

from dataclasses import replace

import numpy as np
import pytest
from conftest import shared_file

from segmap import read
from segmap.alignment import LiveGraph, Tracking, deskew, pose_graph, prepared
from segmap.carried import CarriedMap
from segmap.matching import LiveMap
from segmap.poses import between, compose, transform
from segmap.poses.motions import arc, twist
from segmap.scans import LaserScan, Log
from segmap.segments import point_distance
from segmap.simulation import (
    URG_04LX,
    OdometryNoise,
    Sensor,
    box,
    cast_rays,
    drive,
    office,
    simulate,
)

#: A turn of 0.1 s, as an LD19 makes it.
PERIOD_S = 0.1
WALLS = np.concatenate(
    [box(6, 4, (3, 2, 0)), box(1, 0.6, (2, 3, 0.3)), box(0.5, 0.5, (4.7, 1.2, 0.8))]
)


def hand(turns, way=0.06):
    """Poses `(k, 3)` at the begin of scans: a hand that walks, and turns by so much a scan."""
    heading = np.radians(np.r_[0.0, np.cumsum(turns)])
    x = 1.2 + way * np.arange(len(heading))
    return np.stack([x, 1.3 + 0.2 * np.sin(x), heading], -1)


def recorded(path, *, walls=WALLS, clockwise=False, sensor_pose=(0.0, 0.0, 0.0), noise=0.01):
    """The log without its odometry: nothing but beams and their times."""
    step = 2 * np.pi / 450 * (-1 if clockwise else 1)
    sensor = Sensor("LD19", 450, 0.0, step, max_range=12.0, sigma=noise, period=PERIOD_S)
    log = simulate(
        walls, path, sensor=sensor, rng=np.random.default_rng(5), moving=True,
        sensor_pose=sensor_pose, odometry_noise=OdometryNoise().ideal(),
    )  # fmt: skip
    return replace(log, scans=tuple(replace(scan, odometry=None) for scan in log))


def in_mid_turn(path):
    """The true poses then."""
    steps = twist(between(path[:-1], path[1:]))[[*range(len(path) - 1), -1]]
    return compose(path, arc(steps / 2))


def tracked(log, **rules):
    graph = LiveGraph(tracking=Tracking(moving=True, **rules))
    graph.extend(log)
    return graph


def motions(graph):
    """Velocity and acceleration at each scan, `(k, 6)`."""
    return np.array([row.motion for row in graph.front_end.rows])


def off(graph, path):
    """Errors of the poses in mid-turn, from the first on, metres and radians."""
    truth = in_mid_turn(path)
    return np.abs(between(between(truth[0], truth), between(graph.poses[0], graph.poses)))


TURNS = np.r_[np.full(12, 20.0), np.full(12, -24.0), np.full(12, 8.0)]


@pytest.mark.parametrize("clockwise", [False, True])
@pytest.mark.parametrize("sensor_pose", [(0.0, 0.0, 0.0), (0.15, -0.1, 2.8)])
def test_a_hand_that_turns_gets_poses_and_motion(clockwise, sensor_pose):
    """Catches a velocity of the wrong sign, one in the frame of the map, and a laser that is taken
    for the middle of the robot."""
    path = hand(TURNS)
    graph = tracked(recorded(path, clockwise=clockwise, sensor_pose=sensor_pose))
    errors = off(graph, path)
    assert np.hypot(errors[:, 0], errors[:, 1]).max() < 0.02 and errors[:, 2].max() < 0.01
    found = np.degrees(motions(graph)[2:-1, 2] * PERIOD_S)
    assert np.median(np.abs(found - TURNS[2:])) < 0.5
    assert not any(graph.unmatched)


@pytest.mark.parametrize("seed", [4])
def test_a_hand_that_stops_and_turns_by_forty_degrees_a_scan_is_followed(seed):
    """Catches a scan that is bent by 40 degrees and matched as measured alone: not placed, and the
    map goes on from a bent one, 3 m off after some more."""
    rng, turns = np.random.default_rng(seed), [0.0]
    while len(turns) < 110:
        for turn in (0.0, 40.0 * rng.choice([-1, 1])):
            turns += [turn] * int(rng.integers(3, 14))
    corners = np.array([(1, 5), (2, 5), (2, 6.9), (2, 5), (2, 3.1), (2, 5), (6, 5), (6, 6.9)])
    along = np.r_[0.0, np.cumsum(np.hypot(*np.diff(corners, axis=0).T))]
    way = np.cumsum(0.1 * (np.array(turns) != 0))
    places = [np.interp(way, along, column) for column in corners.T]
    path = np.stack([*places, np.radians(np.cumsum(turns))], -1)
    graph = tracked(recorded(path, walls=office(rng=np.random.default_rng(1))))
    errors = off(graph, path)
    assert np.hypot(errors[:, 0], errors[:, 1]).max() < 0.03 and errors[:, 2].max() < 0.01
    assert not any(graph.unmatched)


@pytest.mark.parametrize("stops", [False, True])
@pytest.mark.parametrize("share", [0.5, 0.7])
@pytest.mark.parametrize("degrees", [40, -40])
def test_a_hand_that_begins_or_ends_to_turn_within_a_scan_is_found_to(degrees, share, stops):
    """Catches an acceleration in the place of a jump: half of the scan 0.2 m off its walls."""
    turn, count = np.radians(degrees), 450
    angles = np.angle(np.exp(2j * np.pi * np.arange(count) / count))
    delays = PERIOD_S * np.arange(count) / count
    graph, rng = LiveGraph(tracking=Tracking(moving=True)), np.random.default_rng(1)

    def turned(scans):
        """How far the hand has turned after so many scans."""
        return turn * (np.minimum(scans, 4 + share) if stops else np.maximum(scans - 4 - share, 0))

    for k in range(6):
        headings = turned(k + delays / PERIOD_S)
        poses = np.stack([1.2 + 0 * headings, 1.3 + 0 * headings, headings], -1)
        ranges = [float(cast_rays(WALLS, pose, [angle], max_range=12.0)[0])
                  for pose, angle in zip(poses, angles, strict=True)]  # fmt: skip
        order = np.argsort(angles)
        noisy = (np.array(ranges) + rng.normal(0, 0.01, count))[order]
        graph.add(LaserScan(noisy, angles[order], k * PERIOD_S, delays=delays[order]))
    carried = graph.tracked(4).scan
    there = transform((1.2, 1.3, turned(4.5)), carried.points())
    assert np.quantile(distance_to_walls(there), 0.95) < 0.04
    change = graph.tracked(4).motion[5] * PERIOD_S
    assert abs(change + (turn if stops else -turn)) < 0.1 * abs(turn)


def test_what_is_drawn_is_carried_and_the_first_scan_too():
    """Catches a first scan that bends all walls, and a map of the scans as they came."""
    path = hand(np.full(20, 22.0), way=0.02)
    log = recorded(path, noise=0.0)
    live = LiveMap(LiveGraph(tracking=Tracking(moving=True)))
    steps = [live.add(scan) for scan in log]
    live.finish()
    assert np.degrees(steps[9].motion[2] * PERIOD_S) == pytest.approx(22.0, abs=0.5)
    truth = in_mid_turn(path)
    scans = [live.graph.tracked(number).scan for number in range(len(log))]
    half = log[1].delays.max() / 2
    assert scans[1].time == pytest.approx(log[1].time + half) and scans[1].delays is None
    for number in (0, 1, 10):
        carried, came = (transform(truth[number], one[number].points()) for one in (scans, log))
        assert distance_to_walls(carried).max() < 0.02 < 0.1 < distance_to_walls(came).max()
    leaves = live.map.leaves()
    ended = leaves.occ > 0
    ends = np.stack([leaves.x, leaves.y], -1)[ended] + leaves.side[ended, None] / 2
    assert np.mean(distance_to_walls(transform(truth[0], ends)) < 0.06) > 0.97


def distance_to_walls(points):
    return point_distance(points[:, None], WALLS).min(axis=1)


def test_a_log_is_carried_to_the_begin_of_its_scans_by_the_motion_in_each():
    """Catches a motion that is that between its neighbours: here it changes from scan to scan."""
    path = hand(TURNS)
    carried = deskew(recorded(path, noise=0.0))
    assert not carried.causes and all(scan.delays is None for scan in carried)
    off = [
        distance_to_walls(transform(pose, scan.points())).mean()
        for pose, scan in zip(path, carried, strict=True)
    ]
    assert max(off[:-1]) < 0.02  # by neighbours .13


def test_a_scan_that_fails_leaves_the_graph_as_it_was(monkeypatch):
    """Catches a first scan that stays carried though the second was not placed."""
    path = hand(np.full(5, 15.0))
    log = recorded(path)
    graph = LiveGraph(tracking=Tracking(moving=True))
    graph.add(log[0])
    with monkeypatch.context() as patch, pytest.raises(ZeroDivisionError):
        patch.setattr(graph.front_end, "needs_frame", lambda *given: 1 / 0)
        graph.add(log[1])
    assert len(graph) == 1 and graph.tracked(0).scan is log[0]
    assert np.array_equal(graph.front_end.frames.rows[0].points, log[0].points())
    for scan in log[1:]:
        graph.add(scan)
    assert np.array_equal(graph.poses, tracked(log).poses)


def test_after_a_break_a_map_begins_with_a_carried_scan():
    """Catches a second map that is bent by the scan with which it begins."""
    path = hand(np.r_[TURNS[:20], np.full(14, 20.0)])
    log = recorded(path)
    covered = [
        replace(scan, ranges=np.full(len(scan), np.inf)) if 20 <= k < 24 else scan
        for k, scan in enumerate(log)
    ]
    graph = tracked(replace(log, scans=covered))
    apart = between(graph.poses[26], graph.poses[26:])
    truth = in_mid_turn(path)
    errors = np.abs(between(between(truth[26], truth[26:]), apart))
    assert errors[:, :2].max() < 0.05 and errors[:, 2].max() < 0.02


def test_a_turn_that_begins_within_a_scan_is_found():
    """Catches a match that knows an even motion alone, and half of an acceleration."""
    since = np.arange(450) / 450 * PERIOD_S
    acceleration = np.radians(12) / PERIOD_S**2 * 2  # 12 degrees by the end of the fifth scan
    headings = np.r_[np.zeros(4 * 450), acceleration * since**2 / 2]
    beams = np.arange(450) * 2 * np.pi / 450
    scans = []
    for k, turned in enumerate(headings.reshape(-1, 450)):
        aims = zip(turned, beams, strict=True)
        ranges = [cast_rays(WALLS, (1.2, 1.3, heading), [beam])[0] for heading, beam in aims]
        scans.append(LaserScan(ranges, beams, k * PERIOD_S, delays=since))
    last = tracked(Log("begins", scans)).tracked(4)
    middle = (1.2, 1.3, acceleration * (since[-1] / 2) ** 2 / 2)
    assert distance_to_walls(transform(middle, last.scan.points())).max() < 0.02
    assert last.motion[5] == pytest.approx(acceleration, rel=0.2)


@pytest.mark.slow
def test_a_real_drive_is_followed_as_its_loops_have_it():
    """Catches jumps that hold a real scan by chance: 0.9 m off where a hundredth more is enough."""
    log = read(shared_file("data/urg04lx-exp1.dat.gz"))[350:]
    graph, live = pose_graph(prepared(log)), CarriedMap()
    for scan in log:
        live.add(scan)
    live.finish()
    off = between(live.poses[0], live.poses) - between(graph.poses[0], graph.poses)
    assert np.hypot(off[:, 0], off[:, 1]).max() < 0.6


def test_a_hall_of_which_little_is_seen_sets_no_motion_free():
    """Catches a match that slides along what no wall fixes, scan after scan: metres off."""
    hall, path = box(12, 9, (6, 4.5, 0)), drive([(2, 2), (10, 2), (10, 7)], step=0.1)
    rng = np.random.default_rng(1)
    log = simulate(hall, path, sensor=URG_04LX, rng=rng, moving=True)
    assert off(tracked(log), path)[:, :2].max() < 0.12


def test_stamps_that_jitter_are_no_speed():
    """Catches a speed that is that of the stamps of a computer, which come late."""
    path, rng = hand(TURNS), np.random.default_rng(0)
    log = recorded(path)
    late = [replace(scan, time=scan.time + rng.uniform(0, 0.02)) for scan in log]
    errors = off(tracked(replace(log, scans=late)), path)
    assert errors[:, :2].max() < 0.03 and errors[:, 2].max() < 0.01


@pytest.mark.parametrize("delays", [None, 0.0])
def test_without_times_of_beams_nothing_is_carried(delays):
    """Catches a division by a turn that takes no time."""
    log = recorded(hand(TURNS[:6]))
    times = None if delays is None else np.zeros(450)
    untimed = replace(log, scans=tuple(replace(scan, delays=times) for scan in log))
    plain = LiveGraph()
    plain.extend(untimed)
    assert np.array_equal(tracked(untimed).poses, plain.poses)
    assert not motions(tracked(untimed)).any()
    assert tracked(untimed).tracked(3).scan is untimed[3]
