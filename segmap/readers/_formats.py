"""Which format a file is of: by its first bytes or header, then by what most first lines are."""

from __future__ import annotations

from itertools import islice
from pathlib import Path

from . import bags, mrpt, tables
from ._lines import Lines, UnknownFormat
from ._text import Binary, TextFormat
from .carmen import CARMEN_FORMATS
from .graphs import GRAPH_FORMATS
from .tables import TABLE_FORMATS

#: These are asked first, in this order.
BINARY_FORMATS: tuple[Binary, ...] = (bags.BAG, mrpt.MRPT, *tables.TABLE_FILES)
FOLDER_FORMATS: tuple[Binary, ...] = (bags.BAG, *tables.TABLE_FOLDERS)
TEXT_FORMATS: tuple[type[TextFormat], ...] = (*CARMEN_FORMATS, *GRAPH_FORMATS, *TABLE_FORMATS)
#: So many lines are looked at; a damaged one among them does not change what most of them say.
LOOKED_AT_LINES = 200
#: Names of all formats of single files.
NAMES_OF_FORMATS = (
    *(form.name for form in TEXT_FORMATS),
    *(form.name for form in BINARY_FORMATS),
)
#: What a user writes whose data are in none of the formats.
WHAT_TO_DO = f"""\
Known formats: {", ".join(NAMES_OF_FORMATS)}.
A line a beam without a header: \
segmap.readers.read_csv(path, columns=['angle_deg', 'range_mm', 'quality']).
Measurements in arrays (metres, radians, seconds) become a log by three lines:
    import segmap
    scans = [segmap.LaserScan(ranges, angles, time=t) for t, ranges in measured]
    log = segmap.Log("mine", scans)"""


def recognise(path: Path) -> Binary | type[TextFormat]:
    """The first format that claims a file or folder, or else the one of most of the first lines."""
    for form in FOLDER_FORMATS if path.is_dir() else BINARY_FORMATS:
        if form.claims(path):
            return form
    if path.is_dir():
        raise UnknownFormat(
            path,
            "holds no log, expected a Rawseeds recording (SICK_FRONT.csv or HOKUYO_FRONT.csv, "
            "ODOMETRY_XYT.csv, GROUNDTRUTH.csv), a bag of ROS 2 (metadata.yaml) "
            f"or numbered files with a Hokuyo scan in each\n{WHAT_TO_DO}",
        )
    lines = Lines(path, "skip", separator="\n")
    sample = [line[0] for line in islice(lines, LOOKED_AT_LINES)]
    split = {separator: [line.split(separator) for line in sample] for separator in (None, ",")}
    votes = [sum(map(form.claims, filter(None, split[form.separator]))) for form in TEXT_FORMATS]
    if any(votes):
        return TEXT_FORMATS[votes.index(max(votes))]
    if lines.first:
        raise UnknownFormat(path, lines.first.reason, lines.first.line)
    found = "is empty, expected a log"
    if lines.number:
        first = f"it starts with {sample[0][:40]!r}" if sample else "it has comments only"
        found = f"is of no known format: {first}"
    raise UnknownFormat(path, f"{found}\n{WHAT_TO_DO}")
