"""Files made to hang, to fill the memory or to end in a foreign exception are LogErrors."""

import gzip
import os
import time
import zipfile

import pytest

from segmap import LogError, read
from segmap.readers import read_trajectory

LINE = b"FLASER 2 1 81.83 0 0 0 0 0 0\n"


def packed(tmp_path, method):
    path = tmp_path / "log.zip"
    with zipfile.ZipFile(path, "w", method) as file:
        file.writestr("a.log", LINE * 9)
    return path


@pytest.mark.parametrize("method", [zipfile.ZIP_DEFLATED, zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA])
@pytest.mark.parametrize("on_error", ["raise", "skip"])
def test_damaged_zips(tmp_path, method, on_error):
    """Catches the exceptions of each way to pack, at every byte of the file."""
    path = packed(tmp_path, method)
    whole = path.read_bytes()
    for place in range(len(whole)):
        path.write_bytes(whole[:place] + bytes([whole[place] ^ 0xFF]) + whole[place + 1 :])
        try:
            read(path, on_error=on_error)
        except LogError as fault:
            assert "log.zip" in str(fault)


@pytest.mark.parametrize("bomb", [b"\n" * 2_000_000, LINE * 200_000, b"#\n" * 500_000])
def test_bombs(tmp_path, bomb):
    """Catches time or memory out of proportion to the file."""
    path = tmp_path / "bomb.log.gz"
    path.write_bytes(gzip.compress(bomb))
    begun = time.process_time()
    for on_error in ("raise", "skip"):
        with pytest.raises(LogError, match=r"in a row|unpacks to more"):
            read(path, on_error=on_error)
    assert time.process_time() - begun < 60


def test_pipes_do_not_hang(tmp_path):
    (tmp_path / "rec").mkdir()
    os.mkfifo(tmp_path / "rec" / "SICK_FRONT.csv")
    with pytest.raises(LogError, match="no regular file"):
        read(tmp_path / "rec")
    os.mkfifo(tmp_path / "pipe.log")
    with pytest.raises(LogError):
        read(tmp_path / "pipe.log")


def test_names_and_links(tmp_path):
    (tmp_path / "a.log").symlink_to(tmp_path / "b.log")
    (tmp_path / "b.log").symlink_to(tmp_path / "a.log")
    (tmp_path / "f").mkdir()
    (tmp_path / "f" / "SICK_FRONT.csv").symlink_to(tmp_path / "a.log")
    for path in (tmp_path / "a.log", tmp_path / "f", tmp_path / ("x" * 300), "a\0b"):
        with pytest.raises(LogError):
            read(path)
        with pytest.raises(LogError):
            read_trajectory(path)
    for bad in (None, 3, b"\xff"):
        with pytest.raises(ValueError, match="path"):
            read(bad)
