"""The emulated sensor by itself: what it answers to which bytes, by the manual, with our clock."""

import numpy as np
import pytest
from emulated import pattern
from scip import replies

from segmap.sensors import parse_scan
from segmap.sensors.emulator import Room, Unit, furnished_room
from segmap.simulation import URG_04LX, rectangular_room


class Bench:
    """A unit without a wire, and the clock that it goes by."""

    def __init__(self, world=pattern, **settings):
        self.now = 0.0
        self.unit = Unit(world, clock=lambda: self.now, **settings)
        self.now = 1.0

    def says(self, text, seconds=0.0):
        """What it sends to a request within some seconds, looked at every hundredth."""
        self.unit.receive(text.encode() + b"\n")
        said = self.unit.transmit()
        for _ in range(round(seconds * 100)):
            self.now += 0.01
            said += self.unit.transmit()
        return said

    def status(self, text, seconds=0.0):
        (found,) = replies(self.says(text, seconds))
        return found.status


@pytest.mark.parametrize(
    ("said", "statuses"),
    [
        ("MD0044076901000", "04"),
        ("MD0725004401000", "05"),
        ("MD00x4072501000", "01"),
        ("MD0044", "0C"),
        ("QT QT XX VV PP TM2", "00 00 0E 00 00 0E"),
    ],
)
def test_statuses_of_the_manual(said, statuses):
    """Catches an emulator that is more forgiving than the sensor."""
    bench = Bench()
    assert [bench.status(text, 0.2) for text in said.split()] == statuses.split()


def test_a_scan_byte_by_byte():
    """2137 bytes with their echo; the turn that was finished last, its stamp, every step of it.

    At 19200 bit/s they take 1.1 s.
    """
    bench = Bench(stamp=5000)
    said = bench.says("MD0044072501001", 0.2)
    assert len(said) == 21 + 2137
    _, reply = replies(said)
    met = parse_scan(reply.body, 3)
    turn = (met.clock - 5000) // 100
    assert met.clock % 100 == 0
    assert turn in (10, 11)
    assert (met.millimetres == pattern(turn)[44:726]).all()
    slow = Bench(rate=19200)
    said = slow.says("MD0044072501001", 0.9)
    assert 21 < len(said) < 1600
    assert len(said + slow.says("", 0.7)) == 21 + 2137


@pytest.mark.parametrize(
    ("text", "seconds", "left"),
    [("MD0044072501003", 1.0, ["02", "01", "00"]), ("MD0044072501000", 1.05, ["00"] * 9)],
)
def test_a_stream(text, seconds, left):
    """Catches a count that is not what is left, and a laser that stays on after the last."""
    bench = Bench()
    first, *scans = replies(bench.says(text, seconds))
    assert (first.echo, first.status) == (text, "00")
    assert [scan.echo for scan in scans] == [text[:-2] + count for count in left]
    assert {scan.status for scan in scans} == {"99"}
    clocks = [parse_scan(scan.body, 3).clock for scan in scans]
    assert set(np.diff(clocks)) == {100}
    assert bench.unit.laser == text.endswith("000"), "the second one goes on until QT"
    assert bench.status("QT") == "00" and not bench.unit.laser
    assert bench.says("", 0.5) == b""


def test_the_old_protocol():
    """Catches a driver's request in SCIP 2.0 that is understood before the sensor has switched."""
    bench = Bench(protocol="1.1")
    assert bench.says("VV") == b"VV\nE\n\n"
    assert bench.says("QT") == b"QT\nE\n\n"
    assert bench.says("SCIP2.0") == b"SCIP2.0\n0\n\n"
    assert not bench.unit.laser
    assert bench.status("VV") == "00"


# ---------------------------------------------------------------------------- worlds
def test_a_room_is_driven_through_there_and_back():
    path = [(1.0, 1.0, 0.0), (1.5, 1.0, 0.0), (2.0, 1.0, 0.0)]
    room = Room(rectangular_room(4, 3), path, URG_04LX.ideal())
    turns = [room(turn) for turn in range(6)]
    assert [int(steps[384]) for steps in turns] == [3000, 2500, 2000, 2500, 3000, 2500]
    assert turns[0][384 + 256] == 2000  # step 640 looks left: the wall at y = 3
    assert len(turns[0]) == 769
    assert (np.delete(turns[0], np.s_[44:726]) == 19).all(), "steps that are not measured"
    with pytest.raises(ValueError, match="path must hold at least one pose"):
        Room(rectangular_room(4, 3), [])
    first, again = furnished_room(), furnished_room()
    assert all((first(turn) == again(turn)).all() for turn in range(5))


# ------------------------------------------------------------------------------ wire
