"""Files that appear only when they are complete, and arrays of which everything is checked.

Only regular files are read or replaced.
"""

from __future__ import annotations

import gzip
import html
import io
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
from numpy.typing import NDArray

from .progress import each

#: A packed file may always unpack to this many bytes.
LEAST_UNPACKED_BYTES = 1 << 20
#: A packed file may unpack to this many times its size: logs shrink to a third, the most regular
#: tree to a 23rd; a file that shrinks to a thousandth was made to fill the memory.
MOST_UNPACKED_RATIO = 50
#: More bytes than the head of an array takes.
HEAD = 256


def escape(name: object) -> str:
    """A name or a line from outside as a terminal may show it: nothing in it moves the cursor.

    Examples
    --------
    >>> print(escape("a\\x1b[2J\\n.log"))
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
    return html.escape("\n".join(map(escape, str(value).split("\n"))))


def file_name(name: str) -> str:
    """A name from outside as part of a file's name: it leads to no other folder.

    Examples
    --------
    >>> file_name("../../home/me"), file_name("run 1"), file_name("..")
    ('.._.._home_me', 'run 1', '__')
    """
    plain = re.sub(r"[/\\:]", "_", escape(name))
    return plain if plain.strip(".") else "_" * len(plain)


def stat_file(path: Path) -> os.stat_result | None:
    """The regular file that a path or its link leads to; None where nothing is there yet.

    Raises
    ------
    ValueError
        For a folder, a device or a pipe: reading could wait for ever, replacing would destroy it.
    OSError
        Where the path cannot be asked for, links in a circle for instance.
    """
    try:
        status = path.stat()
    except FileNotFoundError:
        return None
    if not stat.S_ISREG(status.st_mode):
        kind = "a folder" if stat.S_ISDIR(status.st_mode) else "a device or a pipe"
        raise ValueError(f"{escape(path)} is {kind}, no regular file: name a file")
    return status


def check_place(path: Path) -> Path:
    """Where a file is going to be, seen before any work is done for it.

    Raises
    ------
    ValueError, OSError
        As `stat_file`; for a folder that does not exist, or cannot be written to.
    """
    stat_file(path)
    place = Path(os.path.realpath(path))
    reason = f"cannot write {escape(path)}: the folder {escape(place.parent)}"
    if not place.parent.is_dir():
        raise FileNotFoundError(f"{reason} does not exist")
    try:  # os.access says to root that `/proc` is open
        tempfile.TemporaryFile(dir=place.parent).close()
    except OSError as error:
        raise type(error)(f"{reason} takes no file: {error.strerror}") from error
    return place


@contextmanager
def rewrite(path: Path, *, sync: bool = True) -> Iterator[IO[bytes]]:
    """A file written beside its place, and moved there once it is complete.

    A file that was there keeps its mode; what a symbolic link leads to is replaced. With `sync` the
    disk has it all before; a recorder has no time for that. Raises as `check_place`.
    """
    place, old = check_place(path), stat_file(path)
    part = place.with_name(f".segmap-{uuid.uuid4().hex}.part")
    try:
        with part.open("x+b") as target:
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
    with rewrite(path) as target:
        target.write(pack(data) if path.suffix == ".gz" else data)


def pack(data: bytes) -> bytes:
    """Bytes as gzip, never so small that a reader takes them for a bomb."""
    gzipped = gzip.compress(data, mtime=0)
    return gzip.compress(data, 0, mtime=0) if len(data) > most_unpacked(len(gzipped)) else gzipped


# ------------------------------------------------------------------------------ arrays
def write_npz(path: Path, kind: str, by_name: Mapping[str, NDArray[Any] | str]) -> None:
    """Write arrays by name; `kind` says what they are, with the version of their layout.

    A text among them is a file of its own in the archive; its name ends in `.json`.
    """
    named: dict[str, Any] = {"format": np.array(kind), **by_name}
    texts = {name: value for name, value in named.items() if isinstance(value, str)}
    arrays = {name: value for name, value in named.items() if name not in texts}
    large = sum(map(len, texts.values())) + sum(v.nbytes + HEAD for v in arrays.values())
    with rewrite(path) as target:
        np.savez_compressed(target, **arrays)
        if large > most_unpacked(target.tell()):  # a reader would take it for a bomb
            target.seek(0)
            target.truncate()
            np.savez(target, **arrays)
        with zipfile.ZipFile(target, "a") as packed:
            for name, text in texts.items():
                packed.writestr(zipfile.ZipInfo(name), text, zipfile.ZIP_DEFLATED)


def read_npz(path: Path, kind: str) -> dict[str, NDArray[Any]]:
    """The arrays of a file that `write_npz` wrote; no object is unpickled.

    Raises
    ------
    ValueError
        Naming the file: damaged, of another kind or version, out of proportion to its size.
    """
    arrays, place = read_arrays(path), escape(path)
    (name, version), layout = kind.rsplit(" ", 1), str(arrays.pop("format", ""))
    if not layout.startswith(name):
        raise ValueError(f"{place}: not a {name.split()[1]} of segmap, holds {sorted(arrays)}")
    if layout != kind:
        raise ValueError(f"{place}: written as {layout!r}, this version reads {version}")
    return arrays


def members(path: Path) -> set[str]:
    """Names of what a zip file holds; none where it is damaged, or no zip file at all."""
    with suppress(Exception), zipfile.ZipFile(path) as packed:  # it raises a dozen
        return set(packed.namelist())
    return set()


def read_arrays(path: Path) -> dict[str, NDArray[Any]]:
    """The arrays of any NPZ file, as they stand; no object is unpickled.

    Raises
    ------
    ValueError
        Naming the file: damaged, or out of proportion to its size.
    """
    stat_file(path)
    most, texts = most_unpacked(path.stat().st_size), {}
    try:
        with zipfile.ZipFile(path) as packed:
            if sum(member.file_size for member in packed.infolist()) > most:
                raise ValueError(f"it unpacks to more than {most} bytes")
            names = [n for n in packed.namelist() if n.endswith(".json")]
            texts = {name: np.array(packed.read(name).decode("ascii")) for name in names}
        with np.load(path, allow_pickle=False) as archive:
            names = [name for name in archive.files if name not in texts]
            return texts | {name: archive[name] for name in each(names, "reading array")}
    except Exception as error:  # zipfile, zlib and numpy raise a dozen
        words = escape(error) or type(error).__name__
        raise ValueError(f"{escape(path)}: not a readable NPZ file ({words})") from None


def most_unpacked(size: int) -> int:
    """Bytes that a packed file of some size may unpack to."""
    return max(LEAST_UNPACKED_BYTES, MOST_UNPACKED_RATIO * size)


def chapters_folder() -> Path:
    """The folder of the chapters: in a wheel inside the package, in a clone beside it."""
    package = Path(__file__).parent
    for folder in (package / "notebooks", package.parent / "notebooks"):
        if (folder / "01_start_here.ipynb").is_file():
            return folder
    raise FileNotFoundError("the chapters are missing: install segmap again")
