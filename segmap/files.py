"""Files that appear only when they are complete, and arrays of which everything is checked.

What is no regular file is neither read nor replaced.
"""

from __future__ import annotations

import gzip
import html
import io
import math
import os
import re
import stat
import sys
import tempfile
import uuid
import zipfile
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import IO, Any

import numpy as np
from numpy.lib import format as npy
from numpy.typing import NDArray

from .progress import each

#: A packed file may always unpack to this many bytes, ...
LEAST_UNPACKED_BYTES = 1 << 20
#: ... and to this many times its own: logs shrink to a third, the most regular tree to a 23rd, and
#: what shrinks to a thousandth is to fill the memory.
MOST_UNPACKED_RATIO = 50
#: How numpy packs: other ways cannot be unpacked piece by piece.
PACKED = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)
#: More bytes than the head of an array takes.
HEAD = 256


def shown(name: object) -> str:
    """A name or a line from outside as a terminal may show it: nothing in it moves the cursor.

    Examples
    --------
    >>> print(shown("a\\x1b[2J\\n.log"))
    a\\x1b[2J\\n.log
    """
    letters = (c if c.isprintable() else ascii(c)[1:-1] for c in str(name))
    return "".join(letters)


def speak() -> None:
    """Let standard output and error say every name: with escapes for letters that they lack.

    What was closed, `>&-`, is silent.
    """
    for name in ("stdout", "stderr"):
        stream = getattr(sys, name)
        if stream is None:
            setattr(sys, name, Path(os.devnull).open("w", encoding="utf-8"))  # noqa: SIM115
        elif isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")


def as_html(value: object) -> str:
    """Anything as text in HTML: no mark in it means anything, and a browser can be sent it.

    Examples
    --------
    >>> print(as_html(["<b>", "\\ud800"]), as_html("a\\x1b\\n<i>"))
    [&#x27;&lt;b&gt;&#x27;, &#x27;\\ud800&#x27;] a\\x1b
    &lt;i&gt;
    """
    return html.escape("\n".join(map(shown, str(value).split("\n"))))


def file_name(name: str) -> str:
    """A name from outside as part of a file's name: it leads to no other folder.

    Examples
    --------
    >>> file_name("../../home/me"), file_name("run 1"), file_name("..")
    ('.._.._home_me', 'run 1', '__')
    """
    found = re.sub(r"[/\\:]", "_", shown(name))
    return found if found.strip(".") else "_" * len(found)


def existing(path: Path) -> os.stat_result | None:
    """The regular file that a path or its link leads to; None where nothing is there yet.

    Raises
    ------
    ValueError
        For a folder, a device or a pipe: reading could wait for ever, replacing would destroy it.
    OSError
        Where the path cannot be asked for, links in a circle for instance.
    """
    try:
        found = path.stat()
    except FileNotFoundError:
        return None
    if not stat.S_ISREG(found.st_mode):
        kind = "a folder" if stat.S_ISDIR(found.st_mode) else "a device or a pipe"
        raise ValueError(f"{shown(path)} is {kind}, no regular file: name a file")
    return found


def writable(path: Path) -> Path:
    """Where a file is going to be, seen before any work is done for it.

    Raises
    ------
    ValueError, OSError
        As `existing`; for a folder that does not exist, or cannot be written to.
    """
    existing(path)
    place = Path(os.path.realpath(path))
    said = f"cannot write {shown(path)}: the folder {shown(place.parent)}"
    if not place.parent.is_dir():
        raise FileNotFoundError(f"{said} does not exist")
    try:  # os.access says to root that `/proc` is open
        tempfile.TemporaryFile(dir=place.parent).close()
    except OSError as error:
        raise type(error)(f"{said} takes no file: {error.strerror}") from error
    return place


@contextmanager
def replacing(path: Path, *, sync: bool = True) -> Iterator[IO[bytes]]:
    """A file written beside its place, and moved there once it is complete.

    A file that was there keeps its mode; what a symbolic link leads to is replaced. With `sync` the
    disk has it all before; a recorder has no time for that. Raises as `writable`.
    """
    place, old = writable(path), existing(path)
    part = place.with_name(f".segmap-{uuid.uuid4().hex}.part")
    try:
        with part.open("xb") as target:
            if old is not None:
                part.chmod(old.st_mode & 0o777)
            yield target
            target.flush()
            if sync:
                os.fsync(target.fileno())
        part.replace(place)
    except OSError as error:
        if error.errno and error.filename in (None, str(part)):
            raise OSError(error.errno, error.strerror, str(path)) from error
        raise
    finally:
        part.unlink(missing_ok=True)


def write_lines(path: Path, lines: Iterable[str]) -> None:
    """Write lines of ASCII text."""
    write_bytes(path, "".join(f"{line}\n" for line in lines).encode("ascii"))


def write_bytes(path: Path, data: bytes) -> None:
    """Write bytes, packed where the name ends in `.gz`."""
    with replacing(path) as target:
        target.write(packed(data) if path.suffix == ".gz" else data)


def packed(data: bytes) -> bytes:
    """Bytes as gzip, never so small that a reader takes them for a bomb."""
    found = gzip.compress(data, mtime=0)
    return gzip.compress(data, 0, mtime=0) if len(data) > most_unpacked(len(found)) else found


# ------------------------------------------------------------------------------ arrays
def write_npz(path: Path, kind: str, held: Mapping[str, NDArray[Any] | str]) -> None:
    """Write arrays by name; `kind` says what they are, with the version of their layout.

    A text among them is a file of its own in the archive; its name ends in `.json`.
    """
    named: dict[str, Any] = {"format": np.array(kind), **held}
    large = sum((len(v) if isinstance(v, str) else v.nbytes) + HEAD for v in named.values())
    with replacing(path) as target:
        _pack(target, named, zipfile.ZIP_DEFLATED)
        if large > most_unpacked(target.tell()):
            target.seek(0)  # packed so small that a reader would take it for a bomb
            target.truncate()
            _pack(target, named, zipfile.ZIP_STORED)


def _pack(target: IO[bytes], named: Mapping[str, Any], how: int) -> None:
    """Arrays as numpy packs them, texts as they stand."""
    with zipfile.ZipFile(target, "w", how) as packed:
        for name, value in named.items():
            text = isinstance(value, str)
            with packed.open(name if text else f"{name}.npy", "w", force_zip64=True) as member:
                if text:
                    member.write(value.encode("ascii"))
                else:
                    npy.write_array(member, value, allow_pickle=False)


def read_npz(path: Path, kind: str) -> dict[str, NDArray[Any]]:
    """The arrays of a file that `write_npz` wrote; no object is unpickled.

    Raises
    ------
    ValueError
        Naming the file: damaged, of another kind or version, out of proportion to its size.
    """
    found = read_arrays(path)
    (name, version), said = kind.rsplit(" ", 1), str(found.pop("format", ""))
    if not said.startswith(name):
        raise ValueError(f"{shown(path)}: not a {name.split()[1]} of segmap, holds {sorted(found)}")
    if said != kind:
        raise ValueError(f"{shown(path)}: written as {said!r}, this version reads {version}")
    return found


def members(path: Path) -> set[str]:
    """Names of what a zip file holds; none where it is damaged, or no zip file at all."""
    with suppress(OSError, zipfile.BadZipFile), unzipped(path) as (_, held):
        return {member.filename for member in held}
    return set()


def read_arrays(path: Path) -> dict[str, NDArray[Any]]:
    """The arrays of any NPZ file, as they stand; no object is unpickled.

    Raises
    ------
    ValueError
        Naming the file: damaged, or out of proportion to its size.
    """
    existing(path)
    with path.open("rb") as source:
        try:
            return _arrays(source)
        except (OSError, ValueError, zipfile.BadZipFile) as error:
            raise ValueError(f"{shown(path)}: not a readable NPZ file ({shown(error)})") from None


@contextmanager
def unzipped(source: Path | IO[bytes]) -> Iterator[tuple[zipfile.ZipFile, list[zipfile.ZipInfo]]]:
    """A zip file and the files in it.

    Raises
    ------
    zipfile.BadZipFile
        For damage of any kind, also while it is read here: zipfile, zlib and numpy raise a dozen.
    """
    try:
        with zipfile.ZipFile(source) as packed:
            yield packed, [m for m in packed.infolist() if not m.filename.endswith("/")]
    except (OSError, zipfile.BadZipFile):
        raise
    except Exception as error:
        raise zipfile.BadZipFile(str(error) or type(error).__name__) from error


def most_unpacked(size: int) -> int:
    """Bytes that a packed file of some size may unpack to."""
    return max(LEAST_UNPACKED_BYTES, MOST_UNPACKED_RATIO * size)


def _arrays(source: IO[bytes]) -> dict[str, NDArray[Any]]:
    """The arrays of an NPZ file; nothing is unpacked that is out of proportion to its size."""
    if source.read(2) != b"PK":
        raise ValueError("it does not begin like one")
    most = most_unpacked(os.fstat(source.fileno()).st_size)
    with unzipped(source) as (packed, members):
        if sum(member.file_size for member in members) > most:
            raise ValueError(f"it unpacks to more than {most} bytes")
        if any(member.compress_type not in PACKED for member in members):
            raise ValueError("it is packed as numpy never does")
        found = {}
        for member in each(members, "reading array"):
            found[member.filename.removesuffix(".npy")] = _array(packed, member)
        return found


def _array(packed: zipfile.ZipFile, member: zipfile.ZipInfo) -> NDArray[Any]:
    """One array, or a text; its header must not ask for more than there is."""
    with packed.open(member) as source:
        if member.filename.endswith(".json"):
            return np.array(source.read().decode("ascii"))
        if npy.read_magic(source) != (1, 0):
            raise ValueError(f"{member.filename} is of another version of NPY")
        shape, by_columns, kind = npy.read_array_header_1_0(source)
        data = source.read()
    if kind.hasobject or math.prod(shape) * kind.itemsize != len(data):
        raise ValueError(f"{member.filename} holds {len(data)} bytes, no {kind} {shape}")
    return np.frombuffer(bytearray(data), kind).reshape(shape, order="F" if by_columns else "C")


def chapters_folder() -> Path:
    """The folder of the chapters: in a wheel inside the package, in a clone beside it."""
    package = Path(__file__).parent
    for folder in (package / "notebooks", package.parent / "notebooks"):
        if (folder / "00_start_here.ipynb").is_file():
            return folder
    raise FileNotFoundError("the chapters are missing: install segmap again")
