"""Damaged and hostile files: clear errors, in bounded memory and time, nothing but `LogError`."""

import gzip
import os
import random
import time
import tracemalloc

import pytest
from conftest import slow
from damage import BAGS, MUTANTS, SEED, TARGETS
from log_samples import (
    CORESLAM,
    CSV,
    DPSLAM,
    G2O,
    GMAPPING,
    HOKUYO,
    LD19,
    RAWSEEDS,
    RPLIDAR,
    SICK,
    WEAN,
    flaser,
)

from segmap import readers
from segmap.readers import LogError, read_segments, read_trajectory

GOOD = flaser((1, 2, 0.5), (0, 0, 0), 1.0)


@pytest.fixture
def path(tmp_path):
    return tmp_path / "some.log"


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        (b"", "is empty"),
        (b"\n\n", "of no known format"),
        (b"# a comment\n", "comments only"),
        (b"Dear diary,\ntoday the robot 1 2\n", "starts with 'Dear diary,'"),
        (bytes(range(256)) * 20, "of no known format"),
        (b"\x1f\x8b\x08\x00garbage that is no deflate stream", "packed file is broken"),
        (b"\x1f\x8b", "packed file is broken"),
        (b"PK\x03\x04 and no zip", "packed file is broken"),
        (b"1.0 2.0 3.0\n", "of no known format"),
        (b"3 " + b"sheep " * 30 + b"in 2 fields", "of no known format"),
        (b"3 4 " + b"sheep " * 30, "of no known format"),
        (b"FLASER\n", "line 1: expected the number of ranges, got ''"),
        (b"PARAM robot_length 1\n", "holds no scan"),
        (
            b"VERTEX2 0 0 0 0\nEDGE2 0 1 0 0 0 1 0 0 1 0 1\n",
            "holds no scan, expected a ROBOT",
        ),
        (b"angle_deg,range_mm\n", "expected rows of angle_deg,range_mm"),
        (b"angle_deg,theta_rad,range_mm\n1,2,3\n", "both say that they are the angle"),
    ],
)
@pytest.mark.parametrize("on_error", ["raise", "skip"])
def test_files_that_are_no_logs(path, content, reason, on_error):
    path.write_bytes(content)
    with pytest.raises(LogError) as caught:
        readers.read(path, on_error=on_error)
    assert reason.removeprefix("line 1: ") in str(caught.value)
    assert str(caught.value).startswith(str(path)) and caught.value.path == path


@pytest.mark.parametrize(
    ("sample", "line", "reason"),
    [
        (GOOD, "FLASER 1000000000 1 2 3", "announces 1000000000 ranges, but 3 fields follow"),
        (GOOD, "FLASER " + "9" * 18 + " 1 2", "announces 999999999999999999 ranges, but 2"),
        (GOOD, "FLASER " + "9" * 19 + " 1 2", "expected the number of ranges"),
        (GOOD, "FLASER " + "9" * 5000 + " 1 2", "expected the number of ranges"),
        (GOOD, "FLASER 0 0 0 0 0 0 0", "announces 0 ranges"),
        (GOOD, "FLASER 2 1 2 3 4", "2 fields follow them, expected 0, 6 or 9"),
        (GOOD, GOOD.replace("FLASER 5", "FLASER 4"), "10 fields follow"),
        (GOOD, GOOD.replace("2.50", "2,50"), "expected numbers for ranges, got '2,50'"),
        (GOOD, GOOD.replace("2.50", "2_50"), "expected numbers for ranges, got '2_50'"),
        (GOOD, GOOD.replace("0.500000", "nan"), "expected metres and radians for the laser"),
        (GOOD, GOOD.replace("2.000000", "1e300"), "expected metres and radians for the laser"),
        (GOOD, GOOD.replace("1.000000 robot", "nan robot"), "expected seconds for the time"),
        (GOOD, "FLAZER 5 1 2 3 4 5", "expected a line of a CARMEN log, got 'FLAZER'"),
        (GOOD, "PARAM robot_frontlaser_offset wide", "numbers for robot_frontlaser_offset"),
        (GOOD, "PARAM robot_frontlaser_offset", "expected x, y, heading"),
        (GMAPPING, "SM_UPDATE 2 0 0 0 1", "announces 2 particles, but 1 fields follow"),
        (GMAPPING, "SM_UPDATE 1 0 0 0 nan", "expected the weight of a particle, got none"),
        (GMAPPING, "SM_UPDATE 1 0 inf 0 1", "metres and radians for the heaviest particle"),
        (GMAPPING, "LASER_READING 1 1 0 0 0", "expected 5 fields and 1 ranges, got 5 in all"),
        (GMAPPING, "PARAM maxrange 0", "expected metres for maxrange, got '0'"),
        (GMAPPING, "PARAM maxrange", "expected numbers for maxrange"),
        (GMAPPING, "FLASER 1 1", "a line of GMapping, such as LASER_READING, got 'FLASER'"),
        (DPSLAM, "Laser 1 2 3", "expected 1 fields and 1 ranges, got 3 in all"),
        (DPSLAM, "Odometry 1 2", "expected 3 fields, got 2 in all"),
        (DPSLAM, "Sonar 1 2", "such as Odometry or Laser, got 'Sonar'"),
        (WEAN, WEAN.splitlines()[1].replace("151 ", "", 1), "7 fields and 180 ranges, got 186"),
        (WEAN, "P 0.0 0 0 1", "a line of Wean Hall, such as L, got 'P'"),
        (WEAN, WEAN.splitlines()[1].replace("151 ", "x ", 1), "numbers for ranges, got 'x'"),
        (G2O, "VERTEX_SE2 x 0 0 0", "expected numbers for the vertex, got 'x'"),
        (G2O, "EDGES 0 1", "expected a line of a g2o graph, got 'EDGES'"),
        (CORESLAM, CORESLAM.splitlines()[0].replace("1500 ", "", 1), "683 ranges, got 706 in all"),
        (CORESLAM, CORESLAM.splitlines()[0].replace(" 29221 ", " -1e13 ", 1), "the ticks of"),
        (HOKUYO, "x 1", "expected a number for the urg, got 'x'"),
        (HOKUYO, "1000 13", "expected an angle within two turns, got '13.0'"),
        (SICK, "1,2", "announces 2 ranges, but 0 fields follow"),
        (SICK, SICK.splitlines()[0] + ", 1", "3 fields and 181 ranges, got 185 in all"),
        (CSV, "x,1,0,0", "a number for the angle, got 'x'"),
        (CSV, "800,1,0,0", "an angle within two turns, got '800.0'"),
        (CSV, "1", "expected 4 fields, got 1"),
        (CSV, "1,x,0,0", "a number for the range, got 'x'"),
        (RPLIDAR, "theta: 12.3", "expected a beam, new,angle_deg_cw,range_mm"),
        (LD19, "stamp(ns):1,angle:12.3,distance(mm", "expected a beam, time_ns"),
    ],
)  # fmt: skip
def test_damaged_lines_are_named_and_may_be_skipped(path, sample, line, reason):
    """Two stand before a good line: the first ends the reading, or both are left out."""
    lines = sample.splitlines()
    path.write_text("\n".join([*lines, line, line, lines[-1]]))
    with pytest.raises(LogError) as caught:
        readers.read(path)
    number = len(lines) + 1
    assert caught.value.line == number and reason in caught.value.reason
    assert f"{path}, line {number}: " in str(caught.value)
    assert readers.read(path, on_error="skip").skipped == (2, str(caught.value))


@pytest.mark.parametrize("first", ["1.5 2.5", "laser 0", "VERTEX2 0 1 2 3", "what is this"])
def test_a_damaged_first_line_does_not_decide_the_format(path, first):
    path.write_text(f"{first}\n{GOOD}\n{GOOD}\n")
    log = readers.read(path, on_error="skip")
    assert len(log) == 2 and log.skipped.lines == 1


# ------------------------------------------------------------------------------ bounds
@pytest.mark.parametrize("start", [b"", b"FLASER 400000000 ", GOOD.encode() + b"\nFLASER 9 "])
def test_endless_lines_are_refused_before_they_are_in_memory(path, start):
    """200 MB of one line, packed into 200 kB: reading it whole would fill the machine."""
    path.write_bytes(gzip.compress(start) + 200 * gzip.compress(b"1 " * 500_000))
    tracemalloc.start()
    for on_error in ("raise", "skip"):
        with pytest.raises(LogError, match=r"longer than 1048576 bytes|unpacks to more than"):
            readers.read(path, on_error=on_error)
    assert tracemalloc.get_traced_memory()[1] < 20e6
    tracemalloc.stop()


LONG = b"FLASER 2 1 81.83 0 0 0 0 0 0\nSYNC " + b"x" * 2000 + b"\n"


@pytest.mark.parametrize("bomb", [b"\n" * 2_000_000, LONG * 3000, b"#\n" * 500_000])
def test_bombs(path, bomb):
    """Catches time or memory out of proportion to the file."""
    path.write_bytes(gzip.compress(bomb))
    begun = time.process_time()
    for on_error in ("raise", "skip"):
        with pytest.raises(LogError, match=r"in a row|unpacks to more"):
            readers.read(path, on_error=on_error)
    assert time.process_time() - begun < 60


# ------------------------------------------------------------------------------- files
def test_what_is_no_file_is_named(tmp_path):
    """Pipes would hang, links lead in a circle, and there are names that no file can have."""
    (tmp_path / "a.log").symlink_to(tmp_path / "b.log")
    (tmp_path / "b.log").symlink_to(tmp_path / "a.log")
    for folder in ("linked", "piped"):
        (tmp_path / folder).mkdir()
    (tmp_path / "linked" / "SICK_FRONT.csv").symlink_to(tmp_path / "a.log")
    os.mkfifo(tmp_path / "piped" / "SICK_FRONT.csv")
    os.mkfifo(tmp_path / "pipe.log")
    reasons = {
        tmp_path: "holds no log, expected",
        tmp_path / "missing.log": "does not exist",
        tmp_path / "a.log": "cannot be read",
        tmp_path / "linked": "cannot be read",
        tmp_path / "piped": "no regular file",
        tmp_path / "pipe.log": "is no file",
        tmp_path / ("x" * 300): "cannot be read",
        "a\0b": "has no NUL",
    }
    for path, reason in reasons.items():
        with pytest.raises(LogError, match=reason):
            readers.read(path)
        for other in (read_trajectory, read_segments):
            with pytest.raises(LogError):
                other(path)
    for bad in (None, 3, b"\xff"):
        with pytest.raises(ValueError, match="path"):
            readers.read(bad)


# ---------------------------------------------------------------------------- mutation
@pytest.mark.parametrize("times", [1, slow(27)])
@pytest.mark.parametrize("name", [*TARGETS, *BAGS])
def test_nothing_but_log_errors_comes_out_of_damaged_files(name, times, tmp_path):
    """Each mutant is refused, or sound whether damage is skipped or not; some of each there are."""
    dear = {"coreslam": 3, "coreslam_13": 3} | dict.fromkeys((*RAWSEEDS, *BAGS), 2)
    rng, target, ends = random.Random(f"{SEED} {name}"), (TARGETS | BAGS)[name], set()
    for number in range(times * MUTANTS // dear.get(name, 1)):
        try:
            ends.update(target(tmp_path, rng))
        except Exception as fault:
            fault.add_note(f"mutant {number} of {name}, SEGMAP_SEED={SEED}")
            raise
    assert any(end.startswith("LogError") for end in ends)
    assert any(end.startswith("read") for end in ends) or name in ("npz", "segments.npz", "map.npz")
