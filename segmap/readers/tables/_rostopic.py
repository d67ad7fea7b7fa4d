"""What `rostopic echo -p /scan` writes: a `sensor_msgs/LaserScan` a line, its fields in columns.

    %time,field.header.seq,field.header.stamp,...,field.angle_min,...,field.ranges0,field.ranges1,...

Times are nanoseconds. There is no odometry and no truth.

Assumed: the laser sits at the robot's centre.
"""

from __future__ import annotations

from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

from ...scans import LaserScan, Log
from .._lines import BROKEN, Lines, float_fields, open_bytes, time
from .._raw_scans import beams_of_message

#: How a column of the message begins.
FIELD = "field."
#: Numbers of a message that stand in one column each.
SINGLE_NUMBERS = ("angle_min", "angle_increment", "range_min", "range_max", "time_increment")
#: No head is longer, in bytes: 2 000 beams with intensities.
MOST_HEAD_BYTES = 200_000


def rostopic_columns(path: Path) -> list[str]:
    """The names of the columns, without what they begin with; none for another file."""
    with suppress(*BROKEN, OSError), open_bytes(path) as file:
        names = file.readline(MOST_HEAD_BYTES).decode("ascii", "replace").strip().split(",")
        short = [name.removeprefix(FIELD) for name in names]
        if names[0] == "%time" and {*SINGLE_NUMBERS, "ranges0"} <= {*short}:
            return short
    return []


def read_rostopic(path: Path, name: str, on_error: str = "raise") -> Log:
    """Read a log of such lines."""
    lines, columns = Lines(path, on_error, ","), rostopic_columns(path)
    place = {column: k for k, column in enumerate(columns)}
    ranges = [k for k, column in enumerate(columns) if column[:6] == "ranges"]

    def scan_of(fields: list[str]) -> LaserScan | None:
        """The scan of a line; None of the head."""
        if fields[0] == "%time":
            return None
        if len(fields) != len(columns):
            raise ValueError(f"expected {len(columns)} columns, got {len(fields)}")
        single = float_fields([fields[place[word]] for word in SINGLE_NUMBERS], "the scan")
        found = float_fields([fields[k] for k in ranges], "ranges")
        message = SimpleNamespace(**dict(zip(SINGLE_NUMBERS, single, strict=True)), ranges=found)
        when = time(fields[place.get("header.stamp", 0)], unit=1e-9)
        return replace(beams_of_message(message), time=when)

    scans = [scan for scan in lines.each(scan_of) if scan is not None]
    if not scans:
        raise lines.no_scan("a line of a scan below the head")
    return Log(name, scans, None, lines.skipped, assumed=("the laser sits at the robot's centre",))
