"""Sweeps that are stopped and taken up again, and the files of runs."""

import os
import signal
import subprocess
import sys
import textwrap
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from pandas.testing import assert_frame_equal
from sweep_samples import GRIDS, HALL, MAPS, NAMES, keep_all, notes, slow_start, without_seconds

from segmap import SegmentMap
from segmap.experiments import (
    good_maps,
    load_records,
    load_walls,
    read_records,
    select,
    sweep,
    thresholds_of,
    write_records,
)
from segmap.readers import data_file


@pytest.fixture(scope="module")
def expected():
    return sweep(MAPS, NAMES, GRIDS, filters=(None, 0.10))


def run(**changed):
    """A frame of one run."""
    row = {"map": "hall", "method": "fusion", "tolerance": 0.02, "filtered": 0.0}
    row |= {"n_before": 60, "n_after": 20, "reduction": 0.5, "quality": 0.9, "seconds": 0.1}
    return pd.DataFrame([row | {"digest": "ab"} | changed])


# ------------------------------------------------------------------ stopped, and taken up again


def test_a_sweep_goes_on_where_it_was_stopped(tmp_path, expected):
    """Catches a second beginning, and runs that a file gives back changed."""
    path, bar, options = tmp_path / "runs.csv", notes(), {"filters": (None, 0.10)}
    half = sweep({"hall": HALL}, NAMES, GRIDS, records=path, **options)
    found = sweep(MAPS, NAMES, GRIDS, records=path, progress=bar, **options)
    assert_frame_equal(found[:8], half)
    assert_frame_equal(without_seconds(found), without_seconds(expected))
    assert_frame_equal(read_records(path), found)
    assert bar.seen == list(range(8, 17))


def test_a_stop_by_hand_keeps_what_is_finished_and_cancels_the_rest(tmp_path):
    """Catches pending runs that go on, and finished ones that nobody writes down."""
    path, started = tmp_path / "runs.csv", []

    def method(map, *, number: int = 0):
        started.append(number)
        time.sleep(0.02)
        return keep_all(map)

    with ThreadPoolExecutor(1) as pool, pytest.raises(KeyboardInterrupt):
        grids, options = {"mine": {"number": list(range(50))}}, {"executor": pool, "records": path}
        sweep({"hall": HALL}, {"mine": method}, grids, progress=notes(3), **options)
    numbers = list(read_records(path)["number"])
    assert numbers[:5] == [0, 1, 2, 3, 4] and len(numbers) <= len(started) < 45


def test_an_error_keeps_what_is_finished(tmp_path):
    """Catches `np.float64(0.1)` in a file as well, which nobody can read back."""
    path, grids = tmp_path / "runs.csv", {"fusion": {"tolerance": np.array([0.1, -1])}}
    with pytest.raises(ValueError, match="tolerance=-1"):
        sweep({"hall": HALL}, ["fusion"], grids, records=path)
    assert list(read_records(path)["tolerance"]) == [0.1]
    for other in (
        SegmentMap(HALL.segments + 1e-6, HALL.scan),
        SegmentMap(HALL.segments, HALL.scan + 1),
    ):
        with pytest.raises(ValueError, match="records of another map called 'hall'"):
            sweep({"hall": other}, ["fusion"], records=path)


KILLED = """
    import sys, time
    sys.path.insert(0, {tests!r})
    from sweep_samples import HALL, slow_start
    from segmap.experiments import sweep
    grids = {{"mine": {{"wait": [0.0, 0.001, 60.0]}}}}
    sweep({{"hall": HALL}}, {{"mine": slow_start}}, grids, records={path!r})
"""


@pytest.mark.skipif(not hasattr(signal, "SIGKILL"), reason="this system has no SIGKILL")
def test_a_killed_process_loses_only_the_run_that_it_was_in(tmp_path):
    """Catches records that wait in a buffer, and a resumption that trusts a torn line."""
    path, code = tmp_path / "runs.csv", tmp_path / "run.py"
    here = str(Path(__file__).parents[1])
    code.write_text(textwrap.dedent(KILLED.format(tests=here, path=str(path))))
    process = subprocess.Popen([sys.executable, str(code)])
    try:
        deadline = time.monotonic() + 60
        while (not path.exists() or path.read_bytes().count(b"\n") < 3) and process.poll() is None:
            assert time.monotonic() < deadline, "the runs did not finish"
            time.sleep(0.02)
    finally:
        os.kill(process.pid, signal.SIGKILL)
        process.wait()
    assert process.returncode == -signal.SIGKILL
    assert list(read_records(path)["wait"]) == [0.0, 0.001]
    whole = path.read_bytes()
    path.write_bytes(whole + b"hall,mine,wait=0.0")  # as if it had been killed while it wrote
    bar, grids = notes(), {"mine": {"wait": [0.0, 0.001, 0.002]}}
    found = sweep({"hall": HALL}, {"mine": slow_start}, grids, records=path, progress=bar)
    assert bar.seen == [2, 3] and len(found) == 3
    assert path.read_bytes().startswith(whole)
    assert_frame_equal(read_records(path), found)


def test_other_thresholds_and_filters_are_other_runs(tmp_path):
    """Catches a key that forgets one of them, and one that hangs on the order of thresholds."""
    path, seen = tmp_path / "runs.csv", []
    one = {"distance": 0.1, "angle": 0.2}
    for row, least in ((one, None), (one, None), (one, 0.10), ({"distance": 0.1}, None)):
        bar, options = notes(), {"filters": (least,), "records": path}
        sweep({"hall": HALL}, ["hybrid"], {"hybrid": [row]}, progress=bar, **options)
        seen.append(bar.seen)
        text = path.read_text()
        path.write_text(text.replace("distance=0.1;angle=0.2", "angle=0.2;distance=0.1"))
    assert seen == [[0, 1], [1], [0, 1], [0, 1]]


@pytest.mark.parametrize("text", ["map,meth", "a poem"])
def test_a_file_cut_within_its_head_is_begun_again_and_another_is_left_alone(tmp_path, text):
    """Catches a sweep that mends, and so destroys, a file that is not its own."""
    path = tmp_path / "runs.csv"
    path.write_text(text)
    if "map,method".startswith(text):
        assert_frame_equal(sweep({"hall": HALL}, ["fusion"], records=path), read_records(path))
        return
    with pytest.raises(ValueError, match=r"runs.csv, line 1: expected the head"):
        sweep({"hall": HALL}, ["fusion"], records=path)
    assert path.read_text() == text


# ------------------------------------------------------------------ files


def test_files_give_back_what_they_got(tmp_path, expected):
    """Catches rounding, lost thresholds, whole numbers made floats, names with commas, quotes."""
    path = tmp_path / "runs.csv"
    unknown = run(quality=np.nan, reduction=np.nan, tolerance=np.inf)
    odd = run(map='a "hall", with =;', a=1, b=1e-17, angle=np.radians(10))
    odd["a"] = odd["a"].astype("Int64")
    frame = pd.concat([expected, unknown, odd], ignore_index=True)
    write_records(frame, path)
    assert_frame_equal(read_records(path), frame, check_like=True)
    assert type(thresholds_of(read_records(path).iloc[-1])["a"]) is int
    assert "np." not in path.read_text() and [p.name for p in tmp_path.iterdir()] == ["runs.csv"]


def test_a_run_on_an_empty_map_has_no_quality_and_is_kept(tmp_path):
    """Catches a filter that leaves nothing, reported as perfect, or run again at each start."""
    walls = SegmentMap([[(0, 0), (0.05, 0)]])
    file = tmp_path / "runs.csv"
    found = sweep({"yard": walls}, ["fusion"], filters=(0.10,), records=file)
    assert np.isnan(found["quality"].item()) and found["n_before"].item() == 0
    again = sweep({"yard": walls}, ["fusion"], filters=(0.10,), records=file)
    pd.testing.assert_frame_equal(found, again)
    pd.testing.assert_frame_equal(found, read_records(file))


#: What is changed in the file of two runs, by what, and in which line.
DAMAGED = [
    *(("0.06", "0,06", 3), ("0.02", "open()", 2), (",0.9,", ",0.9.1,", 3), (",60,", ",6.5,", 2)),
    ("tolerance=0.02", "tolerance", 2),
    ("60,20,0.5,0.9,0.1,ab,,", "", 3),  # cut off by a full disk, and gone on with
]


@pytest.mark.parametrize(("old", "new", "line"), DAMAGED)
def test_a_damaged_line_is_named(tmp_path, old, new, line):
    """Catches damage that passes, in a sweep's file too, which stays as it is."""
    path = tmp_path / "runs.csv"
    write_records(pd.concat([run(), run(tolerance=0.06)]), path)
    lines = path.read_text().splitlines(keepends=True)
    lines[line - 1] = lines[line - 1].replace(old, new)
    path.write_text("".join(lines))
    for read in (read_records, lambda path: sweep({"hall": HALL}, ["fusion"], records=path)):
        with pytest.raises(ValueError, match=rf"runs.csv.* line {line}\b"):
            read(path)
    assert path.read_text() == "".join(lines)


def test_select(expected):
    """Catches a filter that is taken for none, and thresholds compared digit by digit."""
    assert len(select(expected)) == 16
    assert len(select(expected, map="hall", method="fusion")) == 4
    for filtered, found in ((True, {0.1}), (False, {0}), (0.1 + 1e-12, {0.1}), (0.2, set())):
        assert set(select(expected, filtered=filtered)["filtered"]) == found
    assert set(select(expected, tolerance=0.06 + 1e-12)["method"]) == {"fusion"}
    assert len(select(expected, distance=0.3, angle=np.radians(10))) == 4
    near = pd.DataFrame({"tolerance": 0.3 * (1 + np.array([-1.1, -0.9, 0.9, 1.1]) * 1e-9)})
    assert list(select(near, tolerance=0.3).index) == [1, 2], "a part in 10^9, to both sides"


def test_records_by_name():
    """Catches a traceback of paths for a name that is not there, and other tables read as runs."""
    one, every = load_records("malaga"), load_records()
    assert len(data_file("records/malaga.csv").read_text().splitlines()) == 1 + len(one)
    assert {*one["map"]} == {"malaga"} < {"office", "intel"} | {*every["map"]} == {*every["map"]}
    assert len(every[every["map"] == "malaga"]) == len(one)
    with pytest.raises(ValueError, match=r"names must be one of 'fr079', .*, got 'attic'"):
        load_records("attic")


def test_maps_that_are_good_are_counted():
    """Catches noises taken one by one, and maps that are counted twice."""
    runs = [
        ("old", "0", "fusion", "tolerance 0.02", "0011"),
        ("old", "drift", "fusion", "tolerance 0.02", "0000"),
        ("old", "0", "fusion", "tolerance 0.04", "0001"),
        ("old", "drift", "fusion", "tolerance 0.04", "0110"),
        ("new", "0", "fusion", "tolerance 0.02", "00"),
        ("old", "0", "hybrid", "distance 0.2", "1111"),
    ]
    frame = pd.DataFrame(runs, columns=["group", "noise", "method", "thresholds", "all_four"])
    table = good_maps(frame.assign(sensor="SICK", maps=frame["all_four"].str.len()))
    assert list(table.index) == ["hybrid", "fusion"]
    assert list(table.loc["hybrid"]) == ["distance 0.2", 4, 0, 4, 4, 4]
    assert list(table.loc["fusion"]) == ["tolerance 0.04", 1, 2, 3, 4, 10]


def test_judged_maps_are_chosen_by_their_group():
    """Catches digits read as a number."""
    frame = load_walls("fresh")
    assert set(frame["group"]) == {"fresh seeds", "fresh buildings"}
    assert (frame["all_four"].str.len() == frame["maps"]).all() and {8, 10} < set(frame["maps"])
    with pytest.raises(ValueError, match=r"group must be the beginning of one of tuned.*, got 'x"):
        load_walls("x")
