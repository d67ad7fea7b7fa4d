"""Which format a file is of: by its first bytes or header, then by what most first lines are."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import islice
from pathlib import Path
from typing import NamedTuple

from ..scans import Log
from ._lines import Lines, LogError, UnknownFormat
from .bags import _bags
from .carmen import _carmen, _dpslam, _gmapping, _player, _wean
from .graphs import _g2o
from .mrpt import _mrpt
from .tables import _coreslam, _csv, _dumps, _hokuyo_text, _npz, _rawseeds

#: So many lines are looked at; a damaged one among them does not change what most of them say.
FIRST = 200
#: What a user writes whose columns have no header.
FROM_COLUMNS = (
    "A line a beam without a header: "
    "segmap.readers.read_csv(path, columns=['angle_deg', 'range_mm', 'quality'])."
)
#: What a user writes whose data are in none of the formats.
FROM_ARRAYS = """Measurements in arrays (metres, radians, seconds) become a log by three lines:
    import segmap
    scans = [segmap.LaserScan(ranges, angles, time=t) for t, ranges in measured]
    log = segmap.Log("mine", scans)"""


class Binary(NamedTuple):
    """A reader, and how to tell its files by their first bytes, suffix or header."""

    name: str
    claims: Callable[[Path], bool]
    read: Callable[[Path, str, str], Log]


class Format(NamedTuple):
    """A reader of text, and how to tell its lines from others."""

    name: str
    claims: Callable[[Sequence[str]], bool]
    read: Callable[[Path, str, str], Log]
    separator: str | None = None


#: These are asked first, in this order.
BINARY: tuple[Binary, ...] = (
    Binary("ROS bag", _bags.claims, _bags.read),
    Binary("MRPT", _mrpt.claims, _mrpt.read),
    Binary("NPZ", _npz.claims, _npz.read),
    Binary("CSV", _csv.claims, _csv.read),
)
FORMATS = (
    Format("CARMEN", _carmen.claims, _carmen.read),
    Format("GMapping", _gmapping.claims, _gmapping.read),
    Format("g2o", _g2o.claims, _g2o.read),
    Format("Player", _player.claims, _player.read),
    Format("DP-SLAM", _dpslam.claims, _dpslam.read),
    Format("Wean Hall", _wean.claims, _wean.read),
    Format("Hokuyo text", _hokuyo_text.claims, _hokuyo_text.read),
    Format("CoreSLAM", _coreslam.claims, _coreslam.read),
    Format("RPLidar", _dumps.claims_rplidar, _dumps.read_rplidar),
    Format("LD19", _dumps.claims_ld19, _dumps.read_ld19),
    Format("Rawseeds", _rawseeds.claims, _rawseeds.read, ","),
)


def recognise(path: Path) -> Binary | Format:
    """The first that claims the file, or else the format that claims most of the first lines."""
    for form in BINARY:
        if form.claims(path):
            return form
    return _by_lines(path)


def _by_lines(path: Path) -> Format:
    lines = Lines(path, "skip", separator="\n")
    sample = [line[0] for line in islice(lines, FIRST)]
    split = {separator: [line.split(separator) for line in sample] for separator in (None, ",")}
    votes = [sum(map(form.claims, filter(None, split[form.separator]))) for form in FORMATS]
    if not any(votes):
        fault = lines.first or LogError(path, _unknown(lines, sample))
        raise UnknownFormat(path, fault.reason, fault.line)
    return FORMATS[votes.index(max(votes))]


def _unknown(lines: Lines, sample: Sequence[str]) -> str:
    if lines.number == 0:
        found = "is empty, expected a log"
    else:
        first = f"it starts with {sample[0][:40]!r}" if sample else "it has comments only"
        found = f"is of no known format: {first}"
    return f"{found}\n{what_to_do()}"


def what_to_do() -> str:
    """The known formats, and what a user writes whose data are in none of them."""
    known = [*(form.name for form in FORMATS), *(form.name for form in BINARY)]
    return f"Known formats: {', '.join(known)}.\n{FROM_COLUMNS}\n{FROM_ARRAYS}"
