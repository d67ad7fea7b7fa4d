"""Objects in MRPT's binary files, plain or gzip: how one begins and ends, within what is there.

    0x80 + length of the name, the name, version (1 byte), members, 0x88     since MRPT 0.5.5
    length of the name (4 bytes), the name, version (4 bytes), members       before

All numbers are little endian; a name may begin with its namespace (`mrpt::obs::`). Nothing says how
long an object is: one that is not known is skipped only where the next one can be told.
"""

from __future__ import annotations

import re
import struct
from collections.abc import Callable, Mapping, Sequence
from io import BufferedReader
from itertools import chain
from pathlib import Path
from typing import Any, NamedTuple, cast

import numpy as np

from ...arrays import Array
from ...files import LEAST_UNPACKED_BYTES, MOST_UNPACKED_RATIO
from .._lines import BROKEN, LogError, open_bytes

END = 0x88
#: Longer names are damage, as MRPT itself has it.
LONGEST_NAME = 120
#: A name, and how two classes were called before.
CLASS_NAME = re.compile(rb"(?:mrpt::\w+::)?(C[A-Z0-9]\w+)")
RENAMED = {"CSensorialFrame": "CSensoryFrame", "CSensFrameProbSequence": "CSimpleMap"}
#: What may be skipped, and what may follow: parts of these have other names.
SKIPPED = re.compile("CObservation|CAction")
NEXT = re.compile(rb"(?<=\x88)[\x80-\xf8](?:mrpt::\w+::)?C(?:Observation|Sensory|Action)\w+")
NEXT_IN_MAP = re.compile(rb"(?<=\x88)[\x80-\xf8](?:mrpt::\w+::)?CPose\w*PDF\w+")

#: Reads the members of an object of a class: it gets the stream and the version.
Parser = Callable[["Stream", int], Any]
#: Of each class that is known, with its versions; None for all.
Parsers = Mapping[str, tuple[Parser, Sequence[int] | None]]


class Broken(ValueError):
    """The bytes do not continue as an object has to: all that follows is lost."""


class Unknown(NamedTuple):
    """An object that was skipped: its class and version, and the byte that it begins with."""

    what: str
    start: int


class Stream:
    """Bytes of a file, read from the front, with a parser and the versions of each known class."""

    def __init__(self, data: bytes, parsers: Parsers) -> None:
        self.data, self.parsers, self.at, self.next = data, parsers, 0, NEXT
        self.open = 0  # objects that have begun and not ended

    def broken(self, reason: str, at: int | None = None) -> Broken:
        """An error about a place in the file, the present one where none is given."""
        return Broken(f"byte {self.at if at is None else at}: {reason}")

    @property
    def left(self) -> int:
        """How many bytes are left."""
        return len(self.data) - self.at

    def values(self, form: str) -> tuple[Any, ...]:
        """The next members; `form` as in `struct`."""
        return struct.unpack("<" + form, self.take(struct.calcsize("<" + form)))

    def array(self, kind: str, count: int) -> Array:
        """The next `count` numbers of one kind, `(count,)` array."""
        size = count * np.dtype(kind).itemsize
        found = np.frombuffer(self.take(size), np.dtype(kind).newbyteorder("<"))
        with np.errstate(invalid="ignore"):  # a NaN of another kind
            return found.astype(float)

    def take(self, size: int) -> bytes:
        """The next bytes."""
        if size > self.left:
            raise self.broken(f"expected {size} bytes more, but only {self.left} follow")
        self.at += size
        return self.data[self.at - size : self.at]

    def text(self) -> str:
        """A length and so many characters."""
        return self.take(self.values("I")[0]).decode("utf-8", "replace")

    def many(self, *names: str) -> list[Any]:
        """A count and so many objects."""
        (count,) = self.values("I")
        return [self.object(*names, closing=int(k == count - 1)) for k in range(count)]

    def object(self, *names: str, closing: int = 0) -> Any:
        """The next object, of a class whose name begins with one of those, as its parser gives it.

        Where it may be skipped, `closing` groups end behind it.
        """
        start = self.at
        name, version, is_old = self.header()
        if not name.startswith(names):
            wanted = " or ".join(names)
            raise self.broken(f"expected {wanted}, got {name} version {version}", start)
        if name not in self.parsers:
            return self._skip(f"{name} version {version}", start, closing, is_old)
        parse, known = self.parsers[name]
        if known is not None and version not in known:
            raise self.broken(f"{name} version {version} is not known here, expected {[*known]}")
        self.open += 1
        found = parse(self, version)
        self.open -= 1
        if not is_old and self.values("B")[0] != END:
            raise self.broken(f"{name} version {version} does not end where it should", start)
        return found

    def header(self) -> tuple[str, int, bool]:
        """Class and version of the next object, and whether it is of the old kind."""
        start, (size,) = self.at, self.values("B")
        is_old = size < 0x80
        length = size & 0x7F
        marked = not is_old or self.take(3) == b"\0\0\0"
        name = (
            CLASS_NAME.fullmatch(self.take(length)) if marked and length <= LONGEST_NAME else None
        )
        if name is None:
            raise self.broken("expected an object of MRPT", start)
        (version,) = self.values("i" if is_old else "B")
        found = name[1].decode("ascii", "replace")
        return RENAMED.get(found, found), version, is_old

    def _skip(self, what: str, start: int, closing: int, is_old: bool) -> Unknown:
        """Go on where the next object, or the file's end, follows so many marks of an end."""
        if is_old or not SKIPPED.match(what):
            raise self.broken(f"{what} is not known here, nor how long it is", start)
        headers = self.next.finditer(self.data, self.at)  # whose first byte tells their length
        places = ((h.start(), closing) for h in headers if h[0][0] - 0x80 == len(h[0]) - 1)
        for place, more in chain(places, [(len(self.data), self.open)]):
            if self.data.endswith(bytes([END]) * (more + 1), self.at, place):
                self.at = place - more
                return Unknown(what, start)
        raise self.broken(f"{what} is not known here, and its end was not found", start)


def unpacked_stream(path: Path) -> tuple[bytes, str]:
    """All bytes of a file, and what is wrong where it is packed and ends too early."""
    most = max(LEAST_UNPACKED_BYTES, MOST_UNPACKED_RATIO * path.stat().st_size)
    parts: list[bytes] = []  # never more than `most`: a file may be made to fill the memory
    try:
        with open_bytes(path) as file:
            while part := cast(BufferedReader, file).read1(1 << 20):  # all there is to the break
                parts.append(part)
                if sum(map(len, parts)) > most:
                    raise LogError(path, f"unpacks to more than {most} bytes: unpack it yourself")
    except BROKEN as fault:
        return b"".join(parts), f"the packed file is broken or cut short ({fault})"
    return b"".join(parts), ""
