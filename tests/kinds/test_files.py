"""What writes a file: whole or not at all, in the place that a link names, with its mode."""

import gzip
import os
import stat
from pathlib import Path

import numpy as np
import pytest
from programs import program

import segmap
from segmap import LaserScan, Log, SegmentMap, exports, readers
from segmap.experiments import load_records, read_records, write_records
from segmap.files import LEAST_UNPACKED_BYTES, MOST_UNPACKED_RATIO, pack, write_bytes
from segmap.plan import floor_plan
from segmap.quadtree import QuadtreeMap, map_of_grid
from segmap_app import files

main = program("segmap")

LOG = Log("one", [LaserScan([1.0], [0.0])], [(0, 0, 0)])
MAP = QuadtreeMap(resolution=0.5, size=2)
MAP.insert_scan((0.2, 0.2), [(1.2, 0.2)])
WALLS = SegmentMap([[(0, 0), (1, 0)]])
FREE = map_of_grid(np.ones((60, 80)), resolution=0.05)
PLAN = floor_plan([[(0, 0), (4, 0)], [(4, 0), (4, 3)], [(4, 3), (0, 3)], [(0, 3), (0, 0)]], FREE)
GRAPH = exports.PoseGraph(np.zeros((2, 3)), [(0, 1)], [(1, 0, 0)], [np.eye(3)])

#: Every function that writes a file in one go, and the end of the name that it wants.
WRITERS = {
    "tum": (lambda path: exports.write_tum(path, LOG, LOG.truth), ".tum"),
    "packed": (lambda path: exports.write_tum(path, LOG, LOG.truth), ".tum.gz"),
    "carmen": (lambda path: exports.write_carmen(path, LOG), ".log"),
    "ros": (lambda path: files.write_ros_map(path, MAP), ".yaml"),
    "geojson": (lambda path: exports.write_geojson(path, MAP), ".geojson"),
    "svg": (lambda path: exports.write_svg(path, MAP), ".svg"),
    "map": (lambda path: MAP.save(path), ".npz"),
    "segment map": (lambda path: WALLS.save(path), ".npz"),
    "segments": (lambda path: exports.write_segments(path, WALLS), ".csv"),
    "plan": (lambda path: exports.write_plan(path, PLAN), ".dxf"),
    "sheet": (lambda path: exports.write_sheet(path, WALLS), ".pdf"),
    "arrays": (lambda path: exports.write_arrays(path, LOG), ".npz"),
    "session": (lambda path: files.write_session(path, files.Session(LOG, {})), ".segmap"),
    "graph": (lambda path: exports.write_graph(path, GRAPH), ".g2o"),
    "drawn": (lambda path: exports.write_segments(path, WALLS), ".dxf.gz"),
    "records": (lambda path: write_records(load_records("malaga")[:2], path), ".csv"),
}


@pytest.fixture(params=WRITERS)
def writer(request):
    """A function that writes, and a name that it takes."""
    write, end = WRITERS[request.param]
    return write, f"it{end}"


def others(folder: Path, *names: str) -> set[str]:
    """Files beside those that should be there; the picture of a ROS map is one."""
    return {p.name for p in folder.iterdir()} - {*names, "it.pgm"}


def test_a_file_is_replaced_whole_or_not_at_all(writer, tmp_path, monkeypatch):
    """Catches a file that is emptied first, half a file left beside it, a mode that is lost."""
    write, name = writer
    path = tmp_path / name
    path.write_bytes(b"what was there")
    path.chmod(0o604)

    def full(file):
        raise OSError(28, "No space left on device")

    with monkeypatch.context() as patch, pytest.raises(OSError, match=r"No space left.*it\."):
        patch.setattr(os, "fsync", full)
        write(path)
    assert path.read_bytes() == b"what was there" and others(tmp_path, name) == set()
    write(path)
    assert stat.S_IMODE(path.stat().st_mode) == 0o604 and others(tmp_path, name) == set()
    assert b"what was there" not in path.read_bytes()


def test_a_link_stays_and_what_it_leads_to_changes(tmp_path):
    """Catches a link that becomes a file, while its target keeps yesterday's content; and files
    that nobody else may read, as temporary ones are made."""
    (tmp_path / "elsewhere").mkdir()
    target, link = tmp_path / "elsewhere" / "real", tmp_path / "it"
    link.symlink_to(target)
    before = os.umask(0o027)
    try:
        write_bytes(link, b"new")
    finally:
        os.umask(before)
    assert link.is_symlink() and target.read_bytes() == b"new"
    assert stat.S_IMODE(target.stat().st_mode) == 0o640
    assert others(target.parent) == {"real"}


def test_what_is_no_regular_file_stays(writer, tmp_path):
    """Catches a device that root replaces by a file, a pipe that nobody reads, a folder that is
    not there and not named."""
    write, name = writer
    path = tmp_path / name
    for make in (os.mkfifo, Path.mkdir):
        make(path)
        with pytest.raises(ValueError, match=r"it\.\S+ is a .*, no regular file"):
            write(path)
        assert [*tmp_path.iterdir()] == [path]
        path.rmdir() if path.is_dir() else path.unlink()
    with pytest.raises(FileNotFoundError, match=r"cannot write .*it\.\S+: the folder .*none does"):
        write(tmp_path / "none" / name)


#: Every function that reads a file.
READERS = {
    **{"log": segmap.read, "trajectory": readers.read_trajectory, "bag": files.read_bag},
    **{"csv": readers.read_csv, "segments": readers.read_segments, "graph": files.read_graph},
    **{"tree": QuadtreeMap.load, "map": SegmentMap.load, "runs": read_records},
}


@pytest.mark.parametrize("name", READERS)
def test_what_is_no_regular_file_is_not_read(name, tmp_path):
    """Catches a pipe that is waited for, and a file that is not there and not named."""
    os.mkfifo(tmp_path / "pipe.csv")
    for path in (tmp_path / "pipe.csv", tmp_path):
        with pytest.raises(ValueError, match=path.name):
            READERS[name](path)
    with pytest.raises((ValueError, FileNotFoundError), match=r"none\.csv"):
        READERS[name](tmp_path / "none.csv")


@pytest.mark.parametrize("size", [1000, LEAST_UNPACKED_BYTES + 1])
def test_a_packed_file_holds_no_date_and_is_never_a_bomb(size):
    """Catches zeros packed so small that our own reader refuses them, and bytes that vary."""
    smallest = pack(bytes(size))
    assert gzip.decompress(smallest) == bytes(size) and smallest[4:8] == bytes(4)
    assert size <= max(LEAST_UNPACKED_BYTES, MOST_UNPACKED_RATIO * len(smallest))


@pytest.mark.skipif(not Path("/proc").is_dir(), reason="there is no folder that takes no file")
@pytest.mark.parametrize(
    "words",
    [
        "map room -o /proc/it.svg",
        "map room --loops /proc/it",
        "compare room -o /proc/it.png",
        "convert room -o /proc/it.npz",
        "locate it.yaml room --table /proc/it.csv",
        "merge room room -o /proc/it.dxf",
    ],
)
def test_a_folder_that_takes_no_file_is_told_before_the_work(words, tmp_path, monkeypatch, capsys):
    """Catches an option for a file that is tried after the work, where root seems to be allowed."""
    monkeypatch.chdir(tmp_path)
    files.write_ros_map(Path("it.yaml"), MAP)
    before = sorted(tmp_path.iterdir())
    monkeypatch.setattr("segmap.alignment.prepared", lambda *given: pytest.fail("it works"))
    assert main(words.split()) == 2
    assert "cannot write /proc/it" in capsys.readouterr().err
    assert sorted(tmp_path.iterdir()) == before
