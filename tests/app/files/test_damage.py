"""Damaged and hostile files: clear errors, in bounded memory and time, nothing but `LogError`."""

import gzip
import random
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
from segmap.readers import LogError

GOOD = flaser((1, 2, 0.5), (0, 0, 0), 1.0)


@pytest.fixture
def path(tmp_path):
    return tmp_path / "some.log"


@pytest.mark.parametrize(
    ("sample", "line", "reason"),
    [
        (GOOD, "FLASER 1000000000 1 2 3", "announces 1000000000 ranges, but 3 fields follow"),
        (GOOD, "FLASER 0 0 0 0 0 0 0", "announces 0 ranges"),
        (GOOD, "FLASER 2 1 2 3 4", "2 fields follow them, expected 0, 6 or 9"),
        (GOOD, GOOD.replace("2.50", "2_50"), "expected numbers for ranges, got '2_50'"),
        (GOOD, GOOD.replace("0.500000", "nan"), "metres and radians for the laser"),
        (GOOD, "PARAM robot_frontlaser_offset wide", "numbers for robot_frontlaser_offset"),
        (GMAPPING, "SM_UPDATE 2 0 0 0 1", "announces 2 particles, but 1 fields follow"),
        (GMAPPING, "SM_UPDATE 1 0 0 0 nan", "the weight of a particle, got none"),
        (GMAPPING, "LASER_READING 1 1 0 0 0", "expected 5 fields and 1 ranges"),
        (DPSLAM, "Odometry 1 2", "expected 3 fields"),
        (WEAN, WEAN.splitlines()[1].replace("151 ", "", 1), "7 fields and 180 ranges"),
        (G2O, "VERTEX_SE2 x 0 0 0", "numbers for the vertex"),
        (CORESLAM, CORESLAM.splitlines()[0].replace("1500 ", "", 1), "683 ranges, got 706"),
        (HOKUYO, "x 1", "a number for the urg"),
        (SICK, SICK.splitlines()[0] + ", 1", "3 fields and 181 ranges"),
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


# ------------------------------------------------------------------------------ bounds
@pytest.mark.parametrize("start", [b"", GOOD.encode() + b"\nFLASER 9 "])
def test_endless_lines_are_refused_before_they_are_in_memory(path, start):
    """200 MB of one line, packed into 200 kB: reading it whole would fill the machine."""
    path.write_bytes(gzip.compress(start) + 200 * gzip.compress(b"1 " * 500_000))
    tracemalloc.start()
    for on_error in ("raise", "skip"):
        with pytest.raises(LogError, match=r"longer than 1048576 bytes|unpacks to more than"):
            readers.read(path, on_error=on_error)
    assert tracemalloc.get_traced_memory()[1] < 20e6
    tracemalloc.stop()


# ---------------------------------------------------------------------------- mutation
@pytest.mark.parametrize("times", [1, slow(45)])
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
