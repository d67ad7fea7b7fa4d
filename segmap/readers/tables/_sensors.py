"""What sensors send, kept as text or bytes: telegrams of SICK, UrgBenri of Hokuyo, packets of LD19.

    sRA LMDscandata 1 1 ...   numbers in hexadecimal                       CoLa A of SICK
    [timestamp], [scan]       each in a line, with its values in the next  UrgBenri of Hokuyo
    54 2C 68 08 ...           packets of 12 beams, as bytes or in hexadecimal     LD06, LD19

Of a telegram 90 degrees of the sensor are straight ahead and 0 is no measurement. Of an LD19 angles
are clockwise, and its clock of milliseconds begins anew every 30 s.

Assumed: a telegram's time is that since the sensor was started, and those of UrgBenri are in
milliseconds.
"""

from __future__ import annotations

import re
import struct
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from ...scans.error_codes import as_ranges
from .._lines import Lines, LogError

#: The number of the line where a record ends, and what it says.
Record = tuple[int, Mapping[str, str]]
#: What SICK's sensors answer to the wish for a scan, or send by themselves.
TELEGRAM = re.compile(r"s(?:RA|SN) LMDscandata ([^\x02\x03]*)")
#: Which field of a telegram is its time, ...
TELEGRAM_TIME = 7
#: ... and which says how many encoders follow, before the channels.
TELEGRAM_ENCODERS = 16
#: Fields of a channel before its values.
CHANNEL_FIELDS = 6
#: What a telegram counts angles in.
SICK_STEP_RAD = np.radians(1e-4)
#: Larger values of a Hokuyo mean that nothing was met.
MOST_OF_URG_MM = 60_000
#: What a telegram of SICK and a log of UrgBenri leave unsaid.
TOLD_OF_TELEGRAMS = (
    "90 degrees of the sensor are straight ahead",
    "times are those since the sensor was started",
)
TOLD_OF_URG_BENRI = ("times are in milliseconds",)
#: First bytes of a packet of an LD06 or LD19, ...
LD19_HEAD = b"\x54\x2c"
#: ... its bytes, ...
LD19_BYTES = 47
#: ... and its beams.
LD19_BEAMS = 12
#: Its clock begins anew after so many milliseconds.
LD19_CLOCK_MS = 30_000
#: Polynomial of the sum at its end.
LD19_POLYNOMIAL = 0x14D
#: So many bytes tell whether a file holds packets.
PACKETS_SAMPLE_BYTES = 2000
#: So many are read.
MOST_PACKETS_BYTES = 1 << 28


def text_of(value: Any) -> str:
    """A value of JSON as a field of a table: of a list the numbers in brackets."""
    if isinstance(value, list):
        return f"[{' '.join(map(text_of, value))}]"
    return "nan" if value is None else str(value)


def telegrams(lines: Lines) -> Iterator[Record]:
    """Telegrams of SICK: head, channels of 16 bits, of which DIST1 holds millimetres."""
    for (text,) in lines:
        for telegram in TELEGRAM.findall(text):
            yield from _record_or_damage(
                lines, "telegram of LMDscandata", _telegram, telegram.split()
            )


def _record_or_damage(
    lines: Lines, what: str, parse: Callable[[Any], Mapping[str, str]], given: Any
) -> Iterator[Record]:
    """One record; a damaged one is told or counted."""
    try:
        yield lines.number, parse(given)
    except (ValueError, ArithmeticError, LookupError, TypeError, struct.error) as fault:
        lines.damaged(lines.error(f"expected a whole {what} ({fault})"))


def _telegram(fields: Sequence[str]) -> dict[str, str]:
    at = TELEGRAM_ENCODERS + 1 + 2 * _number(fields[TELEGRAM_ENCODERS])
    for _ in range(_number(fields[at])):
        name, scale, offset, first, step, count, *data = fields[at + 1 :]
        if name == "DIST1":
            break
        at += CHANNEL_FIELDS + _number(count)
    else:
        raise ValueError("no DIST1 in it")
    if not 0 < _number(count) <= len(data):
        raise ValueError(f"announces {_number(count)} ranges, but {len(data)} fields follow")
    values = np.array([_number(field) for field in data[: _number(count)]])
    ranges = np.where(values > 0, values * _real(scale) + _real(offset), 0) / 1000
    begin = (_number(first) + 2**31) % 2**32 - 2**31
    return {
        "time_us": str(_number(fields[TELEGRAM_TIME])),
        "angle_min": str(begin * SICK_STEP_RAD - np.pi / 2),
        "angle_increment": str(_number(step) * SICK_STEP_RAD),
        "ranges": text_of(np.where(ranges > 0, ranges, np.nan).tolist()),
    }


def _number(field: str) -> int:
    """A number of a telegram: hexadecimal, or decimal with a sign before it."""
    return int(field) if field.startswith(("+", "-")) else int(field, 16)


def _real(field: str) -> float:
    return float(struct.unpack(">f", bytes.fromhex(field.zfill(8)))[0])


def urg_benri(lines: Lines) -> Iterator[Record]:
    """Scans of UrgBenri, whose steps count from behind to the left."""
    said: dict[str, str] = {}
    key = ""
    for (text,) in lines:
        if found := re.fullmatch(r"\[(\w+)\]", text):
            key = found[1]
        elif key:
            said[key] = text
            if key == "scan":
                yield from _record_or_damage(
                    lines, "scan of UrgBenri", _scan_of_urg_benri, dict(said)
                )
            key = ""


def _scan_of_urg_benri(said: Mapping[str, str]) -> dict[str, str]:
    keys = ("totalSteps", "frontStep", "startStep")
    total, front, first = (float(said.get(key, "nan")) for key in keys)
    parts = said["scan"].strip(";").split(";")
    far = np.array([float(re.split("[&|]", part)[0]) for part in parts])  # the first echo
    ranges = np.where(far > MOST_OF_URG_MM, np.inf, as_ranges(far)[0])
    found = {"time_ms": said.get("timestamp", ""), "ranges": text_of(ranges.tolist())}
    if np.isnan(total):  # of some programs the head is missing
        return found
    step = 2 * np.pi / total * float(said.get("grouping", 1) or 1)
    begin = (first - front) * 2 * np.pi / total
    return found | {"angle_min": str(begin), "angle_increment": str(step)}


def packets_in(raw: bytes) -> Iterator[tuple[int, bytes]]:
    """Where the whole packets of an LD19 begin in bytes or in their print in hexadecimal; and they.

    Where the sum of one is wrong the next is looked for.
    """
    plain = re.sub(rb"0[xX]|[\s,;:]", b"", raw)
    plain = plain[: len(plain) // 2 * 2]
    data = bytes.fromhex(plain.decode()) if re.fullmatch(rb"[0-9A-Fa-f]*", plain) else raw
    at = data.find(LD19_HEAD)
    while 0 <= at <= len(data) - LD19_BYTES:
        packet, checksum = data[at : at + LD19_BYTES], 0
        for byte in packet[:-1]:
            checksum = LD19_SUMS[checksum ^ byte]
        if checksum == packet[-1]:
            yield at, packet
        at = data.find(LD19_HEAD, at + (LD19_BYTES if checksum == packet[-1] else 1))


def _sum_of(byte: int) -> int:
    for _ in range(8):
        byte = (byte << 1) ^ (LD19_POLYNOMIAL if byte & 0x80 else 0)
    return byte


LD19_SUMS = tuple(map(_sum_of, range(256)))


def ld19(lines: Lines) -> Iterator[Record]:
    """The beams of an LD19; they share the time of their packet."""
    clock = last = end = 0
    for at, packet in packets_in(lines.held(MOST_PACKETS_BYTES)):
        if end and at > end:
            reason = f"bytes {end} to {at} are no whole packets of an LD19"
            lines.damaged(LogError(lines.path, reason))
        first, *beams, final, stamp = struct.unpack(f"<4xH{LD19_BEAMS * 'Hx'}HHx", packet)
        clock += (stamp - last) % LD19_CLOCK_MS
        last, end = stamp, at + LD19_BYTES
        step = (final - first) % 36_000 / (LD19_BEAMS - 1)
        for k, far in enumerate(beams):
            angle = (first + k * step) % 36_000 / 100
            yield 0, {"angle_deg_cw": str(angle), "range_mm": str(far), "time_ms": str(clock)}
