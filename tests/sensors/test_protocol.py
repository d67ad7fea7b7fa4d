"""SCIP as bytes: coding, sums, whole captures there and back, and what damage does."""

import contextlib
import itertools

import numpy as np
import pytest
from emulated import capture
from hypothesis import given, settings
from hypothesis import strategies as st

from segmap.sensors import SensorError, checksum, decode, encode, parse_scan
from segmap.sensors._connect import switch_off
from segmap.sensors._geometry import laser_scan, parse_geometry
from segmap.sensors._host import HostClock
from segmap.sensors._lines import Lines
from segmap.sensors._protocol import (
    Measurement,
    encode_info,
    encode_reply,
    encode_scan,
    parse_info,
    parse_reply,
)

# ---------------------------------------------------------------------------- coding


def test_numbers_and_sums_of_the_manual():
    """Catches groups of six bits in the wrong order, another zero, and another mask."""
    texts = {1234: b"CB", 5432: b"1Dh", 16_000_000: b"m2@0", 19: b"0C", 4095: b"oo"}
    for value, text in (*texts.items(), (19, b"00C")):
        assert encode(value, len(text)) == text
        assert decode(text, len(text)) == [value]
    for line in (b"00P", b"01Q", b"02R", b"03S", b"10Q", b"99b", b"0Aa", b"0Ii"):
        assert checksum(line[:2]) == line[2:]
    for value in (-1, 4096):
        with pytest.raises(ValueError, match="2 characters, 0 to 4095"):
            encode(value, 2)


@given(st.integers(0, 2**24 - 1), st.integers(0, 800), st.integers(0, 999))
def test_scans_there_and_back(clock, count, seed):
    """Catches values that are cut at the border of a block: 64 is no multiple of 3.

    What two or three characters cannot hold is cut, and a clock beyond its 24 bits wraps.
    """
    millimetres = np.random.default_rng(seed).integers(0, 5600, count)
    for characters in (2, 3):
        met = parse_scan(encode_scan(clock + 2**24, millimetres, characters), characters)
        assert met.clock == clock
        most = 64**characters - 1
        assert met.millimetres.tolist() == np.minimum(millimetres, most).tolist()
    assert parse_scan(encode_scan(0, [2**18], 3), 3).millimetres.tolist() == [2**18 - 1]


# -------------------------------------------------------------------------- captures
def replies_of(data: bytes) -> list[list[bytes]]:
    return [reply.strip(b"\n").split(b"\n") for reply in data.split(b"\n\n") if reply.strip(b"\n")]


def test_the_capture_byte_by_byte():
    """Every reply of the sensor is parsed, its sums seen to, and written again the same."""
    data = capture("urg04lx-from-sensor.scip.gz")
    first, rest = data.split(b"SCIP2.0\n0\n\n")
    assert first.startswith(b"V\n0\nVEND:")
    scans, again = 0, b""
    for lines in replies_of(rest):
        reply = parse_reply(lines)
        body = list(reply.body)
        if reply.echo.startswith("GD"):
            met = parse_scan(body, 3)
            first, last = int(reply.echo[2:6]), int(reply.echo[6:10])
            assert len(met.millimetres) == last - first + 1 == 677
            body, scans = encode_scan(met.clock, met.millimetres, 3), scans + 1
        elif body:
            body = encode_info(parse_info(body))
        again += encode_reply(reply.echo, reply.status, body)
    assert scans == 121
    assert again == rest


# ---------------------------------------------------------------------------- damage
WHOLE = encode_scan(6968830, 20 + np.arange(682) * 7 % 4000, 3)


@settings(max_examples=150)
@given(st.integers(0, 2113), st.integers(0, 7))
def test_no_flipped_bit_passes(at, bit):
    """Catches a sum that is not looked at, or characters that are not: bits 6 and 7 keep sums."""
    text = bytearray(b"\n".join(WHOLE))
    text[at % len(text)] ^= 1 << bit
    with pytest.raises(SensorError):
        assert len(parse_scan(bytes(text).split(b"\n"), 3).millimetres) != 682


@pytest.mark.parametrize("characters", [2, 3])
def test_no_lost_byte_passes(characters):
    """Catches blocks of any length: a lost "@" leaves the sum, a lost end of line joins blocks."""
    met = np.full(682, 1024)
    text = b"\n".join(encode_scan(0, met, characters))
    for at in range(len(text)):
        with pytest.raises(SensorError):
            parse_scan((text[:at] + text[at + 1 :]).split(b"\n"), characters)


TOLD = dict(ARES="1024", AMIN="44", AMAX="725", AFRT="384", DMIN="20", DMAX="5600", SCAN="600")


def test_a_wrong_sum_is_overlooked_in_information_only():
    """Some firmware sends a wrong sum, and a line of another kind, with VV."""
    assert parse_info([b"SERI:H0706400;X"]) == {"SERI": "H0706400"}
    assert parse_info([b"SERI:H0706400;F", b"ready"]) == {"SERI": "H0706400"}
    for line in (b"SERI:H0706400;X", b"SERI:H0706400", b"ready", b""):
        with pytest.raises(SensorError, match="no line of information with its sum"):
            parse_info([line], strict=True)


def flipped(text):
    """A text with each of its bits turned over."""
    for at in range(8 * len(text)):
        damaged = bytearray(text)
        damaged[at // 8] ^= 1 << at % 8
        yield bytes(damaged)


def test_no_flipped_bit_moves_the_geometry():
    """Catches AFRT read without its sum: 385 for 384 turns every scan by a beam."""
    right = parse_geometry(TOLD)
    for damaged in flipped(b"\n".join(encode_info(TOLD))):
        with contextlib.suppress(SensorError):
            assert parse_geometry(parse_info(damaged.split(b"\n"), strict=True)) == right


def test_no_flipped_bit_makes_another_status():
    """Catches "p0", whose sum is that of "00": a refusal that the sensor never gave."""
    assert parse_reply([b"VV", b"00P"]).status == "00"
    for status in flipped(b"00P"):
        with pytest.raises(SensorError, match=r"check sum|no status"):
            parse_reply([b"VV", status])


CANNOT_BE = [dict(ARES="0"), dict(AMIN="x"), dict(AMAX="9999"), dict(SCAN="0"), dict(AFRT="1024")]
CANNOT_BE += [dict(ARES="20000", AMAX="10000")]  # requests have four digits for a step
CANNOT_BE += [{key: str(2**20 + 1)} for key in ("ARES", "DMAX", "SCAN")]


def test_a_geometry_that_cannot_be():
    """Catches an arc without its front, and numbers so long that the arithmetic overflows."""
    geometry = parse_geometry(TOLD)

    scan = laser_scan(Measurement(0, np.full(682, 500)), geometry, time=5.0)
    assert scan.angles[[340, 341]].tolist() == [0.0, 2 * np.pi / 1024]
    assert np.degrees(scan.angles[0]) == pytest.approx(-119.53, abs=0.005)
    assert scan.delays == pytest.approx(np.arange(682) * 0.1 / 1024)
    assert scan.time == pytest.approx(5.0 + (44 - 384 + 512) / 1024 * 0.1)  # from the rear on
    for change in (*CANNOT_BE, *({key: "9" * 400} for key in ("SCAN", "AFRT", "DMAX"))):
        with pytest.raises(SensorError, match="PP told"):
            parse_geometry(TOLD | change)


def test_what_a_model_is():
    """Catches one wrong bit that changes the table of codes: no sum sees the upper two bits."""
    for model in ("UTM-30LX-EW", "UST-20LX", "UXM-30LX-EW(Hokuyo)"):
        assert parse_geometry(TOLD | {"MODL": model}).is_far
    for model in ("URG-04LX-UG01(Simple-URG)", "UBG-04LX-F01", "UHG-08LX"):
        assert not parse_geometry(TOLD | {"MODL": model}).is_far
    line = b"MODL:URG-04LX;" + checksum(b"MODL:URG-04LX")
    for damaged in itertools.islice(flipped(line), 8 * 5, 8 * 8):
        with pytest.raises(SensorError, match="no line of information"):
            parse_info([damaged], strict=True)


# ------------------------------------------------------------------- arbitrary bytes
class Said:
    """A port that holds some bytes; its clock goes on with each read."""

    def __init__(self, data):
        self.left, self.now = data, 0.0

    @property
    def in_waiting(self):
        return len(self.left)

    def read(self, size=1, /):
        self.now += 0.01
        assert self.now < 100, "reads without end"
        data, self.left = self.left[:size], self.left[size:]
        return data


def test_silence_forgets_what_was_heard_before():
    """Catches an old answer, or half a line, that is taken for the answer to the next request."""
    port = Said(b"VV\n00P\n\nMD0044072501000\n00P\nhalf a li")
    lines = Lines(port, lambda: port.now)
    assert lines.reply(b"VV", 0.5) == ([b"VV", b"00P"], 0)
    assert lines.kept.startswith(b"MD0044072501000")
    assert lines.silence(0.1)
    port.left = b"QT\n00P\n\n"
    assert lines.line(0.5) == b"QT"
    port.left = b"VV\n" + 200 * b"0\n"
    with pytest.raises(SensorError, match="its end was lost"):
        lines.reply(b"VV", 0.5)


class Answers(Said):
    """A port that says the next answer to whatever is written."""

    def __init__(self, *answers):
        super().__init__(b"")
        self.answers, self.asked = iter(answers), []

    def write(self, data, /):
        self.asked.append(data)
        self.left = next(self.answers)


@pytest.mark.parametrize(
    ("answers", "asked"),
    [([b"QT\n00P\n\n"], 1), ([b"", b"QT\n0Ee\n\n", b"QT\n00P\n\n"], 3), ([b""] * 3, 3)],
)
def test_the_laser_is_switched_off_until_it_says_so(answers, asked):
    """Catches a laser that stays on where QT was lost once, and one that is told again."""
    port = Answers(*answers)
    switch_off(Lines(port, lambda: port.now))
    assert port.asked == [b"QT\n"] * asked


# ----------------------------------------------------------------------------- clock
@pytest.mark.parametrize("first", [0, 2**24 - 250])
def test_late_arrivals_do_not_move_the_clock(first):
    """Catches times of arrival taken for times of measuring, always or where the stamps wrap."""
    late = [0.0, 0.03, 0.0, 0.9, 0.0, 0.01]
    clock, stamps = HostClock(least=0.07), [(first + 100 * k) % 2**24 for k in range(6)]
    times = [clock.seconds(stamps[k], 50.07 + 0.1 * k + d) for k, d in enumerate(late)]
    assert times == pytest.approx([50 + 0.1 * k for k in range(6)], abs=0.002)


def test_a_night_without_scans_is_counted_in_wraps():
    """Catches a scan that lies 4 h 39 min before the one it follows."""
    clock, wrap = HostClock(), 2**24 / 1000
    clock.seconds(1000, 10.0)
    assert clock.seconds(2000, 11.0 + 2 * wrap) == pytest.approx(11 + 2 * wrap, abs=1e-6)


@pytest.mark.parametrize("pace", [100.02, 99.98])
def test_a_drifting_clock_is_followed(pace):
    """Catches an offset that is fixed at the first scan: quartz parts by a second in hours."""
    clock = HostClock()
    times = [clock.seconds(round(pace * k) % 2**24, 0.1 * k) for k in range(20_000)]
    assert abs(times[-1] - 0.1 * 19_999) < 0.01
