"""Damaged files: clear errors, in bounded memory and time, and nothing but `LogError`.

The last test mutates lines of every format: `MUTANTS` damaged files in all, each read twice (a
quarter of them in `make test`).
"""

import gzip
import os
import tracemalloc
import zipfile

import pytest
from conftest import shared_file, slow
from damage import COUNTS, IN_FOLDER, MUTANTS, NEWLY, SAMPLES, check
from log_samples import CARMEN, RAWSEEDS, flaser

from segmap import readers
from segmap.readers import LogError

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
        (b"FLASER\n", "line 1: expected the number of ranges, got ''"),
        (b"PARAM robot_length 1\n", "holds no scan"),
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
    ("line", "reason"),
    [
        ("FLASER 1000000000 1 2 3", "announces 1000000000 ranges, but 3 fields follow"),
        ("FLASER " + "9" * 5000 + " 1 2", "expected the number of ranges"),
        ("FLASER 0 0 0 0 0 0 0", "announces 0 ranges"),
        ("FLASER -2 1 2", "expected the number of ranges, got '-2'"),
        ("FLASER 2 1 2 3 4", "2 fields follow them, expected 0, 6 or 9"),
        (GOOD.replace("FLASER 5", "FLASER 4"), "10 fields follow"),
        (GOOD.replace("FLASER 5", "FLASER 6"), "8 fields follow"),
        (GOOD.replace("2.50", "2,50"), "expected numbers for ranges, got '2,50'"),
        (GOOD.replace("2.50", "2_50"), "expected numbers for ranges, got '2_50'"),
        (GOOD.replace("0.500000", "inf"), "expected metres and radians for the laser"),
        (GOOD.replace("0.500000", "nan"), "expected metres and radians for the laser"),
        (GOOD.replace("2.000000", "1e300"), "expected metres and radians for the laser"),
        (GOOD.replace("1.000000 robot", "nan robot"), "expected seconds for the time"),
        ("FLAZER 5 1 2 3 4 5", "expected a line of a CARMEN log, got 'FLAZER'"),
        ("PARAM robot_frontlaser_offset wide", "expected numbers for robot_frontlaser_offset"),
        ("PARAM robot_frontlaser_offset", "expected x, y, heading"),
    ],
)
def test_damaged_lines_are_named_and_may_be_skipped(path, line, reason):
    path.write_text(f"{GOOD}\n{line}\n{GOOD}\n{line}\n")
    with pytest.raises(LogError) as caught:
        readers.read(path)
    assert caught.value.line == 2 and reason in caught.value.reason
    assert f"{path}, line 2: " in str(caught.value)
    log = readers.read(path, on_error="skip")
    assert len(log) == 2 and log.skipped.lines == 2
    assert log.skipped.reason == str(caught.value)


@pytest.mark.parametrize("first", ["1.5 2.5", "laser 0", "VERTEX2 0 1 2 3", "what is this"])
def test_a_damaged_first_line_does_not_decide_the_format(path, first):
    path.write_text(f"{first}\n{GOOD}\n{GOOD}\n")
    log = readers.read(path, on_error="skip")
    assert len(log) == 2 and log.skipped.lines == 1


def test_nothing_skipped_is_false(path):
    path.write_text(CARMEN)
    assert not readers.read(path, on_error="skip").skipped


def test_a_truncated_gzip_is_noticed_and_its_whole_lines_may_be_kept(path):
    """A reader that stops quietly at the break loses the end of a log unseen."""
    lines = [flaser((k, 0, 0), (0, 0, 0), k + 0.123) for k in range(3000)]
    path.write_bytes(gzip.compress("\n".join(lines).encode())[:-4000])
    with pytest.raises(LogError, match="packed file is broken or cut short"):
        readers.read(path)
    log = readers.read(path, on_error="skip")
    assert 1000 < len(log) < 3000 and "cut short" in log.skipped.reason


def test_a_gzip_with_a_wrong_sum_is_noticed(path):
    packed = bytearray(gzip.compress(CARMEN.encode()))
    packed[-6] ^= 255
    path.write_bytes(packed)
    with pytest.raises(LogError, match="packed file is broken"):
        readers.read(path)


def test_a_zip_holds_one_log(path):
    with zipfile.ZipFile(path, "w") as packed:
        packed.writestr("__MACOSX/._some.log", "junk")
        packed.writestr("some.log", CARMEN)
    assert len(readers.read(path)) == 2


@pytest.mark.parametrize("start", [b"", b"FLASER 400000000 ", GOOD.encode() + b"\nFLASER 9 "])
@pytest.mark.parametrize("on_error", ["raise", "skip"])
def test_endless_lines_are_refused_before_they_are_in_memory(path, start, on_error):
    """200 MB of one line, packed into 200 kB: reading it whole would fill the machine."""
    path.write_bytes(gzip.compress(start) + 200 * gzip.compress(b"1 " * 500_000))
    tracemalloc.start()
    with pytest.raises(LogError, match="longer than 1048576 bytes"):
        readers.read(path, on_error=on_error)
    assert tracemalloc.get_traced_memory()[1] < 20e6
    tracemalloc.stop()


@pytest.mark.parametrize("name", ["", "missing.log"])
def test_what_is_no_file_is_named(tmp_path, name):
    with pytest.raises(LogError, match=r"holds no log, expected|does not exist"):
        readers.read(tmp_path / name)


def test_files_that_may_not_be_read_are_named(path):
    path.write_text(CARMEN)
    path.chmod(0)
    if os.access(path, os.R_OK):
        pytest.skip("this user may read everything")
    with pytest.raises(LogError, match="Permission denied"):
        readers.read(path)


# --- mutation -------------------------------------------------------------------------------------


@pytest.mark.parametrize("part", [0.25, slow(1.0)])
@pytest.mark.parametrize("name", SAMPLES)
def test_nothing_but_log_errors_comes_out_of_damaged_files(tmp_path, name, part):
    path = tmp_path / name
    path.write_bytes(SAMPLES[name])
    check(path, path, name, int(part * COUNTS[name]))


@pytest.mark.slow
@pytest.mark.parametrize("name", NEWLY)
def test_ten_thousand_of_each_new_format(tmp_path, name):
    path = tmp_path / name
    path.write_bytes(SAMPLES[name])
    check(path, path, name, 10_000)


@pytest.mark.parametrize("part", [0.25, slow(1.0)])
@pytest.mark.parametrize("name", RAWSEEDS)
def test_nothing_but_log_errors_comes_out_of_damaged_folders(tmp_path, name, part):
    for file, content in RAWSEEDS.items():
        if file == name or file != "SICK_FRONT.csv":  # beside it the Hokuyo is not read
            (tmp_path / file).write_bytes(content.encode())
    check(tmp_path, tmp_path / name, name, int(part * IN_FOLDER))


def test_mutants_are_many():
    """The number that the closing note states."""
    assert MUTANTS >= 10_000  # `make fuzz` reads 100 000


@pytest.mark.parametrize("name", ["intel.log.gz", "urg04lx-exp1.dat.gz"])
def test_real_logs_broken_anywhere_are_read_up_to_there(name, tmp_path):
    data = shared_file(f"data/{name}").read_bytes()
    (tmp_path / "cut").write_bytes(data[: len(data) // 2])
    whole, half = (
        readers.read(p, on_error="skip") for p in (shared_file(f"data/{name}"), tmp_path / "cut")
    )
    assert not whole.skipped and half.skipped
    assert 0.3 * len(whole) < len(half) < 0.7 * len(whole)
