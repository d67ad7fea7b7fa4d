"""Bags of ROS 1 and ROS 2: what the messages mean, which are chosen, and damage."""

import json
import tempfile
from contextlib import nullcontext
from pathlib import Path

import bag_samples as bags
import numpy as np
import pytest
from bag_samples import LEVEL, RANGES
from log_samples import ODOMETRY, TIMES
from programs import program
from rosbags import rosbag1

from segmap import readers
from segmap.readers import LogError
from segmap_app.files import read_bag

main = program("segmap")
START = TIMES[0]


@pytest.fixture
def read(tmp_path):
    """Write a story as a bag, the quickest kind unless told, and read it."""

    def write_and_read(*story, kind="mcap", **given):
        def told(m):
            for topic, name, *arguments in story:
                made = getattr(m, name)(*arguments[:-1], **arguments[-1])
                yield topic, arguments[0] if name != "frames" else START, *made

        folder = Path(tempfile.mkdtemp(dir=tmp_path))
        return read_bag(bags.write(folder, kind, told), **given)

    return write_and_read


def scan(time=START, topic="/scan", **given):
    return topic, "scan", time, given


def odometry(time, pose, topic="/odom", **given):
    return topic, "odometry", time, pose, given


def frames(*links, topic="/tf_static", time=START):
    return topic, "frames", time, *links, {}


STANDS = odometry(START, LEVEL)
PLACE = frames(bags.LASER)


@pytest.mark.parametrize("kind", bags.KINDS)
def test_each_kind_of_bag_is_the_same_log(tmp_path, kind):
    path = bags.write(tmp_path, kind)
    for place in {path, tmp_path / bags.KINDS[kind]}:
        log = readers.read(place)
        assert (log.name, readers.format_of(place), log.truth) == ("it", "ROS bag", None)
        assert log.times == pytest.approx(TIMES) and log.odometry == pytest.approx(
            np.array(ODOMETRY)
        )
        assert log[0].ranges.tolist() == list(RANGES) and log[0].max_range == 30
        assert np.degrees(log[0].angles) == pytest.approx([-90, -45, 0, 45, 90])
        assert log[1].sensor_pose == pytest.approx([0.3, 0.1, 0])


@pytest.mark.parametrize("kind", ["db3", "mcap"])
def test_a_folder_without_metadata_is_its_only_file(tmp_path, kind):
    """A recorder that was killed leaves such folders; of two files either may be wanted."""
    path = bags.write(tmp_path, kind)
    (path / "metadata.yaml").unlink()
    assert len(readers.read(path)) == 2 and readers.format_of(path) == "ROS bag"
    (path / f"other.{kind}").write_bytes((path / f"it.{kind}").read_bytes())
    with pytest.raises(LogError, match="holds no log"):
        readers.read(path)


def parts(folder, kind, begins, name="it_{k}"):
    """Files of parts, each of two scans from a time on; ranges number the parts from 1."""
    made = []
    for k, begin in begins.items():
        (folder / f"of {k}").mkdir()
        said = [(begin + j, [k + 1]) for j in range(2)]
        held = bags.write(
            folder / f"of {k}", kind, lambda m, s=said: [("/scan", t, *m.scan(t, r)) for t, r in s]
        )
        file = held if kind == "ros1" else held / f"it.{kind}"
        end = "bag" if kind == "ros1" else kind
        made.append(file.rename(folder / f"{name.format(k=k)}.{end}"))
    return made


@pytest.mark.parametrize("kind", ["db3", "mcap", "ros1"])
def test_the_parts_of_a_split_bag_are_one_log(tmp_path, kind):
    """Catches parts in the order of their names, and two recordings that are taken for one."""
    (split := tmp_path / "split").mkdir()
    for part in parts(tmp_path, kind, {k: 2.0 * k for k in range(11)}):
        part.rename(split / part.name)
    assert [scan.ranges[0] for scan in readers.read(split)[::2]] == [*range(1, 12)]
    (split / part.name.replace("10", "5")).unlink()
    with pytest.raises(LogError, match="holds no log"):
        readers.read(split)


@pytest.mark.parametrize("kind", ["db3", "mcap", "ros1"])
def test_parts_of_a_bag_that_are_named_together_are_one_log(tmp_path, kind, capsys):
    """Catches a log for each part, parts in the order of the command, and a part taken for all."""
    names = "it_2024-01-01-10-0{k}-00_{k}" if kind == "ros1" else "it_{k}"
    files = parts(tmp_path, kind, {0: 5.0, 1: 7.0, 2: 9.0}, names)
    (tmp_path / f"other.{kind}").write_bytes(b"")
    log = read_bag(files[::-1])
    assert log.name == "it" and [scan.ranges[0] for scan in log] == [1, 1, 2, 2, 3, 3]
    assert main(["info", *map(str, files), "malaga", "--json"]) == 0
    found = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    assert [each["log"] for each in found] == ["it", "malaga"]
    assert found[0]["scans"]["scans"] == 6
    with pytest.raises(LogError, match=r"are no parts of one bag, expected it_0.bag, it_1.bag"):
        read_bag([files[0], files[2]])


def test_odometry_is_interpolated_by_the_shorter_way_and_nowhere_else(read):
    """Through zero instead of through pi the robot would look backwards."""
    told = [odometry(START + t, (t, 0, h)) for t, h in ((0, 3.0), (2, -3.0))]
    log = read(*(scan(START + t) for t in (-0.1, 0.5, 2, 2.1)), *told, PLACE)
    known = np.isfinite(log.odometry).all(1)
    assert known.tolist() == [False, True, True, False] and log[0].odometry is None
    assert log.odometry[1] == pytest.approx([0.5, 0, 3 + (2 * np.pi - 6) / 4])


def test_beams_have_times_whose_order_nobody_knows(read):
    """Catches a negative increment, none, and nonsense."""
    known = ((0.01, 0.01), (-0.02, 0.02), (1.0, 1.0))
    for apart, delays in (*known, *((apart, None) for apart in (0.0, np.nan, 1.2))):
        log = read(scan(apart=apart), STANDS, PLACE)
        known = None if delays is None else (np.arange(5) * np.float32(delays)).tolist()
        found = log[0].delays
        assert known == (None if found is None else pytest.approx(found.tolist()))
        assert log.order_known == (known is None)


class TestTopics:
    STORY = (scan(topic="/a"), scan(topic="/b"), scan(START + 1, "/b"), STANDS, PLACE)

    def test_the_one_with_most_messages_is_taken_and_others_are_told(self, read):
        with pytest.warns(UserWarning, match=r"/b \(2\), /a \(1\): /b is read.*scan='/a'"):
            assert len(read(*self.STORY)) == 2
        moved = odometry(START, (1, 2, 3), "/wheels")
        for name in ("/a", "a"):
            log = read(*self.STORY, moved, scan=name, odometry="/wheels")
            assert len(log) == 1 and log.odometry[0] == pytest.approx([1, 2, 3])

    @pytest.mark.parametrize(
        ("story", "given", "said"),
        [
            ([scan(), STANDS], {"scan": "/odom"}, r"scan must be a topic .*, but .* /scan \(s"),
            ([STANDS], {}, r"holds no sensor_msgs/LaserScan, but .*/odom \(nav"),
            ([scan()], {"scan": 3}, "scan must be the name of a topic"),
            ([scan()], {"odometry": ["/odom"]}, "odometry must be the name of a topic"),
        ],
    )
    def test_what_is_not_there_is_told_with_what_is(self, read, story, given, said):
        with pytest.raises(ValueError, match=said):
            read(*story, **given)


def beside(parent, child, x, *turn):
    return parent, child, (x, 0, 0), turn or LEVEL


#: Frames that are told, and where the laser then sits on the robot.
PLACES = {
    "both on a third": (
        [beside("top", "laser", 1.0), beside("top", "base_link", 0.4)],
        (0.6, 0, 0),
    ),
    "in a circle": ([bags.LASER, beside("laser", "base_link", 0.3)], None),
    "a hair of tilt": ([beside("base_link", "laser", 0.0, 0.03, -0.02, 0.5)], (0, 0, 0.5)),
    "as it is": ([bags.LASER], (0.3, 0.1, 0)),
}


class TestFrames:
    @pytest.mark.parametrize("name", PLACES)
    def test_the_laser_sits_where_the_frames_say(self, read, name):
        links, place = PLACES[name]
        # ROS 1 publishes what is static in /tf, many times a second
        again = [frames(*links, topic="/tf", time=START + k / 10) for k in range(3)]
        for told in ([frames(*links)], again):
            log = read(scan(), STANDS, *told)
            assert len(log) == 1
            assert place is None or log[0].sensor_pose == pytest.approx(place, abs=1e-3)
        if name == "as it is":  # without odometry the base is known by its name
            log = read(scan(), frames(*links))
            assert log[0].odometry is None and log[0].sensor_pose == pytest.approx(place)

    @pytest.mark.parametrize("kind", ["mcap", "ros1"])
    def test_a_laser_upside_down_at_the_end_of_a_chain(self, read, kind):
        """Beams that are not mirrored put the left wall to the right."""
        links = [
            ("/base_link", "/plate", (0.2, 0, 0.1), (0, 0, np.pi / 2)),
            ("/plate", "/laser", (0.1, 0, 0.3), (np.pi, 0, 0)),
            ("/base_footprint", "/base_link", (0, 0, 0.05), LEVEL),
        ]
        story = scan(frame="/laser"), frames(*links), odometry(START, LEVEL, child="base_footprint")
        log = read(*story, kind=kind)
        assert log[0].sensor_pose == pytest.approx([0.2, 0.1, np.pi / 2])
        assert np.degrees(log[0].angles) == pytest.approx([90, 45, 0, -45, -90])
        assert log[0].points()[0] == pytest.approx([0.2 - 1.5, 0.1], abs=1e-6)

    @pytest.mark.parametrize("turn", [(5.1, 0, 0), (0, -5.5, 0), (0, 86, 0), (174.8, 0, 0)])
    def test_a_tilted_laser_is_refused(self, read, turn):
        with pytest.raises(LogError, match=r"level, or upside down, .* tilted by (5|6|86) degrees"):
            read(scan(), STANDS, frames(("base_link", "laser", LEVEL, np.radians(turn))))

    @pytest.mark.parametrize("degrees", [4.9, -4.9, 184.9])
    def test_a_laser_hangs_or_stands_within_five_degrees(self, read, degrees):
        turn = (np.radians(degrees), 0, 0.5)
        log = read(scan(), STANDS, frames(("base_link", "laser", (1, -2, 3), turn)))
        assert log[0].sensor_pose == pytest.approx([1, -2, 0.5], abs=4e-3)
        assert log[0].angles[0] * (1 if abs(degrees) < 90 else -1) < 0

    @pytest.mark.parametrize(
        ("ahead", "degrees", "moves"),
        [(0.0099, 0.9, 0), (-0.0099, -0.9, 0), (0.0101, 0, 1), (-0.0101, 0, 1), (0, 1.1, 1),
         (0, -1.1, 1), (0, 28, 1)],
    )  # fmt: skip
    def test_a_laser_that_moves_on_the_robot_is_refused(self, read, ahead, degrees, moves):
        """And one whose frame trembles by a centimetre or a degree is not."""
        turns = (LEVEL, (0, 0, np.radians(degrees)))
        links = [("base_link", "laser", (1 + k * ahead, 2, 0), turns[k]) for k in range(2)]
        told = [frames(link, topic="/tf") for link in links]
        said = pytest.raises(LogError, match="fixed to base_link, but laser moves")
        with said if moves else nullcontext():
            log = read(scan(), STANDS, *told)
            assert log[0].sensor_pose[:2] == pytest.approx((1, 2), abs=0.01)

    def test_a_base_that_moves_below_what_carries_the_laser_is_of_another_robot(self, read):
        """Catches a link that is looked at on the way up from the laser alone."""
        links = [beside("top", "laser", 1.0), *(beside("top", "base_link", x) for x in (0.4, 1.4))]
        log = read(scan(), STANDS, *(frames(link, topic="/tf") for link in links))
        assert log[0].odometry is None and "another robot" in "".join(log.assumed)

    def test_a_place_that_nothing_tells_is_warned_of(self, read):
        with pytest.warns(UserWarning, match="no tf tells where laser sits on base_link"):
            assert read(scan(), STANDS)[0].sensor_pose.tolist() == [0, 0, 0]


class TestBeams:
    def test_the_least_range_is_one(self, read):
        assert read(scan(ranges=[0.1, 2.0, 0.099]))[0].valid.tolist() == [True, True, False]

    def test_what_lies_outside_of_the_limits_is_no_wall(self, read):
        """Angles may fall, and a limit that is none limits nothing."""
        ranges = [0.5, 0.05, 30.0, 31.0, np.inf, -np.inf, np.nan, 0.0, -1.0, 29.9]
        found = read(scan(ranges=ranges, step=0.1))[0]
        far, bad = np.isposinf(found.ranges), np.isnan(found.ranges)
        assert np.flatnonzero(far).tolist() == [2, 3, 4]
        assert np.flatnonzero(bad).tolist() == [1, 5, 6, 7, 8]
        assert np.flatnonzero(found.valid).tolist() == [0, 9]
        for most in (0.0, np.nan, np.inf):
            found = read(scan(most=most, first=np.pi / 2, step=-np.pi / 4))[0]
            assert found.valid.sum() == 4
            assert np.degrees(found.angles) == pytest.approx([90, 45, 0, -45, -90])
            assert found.points()[0] == pytest.approx([0, 1.5], abs=1e-6)

    @pytest.mark.parametrize("kind", ["ros1", "mcap"])
    def test_a_header_without_a_time_has_that_of_the_recorder(self, tmp_path, kind):
        def story(m):
            yield "/scan", START, *m.scan(0.0)

        assert readers.read(bags.write(tmp_path, kind, story)).times == pytest.approx([START])

    def test_clocks_that_never_meet_are_warned_of(self, read):
        with pytest.warns(UserWarning, match="no scan lies within the time of the odometry"):
            assert read(scan(START + 9), STANDS, frames(bags.LASER))[0].odometry is None


class TestDamage:
    def test_a_topic_without_messages_is_not_chosen(self, tmp_path):
        """Catches the first of two topics, and one message that counts as none."""
        m = bags.Messages(1)
        kind, made = m.scan(START)
        with rosbag1.Writer(tmp_path / "it.bag") as writer:
            both = [writer.add_connection(f"/{k}", kind, typestore=m.store) for k in "ab"]
            writer.write(both[1], 1, bytes(m.store.serialize_ros1(made, kind)))
        assert len(readers.read(tmp_path / "it.bag")) == 1

    @pytest.mark.parametrize("given", [{"step": 0.0}, {"ranges": []}])
    def test_a_message_without_sense_costs_one(self, read, given):
        story = scan(), scan(START + 1, **given), scan(START + 2)
        with pytest.raises(LogError, match="/scan, message 2: "):
            read(*story)
        log = read(*story, on_error="skip")
        assert len(log) == 2 and log.skipped.lines == 1 and "message 2" in log.skipped.reason

    @pytest.mark.parametrize("kind", bags.KINDS)
    @pytest.mark.parametrize("harm", ["cut", "never closed"])
    def test_a_bag_that_is_cut_or_was_never_closed_names_what_mends_it(self, tmp_path, kind, harm):
        """Catches a part of a bag that is read in silence, and words that leave one alone."""
        bags.write(tmp_path, kind, _nothing_seen)
        path = tmp_path / bags.KINDS[kind]
        data = bytearray(path.read_bytes())
        if harm == "cut":
            del data[int(0.8 * len(data)) :]
        elif kind == "db3":
            return  # it needs no end
        elif kind == "ros1":
            at = data.index(b"index_pos=") + len(b"index_pos=")
            data[at : at + 8] = bytes(8)
        else:
            del data[-37:]
        path.write_bytes(data)
        for on_error in ("raise", "skip"):
            with pytest.raises(LogError, match=r"`rosbag reindex`.*`ros2 bag reindex`"):
                readers.read(path, on_error=on_error)


def _nothing_seen(m):
    for k in range(300):
        yield "/scan", START + k, *m.scan(START + k, ranges=np.full(360, np.inf), step=0.01)
