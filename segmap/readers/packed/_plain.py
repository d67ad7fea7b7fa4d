"""What a user names as a plain file: unpacked, and text in UTF-8, before any reader looks at it."""

from __future__ import annotations

import bz2
import codecs
import gzip
import lzma
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO, Any

from ... import arrays
from ...files import escape, members, most_unpacked
from ..lines import LogError, UnknownFormat

#: First bytes of a file that one program packed -> the function that opens it.
PACKINGS: dict[bytes, Callable[[Path], Any]] = {
    b"\x1f\x8b": gzip.open,
    b"\xfd7zXZ\x00": lzma.open,
    b"BZh": bz2.open,
}
#: First bytes of files that are not unpacked -> what to do with them.
NOT_UNPACKED = {
    b"PK\x03\x04": "is an archive by zip: unpack it, then name the file or the folder in it",
    b"7z\xbc\xaf\x27\x1c": "is an archive by 7z: unpack it, then name the file or the folder in it",
    b"\x28\xb5\x2f\xfd": "is packed by zstd: `unzstd` unpacks it, then name the unpacked file",
}
AN_ARCHIVE_BY_TAR = "is an archive by tar: `tar -xf` unpacks it, then name the file or the folder"
A_WORKBOOK = (
    "is a workbook: save its sheet as CSV, or pandas.read_excel(path).to_csv('it.csv', index=False)"
)
#: Marks at the front of a text -> its encoding; the longer ones first.
MARKS = {
    codecs.BOM_UTF32_LE: "utf-32",
    codecs.BOM_UTF32_BE: "utf-32",
    codecs.BOM_UTF8: "utf-8-sig",
    codecs.BOM_UTF16_LE: "utf-16",
    codecs.BOM_UTF16_BE: "utf-16",
}
#: Bytes of the front that are looked at.
FRONT_BYTES = 1024
#: Bytes that are copied at once.
CHUNK_BYTES = 1 << 20


@contextmanager
def log_file(path: str | Path, *, folders: bool = False) -> Iterator[Path]:
    """The path that a user names, as a plain file: what is wrong with it is a LogError.

    It must lead to a regular file, or to a folder where these are allowed. What is wrong with a
    file that was packed is told of the packed one.
    """
    if isinstance(path, str) and "\0" in path:
        raise LogError(Path(path), "a path has no NUL in it, expected that of a log")
    place = arrays.file(path)
    try:
        place.resolve()  # tells links in a circle
        if not place.is_file() and not (folders and place.is_dir()):
            reason = "is no file" if place.exists() else "does not exist"
            what = "a log file or a folder of one" if folders else "a file"
            raise LogError(place, f"{reason}, expected {what}")
        with tempfile.TemporaryDirectory(prefix="segmap-") as folder:
            plain = place if place.is_dir() else _unpack(place, Path(folder))
            try:
                yield plain
            except LogError as fault:
                if plain == place or fault.path != plain:
                    raise
                raise type(fault)(place, fault.reason, fault.line) from None
    except (OSError, RuntimeError) as fault:
        reason = getattr(fault, "strerror", None) or str(fault)
        raise LogError(place, f"cannot be read ({reason})") from fault


def read_text(path: str | Path) -> str:
    """The text of a file, unpacked, whatever its encoding.

    Raises
    ------
    LogError
        There is no such file, or it is no text in UTF-8 and has no mark of another encoding.

    Examples
    --------
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder) / "it.toml.xz"
    ...     _ = path.write_bytes(lzma.compress("penalty = 0.1".encode("utf-16")))
    ...     read_text(path)
    'penalty = 0.1'
    """
    with log_file(path) as place:
        try:
            return place.read_text("utf-8")
        except UnicodeDecodeError as fault:
            raise LogError(place, f"expected text in UTF-8 ({fault})") from fault


def _unpack(path: Path, folder: Path) -> Path:
    """The plain file, below `folder`; `path` itself where it is plain."""
    front = _front(path)
    unpack = next((open_ for magic, open_ in PACKINGS.items() if front.startswith(magic)), None)
    if unpack is not None:
        try:
            plain = folder / path.stem
            plain = _copy(unpack(path), plain, path)
            front = _front(plain)
        except LogError:
            raise
        except Exception as fault:  # gzip, lzma and bz2 raise half a dozen
            broken = f"the packed file is broken or cut short ({escape(fault)})"
            raise LogError(path, f"{broken}: unpack by hand what is whole") from fault
    else:
        plain = path
    _refuse_archives(path, plain, front)
    if encoding := next((name for mark, name in MARKS.items() if front.startswith(mark)), ""):
        text = folder / "text"
        text.mkdir()
        source = plain.open(encoding=encoding, errors="replace", newline=None)
        return _copy(source, text / plain.name, plain)
    return plain


def _refuse_archives(path: Path, plain: Path, front: bytes) -> None:
    """Refuse what may hold several files, and what is packed twice or as no reader takes it."""
    if front[257:262] == b"ustar":
        raise UnknownFormat(path, AN_ARCHIVE_BY_TAR)
    for magic, what in NOT_UNPACKED.items():
        if front.startswith(magic):
            names = members(plain)
            if magic.startswith(b"PK") and not names:
                raise LogError(path, "the packed file is broken or cut short")
            if {"xl/workbook.xml", "content.xml"} & names:
                raise UnknownFormat(path, A_WORKBOOK)
            if not any(name.endswith((".npy", ".json")) and "/" not in name for name in names):
                raise UnknownFormat(path, what)
    if plain != path and any(front.startswith(magic) for magic in PACKINGS):
        raise UnknownFormat(path, "is packed twice: unpack it once")


def _front(path: Path) -> bytes:
    """The first bytes of a file."""
    with path.open("rb") as file:
        return file.read(FRONT_BYTES)


def _copy(source: IO[Any], target: Path, path: Path) -> Path:
    """All that a file holds, as bytes in UTF-8 where it is text, in proportion to its size."""
    most = rest = most_unpacked(path.stat().st_size)
    with source, target.open("wb") as file:
        while part := source.read(CHUNK_BYTES):
            rest -= file.write(part.encode("utf-8") if isinstance(part, str) else part)
            if rest < 0:
                raise LogError(
                    path, f"unpacks to more than {most} bytes: unpack it, if it is a log"
                )
    return target
