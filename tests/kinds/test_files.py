"""What writes a file: whole or not at all, in the place that a link names, with its mode."""

import ast
import errno
import gzip
import inspect
import os
import re
import stat
import tempfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import segmap_course as course
from programs import program

import segmap
import segmap_app
from segmap import LaserScan, Log, SegmentMap, exports, readers
from segmap.experiments import (
    load_records,
    read_records,
    sweep,
    write_records,
)
from segmap.files import (
    LEAST_UNPACKED_BYTES,
    MOST_UNPACKED_RATIO,
    packed,
    replacing,
    write_bytes,
)
from segmap.plan import floor_plan
from segmap.quadtree import QuadtreeMap, map_of_grid
from segmap.sensors import record
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


def others(folder: Path, *known: str) -> set[str]:
    """Files beside those that should be there; the picture of a ROS map is one."""
    return {p.name for p in folder.iterdir()} - {*known, "it.pgm"}


def test_the_table_of_writers_is_whole():
    """Catches an export that joins the package and not these tests, and a second way to write."""
    functions = {name for name, found in vars(exports).items() if inspect.isfunction(found)}
    assert functions - {"ros_classes", "log_arrays"} == {
        *("write_tum", "write_carmen", "write_geojson", "write_svg"),
        *("write_segments", "write_graph", "write_arrays", "write_sheet"),
        "write_plan",
    }
    found = set()
    for package in (Path(m.__file__).parent for m in (segmap, segmap_app, course)):
        for path in package.rglob("*.py"):
            for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
                if isinstance(node, ast.Call) and writes(node):
                    found.add(path.relative_to(package.parent).as_posix())
    assert found == {
        "segmap/files.py",
        "segmap/sensors/_record.py",  # a line a scan
        "segmap/experiments/_files.py",  # a line a run
        "segmap/readers/packed/_plain.py",  # what is unpacked, into a folder that goes
        "segmap_app/page/_source.py",  # an upload, into a folder that goes with it
        "segmap_app/commands/log_options/_workers.py",  # a log that is sent, into one that goes
        "segmap_course/exercises/open/scans.py",  # a log of one line, alike
    }


def writes(call: ast.Call) -> bool:
    """Whether a call opens a file to write in it; examples in docstrings are none."""
    name = getattr(call.func, "attr", getattr(call.func, "id", ""))
    if name in ("write_text", "savetxt", "savez", "savez_compressed", "truncate"):
        return True
    if name == "to_csv":  # of no file: a text
        return bool(call.args)
    if name == "write_bytes" and isinstance(call.func, ast.Attribute):  # of a path, not of _files
        return True
    if name != "open":
        return False
    values = [a.value for a in ast.walk(call) if isinstance(a, ast.Constant)]
    modes = {v for v in values if isinstance(v, str) and v and set(v) <= set("wxabt+")}
    return "O_CREAT" in ast.unparse(call) or bool(modes - {"b", "t", "bt"})


def test_a_call_that_writes_is_seen():
    seen = ["open(path, 'w')", "path.open('ab')", "os.open(path, os.O_CREAT | os.O_RDWR)"]
    seen += [
        "table.to_csv(path)",
        "path.write_text('x')",
        "path.write_bytes(b'x')",
        "np.savez(path, a=1)",
    ]
    others = [
        "table.to_csv()",
        "write_bytes(path, b'x')",
        "path.open(encoding='utf-8')",
        "path.open('rb')",
    ]
    found = [call for call in seen + others if writes(ast.parse(call).body[0].value)]
    assert found == seen


def test_a_new_file_has_the_mode_that_the_user_asks_for(writer, tmp_path):
    """Catches files that nobody else may read, as temporary ones are made."""
    write, name = writer
    before = os.umask(0o027)
    try:
        write(tmp_path / name)
    finally:
        os.umask(before)
    assert stat.S_IMODE((tmp_path / name).stat().st_mode) == 0o640
    assert others(tmp_path, name) == set()


@pytest.mark.parametrize("mode", [0o600, 0o664, 0o444])
def test_a_file_that_is_replaced_keeps_its_mode(writer, mode, tmp_path):
    write, name = writer
    (tmp_path / name).write_bytes(b"what was there")
    (tmp_path / name).chmod(mode)
    write(tmp_path / name)
    assert stat.S_IMODE((tmp_path / name).stat().st_mode) == mode
    assert b"what was there" not in (tmp_path / name).read_bytes()


@pytest.mark.parametrize("there", [True, False])
def test_a_link_stays_and_what_it_leads_to_changes(writer, there, tmp_path):
    """Catches a link that becomes a file, while its target keeps yesterday's content."""
    write, name = writer
    (tmp_path / "elsewhere").mkdir()
    target = tmp_path / "elsewhere" / "real"
    if there:
        target.write_bytes(b"what was there")
    (tmp_path / "between").symlink_to(Path("elsewhere") / "real")
    (tmp_path / name).symlink_to("between")
    write(tmp_path / name)
    assert (tmp_path / name).is_symlink() and (tmp_path / "between").is_symlink()
    assert target.stat().st_size > 14 and b"what was there" not in target.read_bytes()
    assert others(tmp_path, name, "between", "elsewhere") == set()
    assert others(tmp_path / "elsewhere") == {"real"}


def test_what_is_no_regular_file_stays(writer, tmp_path):
    """Catches a device that root replaces by a file, and a pipe that nobody reads."""
    write, name = writer
    path = tmp_path / name
    makers = (os.mkfifo, lambda path: path.symlink_to("/dev/full"), Path.mkdir)
    for make in makers:
        make(path)
        before = path.stat().st_mode
        with pytest.raises(ValueError, match=r"it\.\S+ is a .*, no regular file"):
            write(path)
        assert path.stat().st_mode == before and [*tmp_path.iterdir()] == [path]
        path.rmdir() if path.is_dir() else path.unlink()


def test_links_in_a_circle_and_folders_that_are_not_there_are_named(writer, tmp_path):
    write, name = writer
    (tmp_path / name).symlink_to(tmp_path / name)
    with pytest.raises(OSError, match="it"):
        write(tmp_path / name)
    with pytest.raises(FileNotFoundError, match=r"cannot write .*it\.\S+: the folder .*none does"):
        write(tmp_path / "none" / name)


def test_a_write_that_fails_leaves_what_was_there(writer, tmp_path, monkeypatch):
    """Catches a file that is emptied first, and half a file left beside it."""
    write, name = writer
    (tmp_path / name).write_bytes(b"what was there")

    def full(file):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(OSError, match="No space left"):
        write(tmp_path / name)
    assert (tmp_path / name).read_bytes() == b"what was there" and others(tmp_path, name) == set()


#: Every function that reads a file.
READERS = {
    **{"log": segmap.read, "trajectory": readers.read_trajectory, "bag": files.read_bag},
    **{"csv": readers.read_csv, "segments": readers.read_segments, "graph": files.read_graph},
    **{"tree": QuadtreeMap.load, "map": SegmentMap.load, "runs": read_records},
    "sweep": lambda path: sweep({"it": WALLS}, ["fusion"], records=path),
}


@pytest.mark.parametrize("name", READERS)
def test_what_is_no_regular_file_is_not_read(name, tmp_path):
    """Catches a pipe that is waited for, and a file that is not there and not named."""
    os.mkfifo(tmp_path / "pipe.csv")
    for path in (tmp_path / "pipe.csv", tmp_path):
        with pytest.raises(ValueError, match=path.name):
            READERS[name](path)
    if name != "sweep":  # it begins a new one
        with pytest.raises((ValueError, FileNotFoundError), match=r"none\.csv"):
            READERS[name](tmp_path / "none.csv")


def test_the_longest_name_is_written(tmp_path):
    """Catches a temporary name that is longer than its own."""
    path = tmp_path / ("n" * 251 + ".csv")
    write_records(pd.DataFrame(load_records("malaga")[:1]), path)
    assert path.exists()


@pytest.mark.parametrize("size", [1000, LEAST_UNPACKED_BYTES + 1])
def test_a_packed_file_holds_no_date_and_is_never_a_bomb(size):
    """Catches zeros packed so small that our own reader refuses them, and bytes that vary."""
    found = packed(bytes(size))
    assert gzip.decompress(found) == bytes(size) and found[4:8] == bytes(4)
    assert size <= max(LEAST_UNPACKED_BYTES, MOST_UNPACKED_RATIO * len(found))


def test_two_threads_that_write_leave_each_other_alone(tmp_path):
    """Catches one temporary name for two files."""
    with ThreadPoolExecutor(4) as workers:
        names = [tmp_path / f"{k}.csv" for k in range(200)]
        list(workers.map(table_of_one, names))
    assert all(path.read_bytes() == b"1\n" for path in names)
    assert others(tmp_path, *(path.name for path in names)) == set()


def table_of_one(path):
    write_bytes(path, b"1\n")


@pytest.fixture
def read_only(tmp_path, monkeypatch):
    """A folder into which this user may not write; root may, so that the system says it here."""
    (folder := tmp_path / "closed").mkdir()
    begun = tempfile.TemporaryFile

    def refused(*, dir):
        if dir == folder:
            raise PermissionError(errno.EACCES, "it is read-only")
        return begun(dir=dir)

    monkeypatch.setattr(tempfile, "TemporaryFile", refused)
    return folder


def test_a_read_only_folder_is_told_by_the_name_of_the_file(writer, read_only):
    """Catches a message about a file `.segmap-12-0.part`, which nobody asked for."""
    write, name = writer
    with pytest.raises(PermissionError, match=rf"cannot write .*{re.escape(name)}: .* read-only"):
        write(read_only / name)


def test_a_full_disk_is_told_by_the_name_of_the_file(tmp_path):
    with pytest.raises(OSError, match=r"No space left.*it\.csv"), replacing(tmp_path / "it.csv"):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))


@pytest.mark.parametrize(
    "words", [f"{option} closed/it.csv" for option in ("-o", "--table", "--loops")]
)
def test_a_read_only_folder_is_told_before_the_work(words, read_only, monkeypatch, capsys):
    """Catches minutes of work whose map has nowhere to go."""
    monkeypatch.chdir(read_only.parent)
    monkeypatch.setattr("segmap.alignment.prepared", lambda *given: pytest.fail("it works"))
    assert main(["map", "room", *words.split()]) == 2
    assert re.search(r"cannot write closed/\w+\.\w+: .* is read-only", capsys.readouterr().err)


@pytest.mark.skipif(not Path("/proc").is_dir(), reason="there is no folder that takes no file")
@pytest.mark.parametrize(
    "words",
    [
        *(
            "map room -o /proc/it.svg",
            "map room room -o /proc/{name}.svg",
            "map room --loops /proc/it",
        ),
        *("compare room -o /proc/it.png", "occupancy room -o /proc/it.yaml", "info room --table"),
        *(
            "convert room -o /proc/it.log",
            "convert it.yaml -o /proc/it.npz",
            "locate it.yaml room --table",
        ),
        *(
            "merge room room -o /proc/it.dxf",
            "map room -o it.svg -o /proc/it.svg",
            "merge room room --table",
        ),
    ],
)
def test_a_folder_that_takes_no_file_is_told_before_the_work(words, tmp_path, monkeypatch, capsys):
    """Catches an option for a file that is tried after the work, where root seems to be allowed."""
    monkeypatch.chdir(tmp_path)
    files.write_ros_map(Path("it.yaml"), MAP)
    before = sorted(tmp_path.iterdir())
    monkeypatch.setattr("segmap.alignment.prepared", lambda *given: pytest.fail("it works"))
    words += " /proc/it.csv" * words.endswith("--table")
    assert main(words.split()) == 2
    assert re.match(
        r"segmap: cannot write /proc/.*: the folder /proc .*\n$", capsys.readouterr().err
    )
    assert sorted(tmp_path.iterdir()) == before


def test_a_recording_is_refused_before_the_sensor_is_asked(read_only):
    with pytest.raises(PermissionError, match="closed"):
        record([], read_only)
