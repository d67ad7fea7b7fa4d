"""What all formats of text share: a file is walked by lines, and its format says what each means.

A format is one class: its name, the words that its lines begin with, what a line says (`_take`),
and what all of them together say of odometry (`_finish`) and of the laser's place (`_extrinsic`).
Where fields stand in a fixed order a line is `Declared`: "odometry*3 n ranges*n time" are three
fields, then a number and so many ranges, then one of the time.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from pathlib import Path
from typing import Any, ClassVar, NamedTuple, Self

import numpy as np

from ..arrays import Array
from ..scans import NOTHING_SKIPPED, Log
from ..scans.causes import Finding
from .lines import Lines, counted_fields, float_fields, merged_skipped, pose_fields, time
from .raw_scans import (
    NOWHERE,
    Extrinsic,
    RawScan,
    Track,
    assemble,
    half_turn,
    view_of,
    with_odometry,
)


class Parts(NamedTuple):
    """How the files of one log are found and read."""

    together: Callable[[Sequence[str]], list[list[str]]]  #: files in groups, one for each log
    read: Callable[..., Log]  #: of paths, and `on_error`


class Binary(NamedTuple):
    """A format that is told by the first bytes of a file, its header, or what a folder holds."""

    name: str
    claims: Callable[[Path], object]  #: something where the file or folder is of this format
    read: Callable[[Path, str, str], Log]
    parts: Parts | None = None  #: where a log may lie in several files


class TextFormat:
    """A format of lines, and what the lines of one log said so far."""

    name: ClassVar[str]
    #: What is missing in a file without a scan.
    expected: ClassVar[str]
    #: The first words of its lines.
    keywords: ClassVar[Collection[str]] = ()
    separator: ClassVar[str | None] = None
    #: Whether its lines have no words of their own: numbers alone tell it.
    by_shape: ClassVar[bool] = False

    def __init__(self, lines: Lines) -> None:
        self.lines, self.scans, self.track = lines, list[Any](), Track()
        #: Lines that are left out though they are whole.
        self.unknown = NOTHING_SKIPPED
        self.causes: Sequence[Finding] = ()

    @classmethod
    def claims(cls, fields: Sequence[str]) -> bool:
        """Whether a line is one of this format."""
        return fields[0] in cls.keywords

    @classmethod
    def read(cls, path: Path, name: str, on_error: str = "raise") -> Log:
        """Read a log of this format."""
        return cls(Lines(path, on_error, cls.separator)).walk()._log(name)

    def walk(self) -> Self:
        """All lines of the file taken in; a ValueError marks a line as damaged."""
        for _ in self.lines.each(self._take):
            pass
        if not self.scans:
            raise self.lines.no_scan(self.expected)
        return self

    def _take(self, fields: list[str]) -> None:
        raise NotImplementedError

    def _finish(self) -> Sequence[RawScan]:
        """The scans with their odometry."""
        scans, self.causes = with_odometry(self.scans, self.track)
        return scans

    def _extrinsic(self, laser: str, scans: Sequence[RawScan]) -> Extrinsic:
        """Where a laser sits on the robot, and the robot's corrected poses."""
        return Extrinsic(np.zeros(3))

    def _log(self, name: str) -> Log:
        scans, truth, assumed = assemble(self._finish(), self._extrinsic)
        skipped = merged_skipped(self.lines.skipped, self.unknown)
        return Log(name, scans, truth, skipped, causes=self.causes, assumed=assumed)


class Declared(TextFormat):
    """A format of lines with fields in a fixed order, of which those with `ranges` are scans."""

    #: First word of a line -> its other fields.
    forms: ClassVar[Mapping[str, str]]
    #: Lengths of the file in a metre.
    per_metre: ClassVar[float] = 1

    def _take(self, fields: list[str]) -> None:
        word, *rest = fields
        if word not in self.keywords:
            wanted = " or ".join(self.forms)
            raise ValueError(f"expected a line of {self.name}, such as {wanted}, got {word[:40]!r}")
        if word in self.forms:
            self._take_fields(word, fields_by_name(self.forms[word], rest))
        else:
            self._other(fields)

    def _other(self, fields: list[str]) -> None:
        """What a line says that is no declared one."""

    def _take_fields(self, word: str, by_name: Mapping[str, Sequence[str]]) -> None:
        """What a declared line says."""
        ranges = float_fields(by_name["ranges"], "ranges") / self.per_metre
        unit = np.array([1 / self.per_metre, 1 / self.per_metre, 1])
        odometry, pose = (
            pose_fields(by_name[name], f"the {name}") * unit if name in by_name else NOWHERE
            for name in ("odometry", "laser")
        )
        angles = self._directions(len(ranges))
        when = time(by_name["time"][0]) if "time" in by_name else None
        view = (view_of(angles),)
        self.scans.append(RawScan(word, ranges, angles, when, odometry, pose, assumed=view))

    def _directions(self, count: int) -> Array:
        """Where so many beams point, radians."""
        return half_turn(count)


def fields_by_name(form: str, fields: Sequence[str]) -> dict[str, Sequence[str]]:
    """The fields of a line by the names that a declaration has for them, `-` for others.

    Examples
    --------
    >>> fields_by_name("n ranges*n time", ["2", "1.5", "2.5", "7"])
    {'n': ['2'], 'ranges': ['1.5', '2.5'], 'time': ['7']}
    """
    by_name: dict[str, Sequence[str]] = {}
    rest, wanted = fields, {"fields": 0, "ranges": 0}
    for word in form.split():
        name, _, count = word.partition("*")
        if count in by_name:
            by_name[name], rest = counted_fields([*by_name[count], *rest], name)
        else:
            by_name[name], rest = rest[: int(count or 1)], rest[int(count or 1) :]
        wanted["ranges" if name == "ranges" else "fields"] += (
            len(by_name[name]) if count in by_name else int(count or 1)
        )
    if rest or sum(wanted.values()) != len(fields):
        counts = " and ".join(f"{count} {name}" for name, count in wanted.items() if count)
        raise ValueError(f"expected {counts}, got {len(fields)} in all: fields are {form}")
    return by_name
