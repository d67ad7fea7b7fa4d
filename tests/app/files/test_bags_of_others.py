"""Bags as others record them: several robots and lasers, parts of turns, poses, files cut off."""

import tempfile
from pathlib import Path

import bag_samples as bags
import numpy as np
import pytest
from bag_samples import LASER, LEVEL, RANGES
from log_samples import TIMES

from segmap.readers import LogError
from segmap_app.files import read_bag

START = TIMES[0]
#: Eight parts of 45 degrees, 0.02 s apart, of ranges that tell the beam.
BEAMS = 1 + np.arange(1.0, 361.0) / 100
STEP = np.radians(1)


@pytest.fixture
def read(tmp_path):
    """Write what a function of messages yields as a bag, and read it."""

    def write_and_read(story, kind="mcap", **given):
        folder = Path(tempfile.mkdtemp(dir=tmp_path))
        return read_bag(bags.write(folder, kind, story), **given)

    return write_and_read


def robot(m, name, count, *, x=0.0, scans=True):
    """A robot that drives along x, with its frames below a name of its own."""
    yield (
        f"/{name}/tf_static",
        START,
        *m.frames(START, (f"{name}/base_link", f"{name}/laser", (0.2, 0, 0), LEVEL)),
    )
    for k in range(count):
        when = START + k / count
        pose = (x + when - START, 0.0, 0.0)
        odometry = m.odometry(when, pose, f"{name}/odom", f"{name}/base_link")
        yield f"/{name}/odom", when, *odometry
        if scans:
            yield f"/{name}/scan", when, *m.scan(when, frame=f"{name}/laser")


def test_the_odometry_is_that_of_the_robot_that_carries_the_laser(read):
    """Catches the topic with most messages, which is the other robot's, and a guess without tf."""

    def story(m):
        return [*robot(m, "robot1", 5), *robot(m, "robot2", 20, x=50.0, scans=False)]

    with pytest.warns(UserWarning, match=r"\(20\), /robot1/odom \(5\): /robot1/odom is read"):
        log = read(story)
    assert log.odometry[:, 0].max() < 2 and np.isfinite(log.odometry).all()

    def without_frames(m):
        return [each for each in story(m) if "tf_static" not in each[0]]

    asked = r"no tf tells which carries robot1/laser, --odometry /robot2/odom or files\.read"
    with pytest.raises(LogError, match=asked):
        read(without_frames)
    with pytest.warns(UserWarning, match="no tf tells where robot1/laser sits"):
        log = read(without_frames, odometry="/robot1/odom")
    assert log.odometry[:, 0].max() < 2


def test_an_odometry_of_another_robot_alone_is_not_used(read):
    """Catches poses of robot2 for scans of robot1, since no other topic has any."""

    def story(m):
        yield from (e for e in robot(m, "robot1", 5) if "odom" not in e[0])
        yield from robot(m, "robot2", 20, scans=False)

    log = read(story)
    assert log.odometry is None or not np.isfinite(log.odometry).any()
    assert "/robot2/odom is of another robot than robot1/laser by tf" in "".join(log.assumed)


def test_scan_goes_before_what_is_made_of_it(read):
    def story(m):
        for k in range(3):
            yield "/stable_scan", START + k, *m.scan(START + k)
        for k in range(2):
            yield "/scan", START + k, *m.scan(START + k, frame="raw")

    with pytest.warns(UserWarning, match=r"/scan is read.*|no tf tells"):
        assert len(read(story)) == 2


@pytest.mark.filterwarnings("ignore:.*no tf tells")
def test_two_lasers_in_one_topic_are_refused(read):
    """Catches a map of the scans of two lasers, at the place of one."""

    def story(m):
        for k in range(4):
            yield "/scan", START + k, *m.scan(START + k)
            yield "/scan", START + k + 0.5, *m.scan(START + k + 0.5, frame="other")

    with pytest.raises(LogError, match="/scan holds the scans of several lasers, laser, other"):
        read(story)


# ------------------------------------------------------------------------------ parts of turns
def parts(m, *, turns=3, lost=(), backwards=False, first=-180):
    sign = -1 if backwards else 1
    for turn in range(turns):
        for part in range(8):
            if (turn, part) in lost:
                continue
            when = START + 0.2 * turn + 0.02 * part
            begin = sign * np.radians(first + 45 * part)
            given = {"first": begin, "step": sign * STEP, "apart": 0.0}
            ranges = BEAMS[45 * part : 45 * part + 45]
            yield "/scan", when, *m.scan(when, ranges=ranges, **given)
            yield "/odom", when, *m.odometry(when, (when - START, 0, 0))


@pytest.mark.parametrize("given", [{}, {"backwards": True}, {"first": 0}])
@pytest.mark.filterwarnings("ignore:.*no tf tells")
def test_parts_of_a_turn_are_one_scan_with_times(read, given):
    """Catches a message that is taken for a turn, and beams that all have the time of the first."""
    log = read(lambda m: parts(m, **given))
    assert [len(scan) for scan in log] == [360] * 3
    assert log.times == pytest.approx(START + 0.2 * np.arange(3))
    assert log.odometry[:, 0] == pytest.approx(0.2 * np.arange(3))
    scan = log[1]
    assert scan.ranges == pytest.approx(BEAMS) and log.order_known
    assert scan.delays == pytest.approx(np.arange(360) * 0.02 / 45)
    assert "24 messages of /scan are parts of 3 turns" in log.assumed


@pytest.mark.filterwarnings("ignore:.*no tf tells")
def test_a_part_that_is_lost_costs_its_beams_alone(read):
    """Catches turns that begin elsewhere from then on."""
    log = read(lambda m: parts(m, lost=[(1, 3), (2, 0)]))
    assert [len(scan) for scan in log] == [360, 315, 315]
    assert np.degrees(log[2].angles[0]) == pytest.approx(-135)


@pytest.mark.filterwarnings("ignore:.*no tf tells")
def test_whole_turns_are_left_as_they_are(read):
    """Catches full turns, each of which ends where the next begins, that are joined."""

    def story(m):
        for k in range(4):
            full = {"ranges": BEAMS, "first": -np.pi, "step": STEP}
            yield "/scan", START + k / 5, *m.scan(START + k / 5, **full)

    assert [len(scan) for scan in read(story)] == [360] * 4


# ------------------------------------------------------------------------------- other messages
@pytest.mark.filterwarnings("ignore:.*no tf tells")
@pytest.mark.parametrize("kind", ["mcap", "ros1"])
def test_the_first_echo_counts(read, kind):
    def story(m):
        echo = lambda *r: m.make("sensor_msgs/msg/LaserEcho", np.array(r, np.float32))  # noqa: E731
        echoes = [echo(1.5), echo(2.0, 2.5), echo(), echo(np.inf), echo(3.0, 9.0)]
        _, one = m.scan(START)
        angles = one.angle_min, one.angle_max, one.angle_increment
        name = "sensor_msgs/msg/MultiEchoLaserScan"
        made = m.make(name, one.header, *angles, 0.0, 0.1, 0.1, 30.0, echoes, [])
        yield "/echoes", START, name, made

    log = read(story, kind)
    assert log[0].valid.tolist() == [True, True, False, False, True]
    assert log[0].ranges[[0, 1, 4]].tolist() == [1.5, 2.0, 3.0] and np.isnan(log[0].ranges[2])


def posed(m, kind, when, x):
    _, odometry = m.odometry(when, (x, 0, 0.5))
    made = {
        "PoseStamped": lambda: odometry.pose.pose,
        "PoseWithCovarianceStamped": lambda: odometry.pose,
    }[kind]()
    name = f"geometry_msgs/msg/{kind}"
    return name, m.make(name, m.header(when, "map"), made)


@pytest.mark.parametrize("kind", ["PoseStamped", "PoseWithCovarianceStamped"])
@pytest.mark.parametrize("use", ["truth", "odometry"])
def test_poses_are_odometry_or_truth_where_they_are_named(read, kind, use):
    def story(m):
        yield "/tf_static", START, *m.frames(START, LASER)
        for k in range(3):
            yield "/pose", START + k, *posed(m, kind, START + k, float(k))
            yield "/scan", START + k, *m.scan(START + k)

    assert read(story).odometry is None or np.isnan(read(story).odometry).all()
    found = getattr(read(story, **{use: "/pose"}), use)
    assert found == pytest.approx(np.array([(0, 0, 0.5), (1, 0, 0.5), (2, 0, 0.5)]))
    with pytest.raises(LogError, match=f"{use} must be a topic of nav_msgs/Odometry"):
        read(story, **{use: "/scan"})


@pytest.mark.parametrize("above", ["camera_odom_frame", "wheel_odom", "world"])
def test_how_the_robot_moves_in_the_frame_above_is_its_odometry(read, above):
    """Catches an odometry that is missed since its frame is called otherwise than odom."""

    def story(m):
        yield "/tf_static", START, *m.frames(START, LASER)
        for k in range(4):
            where = (above, "base_link", (float(k), 0, 0), LEVEL)
            yield "/tf", START + k, *m.frames(START + k, where)
            yield "/scan", START + k, *m.scan(START + k)

    log = read(story)
    assert log.odometry[:, 0] == pytest.approx(np.arange(4.0))
    assert log[0].sensor_pose == pytest.approx([0.3, 0.1, 0])
    assert f"the odometry is how base_link moves in {above}" in log.assumed


def test_the_odometry_is_the_lowest_frame_that_moves(read):
    """Catches the correction of a mapper, from map to odom, taken for the odometry."""

    def story(m):
        yield "/tf_static", START, *m.frames(START, LASER)
        for k in range(4):
            links = ("map", "odom", (0, 5.0 * k, 0), LEVEL), ("odom", "base_link", (k, 0, 0), LEVEL)
            yield "/tf", START + k, *m.frames(START + k, *links)
            yield "/scan", START + k, *m.scan(START + k)

    assert read(story).odometry == pytest.approx(np.array([(k, 0, 0) for k in range(4)]))


def two_lasers(m, rear=True):
    links = [LASER, ("base_link", "back", (-0.3, 0, 0), (0, 0, np.pi))]
    yield "/tf_static", START, *m.frames(START, *links[: 1 + rear])
    for k in range(3):
        yield "/odom", START + k, *m.odometry(START + k, (k, 0, 0))
        yield "/front", START + k, *m.scan(START + k)
        yield "/rear", START + k, *m.scan(START + k, ranges=(*RANGES[:4], 1.0), frame="back")


def test_two_topics_make_one_log_with_both_places(read):
    """Catches a second laser that cannot be had, or whose place is that of the first."""
    log = read(two_lasers, scan=["/front", "/rear"])
    assert len(log) == 6 and log.odometry[:, 0] == pytest.approx([0, 0, 1, 1, 2, 2])
    assert [scan.ranges[4] for scan in log] == pytest.approx([3, 1] * 3)
    assert log[0].sensor_pose == pytest.approx([0.3, 0.1, 0])
    assert log[1].sensor_pose == pytest.approx([-0.3, 0, np.pi])
    with pytest.raises(LogError, match="no tf tells where back sits: read its topic alone"):
        read(lambda m: two_lasers(m, rear=False), scan=["/front", "/rear"])


@pytest.mark.parametrize("kind", bags.KINDS)
@pytest.mark.parametrize("back", [5, 3600])
def test_a_recorders_clock_that_is_set_back_mixes_nothing(read, kind, back):
    """Catches messages in the order of that clock: scans with odometry of another moment; and one
    that came late before it, from which the clock goes on."""

    def story(m):
        yield "/tf_static", 9000.0, *m.frames(9000.0, LASER)
        for k in range(60):
            when = 9000 + (26.5 if k == 29 else k) / 5 - (back if k >= 30 else 0)
            yield "/odom", when, *m.odometry(when, (k, 0, 0))
            yield "/scan", when, *m.scan(when, ranges=(1 + k / 10, *RANGES[1:]))

    log = read(story, kind)
    assert [scan.ranges[0] for scan in log] == pytest.approx(1 + np.arange(60) / 10)
    assert log.odometry[:, 0] == pytest.approx(np.arange(60.0))
    assert (np.diff(np.delete(log.times, 29)) > 0).all()
