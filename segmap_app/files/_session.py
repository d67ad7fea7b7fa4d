"""A log with all that was chosen and found on it: as a file."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import astuple, dataclass, field, replace
from pathlib import Path
from typing import Any, ClassVar

from segmap import arrays
from segmap.exports import log_arrays
from segmap.files import escape, read_npz, write_npz
from segmap.readers.lines import LogError
from segmap.readers.packed import log_file
from segmap.readers.tables import log_from_arrays
from segmap.scans import Log, Skipped
from segmap.scans.causes import Cause, Finding


@dataclass(frozen=True, eq=False)
class Session:
    """A log, and what a person made of it; all but the log is kept as JSON holds it.

    Parameters
    ----------
    log : Log
        As it was read, before any beam was carried.
    settings : mapping
        Options of `segmap map` by their names: `{"method": "fusion", "extract_gap": 0.3}`, in the
        units of the command, degrees for angles.
    runs : sequence of mappings
        The figures of what was run.
    edits : mapping
        What was done to the map by hand, by the options of the command too: `crop`, `square`, ...

    Examples
    --------
    >>> from segmap import load
    >>> Session(load("room"), {"method": "fusion"}, edits={"crop": (0, 0, 4, 3)}).edits
    {'crop': [0, 0, 4, 3]}
    """

    FORMAT: ClassVar[str] = "segmap session 1"

    log: Log
    settings: Mapping[str, Any]
    runs: Sequence[Mapping[str, Any]] = ()
    edits: Mapping[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        arrays.instance(self.log, "log", Log)
        for name in ("settings", "runs", "edits"):
            try:  # what JSON does not hold is refused; NaN becomes null
                text = json.dumps(getattr(self, name), ensure_ascii=False)
                text.encode("utf-8")  # half of a letter, which no browser can be sent
                content = json.loads(text, parse_constant=lambda word: None)
            except (TypeError, ValueError, RecursionError) as fault:
                raise ValueError(f"{name} must be what JSON holds: {fault}") from fault
            rows = content if name == "runs" else [content]
            if not isinstance(rows, list) or not all(isinstance(row, dict) for row in rows):
                raise ValueError(f"{name} must have a name for each value, got {text[:80]}")
            object.__setattr__(self, name, content)


def write_session(path: str | Path, session: Session) -> None:
    """Write a log with all that was chosen and found on it, as `read_session` reads it.

    The file is a zip: `session.json` holds settings, runs and edits, and beside it lie the arrays
    of the log, as `write_arrays` names them; `beams` counts those of each scan, where scans with
    fewer are filled up. The name must end in `.segmap`.

    Examples
    --------
    >>> import tempfile
    >>> from segmap import load
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     write_session(f"{folder}/it.segmap", Session(load("room"), {"method": "fusion"}))
    ...     read_session(f"{folder}/it.segmap").settings
    {'method': 'fusion'}
    """
    place = arrays.file(path)
    if place.suffix.lower() != ".segmap":
        raise ValueError(f"path: the name must end in .segmap, got {place.name!r}")
    log = arrays.instance(session, "session", Session).log
    content = {name: getattr(session, name) for name in ("settings", "runs", "edits")}
    causes = [astuple(cause) for cause in log.causes]
    content |= {"name": log.name, "skipped": log.skipped, "causes": causes}
    write_npz(place, Session.FORMAT, {**log_arrays(log), "session.json": json.dumps(content)})


def read_session(path: str | Path) -> Session:
    """Read a session that `write_session` wrote.

    Raises
    ------
    LogError
        A file that is damaged, no session, or of a newer version of segmap.
    """
    with log_file(path) as place:
        try:
            by_name = read_npz(place, Session.FORMAT)
            parts = json.loads(str(by_name.pop("session.json")))
            log = log_from_arrays(str(parts.pop("name")), by_name)
            skipped = Skipped(*parts.pop("skipped"))
            doubt = parts.pop("doubt", "")  # earlier versions held words alone
            causes = [Finding(Cause.OTHER, 1, str(doubt))] if doubt else []
            causes += [Finding(Cause(cause), *rest) for cause, *rest in parts.pop("causes", [])]
            names = parts.get("edits", {}).pop("rooms", [])  # earlier versions held no other edits
            if names:
                parts["edits"]["edit"] = [f"Name {x} {y} {name}" for x, y, name in names]
            return Session(replace(log, skipped=skipped, causes=tuple(causes)), **parts)
        except (TypeError, LookupError, AttributeError, RecursionError) as fault:
            raise LogError(place, f"its session.json is damaged ({fault})") from fault
        except ValueError as fault:
            raise LogError(place, str(fault).removeprefix(f"{escape(place)}: ")) from fault
