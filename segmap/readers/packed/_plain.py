"""What a user names as plain files: unpacked, and text in UTF-8, before any reader looks at it."""

from __future__ import annotations

import codecs
import re
import tarfile
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import IO, Any, cast

import numpy as np

from ... import arrays
from ...files import LEAST_UNPACKED_BYTES, MOST_UNPACKED_RATIO, members, shown, unzipped
from .._lines import GZIP, PACKINGS, LogError, UnknownFormat, open_bytes

#: First bytes of bags of ROS.
BAGS = (b"#ROSBAG V", b"SQLite format 3\0", b"\x89MCAP0\r\n")
#: First bytes of one array of numpy's.
NPY = b"\x93NUMPY"
#: First bytes of an archive by zip.
ZIP = b"PK\x03\x04"
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
#: No options, and no table of loops, are longer.
MOST_TEXT_BYTES = 10_000_000
#: Names of files in an archive that are about its logs.
ABOUT_LOGS = re.compile(r"(?i)(readme|licen[cs]e|copying|authors|citation)\b.*|.*\.(md|rst|html?)")
#: Names of so many files are listed.
MOST_NAMES = 5


@contextmanager
def log_file(path: str | Path, *, folders: bool = False) -> Iterator[Path]:
    """The path that a user names, as a plain file: what is wrong with it is a LogError.

    It must lead to a regular file, to a folder where these are allowed, or into an archive:
    `logs.zip/room.log`. What is wrong with a file in an archive is told of the archive.
    """
    if isinstance(path, str) and "\0" in path:
        raise LogError(Path(path), "a path has no NUL in it, expected that of a log")
    place = arrays.file(path)
    try:
        place.resolve()  # tells links in a circle
        archive = next((p for p in (place, *place.parents) if p.is_file()), place)
        if not archive.is_file() and not (folders and place.is_dir()):
            found = "is no file" if place.exists() else "does not exist"
            what = "a log file or a folder of one" if folders else "a file"
            raise LogError(place, f"{found}, expected {what}")
        if place.is_dir():
            yield place
            return
        with _unpacked(archive) as held:
            inside = place.relative_to(archive).as_posix()
            opened = _one(held, archive, "" if inside == "." else inside)
            try:
                yield opened
            except LogError as fault:
                if opened == archive or not fault.path.is_relative_to(opened):
                    raise
                raise type(fault)(_told(held, opened, archive), fault.reason, fault.line) from None
    except (OSError, RuntimeError) as fault:
        reason = getattr(fault, "strerror", None) or fault
        raise LogError(place, f"cannot be read ({reason})") from fault


def logs_in(path: str | Path) -> list[str]:
    """The logs in a file, each by a path that `read` takes: several only in an archive.

    Examples
    --------
    >>> logs_in("room.log")
    ['room.log']
    """
    path = arrays.file(path)
    if not path.is_file() or not _is_archive(path):
        return [str(path)]
    with _unpacked(path) as held:
        return [str(path / name) for name in held] if len(held) > 1 else [str(path)]


def read_text(path: str | Path) -> str:
    """The text of a file, unpacked, whatever its encoding.

    Raises
    ------
    LogError
        There is no such file, or it is no text in UTF-8 and has no mark of another encoding.

    Examples
    --------
    >>> import lzma
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     path = Path(folder) / "it.toml.xz"
    ...     _ = path.write_bytes(lzma.compress("penalty = 0.1".encode("utf-16")))
    ...     read_text(path)
    'penalty = 0.1'
    """
    with log_file(path) as place:
        try:
            with open_bytes(place) as file:
                return file.read(MOST_TEXT_BYTES).decode("utf-8")
        except UnicodeDecodeError as fault:
            raise LogError(place, f"expected text in UTF-8 ({fault})") from fault


@dataclass
class _Room:
    """Bytes that a file may be unpacked to in all, whatever is packed in what was packed in it."""

    path: Path
    used: int = 0

    def take(self, count: int) -> None:
        """So many bytes more."""
        most = max(LEAST_UNPACKED_BYTES, MOST_UNPACKED_RATIO * self.path.stat().st_size)
        self.used += count
        if self.used > most:
            raise LogError(
                self.path, f"unpacks to more than {most} bytes: unpack it, if it is a log"
            )


@contextmanager
def _unpacked(path: Path) -> Iterator[dict[str, Path]]:
    """The plain files that are logs in a file, by their names in it; a plain file is its own."""
    with tempfile.TemporaryDirectory(prefix="segmap-") as folder:
        room = _Room(path)
        found = _opened(path, Path(folder), room)
        if not found.is_dir():
            yield {"": found}
        elif held := dict(_logs(found, room)):
            yield held
        else:
            held = {str(p.relative_to(found)): p for p in sorted(found.rglob("*")) if p.is_file()}
            if len(held) == 1:
                yield held  # a plan, a graph
                return
            if {"xl/workbook.xml", "content.xml"} & {*held}:
                how = "pandas.read_excel(path).to_csv('it.csv', index=False)"
                raise UnknownFormat(path, f"is a workbook: save its sheet as CSV, or {how}")
            listed = _listed(list(held)) or "nothing"
            raise UnknownFormat(path, f"is an archive without a log, it holds {listed}")


def _one(held: dict[str, Path], path: Path, inside: str) -> Path:
    """The log of that name in an archive; without a name, the only one."""
    if inside in held:
        return held[inside]
    if len(held) == 1 and not inside:
        return next(iter(held.values()))
    what = f"no log {shown(inside)} in it, but" if inside else f"is an archive of {len(held)} logs:"
    first = shown(path / next(iter(held)))
    raise LogError(path, f"{what} {_listed(list(held))}; read one, as {first}")


def _told(held: dict[str, Path], opened: Path, path: Path) -> Path:
    """What a user knows of a file that was unpacked."""
    return path / next(name for name, place in held.items() if place == opened)


def _listed(names: list[str]) -> str:
    """The first names of many."""
    return ", ".join(map(shown, names[:MOST_NAMES])) + (", ..." if names[MOST_NAMES:] else "")


def _opened(path: Path, folder: Path, room: _Room) -> Path:
    """The plain file, or the folder of an archive, below `folder`; `path` where it is plain."""
    try:
        while True:
            front = _front(path)
            pack = next((magic for magic in PACKINGS if front.startswith(magic)), None)
            if pack is not None:
                if not _needs_more(_front(path, PACKINGS[pack]), pack):
                    return path  # readers take it as it comes
                path = _copied(PACKINGS[pack](path), folder / _without_suffix(path), room)
            elif _is_tar(front) or (front.startswith(ZIP) and not _is_ours(path)):
                return _extracted(path, folder, room)
            elif front.startswith(NPY):
                return _as_text(path, folder)
            elif encoding := _encoding(front):
                text = folder / "text"
                text.mkdir(exist_ok=True)
                source = path.open(encoding=encoding, errors="replace", newline=None)
                return _copied(source, text / path.name, room)
            else:
                return path
    except LogError:
        raise
    except Exception as fault:  # gzip, lzma, bz2, zstd, tarfile and zipfile raise a dozen
        found = f"the packed file is broken or cut short ({shown(fault)})"
        raise LogError(path, f"{found}: unpack by hand what is whole") from fault


def _front(path: Path, open_: Callable[[Path], Any] | None = None) -> bytes:
    """The first bytes of a file, unpacked where `open_` does so."""
    with path.open("rb") if open_ is None else open_(path) as file:
        return cast(bytes, file.read(FRONT_BYTES))


def _needs_more(front: bytes, pack: bytes) -> bool:
    """Whether these first bytes are of something that readers do not take as it comes.

    That is lines, and whatever gzip packed.
    """
    if pack != GZIP and 0 in front:
        return True
    return _is_tar(front) or bool(_encoding(front)) or front.startswith((*PACKINGS, *BAGS))


def _is_archive(path: Path) -> bool:
    """Whether a file, packed or not, holds several files."""
    front = _front(path)
    opener = next((open_ for magic, open_ in PACKINGS.items() if front.startswith(magic)), None)
    if opener is not None:
        try:
            front = _front(path, opener)
        except Exception:  # a damaged one: it is told when it is read
            return False
    return _is_tar(front) or (front.startswith(ZIP) and not _is_ours(path))


def _is_tar(front: bytes) -> bool:
    return front[257:262] == b"ustar"


def _is_ours(path: Path) -> bool:
    """Whether a zip file holds arrays: NPZ, a session, a map."""
    return any(name.endswith((".npy", ".json")) and "/" not in name for name in members(path))


def _encoding(front: bytes) -> str:
    """The encoding of a text that is no plain UTF-8 in lines; empty where it is, or is no text."""
    marked = next((name for mark, name in MARKS.items() if front.startswith(mark)), "")
    if marked or len(front) < 8:
        return marked
    even, odd = front[::2].count(0), front[1::2].count(0)
    half = len(front) // 2
    if b"\r" in front and b"\n" not in front and not even + odd and front.isascii():
        return "utf-8"  # lines of old Macs, and of Excel for them
    if even == 0 and odd > 0.9 * half:
        return "utf-16-le"
    return "utf-16-be" if odd == 0 and even > 0.9 * half else ""


def _without_suffix(path: Path) -> str:
    """The name of what is packed in a file: `room.log.xz` -> `room.log`, `it.tgz` -> `it.tar`."""
    short = {".tgz": ".tar", ".txz": ".tar", ".tbz2": ".tar", ".tbz": ".tar"}
    return path.stem + short.get(path.suffix.lower(), "")


def _copied(source: IO[Any], target: Path, room: _Room) -> Path:
    """All that a file holds, as bytes in UTF-8 where it is text, within bounds."""
    with source, target.open("wb") as file:
        while part := source.read(CHUNK_BYTES):
            room.take(file.write(part.encode("utf-8") if isinstance(part, str) else part))
    return target


def _as_text(path: Path, folder: Path) -> Path:
    """An array as a table: a row a line; of three dimensions a scan a line, its beams in brackets.

    So scans of the package rplidar, `(k, n, 3)`, and ranges `(k, n)` are what they are as text.
    """
    try:
        held = np.atleast_2d(np.load(path, allow_pickle=False))
    except ValueError as fault:
        words = "scans of several lengths, perhaps: write a line for each beam, or numpy.savez"
        raise LogError(path, f"is no array of numbers alone ({fault}): {words}") from fault
    if held.ndim > 3 or held.dtype.kind not in "iuf" or not held.size:
        raise LogError(path, f"expected numbers, got {held.dtype} of shape {held.shape}")
    text = folder / "text"
    text.mkdir(exist_ok=True)
    with (text / path.name).open("w", encoding="utf-8") as file:
        for row in held.tolist():
            beams = row if held.ndim == 2 else [str(tuple(beam)) for beam in row]
            line = " ".join(map(str, beams)) if held.ndim == 2 else f"[{', '.join(beams)}]"
            file.write(f"{line}\n")
    return text / path.name


def _extracted(path: Path, folder: Path, room: _Room) -> Path:
    """The files of an archive, with their names, in a folder of their own."""
    target = folder / path.name.split(".")[0]
    target.mkdir(exist_ok=True)
    for name, source in _members(path):
        parts = [part for part in PurePosixPath(name).parts if part not in ("/", "..", ".")]
        if any(part.startswith((".", "__")) for part in parts):
            continue  # `__MACOSX/` holds none of the user's
        place = target.joinpath(*parts or ["unnamed"])
        place.parent.mkdir(parents=True, exist_ok=True)
        _copied(source, place, room)
    inside = list(target.iterdir())
    while len(inside) == 1 and inside[0].is_dir():
        target, inside = inside[0], list(inside[0].iterdir())
    return target


def _members(path: Path) -> Iterator[tuple[str, IO[bytes]]]:
    """Names and contents of the regular files in an archive."""
    if _is_tar(_front(path)):
        with tarfile.open(path, "r:") as packed:
            for member in packed:
                if member.isreg() and (source := packed.extractfile(member)) is not None:
                    yield member.name, source
    else:
        with unzipped(path) as (zipped, entries):
            for entry in entries:
                yield entry.filename, zipped.open(entry)


def _logs(folder: Path, room: _Room, begin: str = "") -> Iterator[tuple[str, Path]]:
    """Names and plain files of the logs in what an archive held; a folder may be one itself."""
    if _is_log(folder):
        yield begin.rstrip("/"), folder
        return
    for path in sorted(folder.iterdir()):
        name, place = begin + path.name, path
        if ABOUT_LOGS.fullmatch(path.name):
            continue
        if path.is_file():
            inner = folder.with_name(f"of {folder.name}") / path.name
            inner.mkdir(parents=True, exist_ok=True)
            place = _opened(path, inner, room)
        if place.is_dir():
            yield from _logs(place, room, f"{name}/")
        elif _is_log(place):
            yield name, place


def _is_log(path: Path) -> bool:
    """Whether some reader takes a file or folder; one that is damaged may have been a log."""
    from .._formats import recognise  # of which each format reads its files by this module

    try:
        recognise(path)
    except UnknownFormat:
        return False
    except LogError:
        pass
    return True
