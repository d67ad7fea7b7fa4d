"""Readers of the package `rosbags` that give messages in the order of the file, as far as it goes.

A clock may have been set back, so times do not order them. The index of a bag of ROS 1 is not used:
it is missing where the recorder lost power, and wrong where another program wrote it. This module
is imported where a bag is opened, since `rosbags` may not be there.
"""

from __future__ import annotations

import importlib
from collections.abc import Iterator
from io import BytesIO
from pathlib import Path
from typing import IO, Any, NamedTuple

from .._lines import LogError, Reading
from ._bounds import Budget

#: First line of a bag of ROS 1.
ROS_1_LINE = b"#ROSBAG V2.0\n"
#: All messages of a database, in the order in which they were written.
MESSAGES = "SELECT topic_id, timestamp, data FROM messages ORDER BY id"
#: What `rosbags` reads of a bag of ROS 1, and its readers of ROS 2: it comes without types.
ros1: Any = importlib.import_module("rosbags.rosbag1.reader")
DirectoryReader: Any = importlib.import_module("rosbags.rosbag2.reader").DirectoryReader
McapReader: Any = importlib.import_module("rosbags.rosbag2.storage_mcap").McapReader
Sqlite3Reader: Any = importlib.import_module("rosbags.rosbag2.storage_sqlite3").Sqlite3Reader
Kind: Any = ros1.RecordType


class Record(NamedTuple):
    """A record of a bag of ROS 1: where it, and what follows its header, begin, and its end."""

    kind: Any
    header: Any
    start: int
    data: int
    end: int


class Chunk(NamedTuple):
    """Where messages lie in a file, how they are packed, and whether the file ends in them."""

    start: int
    end: int
    packing: str
    is_cut: bool = False


class Ros1(ros1.Reader):  # type: ignore[misc]
    """A bag of ROS 1, chunk after chunk; of one that is broken what is whole, if `reading` may."""

    def __init__(self, path: Path, reading: Reading, budget: Budget) -> None:
        super().__init__(path)
        self.reading, self.budget = reading, budget
        self.topics_by_id: dict[int, Any] = {}
        self.counts: dict[int, int] = {}

    def open(self) -> None:
        """Find the chunks, and what topics they hold."""
        self.bio = file = self.path.open("rb")
        if (line := file.readline(20)) != ROS_1_LINE:
            raise LogError(self.path, f"is a bag of an older version, {line!r}: `rosbag fix` helps")
        size, closed, self.chunks = self.path.stat().st_size, False, []
        for record in _records(file, size):
            closed &= record.end <= size
            if record.kind == Kind.BAGHEADER:
                closed = record.header.get_uint64("index_pos") > 0
                if record.header.get("encryptor"):
                    raise LogError(self.path, "is encrypted")
            elif record.kind == Kind.CHUNK:
                packing, is_cut = record.header.get_string("compression"), record.end > size
                self.chunks.append(Chunk(record.data, min(record.end, size), packing, is_cut))
            elif record.kind == Kind.MSGDATA:  # of a chunk that was never ended
                self.chunks.append(Chunk(record.start, size, "none", is_cut=True))
                closed = False
                break
            elif record.kind == Kind.IDXDATA:
                self._count(record.header, record.header.get_uint32("count"))
            elif record.kind == Kind.CONNECTION and record.end <= size:
                self._know(file, record)
        if not closed or (self.chunks and not self.topics_by_id):
            self._without_index()
        self.connections = [
            each._replace(msgcount=self.counts.get(key, 0))
            for key, each in self.topics_by_id.items()
        ]

    def _count(self, header: Any, count: int) -> None:
        key = header.get_uint32("conn")
        self.counts[key] = self.counts.get(key, 0) + count

    def _know(self, source: IO[bytes], record: Record) -> None:
        """Note a topic, which `rosbags` reads from where it stands."""
        file, self.bio = self.bio, source
        try:
            source.seek(record.start)
            found = self.read_connection()
            self.topics_by_id.setdefault(found.id, found)
        finally:
            self.bio = file

    def _without_index(self) -> None:
        """Topics and counts from the chunks themselves."""
        self.counts.clear()
        for chunk in self.chunks:
            for data, record in self._inside(chunk):
                if record.kind == Kind.CONNECTION:
                    self._know(data, record)
                elif record.kind == Kind.MSGDATA:
                    self._count(record.header, 1)
        whole = f"{sum(self.counts.values())} messages are whole"
        why = f"is cut off, or was never closed: {whole}; `rosbag reindex` mends a copy of it"
        self.reading.damaged(LogError(self.path, f"{why}, --skip reads what is whole"))

    def _inside(self, chunk: Chunk) -> Iterator[tuple[IO[bytes], Record]]:
        """The records of a chunk, and what they are read from."""
        self.bio.seek(chunk.start)
        data = self.bio.read(chunk.end - chunk.start)
        if chunk.packing != "none":
            if chunk.is_cut:
                return
            if chunk.packing not in ("bz2", "lz4"):
                raise LogError(self.path, f"is packed by {chunk.packing[:20]!r}, not by bz2 or lz4")
            data = self.budget.unpack(chunk.packing, data)
        source, end = BytesIO(data), 0
        for record in _records(source, len(data)):
            if record.end > len(data):
                break
            yield source, record
            end = record.end
        if end < len(data) and not chunk.is_cut:
            raise LogError(self.path, f"is damaged: in the chunk at byte {chunk.start}")

    def messages(self, connections: Any, *when: None) -> Iterator[tuple[Any, int, bytes]]:
        """Messages of these topics; a damaged chunk is told or counted, and ends where it is so."""
        chosen = {each.id: each for each in connections}
        for chunk in self.chunks:
            try:
                for source, record in self._inside(chunk):
                    if record.kind != Kind.MSGDATA:
                        continue
                    if each := chosen.get(record.header.get_uint32("conn")):
                        source.seek(record.data)
                        data = source.read(record.end - record.data)
                        yield each, record.header.get_time("time"), data
            except (GeneratorExit, MemoryError):
                raise
            except Exception as fault:  # bz2 and lz4 raise what they like
                reason = getattr(fault, "reason", f"is damaged: a chunk ({fault})")
                self.reading.damaged(LogError(self.path, reason))


def _records(source: IO[bytes], size: int) -> Iterator[Record]:
    """Headers of records from where a file stands; the last one may end behind the file."""
    while (start := source.tell()) < size:
        try:
            header = ros1.Header.read(source)
            kind, length = Kind(header.get_uint8("op")), ros1.read_uint32(source)
        except (ros1.ReaderError, ValueError):
            return
        record = Record(kind, header, start, source.tell(), source.tell() + length)
        yield record
        source.seek(record.end)


class Database(Sqlite3Reader):  # type: ignore[misc]
    """A .db3 of ROS 2."""

    def messages(self, connections: Any, *when: None) -> Iterator[tuple[Any, int, bytes]]:
        """Messages of these topics."""
        found = {each.id: each for each in connections}
        for topic, time, data in self.dbconn.execute(MESSAGES):
            if topic in found:
                yield found[topic], time, data


class Mcap(McapReader):  # type: ignore[misc]
    """An .mcap of ROS 2; one whose end is missing has so many bytes that are `whole`."""

    whole = 0
    connections: list[Any]

    def open(self) -> None:
        """Find the topics."""
        if not self.whole:
            super().open()
            return
        self.bio = file = self.path.open("rb")
        file.seek(9)  # behind the first bytes and the kind of the header, which says its length
        file.seek(int.from_bytes(file.read(8), "little"), 1)
        self.data_start, self.data_end = file.tell(), self.whole
        self.meta_scan()
        counts = self.statistics.channel_message_counts
        for place, each in enumerate(self.connections):
            self.connections[place] = each._replace(msgcount=counts.get(each.id, 0))

    def messages(self, connections: Any, *when: None) -> Iterator[tuple[Any, int, bytes]]:
        """Messages of these topics."""
        yield from self.messages_scan(connections)


class Folder(DirectoryReader):  # type: ignore[misc]
    """A folder of ROS 2."""

    STORAGE_PLUGINS = {"mcap": Mcap, "sqlite3": Database}  # noqa: RUF012


#: By kind of file.
READERS_2 = {"folder": Folder, ".db3": Database, ".mcap": Mcap}
