"""Times that go back, leap or are all equal; ranges in another unit."""

from dataclasses import replace

import alignment_logs as logs
import numpy as np
import pytest

from segmap import load
from segmap.alignment import pose_graph, position_errors, prepared
from segmap.scans.causes import Cause
from segmap.simulation import OdometryNoise


@pytest.mark.parametrize("by", [-5.0, -3600.0, 3600.0])
def test_a_clock_that_is_set_goes_on(by):
    """Catches scans in another order, times before the change that move, and a leap that stays."""
    log = load("corridor")
    times = log.times
    found = prepared(logs.changed(log, times=times + np.where(np.arange(len(log)) >= 60, by, 0.0)))
    (finding,) = found.causes
    assert finding.cause is Cause.CLOCK and not finding.doubtful
    assert abs(finding.value - by - 0.6) < 1e-6 and "at scan 60" in finding.words
    assert np.allclose(found.times, times)
    assert all(np.array_equal(a.ranges, b.ranges) for a, b in zip(found, log, strict=True))


def test_a_pause_is_no_leap():
    """Catches a robot that waits for a minute."""
    log = load("corridor")
    times = log.times + np.where(np.arange(len(log)) >= 60, 60.0, 0.0)
    assert not prepared(logs.changed(log, times=times)).causes


@pytest.mark.parametrize("waiting", [2, 4, 8])
def test_scans_that_waited_for_the_recorder_lie_where_they_were_measured(waiting):
    """Catches odometry of the arrival that is taken for that of the scan: 1.8 m off, and GOOD."""
    log = load("corridor")
    times, rows = log.times, log.odometry
    for last in range(20 + waiting - 1, len(log), 20):
        waited = slice(last - waiting + 1, last + 1)
        times[waited] = times[last] - 0.003 * np.arange(waiting)[::-1]
        rows[waited] = rows[last]
    late = logs.changed(log, times=times, odometry=rows)
    mended = prepared(late)
    assert [finding.cause for finding in mended.causes] == [Cause.CLOCK]
    assert mended.causes[0].value == waiting * len(range(20 + waiting - 1, len(log), 20))
    assert np.allclose(mended.times, log.times)
    alignment = pose_graph(mended)
    off = position_errors(alignment.poses, log.truth, best=True)
    assert alignment.verdict.grade == "good" and off.max() < 0.05


def test_the_last_scans_wait_too_but_not_the_first_or_those_of_a_robot_that_stands():
    """Catches a group that ends with the log, one before which nothing is known, and wheels that
    are believed against the scans."""
    log = load("corridor")[:40]
    times, rows = log.times, log.odometry
    times[-4:], rows[-4:] = times[-1] - 0.003 * np.arange(4)[::-1], rows[-1]
    (finding,) = prepared(logs.changed(log, times=times, odometry=rows)).causes
    assert finding.cause is Cause.CLOCK and finding.value == 4
    first = load("corridor")[:8]
    times, rows = first.times + 0.3 * (np.arange(8) > 6), first.odometry
    times[:3], rows[:3] = times[3] - 0.003 * np.arange(3, 0, -1), rows[3]
    begun = prepared(logs.changed(first, times=times, odometry=rows))
    assert np.array_equal(begun.times, times)
    twice = load("corridor")[:40]  # and no pause before them
    times, rows = twice.times, twice.odometry
    times[20:22], rows[20] = times[20] - (0.05, 0.047), rows[21]
    even = prepared(logs.changed(twice, times=times, odometry=rows))
    assert np.array_equal(even.times, times)
    room = load("room")
    stands = room[[*range(20), 20, 20, 20, *range(21, len(room))]]
    later = room.times[20:] + 0.5 * np.median(np.diff(room.times))
    times = np.r_[room.times[:20], later[0] + 0.003 * np.arange(3), later[1:]]
    assert not prepared(logs.changed(stands, times=times)).causes


def test_scans_of_two_lasers_that_come_together_have_not_waited():
    """Catches a second laser whose scans are moved back, by a clock that jitters."""
    log, order = load("corridor"), np.sort(np.r_[np.arange(153), np.arange(0, 153, 3)])
    rear = np.diff(order, prepend=-1) == 0
    times = log.times + np.random.default_rng(1).uniform(-0.02, 0.02, len(log))
    both = logs.changed(log[order], times=times[order] + 0.003 * rear)
    scans = [replace(s, sensor_pose=(-0.2 * r, 0, 0)) for s, r in zip(both, rear, strict=True)]
    assert not prepared(replace(both, scans=tuple(scans))).causes


def test_times_that_are_all_equal_are_none():
    """Catches zeros that are used as times."""
    found = prepared(logs.changed(load("corridor"), times=np.zeros(153)))
    assert np.isnan(found.times).all() and not found.causes


def test_scans_in_another_order_are_told_and_kept():
    """Catches a clock that is mended where the scans were shuffled."""
    log = load("corridor")
    order = np.random.default_rng(1).permutation(len(log))
    found = prepared(log[order])
    assert Cause.ORDER in {finding.cause for finding in found.causes}
    assert np.array_equal(found.times, log.times[order])


@pytest.mark.parametrize(("unit", "factor"), [("centimetres", 100.0), ("millimetres", 1000.0)])
@pytest.mark.filterwarnings("ignore:half of the ranges")
def test_ranges_are_in_the_unit_in_which_the_wheels_go_the_same_way(unit, factor):
    """Catches a factor upside down, a reach that stays, and a guess that is not told as one."""
    log = logs.loop_log(step=0.25)[:150]
    scans = (replace(s, ranges=s.ranges * factor, max_range=s.max_range * factor) for s in log)
    wrong = replace(log, scans=tuple(scans))
    found = prepared(wrong)
    (finding,) = found.causes
    assert finding.cause is Cause.UNIT and unit in finding.words and not finding.doubtful
    assert np.allclose(found[5].ranges, log[5].ranges) and np.isclose(
        found[5].max_range, log[5].max_range
    )
    blind = logs.without_odometry(wrong)
    (guessed,) = prepared(blind).causes
    assert guessed.cause is Cause.UNIT and guessed.doubtful and unit in guessed.words


@pytest.mark.parametrize("period", [2, 3])
def test_wheels_that_are_read_less_often_than_the_laser_drive_on_between(period):
    """Catches rows that repeat and are taken for a robot that stands: a map that is metres off."""
    log = logs.loop_log(OdometryNoise(), step=0.2)[:200]
    rows = log.odometry[np.arange(len(log)) // period * period]
    mended = prepared(logs.changed(log, odometry=rows))
    assert [(each.cause, each.value) for each in mended.causes] == [(Cause.DELAY, period)]
    alignment = pose_graph(mended)
    assert alignment.verdict.grade == "good" and logs.errors(log, alignment.poses)[0].max() < 0.1
    late = 30 * period  # longer before a reading it stood
    rows_late = np.vstack([rows[:late], rows[[late - 1] * period], rows[late + period :]])
    stood = prepared(logs.changed(log, odometry=rows_late)).odometry
    assert stood[late] == pytest.approx(rows[late - 1])
    missing = logs.without_odometry(logs.changed(log, odometry=rows), 100)
    assert prepared(missing).causes[0].value == period and prepared(missing)[100].odometry is None
    stands = log[np.repeat(np.arange(66), period)]
    assert not prepared(logs.changed(stands, times=log.times[: len(stands)])).causes
