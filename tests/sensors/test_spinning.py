"""Lasers that turn without end, on emulators of the makers' protocols: turns, angles, damage."""

import threading

import numpy as np
import pytest
from emulated import needs_terminals

from segmap.scans import LaserScan
from segmap.sensors import SensorError, SpinningLaser
from segmap.sensors.emulator import SpinningEmulator

lds2d = pytest.importorskip("lds2d")
crc8 = pytest.importorskip("lds2d.crc").crc8

ANGLES = np.radians(0.8 * np.arange(450) - 180)
#: A packet of a true LD19 (docs of its maker): 324.27 to 334.70 degrees, 224 to 190 mm.
TRUE_PACKET = bytes.fromhex(
    "542c6808ab7ee000e4dc00e2d900e5d500e3d300e4d000e9cd00e4ca00e2c700e9c500e5c200e5c000e5be823a1a50"
)


def turns(count=3):
    """Scans in which no two beams are equal: 1 m, growing by a millimetre a beam, .5 m a turn."""
    return [LaserScan(1 + 0.5 * k + 0.001 * np.arange(450), ANGLES, 0.1 * k) for k in range(count)]


class Bytes:
    """An open port that says what it is given, then nothing."""

    baudrate, timeout = 230400, 0.02

    def __init__(self, *said):
        self.said, self.heard, self.dtr = list(said), b"", None

    @property
    def in_waiting(self):
        return len(self.said[0]) if self.said else 0

    def read(self, size=1):
        return self.said.pop(0) if self.said else b""

    def write(self, data):
        self.heard += data

    def close(self):
        pass


@lds2d.register("FALLING")
class Falling(lds2d.LidarDriver):
    """Angles that fall, as those of an XV-11 do, every degree; one that jitters about 0."""

    def _packets(self):
        for k in range(100_000):
            yield 5.0, [lds2d.ScanPoint((-k + (k % 360 == 1) * 1.5) % 360, 1000 + k % 360, 0)]


@lds2d.register("UNEVEN")
class Uneven(lds2d.LidarDriver):
    """A turn is no whole number of measurements."""

    def _packets(self):
        for k in range(100_000):
            yield 5.0, [lds2d.ScanPoint(-0.83 * k % 360, 1000, 0)]


@needs_terminals
@pytest.mark.parametrize("model", ["LD19", "RPLIDAR-A1"])
def test_every_turn_is_whole_and_lies_where_it_was_measured(model):
    """Catches turns split at angle 0, mirrored, shifted by a beam, or mixed with another."""
    said = turns()
    with (
        SpinningEmulator(said, model=model, speed=3) as emulator,
        SpinningLaser(model, emulator.port) as laser,
    ):
        scans = [scan for scan, _ in zip(laser.scans(), range(14), strict=False)]
    assert laser.delivered >= 14 and repr(laser).startswith(f"SpinningLaser({model}, closed, ")
    for scan in scans[1:]:
        assert 445 <= len(scan) <= 455 and scan.whole_turn
        turn, beam = np.divmod(np.rint(1000 * scan.ranges).astype(int) - 1000, 500)
        off = np.abs(np.angle(np.exp(1j * (scan.angles - ANGLES[beam]))))
        assert off.max() < np.radians(0.02)
        assert len(np.unique(turn)) <= 2  # it may begin anywhere
        first = np.argsort(scan.delays, kind="stable")
        assert np.all(np.diff(np.unwrap(scan.angles[first])) < 0)  # clockwise, as it turns
        assert 0 < scan.delays.max() < 1
    steps = np.diff([scan.time for scan in scans])
    assert np.all(steps > 0) and 0.01 < np.median(steps) < 0.1  # a thirtieth of a second each


def test_a_true_packet_and_what_no_measurement_is():
    """Catches angles that count the wrong way, a range of 0 taken for a wall, and the time of the
    end of a turn."""
    said = [TRUE_PACKET]
    for k in range(1, 40):
        words = [(angle + 1100 * k) % 36000 for angle in (32427, 33470)]
        low, high = (word.to_bytes(2, "little") for word in words)
        body = TRUE_PACKET[:4] + low + bytes(36) + high + TRUE_PACKET[44:46]
        said.append(body + bytes([crc8(body)]))
    port = Bytes(*said)
    scan = next(SpinningLaser("ld19", port, clock=lambda: 5 - 0.01 * len(port.said)).scans())
    assert scan.time == pytest.approx(4.6, abs=0.02) and 0.3 < scan.delays.max() < 0.4
    assert scan.ranges[scan.valid][[0, -1]].tolist() == [0.192, 0.224]
    assert np.degrees(scan.angles[scan.valid][[0, -1]]) == pytest.approx([25.3, 35.73], abs=0.01)
    assert np.isnan(scan.ranges[~scan.valid]).all() and len(scan) > 380


def test_a_packet_of_the_manual_of_an_x4_and_the_turn_around_it():
    """Catches ranges that are not mm / 4, angles that are not corrected, a turn that ends early."""
    true = bytes.fromhex("aa5500050105010a9a5fa00fc80f000018104010")
    said = [true]
    for k in range(1, 40):
        first, last = (2 * (64 * (10 + 12 * k + more) % 23040) + 1 for more in (0, 10))
        words = np.array([first, last, 0, *np.frombuffer(true[10:], "<u2")], "<u2")
        words[2] = np.bitwise_xor.reduce([0x55AA, *words[:2], *words[3:], 5 << 8])
        said.append(true[:4] + words.tobytes())
    scan = next(SpinningLaser("YDLIDAR-X4", Bytes(*said)).scans())
    at = [np.argmin(np.abs(np.degrees(scan.angles) + angle)) for angle in (3.24, 5.73)]
    assert np.degrees(scan.angles[at]) == pytest.approx([-3.24, -5.73], abs=0.02)
    assert scan.ranges[at].tolist() == [1.0, 1.01] and 140 <= len(scan) <= 160


def test_angles_that_fall_make_turns_too():
    """Catches turns that end where an angle drops: none ever does, or each jitter is one; and
    turns that are longer, each by what was left of the one before."""
    scans = SpinningLaser("FALLING", Bytes(b"x")).scans()
    for scan, _ in zip(scans, range(5), strict=False):
        assert 359 <= len(scan) <= 361 and scan.whole_turn
    scans = SpinningLaser("UNEVEN", Bytes(b"x")).scans()
    beams = sum(len(scan) for scan, _ in zip(scans, range(20), strict=False))
    assert abs(beams - 20 * 360 / 0.83) < 2


def test_what_is_not_known_is_assumed_and_what_is_told_is_taken():
    """Catches a mirrored log of a model whose maker says nothing, and a caller who is not heard."""
    known, other = SpinningLaser("LD06", Bytes()), SpinningLaser("FALLING", Bytes())
    told = SpinningLaser("FALLING", Bytes(), clockwise=False)
    assert "count clockwise" in str(other.assumed) and len(known.assumed) == len(told.assumed) == 1
    one, two = next(other.scans()), next(told.scans())
    mirrored = {(x, -y) for x, y in one.points().round(6).tolist()}
    assert mirrored == set(map(tuple, two.points().round(6).tolist()))


def test_motors_run_as_their_makers_say():
    """Catches a laser that never turns, and one that turns on after the program has ended."""
    for model, dtr, start in (
        ("RPLIDAR-A1", False, b"\xa5\x20"),
        ("YDLIDAR-X4", True, b"\xa5\x60"),
    ):
        port = Bytes()
        with SpinningLaser(model, port):
            assert port.dtr is dtr and start in port.heard
        assert port.dtr is not dtr


@needs_terminals
def test_another_thread_may_close_it():
    """Catches a loop that hangs, or ends with a foreign exception, when a page closes its laser."""
    with SpinningEmulator(turns(), speed=3) as emulator:
        laser = SpinningLaser("LD19", emulator.port)
        threading.Timer(0.3, laser.close).start()
        with pytest.raises(SensorError, match="closed"):
            list(laser.scans())
