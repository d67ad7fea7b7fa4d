"""De-skewing: exact on a steady twist, sure of what it believes, and as good as standing still."""

from dataclasses import replace

import numpy as np
import pytest
from alignment_logs import L_ROOM, OFFICE, errors
from segmap_course import literal

from segmap.alignment import Alignment, deskew, pose_graph
from segmap.poses import between, compose, inverse, transform
from segmap.poses.motions import arc, twist
from segmap.scans import LaserScan, Log
from segmap.scans.causes import Cause
from segmap.scans.motion import motion_compensated, skew_warning, velocities
from segmap.simulation import OdometryNoise, Sensor, corridor_loop, drive, simulate

TURNED = "the beams are in the other order than the file says"
TWIST, OFFSET = np.array([0.4, -0.1, 0.9]), (0.2, -0.1, 0.7)
EXACT = Sensor("turning", 90, -3.0, np.radians(4), max_range=20.0)
#: 5.5 turns a second, as the cheapest lasers have.
PERIOD = 0.18
SPIN = Sensor("cheap", 360, 0.0, np.radians(1), max_range=8.0, sigma=0.01, period=PERIOD)
WAY = [(1, 5), (2, 5), (2, 7.8), (2, 5), (6, 5), (6, 2.2), (6, 4.4)]
PATH = drive(WAY, step=0.3 * PERIOD, turn=1.0 * PERIOD)


def off_walls(points: np.ndarray, walls: np.ndarray) -> np.ndarray:
    """Distance of points `(n, 2)` from the nearest wall, `(n,)`."""
    a, along = walls[:, 0], walls[:, 1] - walls[:, 0]
    rel = points[:, None] - a
    part = np.clip((rel * along).sum(-1) / (along**2).sum(-1), 0, 1)
    return np.hypot(*np.moveaxis(rel - part[..., None] * along, -1, 0)).min(1)


def points_of(log: Log, poses: np.ndarray) -> np.ndarray:
    return np.concatenate([transform(p, s.points()) for p, s in zip(poses, log, strict=True)])


def steady(sensor: Sensor = EXACT, place=OFFSET) -> Log:
    """A robot that drives and turns evenly, without any noise."""
    path = compose((2.0, 1.2, 0.3), arc(TWIST * sensor.period * np.arange(12)[:, None]))
    return simulate(L_ROOM, path, sensor=sensor, rng=np.random.default_rng(1), sensor_pose=place,
                    odometry_noise=OdometryNoise().ideal(), moving=True)  # fmt: skip


def shuffled(log: Log) -> Log:
    """The beams of each scan in another order."""
    order = np.random.default_rng(2).permutation(len(log[0]))
    kinds = ("ranges", "angles", "delays")
    scans = [replace(s, **{kind: getattr(s, kind)[order] for kind in kinds}) for s in log]
    return replace(log, scans=tuple(scans))


def moved(log: Log) -> Log:
    return replace(log, truth=compose((5.0, -3.0, 2.0), log.truth))


def late(log: Log) -> Log:
    """Years after 1970: seconds with nine digits before the point."""
    return replace(log, scans=tuple(replace(s, time=s.time + 2.0**30) for s in log))


WAYS = {
    "as it is": (steady, 1e-12),
    "clockwise": (lambda: steady(replace(EXACT, step=-EXACT.step)), 1e-12),
    "at the turning point": (lambda: steady(place=(0, 0, 0)), 1e-12),
    "shuffled": (lambda: shuffled(steady()), 1e-12),
    "moved": (lambda: moved(steady()), 1e-12),
    "late": (lambda: late(steady()), 1e-6),
}


@pytest.mark.parametrize("way", WAYS)
def test_a_steady_twist_is_undone_exactly(way):
    """Catches a wrong sign, half a twist, the laser's place left out, and beams out of order."""
    made, most = WAYS[way]
    log = made()
    walls = transform((5.0, -3.0, 2.0), L_ROOM) if way == "moved" else L_ROOM
    assert off_walls(points_of(log, log.truth), walls).max() > 0.1
    found = deskew(log, log.truth)
    assert off_walls(points_of(found, log.truth), walls).max() < most
    assert all(scan.delays is None for scan in found) and found.doubt == ""
    for before, after in zip(log, found, strict=True):
        assert (before.time, before.valid.tolist()) == (after.time, after.valid.tolist())
        assert np.abs(after.angles - before.angles).max() < 1  # not the same direction a turn on


def test_the_plain_loops_say_the_same():
    """Catches an error that the simulation shares, since both use one arc."""
    log = steady(replace(EXACT, beams=30, step=0.3))
    for k, found in enumerate(deskew(log, log.truth)):
        for beam in range(30):
            scan = log[k]
            said = literal.carry_beam(
                scan.ranges[beam], scan.angles[beam], scan.delays[beam], TWIST, OFFSET
            )
            assert (found.ranges[beam], found.angles[beam]) == pytest.approx(said, abs=1e-12)
    for motion in ((1.0, 2.0, 0.5), (-0.3, 0.1, -3.0), (0.2, 0.0, 0.0), (0.0, 0.0, 1.0)):
        said = literal.steady_twist(motion, 1.0)
        assert twist(np.array(motion)) == pytest.approx(said, abs=1e-12)
        assert literal.after(said, 1.0) == pytest.approx(motion, abs=1e-12)
        assert arc(np.array(said)) == pytest.approx(motion, abs=1e-12)


def test_without_times_of_the_beams_nothing_changes():
    """Catches zeros in the place of None, which differ by 9e-16; and a doubt of a robot at rest."""
    log = steady()
    bare = replace(log, scans=tuple(replace(scan, delays=None) for scan in log))
    assert deskew(bare) is bare and deskew(Log("none", [])).scans == ()
    assert skew_warning(bare, log.truth) == [] and pose_graph(bare).doubt == ""
    mixed = replace(log, scans=(bare[0], *log[1:]))
    assert deskew(mixed, log.truth)[0] is bare[0]
    still = simulate(L_ROOM, log.truth[[0] * 5], sensor=EXACT, rng=np.random.default_rng(1),
                     odometry_noise=OdometryNoise().ideal(), moving=True)  # fmt: skip
    assert skew_warning(still, still.truth) == []


def test_gaps_and_unplaced_scans_say_nothing_of_the_motion():
    """Catches a twist over a pause, by times that stand still, or by a pose that is none."""
    poses = np.array([(k, 0, 0.1 * k) for k in range(6)], float)
    times = np.array([0.0, 0.5, 0.5, 1.0, 3.0, 3.5])
    found = velocities(times, poses)
    speeds = twist(between(poses[:-1], poses[1:])) / 0.5
    expected = [speeds[0], speeds[0], speeds[2], speeds[2], speeds[4], speeds[4]]
    np.testing.assert_allclose(found, expected, atol=1e-12)
    poses[3] = np.nan
    assert velocities(times, poses)[[2, 3]].tolist() == [[0, 0, 0]] * 2
    times = np.arange(6) * 0.5
    assert velocities(times, poses * 0 + 1)[1].tolist() == [0, 0, 0]
    stamped = times + 0.05 * np.array(
        [0, 1, -1, 1.5, 1, -2]
    )  # by a computer that does other things
    even = np.array([(k, 0, 0.1 * k) for k in range(6)], float)
    np.testing.assert_allclose(velocities(stamped, even)[:, 2], 0.2, atol=0.02)
    lost = velocities(np.array([0, 0.5, 1.5, 2.0]), even[[0, 1, 3, 4]])
    np.testing.assert_allclose(lost[:, 2], 0.2)
    middle = velocities(times[:3], np.array([(0, 0, 0), (1, 0, 0), (4.0, 0, 0)]))
    np.testing.assert_allclose(middle[:, 0], [2, 4, 6])


def test_beams_stay_as_good_or_bad_as_they_were():
    """Catches walls where the laser met nothing, and a wall that moved out of reach."""
    ranges = [8.0, 9.0, np.inf, np.nan, 0.0, -1.0, 7.99, 7.99, 1.0]
    scan = LaserScan(ranges, np.linspace(-3, 3, 9), max_range=8.0, delays=np.full(9, 0.1))
    found = motion_compensated(scan, np.array([-0.3, 0.0, 0.2]))
    assert found.valid.tolist() == scan.valid.tolist()
    assert np.isposinf(found.ranges[:3]).all() and np.isnan(found.ranges[3])
    assert found.ranges[4:6].tolist() == [0, -1] and found.max_range > 8.1
    np.testing.assert_allclose(found.angles[:6], scan.angles[:6] + 0.2, atol=1e-12)
    np.testing.assert_allclose(found.points(), transform((-0.3, 0.0, 0.2), scan.points()))
    blind = LaserScan([np.inf], [0.0], max_range=8.0, delays=[0.0])
    assert motion_compensated(blind, np.zeros(3)).max_range == 8.0
    kept = replace(scan, codes=np.arange(9), odometry=(1, 2, 3))
    assert motion_compensated(kept, np.zeros(3)).codes.tolist() == list(range(9))


# ------------------------------------------------------------- an office, 5.5 turns a second
def simulated(moving: bool, sensor: Sensor = SPIN, seed: int = 1) -> Log:
    rng = np.random.default_rng(seed)
    return simulate(OFFICE, PATH, sensor=sensor, rng=rng, moving=moving)


def blur(log: Log) -> float:
    """Root mean square distance from the walls that the pose graph leaves, metres."""
    poses = pose_graph(log).poses
    poses = compose(compose(PATH[0], inverse(poses[0])), poses)
    off = off_walls(points_of(log, poses)[::7], OFFICE)
    return float(np.sqrt(np.mean(off[off < 0.3] ** 2)))


def test_walls_are_as_sharp_as_if_the_robot_had_stopped_in_whatever_order_beams_are_stored():
    """Catches half of the turn left, the second graph on the scans of the first, a sign that is
    believed, beams turned over where they need not be, and a skew that nobody tells."""
    still, skewed = blur(simulated(moving=False)), simulated(moving=True)
    unsure = replace(skewed, order_known=False)
    scans = [replace(scan, delays=scan.delays.max() - scan.delays) for scan in unsure]
    for log, said in ((unsure, ""), (replace(unsure, scans=tuple(scans)), TURNED)):
        carried = deskew(log)
        assert carried.doubt == said and blur(carried) < 1.2 * still
    told = "; ".join(map(str, skew_warning(skewed, skewed.truth)))
    assert "in 355 of 355" in told and "up to 10." in told
    placed = Alignment(skewed.truth, np.full(len(skewed), True), 0.0)
    a, b = deskew(skewed, placed), deskew(skewed, skewed.truth)
    assert all((p.ranges == q.ranges).all() for p, q in zip(a, b, strict=True))


def test_an_order_that_nothing_shows_is_left_alone():
    """Catches a coin that is tossed: a robot that drives straight on, or turns a few times."""
    path = drive([(1, 5), (5, 5)], step=0.3 * PERIOD)
    log = simulate(OFFICE, path, sensor=SPIN, rng=np.random.default_rng(1), moving=True,
                   odometry_noise=OdometryNoise().ideal())  # fmt: skip
    unsure = replace(log, order_known=False)
    found = deskew(unsure, log.truth)
    assert found.doubt == "nothing tells in which order the beams were measured"
    assert found.scans == unsure.scans and not found.order_known
    assert pose_graph(found[:20]).doubt.startswith("nothing tells in which order the beams")
    known = deskew(log, log.truth)
    assert known.doubt == "" and all(scan.delays is None for scan in known)


def test_a_robot_that_stood_while_it_measured_keeps_its_scans():
    """Catches times of beams that are believed: walls of a robot that stood are bent by them."""
    rng = np.random.default_rng(1)
    still = simulate(OFFICE, PATH, sensor=SPIN, rng=rng)
    turn = PERIOD * np.arange(360) / 360
    given = replace(
        still, scans=tuple(replace(s, time=PERIOD * k, delays=turn) for k, s in enumerate(still))
    )
    kept = deskew(given)
    (told,) = kept.causes
    assert told.cause is Cause.SKEW and "no beam is carried" in told.words
    assert all(s.delays is None and np.array_equal(s.ranges, o.ranges, equal_nan=True)
               for s, o in zip(kept, still, strict=True))  # fmt: skip
    moved = simulate(OFFICE, PATH, sensor=SPIN, rng=np.random.default_rng(1), moving=True)
    assert not deskew(moved).causes


def test_times_that_no_turn_takes_are_not_believed():
    """Catches beams carried by times that are 20 times too short, and no word of it."""
    log = simulate(OFFICE, PATH[:60], sensor=SPIN, rng=np.random.default_rng(1), moving=True)
    short = replace(log, scans=tuple(replace(s, delays=s.delays / 20) for s in log))
    found = deskew(short, log.truth)
    assert [finding.cause for finding in found.causes] == [Cause.SKEW]
    assert "not believed" in found.doubt
    assert all(np.array_equal(a.ranges, b.ranges) for a, b in zip(found, log, strict=True))
    assert "not believed" not in deskew(log, log.truth).doubt


def test_what_is_less_sharp_than_an_even_motion_is_not_taken():
    """Catches beams carried by the better of match and wheels, where both are worse."""
    path = compose(
        (2.0, 1.2, 0.3), arc(np.array((0.3, -0.1, 0.9)) * PERIOD * np.arange(25)[:, None])
    )
    wheels = OdometryNoise(turn_noise=0.5, heading_noise=0.3, distance_noise=0.3)
    log = simulate(L_ROOM, path, sensor=replace(SPIN, sigma=0.05, max_range=20.0), moving=True,
                   rng=np.random.default_rng(1), odometry_noise=wheels)  # fmt: skip
    pairs = zip(deskew(log), deskew(log, pose_graph(log).poses), strict=True)
    assert all(np.array_equal(a.ranges, b.ranges, equal_nan=True) for a, b in pairs)


@pytest.mark.parametrize(("way_round", "place"), [(1, (0, 0, 0)), (-1, (0.3, -0.15, 2.5))])
def test_a_laser_of_one_turn_a_second_is_carried_as_the_wheels_say(way_round, place):
    """Catches a motion that is even over a corner, 0.5 m off, and one of the laser's own place."""
    corners = [(1, 1), (29, 1), (29, 13), (1, 13), (1, 1), (10, 1)]
    path = drive(corners, step=1.0, turn=np.radians(45))
    slow = replace(SPIN, step=way_round * SPIN.step, max_range=12.0, period=1.0)
    walls, rng = corridor_loop(30, 14), np.random.default_rng(1)
    log = simulate(walls, path, sensor=slow, rng=rng, moving=True, sensor_pose=place)
    assert errors(log, pose_graph(deskew(log)).poses)[0].max() < 0.1
