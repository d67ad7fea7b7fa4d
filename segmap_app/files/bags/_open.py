"""Bags of ROS 1 and ROS 2, opened by the package `rosbags`: messages in the order of the file.

`rosbags` gives messages by the recorder's clock; where that was set back while it recorded, scans
and odometry of two times would be mixed. It raises errors of many kinds over damaged files: each
ends as a LogError.
"""

from __future__ import annotations

import importlib
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from functools import cache
from pathlib import Path
from typing import Any

from segmap.display import pip_install
from segmap.readers.lines import LogError

from ._files import kind_of

#: Messages with transforms between frames: today's, and how ROS 1 called them first.
FRAMES = "tf2_msgs/msg/TFMessage", "tf/msg/tfMessage"
#: All messages of a database, in the order in which they were written.
MESSAGES_QUERY = "SELECT topic_id, timestamp, data FROM messages ORDER BY id"
REMEDIES = (
    "`rosbag reindex` (ROS 1) or `ros2 bag reindex` (ROS 2) mends a copy of it, "
    "`mcap recover` or `sqlite3 FILE .recover` a file of ROS 2 that was cut off"
)


class Bag:
    """An open bag, with a reader of `rosbags` for each of its files."""

    def __init__(self, parts: Sequence[Path], readers: Sequence[Any]) -> None:
        self.path, self._parts = parts[0], [*zip(parts, readers, strict=True)]
        every = [c for reader in readers for c in reader.connections]
        self.connections = [c for c in every if isinstance(c.topic, str)]  # a database holds all
        is_2 = kind_of(self.path) != "ROS 1"
        types = _types(is_2)
        self._decode = types.deserialize_cdr if is_2 else types.deserialize_ros1
        self._digest = types.hash_rihs01 if is_2 else lambda kind: types.generate_msgdef(kind)[1]

    def topics(self, *kinds: str) -> dict[str, int]:
        """Names of the topics with messages of these types, and how many each has."""
        counts: dict[str, int] = {}
        for each in self.connections:
            if each.msgtype in kinds:
                counts[each.topic] = counts.get(each.topic, 0) + each.msgcount
        return counts

    def messages(self, kinds: Mapping[str, str]) -> Iterator[tuple[str, int, bytes]]:
        """Topic, time in nanoseconds and bytes of each message of topics of these kinds."""
        for path, reader in self._parts:
            chosen = [c for c in reader.connections if kinds.get(c.topic) == c.msgtype]
            for each in chosen:
                if each.digest not in ("", "*", None, self._digest(each.msgtype)):
                    reason = f"{each.topic} is of another {each.msgtype} than that of ROS"
                    raise LogError(path, reason)
            count = 0
            with damage(path):
                for topic, time_ns, data in _in_order_of_file(reader, chosen):
                    count += 1
                    yield topic, time_ns, bytes(data)
                if count < (most := sum(each.msgcount for each in chosen)):
                    raise ValueError(f"{count} of {most} messages are there")

    def decode(self, data: bytes, kind: str) -> Any:
        """A message out of its bytes; damaged ones are a ValueError."""
        try:
            return self._decode(data, kind)
        except Exception as fault:
            raise ValueError(f"expected a message of {kind} ({_fault_text(fault)})") from fault


def _in_order_of_file(reader: Any, chosen: Sequence[Any]) -> Iterator[tuple[str, int, Any]]:
    """Topic, time and bytes of the messages of some connections, as they were written."""
    topics = {each.id: each.topic for each in chosen}
    if not topics:
        return
    if hasattr(reader, "indexes"):  # ROS 1: what the index of one topic lists comes as it stands
        indexes, entries = reader.indexes, [e for id in topics for e in reader.indexes[id]]
        entries.sort(key=lambda entry: (entry.chunk_pos, entry.offset))
        reader.indexes = {chosen[0].id: entries}
        for each, time_ns, data in reader.messages(chosen[:1]):
            yield each.topic, time_ns, data
        reader.indexes = indexes
    elif hasattr(reader.storage, "messages_scan"):  # an .mcap
        for each, time_ns, data in reader.storage.messages_scan(chosen):
            yield each.topic, time_ns, data
    else:
        for id, time_ns, data in reader.storage.dbconn.execute(MESSAGES_QUERY):
            if id in topics:
                yield topics[id], time_ns, data


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
        transforms = "geometry_msgs/TransformStamped[] transforms"
        types.register(system.get_types_from_msg(transforms, kind))
    return types


@contextmanager
def open_bag(parts: Sequence[Path]) -> Iterator[Bag]:
    """A bag, closed in the end; one that is damaged is a LogError."""
    readers = []
    with ExitStack() as stack:
        for part in parts:
            with damage(part):
                package = "rosbags.rosbag1" if kind_of(part) == "ROS 1" else "rosbags.rosbag2"
                readers.append(stack.enter_context(importlib.import_module(package).Reader(part)))
        yield Bag(parts, readers)


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
        reason = f"is cut off, was never closed, or is damaged ({_fault_text(fault)}): {REMEDIES}"
        raise LogError(path, reason) from fault


def _fault_text(fault: Exception) -> str:
    return str(fault)[:300] or type(fault).__name__
