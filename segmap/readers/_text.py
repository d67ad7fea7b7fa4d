"""What all formats of text share: a file is walked by lines, and its format says what each means.

A format is one class: its name, the words that its lines begin with, what a line says (`_take`),
and what all of them together say of odometry (`_finished`) and of the laser's place (`_extrinsic`).
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from pathlib import Path
from typing import Any, ClassVar, NamedTuple, Self

import numpy as np

from ..scans import NOTHING_SKIPPED, Log
from ..scans.causes import Finding
from ._lines import Lines, merged_skipped
from ._raw_scans import Extrinsic, RawScan, Track, assemble, uncorrected, with_odometry


class Binary(NamedTuple):
    """A format that is told by the first bytes of a file, its header, or what a folder holds."""

    name: str
    claims: Callable[[Path], object]  #: something where the file or folder is of this format
    read: Callable[[Path, str, str], Log]


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
        return cls(Lines(path, on_error, cls.separator)).walked()._log(name)

    def walked(self) -> Self:
        """All lines of the file taken in; a ValueError marks a line as damaged."""
        for _ in self.lines.each(self._take):
            pass
        if not self.scans:
            raise self.lines.no_scan(self.expected)
        return self

    def _take(self, fields: list[str]) -> None:
        raise NotImplementedError

    def _finished(self) -> Sequence[RawScan]:
        """The scans with their odometry."""
        found, self.causes = with_odometry(self.scans, self.track)
        return found

    def _extrinsic(self, laser: str, scans: Sequence[RawScan]) -> Extrinsic:
        """Where a laser sits on the robot, and the robot's corrected poses."""
        return uncorrected(scans, np.zeros(3))

    def _log(self, name: str) -> Log:
        scans, truth, assumed = assemble(self._finished(), self._extrinsic)
        left = merged_skipped(self.lines.skipped, self.unknown)
        return Log(name, scans, truth, left, causes=self.causes, assumed=assumed)
