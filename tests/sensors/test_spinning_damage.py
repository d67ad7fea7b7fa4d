"""What goes wrong with lasers that turn: each kind of damage leaves scans right, or is told."""

import errno
import itertools

import numpy as np
import pytest
from emulated import Wired, needs_terminals

from segmap.scans import LaserScan
from segmap.sensors import SensorError, SpinningLaser
from segmap.sensors.emulator import SpinningEmulator
from segmap.sensors.emulator._spinning import SpinningUnit

pytest.importorskip("lds2d")
crc8 = pytest.importorskip("lds2d.crc").crc8
serial = pytest.importorskip("serial")

ANGLES = np.radians(0.8 * np.arange(450) - 180)
RATES = {"LD19": 230_400, "RPLIDAR-A1": 115_200}
#: Scans that a run asks for, and the first byte that is damaged: in the second turn.
SCANS, FIRST = 8, 2500
GPS = b"$GPGGA,123519,4807.038,N,01131.000,E,1,08,0.9,545.4,M,46.9,M,,*47\r\n"
RNG = np.random.default_rng(7)


def turns(way=-1, **change):
    """Scans in which no two beams are equal: 1 m, growing by a millimetre a beam, .5 m a turn."""
    delays = (way * np.degrees(ANGLES) % 360) / 3600
    beams = {"ranges": np.arange(450), "angles": ANGLES, "delays": delays} | change
    return [
        LaserScan(1 + 0.5 * k + 0.001 * beams["ranges"], beams["angles"], 0.1 * k,
                  delays=beams["delays"])
        for k in range(3)
    ]  # fmt: skip


def false(scan, mirror=1):
    """How many beams the laser has not measured there."""
    met, angles = scan.ranges[scan.valid], mirror * scan.angles[scan.valid]
    turn, beam = np.divmod(np.rint(1000 * met).astype(int) - 1000, 500)
    inside = (turn >= 0) & (turn < 3) & (beam < 450)
    off = np.abs(np.angle(np.exp(1j * (angles - ANGLES[np.where(inside, beam, 0)]))))
    return int((~inside | (off > np.radians(0.03))).sum())


def every(count, change):
    """Each so-many-th byte changed."""
    return lambda data, at: b"".join(
        change(data[k : k + 1]) if at + k >= FIRST and (at + k) % count == 0 else data[k : k + 1]
        for k in range(len(data))
    )


def between(first, last, change=lambda data: b""):
    """Some of the bytes changed, or gone."""

    def spoil(data, at):
        a, b = (min(max(end - at, 0), len(data)) for end in (first, last))
        return data[:a] + (change(data[a:b]) if b > a else b"") + data[b:]

    return spoil


def packets(change, count=1, times=1):
    """Each so-many-th packet of an LD19 changed, and its check made right again; or each node."""

    def spoil(data, at):
        begin = 7 if data[:2] == b"\xa5\x5a" else 0
        size = 47 if data[:1] == b"\x54" else 5
        sent = data[:begin]
        for k in range(begin, len(data), size):
            one = data[k : k + size]
            if (at + k) // size % count == 0:
                one = change(one)
                one = (one[:-1] + bytes([crc8(one[:-1])]) if size == 47 else one) * times
            sent += one
        return sent

    return spoil


def flip(data):
    return bytes([data[0] ^ 1 << int(RNG.integers(8))])


def random(data):
    return RNG.bytes(len(data))


def still(packet):
    """A speed of 0, of which an RPLidar says nothing."""
    return packet[:2] + bytes(2) + packet[4:] if packet[5:] else packet


def stamped_late(packet, count=itertools.count()):
    """The clock of an LD19 near its end, which is 30 s; an RPLidar sends none."""
    if not packet[5:]:
        return packet
    return packet[:44] + ((29_900 + 3 * next(count)) % 30_000).to_bytes(2, "little") + packet[46:]


def dull(packet):
    """Quality and intensity 0."""
    if len(packet) == 5:
        return bytes([packet[0] & 3]) + packet[1:]
    return bytes(0 if 6 <= k < 42 and k % 3 == 2 else byte for k, byte in enumerate(packet))


def short(packet):
    """Eleven measurements where there were twelve; a node of six bytes."""
    return packet + b"\x01" if len(packet) == 5 else b"\x54\x2b" + packet[2:39] + packet[42:]


END, TALKS = 1 << 30, "no whole turn in them"
#: How the bytes are spoiled, and what is said; where nothing is said the scans are right.
KINDS = {
    "a byte lost": (between(FIRST, FIRST + 1), ""),
    "many bytes lost": (every(211, lambda data: b""), ""),
    "bytes lost at the start": (between(7, 40), ""),
    "the first bytes lost": (between(0, 5), ("", TALKS)),
    "a check wrong": (between(FIRST, FIRST + 1, flip), ""),
    "checks wrong in a row": (between(FIRST, FIRST + 500, random), ""),
    "bits wrong all the way": (every(503, flip), ""),
    "half a turn cut": (between(FIRST, FIRST + 900), ""),
    "most of a turn cut": (between(FIRST, FIRST + 1500), ""),
    "three turns cut": (between(FIRST, FIRST + 6000), ""),
    "text": (lambda data, at: (b"login: \r\n" * 60)[: len(data)], TALKS),
    "zeros": (lambda data, at: bytes(len(data)), TALKS),
    "a GPS": (lambda data, at: (GPS * 9)[: len(data)], TALKS),
    "a GPS in the middle": (between(FIRST, END, lambda data: (GPS * 9)[: len(data)]), TALKS),
    "wrong baud": (lambda data, at: random(data), TALKS),
    "noise from the middle on": (between(FIRST, END, random), TALKS),
    "garbage between packets": (every(470, lambda data: RNG.bytes(60) + data), ""),
    "packets twice": (packets(bytes, 10, times=2), ""),
    "a length wrong": (packets(short, 20), ""),
    "speed 0 in packets": (packets(still), ""),
    "quality 0": (packets(dull), ""),
    "stamps that wrap": (packets(stamped_late), ""),
}  # fmt: skip


def scans_of(wired, model, **settings):
    """The scans that come, and why there are no more."""
    came = []
    wired.port = "/dev/ttyUSB7"
    try:
        with SpinningLaser(model, wired, clock=lambda: wired.now, **settings) as laser:
            for scan in itertools.islice(laser.scans(), SCANS):
                came.append(scan)
    except SensorError as error:
        return came, str(error)
    return came, ""


@pytest.mark.parametrize("model", RATES)
@pytest.mark.parametrize("kind", KINDS)
def test_scans_stay_right_or_the_damage_is_told(kind, model):
    """Catches beams out of step, turns split, noise taken for scans, a wait without end."""
    spoil, words = KINDS[kind]
    words = words if isinstance(words, str) else words[model != "LD19"]
    wired = Wired(spoil, world=turns(), unit=SpinningUnit, model=model)
    scans, why = scans_of(wired, model)
    assert (words in why and model in why and "/dev/ttyUSB7" in why) if words else not why
    assert len(scans) == SCANS or words
    for scan in scans:
        # no check but two bits: the node of an RPLidar that a byte was lost from may look right
        assert false(scan) <= (0 if model == "LD19" else 9)
        assert 0 < scan.delays.max() <= 0.125 and len(scan) <= 500  # a tenth came twice
    assert not why or kind.endswith(" on") or "middle" in kind or not scans
    assert words or sum(len(scan) > 400 for scan in scans) >= 4 or "all" in kind or "many" in kind
    assert np.all(np.diff([scan.time for scan in scans]) > 0)


@pytest.mark.parametrize("model", RATES)
def test_a_laser_that_stands_or_counts_the_other_way_or_sees_nothing(model):
    """Catches a wait without end for a turn, a mirrored scan, and turns lost with their walls."""
    stands = [LaserScan(np.full(450, 2.0), np.zeros(450), 0.1 * k) for k in range(3)]
    scans, why = scans_of(Wired(world=stands, unit=SpinningUnit, model=model), model)
    assert not scans and TALKS in why and "does it turn?" in why
    turned = Wired(world=turns(way=1), unit=SpinningUnit, model=model)
    scans, why = scans_of(turned, model)
    if model == "LD19":  # its packets are read as if their angles grew
        assert not scans and TALKS in why
    assert model == "LD19" or (len(scans) == SCANS and not any(map(false, scans)))
    mirrored = turns(angles=-ANGLES, way=1)
    wired = Wired(world=mirrored, unit=SpinningUnit, model=model)
    scans, why = scans_of(wired, model, clockwise=False)
    assert len(scans) == SCANS and not any(map(false, scans))
    empty = Wired(world=turns(ranges=np.full(450, np.nan)), unit=SpinningUnit, model=model)
    scans, why = scans_of(empty, model)
    assert len(scans) == SCANS and {len(scan) for scan in scans} == {450}
    assert not any(scan.valid.any() for scan in scans)


@pytest.mark.parametrize("model", RATES)
@pytest.mark.parametrize("kind", ["silence", "unplug"])
def test_what_ends_in_the_middle_is_told_and_what_came_stays(kind, model):
    """Catches a wait without end, and turns before the end that are lost with it."""
    wired = Wired(world=turns(), unit=SpinningUnit, model=model)
    wired.plan(kind, 3 * FIRST, seconds=3.0)
    scans, why = scans_of(wired, model)
    assert 2 <= len(scans) < SCANS and not any(map(false, scans))
    assert ("nothing came for 2 s" if kind == "silence" else "gone") in why
    assert "/dev/ttyUSB7" in why and model in why


@pytest.mark.parametrize("model", RATES)
def test_a_silence_that_is_waited_out_mixes_no_turns(model):
    """Catches a scan of which a half was measured three seconds before the other."""
    wired = Wired(world=turns(), unit=SpinningUnit, model=model)
    wired.plan("silence", 3 * FIRST, seconds=3.0)
    scans, why = scans_of(wired, model, timeout=5.0)
    assert len(scans) == SCANS and not why
    for scan in scans:  # of one turn, or of it and the next; the scans begin anew after three
        count = np.unique((scan.ranges - 1) // 0.5, return_counts=True)[1]
        assert (count > 1).sum() <= 2 and len(scan) > 400
    assert max(np.diff([scan.time for scan in scans])) == pytest.approx(3.1, abs=0.15)


@needs_terminals
@pytest.mark.parametrize("model", RATES)
def test_a_port_that_is_taken_forbidden_or_gone(model, monkeypatch):
    """Catches a port that two programs read, half of the bytes each, and a bare error."""
    with SpinningEmulator(turns(), model=model) as emulator:
        port = emulator.port
        with (
            SpinningLaser(model, port),
            pytest.raises(SensorError, match=f"{port}: another program"),
        ):
            SpinningLaser(model, port)
    with pytest.raises(SensorError, match=f"cannot open {port}: it is not there: is the sensor"):
        SpinningLaser(model, port)

    def forbidden(*args, **settings):
        raise serial.SerialException(errno.EACCES, "could not open port: Permission denied")

    monkeypatch.setattr(serial, "Serial", forbidden)
    with pytest.raises(SensorError, match="/dev/ttyUSB0: you may not use it: join the group"):
        SpinningLaser(model, "/dev/ttyUSB0")
