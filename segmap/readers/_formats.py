"""Which format a file has: each looks at its first lines and claims those that it knows."""

from collections.abc import Callable, Sequence
from itertools import islice
from pathlib import Path
from typing import NamedTuple

from ..scans import Log
from . import _carmen, _coreslam, _g2o, _hokuyo_text, _player, _rawseeds
from ._lines import Lines, LogError

#: So many lines are looked at; a damaged one among them does not change what most of them say.
FIRST = 200


class Format(NamedTuple):
    """A reader, and how to tell its lines from others."""

    name: str
    claims: Callable[[Sequence[str]], bool]
    read: Callable[[Path, str, str], Log]
    separator: str | None = None


FORMATS = (
    Format("CARMEN", _carmen.claims, _carmen.read),
    Format("g2o", _g2o.claims, _g2o.read),
    Format("Player", _player.claims, _player.read),
    Format("Hokuyo text", _hokuyo_text.claims, _hokuyo_text.read),
    Format("CoreSLAM", _coreslam.claims, _coreslam.read),
    Format("Rawseeds", _rawseeds.claims, _rawseeds.read, ","),
)


def recognise(path: Path) -> Format:
    """The format that claims most of the first lines."""
    lines = Lines(path, "skip", separator="\n")
    sample = [line[0] for line in islice(lines, FIRST)]
    votes = [sum(_claimed(form, line) for line in sample) for form in FORMATS]
    if not any(votes):
        raise lines.first or LogError(path, _unknown(lines, sample))
    return FORMATS[votes.index(max(votes))]


def read_file(path: Path, name: str, on_error: str) -> Log:
    """Read one file of any format."""
    return recognise(path).read(path, name, on_error)


def read_folder(folder: Path, name: str, on_error: str) -> Log:
    """Read a folder: a Rawseeds recording, or numbered files with a Hokuyo scan in each."""
    if files := _rawseeds.files_of(folder):
        return _rawseeds.read_folder(files, name, on_error)
    if scans := _hokuyo_text.numbered(folder):
        return _hokuyo_text.read_folder(scans, name, on_error)
    raise LogError(
        folder,
        "holds no log, expected a Rawseeds recording (SICK_FRONT.csv or HOKUYO_FRONT.csv, "
        "ODOMETRY_XYT.csv, GROUNDTRUTH.csv) or numbered files with a Hokuyo scan in each",
    )


def _claimed(form: Format, line: str) -> bool:
    fields = line.split(form.separator)
    return bool(fields) and form.claims(fields)


def _unknown(lines: Lines, sample: Sequence[str]) -> str:
    known = ", ".join(form.name for form in FORMATS)
    if lines.number == 0:
        return f"is empty, expected a log ({known})"
    first = f"it starts with {sample[0][:40]!r}" if sample else "it has comments only"
    return f"is of no known format ({known}); {first}"
