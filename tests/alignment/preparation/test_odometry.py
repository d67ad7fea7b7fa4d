"""Odometry of another unit, direction, moment or robot: told, and put right where that is known."""

from collections.abc import Callable
from dataclasses import replace

import alignment_logs as logs
import numpy as np
import pytest

from segmap import load
from segmap.alignment import pose_graph, position_errors, prepared
from segmap.poses import between, compose, inverse
from segmap.scans import Log
from segmap.scans.causes import Cause
from segmap.simulation import SICK_LMS200, OdometryNoise, box, drive, simulate

SENSORS = {"around": logs.AROUND, "ahead": SICK_LMS200}


def driven(sensor: str = "around", place: tuple[float, float, float] = (0, 0, 0)) -> Log:
    return logs.rooms_log(SENSORS[sensor], place)


def counted_again(rows: np.ndarray, way: float = 1.0, turn: float = 1.0) -> np.ndarray:
    """What wheels count that say so many times the way and the turn of each step."""
    found = [rows[0]]
    for step in between(rows[:-1], rows[1:]) * (way, way, turn):
        found.append(compose(found[-1], step))
    return np.array(found)


def from_zero(rows: np.ndarray, scan: int) -> np.ndarray:
    """A driver that was started again at a scan."""
    return np.vstack([rows[:scan], between(rows[scan], rows[scan:])])


def causes(log: Log) -> dict[Cause, bool]:
    """What was found, and whether it makes the map doubtful."""
    return {finding.cause: finding.doubtful for finding in log.causes}


def late_by(rows: np.ndarray, scans: float) -> np.ndarray:
    """The odometry read so many scans late, between its rows."""
    at, own = np.arange(len(rows)) - scans, np.arange(len(rows))
    x, y, heading = (np.interp(at, own, column) for column in (*rows.T[:2], np.unwrap(rows[:, 2])))
    return np.stack([x, y, (heading + np.pi) % (2 * np.pi) - np.pi], -1)


Change = Callable[[np.ndarray], np.ndarray]
#: Mistakes that are put right: from the right rows to the wrong ones.
MENDED: dict[str, tuple[Cause, Change]] = {
    "millimetres": (Cause.UNIT, lambda rows: rows * (1000, 1000, 1)),
    "centimetres": (Cause.UNIT, lambda rows: rows * (100, 100, 1)),
    "feet": (Cause.UNIT, lambda rows: rows / (0.3048, 0.3048, 1)),
    "y to the right": (Cause.ODOMETRY_MIRRORED, lambda rows: rows * (1, -1, 1)),
    "clockwise": (Cause.ODOMETRY_MIRRORED, lambda rows: rows * (1, 1, -1)),
    "compass": (Cause.ODOMETRY_MIRRORED, lambda rows: (0, 0, np.pi / 2) + rows * (1, 1, -1)),
    "wheels backwards": (Cause.MOUNTING, lambda rows: counted_again(rows, way=-1)),
    "late": (Cause.DELAY, lambda rows: np.vstack([np.repeat(rows[:1], 5, 0), rows[:-5]])),
    "late, to the west": (
        Cause.DELAY,
        lambda rows: late_by(compose(np.array([0, 0, np.pi]), rows), 5.5),
    ),
    "late by a scan": (Cause.DELAY, lambda rows: np.vstack([rows[:1], rows[:-1]])),
    "early": (Cause.DELAY, lambda rows: np.vstack([rows[8:], np.repeat(rows[-1:], 8, 0)])),
}


@pytest.mark.parametrize(
    ("name", "sensor"),
    [*((name, "around") for name in MENDED), ("millimetres", "ahead"), ("compass", "ahead"),
     ("late, to the west", "ahead")],
)  # fmt: skip
def test_what_is_known_is_put_right(name, sensor):
    """Catches a factor upside down, a turn or delay of the wrong sign, a grade that suffers."""
    cause, change = MENDED[name]
    log = driven(sensor)
    found = prepared(logs.changed(log, odometry=change(log.odometry)))
    assert causes(found) == {cause: False}
    if cause is Cause.DELAY:
        assert name[:4] in found.causes[0].words
        assert (found.causes[0].value > 0) == name.startswith("late")
    right, known = log.odometry, np.isfinite(found.odometry).all(1)
    assert known.sum() >= len(log) - 10
    wanted, steps = between(right[:-1], right[1:]), between(found.odometry[:-1], found.odometry[1:])
    if name == "wheels backwards":  # the robot's frame is the laser's, whatever the wheels call it
        wanted = wanted * (1, 1, 1)
    off = (np.abs(steps - wanted) % (2 * np.pi))[known[:-1] & known[1:]]
    off = np.minimum(off, 2 * np.pi - off)
    assert (
        np.quantile(off, 0.98) < (0.08 if "west" in name else 0.02) and np.median(off[:, :2]) < 0.01
    )


def test_a_right_log_is_the_same_object():
    """Catches a mask, a new odometry or a doubt where nothing is wrong."""
    for log in (driven(), driven("ahead"), load("corridor"), load("room")):
        assert prepared(log) is log
    bare = logs.without_odometry(driven())
    assert prepared(bare) is bare
    assert prepared(Log("none", [])).scans == () == prepared(driven()[:1]).causes


#: Mistakes that cannot be attributed, or leave nothing to use.
DOUBTFUL: dict[str, tuple[Cause, Change]] = {
    "a tenth too far": (Cause.SCALE, lambda rows: counted_again(rows, way=1.1)),
    "twice the way": (Cause.SCALE, lambda rows: rows * (2, 2, 1)),
    "twice the turn": (Cause.SCALE, lambda rows: counted_again(rows, turn=2)),
    "no heading": (Cause.NO_ODOMETRY, lambda rows: rows * (1, 1, 0)),
    "wheels exchanged": (Cause.MIRRORED, lambda rows: counted_again(rows, turn=-1)),
}


@pytest.mark.parametrize("name", DOUBTFUL)
def test_what_cannot_be_attributed_is_doubted(name):
    """Catches a wrong factor in silence, and odometry that wins against the scans."""
    cause, change = DOUBTFUL[name]
    log = driven()
    found = prepared(logs.changed(log, odometry=change(log.odometry)))
    assert causes(found)[cause]
    assert name != "a tenth too far" or "wheels or ranges are 10 % off" in found.causes[0].words
    aligned = pose_graph(found)
    assert set(found.causes) <= set(aligned.causes)
    assert position_errors(aligned.poses, log.truth, best=True).max() < 0.05


@pytest.mark.parametrize("sensor", SENSORS)
def test_mirrored_scans_and_the_option_for_them(sensor):
    """Catches a mirrored map that is called good, and --clockwise that turns nothing."""
    log = driven(sensor)
    mirrored = replace(log, scans=tuple(replace(scan, ranges=scan.ranges[::-1]) for scan in log))
    found = prepared(mirrored)
    (finding,) = found.causes
    assert finding.cause is Cause.MIRRORED and finding.doubtful and -1.1 < finding.value < -0.9
    assert "--clockwise" in finding.remedy
    mended = prepared(mirrored, clockwise=True)
    assert not mended.causes
    assert np.allclose(mended[3].points(), mirrored[3].points() * (1, -1))


@pytest.mark.parametrize("place", [(0.8, 0.3, 0.0), (0.3, 0.0, np.pi), (0.25, -0.2, np.pi / 2)])
def test_a_forgotten_place_of_the_laser_is_found(place):
    """Catches x and y exchanged, a place in the frame of the laser, and a turn the other way."""
    log = driven("around", place)
    bare = replace(log, scans=tuple(replace(scan, sensor_pose=(0, 0, 0)) for scan in log))
    found = prepared(bare)
    assert causes(found)[Cause.LEVER_ARM] is False
    assert (Cause.MOUNTING in causes(found)) == (place[2] != 0)
    x, y, _ = place
    lever = next(f for f in found.causes if f.cause is Cause.LEVER_ARM)
    assert abs(lever.value - np.hypot(x, y)) < 0.05 and lever.remedy == "--mount auto"
    mounted = prepared(bare, mount="auto")
    taken = mounted[0].sensor_pose
    assert np.abs(taken[:2] - place[:2]).max() < 0.05
    assert abs((taken[2] - place[2] + np.pi) % (2 * np.pi) - np.pi) < 0.02
    assert not causes(mounted).keys() & {Cause.LEVER_ARM, Cause.MOUNTING}
    assert not prepared(bare, mount=place).causes
    # Without it the map is that of the laser's own poses
    poses = compose(pose_graph(found).poses, inverse(np.array(place)))
    assert np.isfinite(poses).all()
    lasers = compose(log.truth, np.broadcast_to(place, log.truth.shape))
    assert position_errors(pose_graph(found).poses, lasers, best=True).max() < 0.1


def wild(rows: np.ndarray) -> np.ndarray:
    """One row that is 50 m off."""
    return np.vstack([rows[:99], rows[99:100] + (50, 0, 1), rows[100:]])


def stepped(rows: np.ndarray) -> np.ndarray:
    """Three steps of 3 m."""
    return rows + np.digitize(np.arange(len(rows)), [60, 90, 130])[:, None] * (3, 0, 0)


def wrapped(rows: np.ndarray) -> np.ndarray:
    """Ticks that begin at 0 again."""
    return np.vstack([rows[:80], compose(np.array([65.5, 0, 1.0]), rows[80:])])


JUMPS: dict[str, tuple[int, Change]] = {
    "started again": (1, lambda rows: from_zero(rows, 100)),
    "one wild row": (1, wild),
    "three steps": (3, stepped),
    "ticks that wrap": (1, wrapped),
}


@pytest.mark.parametrize("name", JUMPS)
def test_a_step_that_no_robot_drives_is_no_motion(name):
    """Catches a jump that is believed, one that is counted twice, and the row before it lost."""
    count, change = JUMPS[name]
    log = driven()
    found = prepared(logs.changed(log, odometry=change(log.odometry)))
    (finding,) = found.causes
    assert (finding.cause, finding.value, finding.doubtful) == (Cause.JUMP, count, False)
    assert np.isnan(found.odometry[:, 0]).sum() == count
    aligned = pose_graph(found)
    assert aligned.used.all()
    assert position_errors(aligned.poses, log.truth, best=True).max() < 0.05


def paused(log: Log, begin: int, end: int) -> Log:
    """A log whose recorder paused between two scans, and whose times do not show it."""
    scans = (*log[:begin], *log[end:])
    timed = tuple(replace(scan, time=0.1 * k) for k, scan in enumerate(scans))
    return replace(log, scans=timed, truth=np.delete(log.truth, np.s_[begin:end], 0))


@pytest.mark.parametrize(("begin", "end", "wild_rows"), [(100, 190, []), (150, 260, [148])])
def test_a_step_that_the_scans_confirm_is_true(begin, end, wild_rows):
    """Catches a recorder that paused taken for a jump: the map is GOOD then, and metres off; and
    rows in the frame of a wild one before it."""
    log = paused(driven(), begin, end)
    rows = log.odometry.copy()
    rows[wild_rows] += (50, 0, 1)
    found = prepared(logs.changed(log, odometry=rows))
    finding = found.causes[-1]
    assert finding.cause is Cause.JUMP and not finding.doubtful and "paused" in finding.words
    rows[wild_rows] = np.nan
    assert np.array_equal(found.odometry, rows, equal_nan=True)


def test_a_step_that_nothing_tells_is_doubted():
    """Catches a corridor that looks alike from both places, and a map of it that is called good; a
    step that fits no scan, and is believed."""
    walls = box(60, 2.2, (30, 1.1, 0))
    path = drive([(2, 1.1), (55, 1.1)], step=0.25)
    rng = np.random.default_rng(3)
    log = simulate(walls, path, sensor=logs.AROUND, rng=rng, odometry_noise=OdometryNoise())
    assert causes(prepared(paused(log, 100, 120))) == {Cause.JUMP: True}
    elsewhere = paused(driven(), 100, 190)  # it neither stood nor drove so
    rows = elsewhere.odometry
    rows[100:] = compose(compose(rows[99], (0.5, 3.0, 1.5)), between(rows[100], rows[100:]))
    unclear = prepared(logs.changed(elsewhere, odometry=rows))
    assert causes(unclear)[Cause.JUMP] and unclear[100].odometry is None


def test_a_faster_robot_does_not_jump():
    """Catches a threshold in metres: what jumps in one log is a drive in another."""
    log = driven()
    assert Cause.JUMP not in causes(
        prepared(logs.changed(log, odometry=log.odometry * (20, 20, 1)))
    )
    quick = slice(100, 140)  # which lasts, so it is no jump
    rows = log.odometry.copy()
    steps = between(rows[:-1], rows[1:])
    steps[quick, :2] *= 6
    found = [rows[0]]
    for step in steps:
        found.append(compose(found[-1], step))
    assert Cause.JUMP not in causes(prepared(logs.changed(log, odometry=np.array(found))))


def test_a_gap_in_time_explains_a_long_step():
    """Catches a robot that drove on while nothing was recorded, and that was called a jump."""
    log = driven()
    part = log[np.r_[:100, 112 : len(log)]]
    assert Cause.JUMP not in causes(prepared(part))


@pytest.mark.parametrize(("begin", "end"), [(0, None), (80, 200)])
def test_an_odometry_that_stands_still_is_none(begin, end):
    """Catches frozen rows that hold the robot, and rows before or after them that are lost."""
    log = driven()
    rows, stop = log.odometry.copy(), len(log) if end is None else end
    rows[stop:] = compose(rows[begin], between(rows[stop - 1], rows[stop:]))
    rows[begin:stop] = rows[begin]
    found = prepared(logs.changed(log, odometry=rows))
    (finding,) = found.causes
    assert finding.cause is Cause.NO_ODOMETRY and not finding.doubtful
    gone = np.isnan(found.odometry[:, 0])
    assert gone.sum() == finding.value == stop - begin - 1 and not gone[: begin + 1].any()
