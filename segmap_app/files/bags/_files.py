"""Which files are a bag of ROS: by their first bytes; of its parts, by their names.

    #ROSBAG V2.0        a file of ROS 1
    SQLite format 3     a file of ROS 2: .db3
    0x89 MCAP0          a file of ROS 2: .mcap

A folder of ROS 2 is the files in it; its metadata.yaml repeats what they say.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from pathlib import Path
from typing import Any, TypeVar

#: What the first bytes of a file say.
MAGIC = {
    b"#ROSBAG V": "ROS 1",
    b"SQLite format 3\0": ".db3",
    b"\x89MCAP0\r\n": ".mcap",
}
LONGEST_MAGIC_BYTES = max(map(len, MAGIC))
SUFFIXES = (".db3", ".mcap", ".bag")
#: The name of a part of a bag: of ROS 1 perhaps with a time before its number.
PART = re.compile(r"(.*?)(?:_\d{4}(?:-\d\d){5})?_([0-9]{1,6})")
P = TypeVar("P", str, Path)


def recordings(files: Iterable[P]) -> list[list[P]]:
    """Files, those of a bag that are its parts together, in their order: `it_0.db3`, `it_1.db3`.

    A recorder that splits what it writes gives them one name, and numbers that go on from 0.
    """
    by_name: dict[Any, list[tuple[int, P]]] = {}
    for k, file in enumerate(files):
        name, number = _part_of(Path(file)) or (k, 0)
        by_name.setdefault(name, []).append((number, file))
    groups = list[list[P]]()
    for numbered in by_name.values():
        numbered.sort(key=lambda each: each[0])
        parts: list[P] = [file for _, file in numbered]
        together = [number for number, _ in numbered] == [*range(len(parts))]
        groups += [parts] if together else [[file] for file in parts]
    return groups


def _part_of(path: Path) -> tuple[Any, int] | None:
    """What the parts of a bag share in their names, and the number of this one."""
    part = PART.fullmatch(path.stem) if path.suffix in SUFFIXES else None
    return ((path.parent, part[1], path.suffix), int(part[2])) if part else None


def parts_of(path: Path) -> list[Path]:
    """The files of a bag: it, or of a folder the only one or its parts.

    Nothing of a folder that holds several bags, or none.
    """
    if not path.is_dir():
        return [path]
    inside = (file for file in path.iterdir() if file.is_file())
    groups = recordings(file for file in inside if file.suffix in SUFFIXES)
    return groups[0] if len(groups) == 1 else []


def kind_of(path: Path) -> str | None:
    """Which bag a file or a folder is; None if it is not a bag."""
    path = next(iter(parts_of(path)), path)
    if path.is_dir():
        return None
    with path.open("rb") as file:
        head = file.read(LONGEST_MAGIC_BYTES)
    return next((kind for magic, kind in MAGIC.items() if head.startswith(magic)), None)
