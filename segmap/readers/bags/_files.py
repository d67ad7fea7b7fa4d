"""Bags of ROS 1 and ROS 2, opened by the package `rosbags` within bounds.

    #ROSBAG V2.0        a file of ROS 1
    SQLite format 3     a file of ROS 2: .db3
    0x89 MCAP0          a file of ROS 2: .mcap
    metadata.yaml       a folder of ROS 2, with files of the last two kinds

`rosbags` raises errors of many kinds over damaged files; each ends as a LogError. It believes what
a file says of its own sizes: what could fill the memory, or take for ever, is looked for before.
"""

from __future__ import annotations

import importlib
import re
import tempfile
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager, suppress
from functools import cache
from pathlib import Path
from typing import Any, TypeVar

from ..._display import pip_install
from .._lines import BROKEN, Apart, LogError, Reading, open_bytes
from ._bounds import Budget, check_metadata, look_through, recovered

#: What the first bytes of a file say.
MAGIC = {b"#ROSBAG V": "ROS 1", b"SQLite format 3\0": ".db3", b"\x89MCAP0\r\n": ".mcap"}
METADATA_FILE = "metadata.yaml"
#: The longest of the first bytes that tell a bag's format.
LONGEST_MAGIC_BYTES = max(map(len, MAGIC))
P = TypeVar("P", str, Path)
SUFFIXES = (".db3", ".mcap", ".bag")
#: The name of a part of a bag: of ROS 1 perhaps with a time before its number.
PART = re.compile(r"(.*?)(?:_\d{4}(?:-\d\d){5})?_([0-9]{1,6})")
#: A part begins at most so long after the one before ends, ...
MOST_BETWEEN_PARTS_NS = 60 * 10**9
#: ... and no earlier than so long before that: topics are not written quite in their order.
MOST_OVERLAP_OF_PARTS_NS = 10**9
#: Messages with transforms between frames: today's, and how ROS 1 called them first.
FRAMES = "tf2_msgs/msg/TFMessage", "tf/msg/tfMessage"


def recordings(files: Iterable[P]) -> list[list[P]]:
    """Files in their order, those of a bag that are its parts together: `it_0.db3`, `it_1.db3`.

    A recorder that splits what it writes gives them one name, and numbers that go on from 0. Where
    nothing has the number 0, somebody has numbered drives.
    """
    found: dict[Any, list[tuple[int, P]]] = {}
    for k, file in enumerate(files):
        key, number = _part_of(Path(file)) or (k, 0)
        found.setdefault(key, []).append((number, file))
    groups = list[list[P]]()
    for key, parts in found.items():
        ordered: list[tuple[int, P]] = sorted(parts, key=lambda each: each[0])
        first: int = ordered[0][0]
        together = [number for number, _ in ordered] == [*range(first, first + len(ordered))]
        if len(ordered) > 1 and first > 0:  # not all are named
            together &= (key, 0) in map(_part_of, Path(ordered[0][1]).parent.glob("*"))
        groups += [[each for _, each in ordered]] if together else [[each] for _, each in parts]
    return groups


def _part_of(path: Path) -> tuple[Any, int] | None:
    """What the parts of a bag share in their names, and the number of this one."""
    part = PART.fullmatch(path.stem) if path.suffix in SUFFIXES else None
    return ((path.parent, part[1], path.suffix), int(part[2])) if part else None


def parts_of(path: Path) -> list[Path]:
    """The files of a bag: it, or of a folder without metadata the only one, or its parts.

    Nothing of a folder that holds other bags, or none.
    """
    if not path.is_dir() or (path / METADATA_FILE).is_file():
        return [path]
    found = recordings(f for f in path.iterdir() if f.suffix in SUFFIXES and f.is_file())
    return found[0] if len(found) == 1 else []


def kind_of(path: Path) -> str | None:
    """Which bag a file or a folder is, by its first bytes; None for what is none."""
    path = next(iter(parts_of(path)), path)
    if path.is_dir():
        return "folder" if (path / METADATA_FILE).is_file() else None
    try:
        with open_bytes(path) as file:
            return _kind_by(file.read(LONGEST_MAGIC_BYTES))
    except BROKEN:
        return None


def _kind_on_disk(path: Path) -> str | None:
    """The same of a file as it lies there: what is packed in a folder, `rosbags` unpacks."""
    with path.open("rb") as file:
        return _kind_by(file.read(LONGEST_MAGIC_BYTES))


def _kind_by(head: bytes) -> str | None:
    return next((kind for magic, kind in MAGIC.items() if head.startswith(magic)), None)


class Bag:
    """An open bag, with a reader of `rosbags` for each of its files."""

    def __init__(self, path: Path, readers: Sequence[Any], is_2: bool, budget: Budget) -> None:
        self.path, self.budget, self._readers = path, budget, readers
        self.connections = [each for reader in readers for each in reader.connections]
        for each in self.connections:  # what a metadata.yaml says may be of any kind
            if not (isinstance(each.topic, str) and isinstance(each.msgtype, str)):
                raise LogError(path, f"names a topic {each.topic!r} of type {each.msgtype!r}")
            if not (isinstance(each.msgcount, int) and isinstance(each.digest, str | None)):
                raise LogError(path, f"has a topic {each.topic} of {each.msgcount!r} messages")
        self.types = _types(is_2)
        self._decode = self.types.deserialize_cdr if is_2 else self.types.deserialize_ros1
        self._digest = (
            self.types.hash_rihs01
            if is_2
            else lambda kind: str(self.types.generate_msgdef(kind)[1])
        )

    def topics(self, *kinds: str) -> dict[str, int]:
        """Names of the topics with messages of these types, and how many each has."""
        found: dict[str, int] = {}
        for each in self.connections:
            if each.msgtype in kinds:
                found[each.topic] = found.get(each.topic, 0) + int(each.msgcount)
        return found

    def messages(self, kinds: Mapping[str, str]) -> Iterator[tuple[str, int, bytes]]:
        """Topic, time in nanoseconds and bytes of each message of topics of these kinds.

        They come in the order of the file: a clock may have been set back.
        """
        chosen = [c for c in self.connections if kinds.get(c.topic) == c.msgtype]
        for each in chosen:
            kind = each.msgtype
            if each.digest not in ("", "*", None, self._digest(kind)):
                raise LogError(self.path, f"{each.topic} is of another {kind} than that of ROS")
        last = 0
        for k, reader in enumerate(self._readers):
            if mine := [each for each in reader.connections if each in chosen]:
                with damage(self.path):
                    before = last
                    for connection, time, data in reader.messages(mine):
                        away, before = time - before if before else 0, 0
                        if not -MOST_OVERLAP_OF_PARTS_NS <= away <= MOST_BETWEEN_PARTS_NS:
                            when = f"{abs(away) / 1e9:.0f} s {'after' if away > 0 else 'before'}"
                            reason = f"begins {when} the part before it ends: a log of its own"
                            fault = Apart(reader.path, reason)
                            fault.parts = (
                                [each.path for each in self._readers[:k]],
                                [each.path for each in self._readers[k:]],
                            )
                            raise fault
                        last = max(last, int(time))
                        self.budget.take(len(data))
                        yield connection.topic, int(time), bytes(data)

    def decoded(self, data: bytes, kind: str) -> Any:
        """A message out of its bytes; damaged ones are a ValueError."""
        try:
            return self._decode(data, kind)
        except Exception as fault:
            raise ValueError(f"expected a message of {kind} ({_fault_text(fault)})") from fault


@cache
def _types(is_2: bool) -> Any:
    """The types of messages of a generation of ROS: those that are read never changed in it.

    They are kept, since `rosbags` makes code of them, 0.1 s for each bag. What a bag says of
    its types is not believed: `rosbags` would make code of that too.
    """
    system = importlib.import_module("rosbags.typesys")
    if is_2:
        return system.get_typestore(system.Stores.ROS2_HUMBLE)
    types = system.get_typestore(system.Stores.ROS1_NOETIC)
    for kind in FRAMES:
        types.register(
            system.get_types_from_msg("geometry_msgs/TransformStamped[] transforms", kind)
        )
    return types


@contextmanager
def opened(parts: Sequence[Path], reading: Reading) -> Iterator[Bag]:
    """A bag, closed in the end; one that is damaged, or made to fill the memory, is a LogError.

    `reading` says whether a bag that is cut off may be read as far as it is whole.
    """
    path = parts[0]
    stack, readers = ExitStack(), list[Any]()
    sizes = [file.stat().st_size for place in parts for file in _files_in(place)]
    budget = Budget(path, sum(sizes))
    with stack:
        for part in parts:
            with damage(part):
                readers.append(_reader(part, reading, budget, stack))
                stack.callback(_closed, readers[-1])
                readers[-1].open()
        with damage(path):
            bag = Bag(parts[0], readers, kind_of(path) != "ROS 1", budget)
        yield bag


def _files_in(path: Path) -> list[Path]:
    return list(path.iterdir()) if path.is_dir() else [path]


def _reader(path: Path, reading: Reading, budget: Budget, stack: ExitStack) -> Any:
    """What gives the messages of one file, or of a folder with metadata."""
    rosbags = importlib.import_module(f"{__package__}._rosbags")
    kind, files, broken = str(kind_of(path)), _files_in(path), None
    if kind == "ROS 1":
        return rosbags.Ros1(path, reading, budget)
    if kind == "folder":
        check_metadata(path / METADATA_FILE)
    for file in files:
        of_file = _kind_on_disk(file) if file.is_file() else None
        if found := look_through(file, of_file, budget):
            broken = found
            others = sum(other.suffix == file.suffix for other in files) > 1
            if kind == "folder" and others:
                raise LogError(path, f"of several files {file.name} {found.why}")
            path, kind = file, str(of_file)
    reader = rosbags.READERS_2[kind](path)
    if broken:
        why = f"{broken.why}, --skip reads what is whole"
        reading.damaged(LogError(path, why))
        if kind == ".mcap":
            reader.whole = broken.whole
        else:
            copy = stack.enter_context(tempfile.TemporaryDirectory(prefix="segmap-"))
            reader = rosbags.READERS_2[kind](recovered(path, Path(copy) / path.name))
    return reader


def _closed(reader: Any) -> None:
    with suppress(Exception):
        reader.close()


@contextmanager
def damage(path: Path) -> Iterator[None]:
    """Turn whatever `rosbags` raises into a LogError."""
    try:
        yield
    except (LogError, GeneratorExit):
        raise
    except ImportError as fault:
        reason = f"is a bag of ROS: reading it needs {pip_install('ros')}"
        raise LogError(path, reason) from fault
    except Exception as fault:
        reason = f"is damaged, or no bag that rosbags reads ({_fault_text(fault)})"
        raise LogError(path, reason) from fault


def _fault_text(fault: Exception) -> str:
    return f"{type(fault).__name__}: {str(fault)[:300]}"
