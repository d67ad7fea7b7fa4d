"""Sweeps that are stopped and taken up again, and the files of records."""

import json
import os
import signal
import subprocess
import sys
import textwrap
import time
import types
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from math import radians
from pathlib import Path

import numpy as np
import pytest
from sweep_samples import GRIDS, HALL, MAPS, NAMES, keep_all, slow_start, without_seconds

from segmap import SegmentMap
from segmap.experiments import Record, Records, sweep


@pytest.fixture(scope="module")
def expected():
    return sweep(MAPS, NAMES, GRIDS, filters=(None, 0.10))


# ------------------------------------------------------------------ stopped, and taken up again


def test_a_sweep_goes_on_where_it_was_stopped(tmp_path, expected):
    """Catches a second beginning, and records that a file gives back changed."""
    path = tmp_path / "runs.csv"
    half = sweep({"hall": HALL}, NAMES, GRIDS, filters=(None, 0.10), records=path)
    seen = []
    found = sweep(
        MAPS,
        NAMES,
        GRIDS,
        filters=(None, 0.10),
        records=path,
        progress=lambda done, total, record: seen.append((done, total)),
    )
    assert found[:8] == half and without_seconds(found) == without_seconds(expected)
    assert seen == [(done, 16) for done in range(8, 17)]
    assert Records.read(path) == found


def test_a_stop_by_hand_keeps_what_is_finished_and_cancels_the_rest(tmp_path):
    """Catches pending runs that go on, and finished ones that nobody writes down."""
    path, started = tmp_path / "runs.csv", []

    def method(map, *, number: int = 0):
        started.append(number)
        time.sleep(0.02)
        return keep_all(map)

    def stop(done, total, record):
        if done == 3:
            raise KeyboardInterrupt

    with ThreadPoolExecutor(1) as pool, pytest.raises(KeyboardInterrupt):
        grids = {"mine": {"number": list(range(50))}}
        sweep({"hall": HALL}, {"mine": method}, grids, executor=pool, records=path, progress=stop)
    numbers = [r.thresholds["number"] for r in Records.read(path)]
    assert numbers[:3] == [0, 1, 2] and len(set(started)) < 10
    assert set(numbers) <= set(started)


def test_an_error_keeps_what_is_finished(tmp_path):
    path = tmp_path / "runs.csv"
    with pytest.raises(ValueError, match="tolerance=-1"):
        sweep({"hall": HALL}, ["fusion"], {"fusion": {"tolerance": [0.1, -1]}}, records=path)
    assert [r.thresholds for r in Records.read(path)] == [{"tolerance": 0.1}]


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
    here = str(Path(__file__).parent)
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
    assert [r.thresholds["wait"] for r in Records.read(path)] == [0.0, 0.001]
    whole = path.read_bytes()
    path.write_bytes(whole + b"hall,mine,wait=0.0")  # as if it had been killed while it wrote
    seen = []
    found = sweep(
        {"hall": HALL},
        {"mine": slow_start},
        {"mine": {"wait": [0.0, 0.001, 0.002]}},
        records=path,
        progress=lambda done, total, record: seen.append(done),
    )
    assert seen == [2, 3] and len(found) == 3
    assert path.read_bytes().startswith(whole) and Records.read(path) == found


def test_a_changed_map_is_not_resumed(tmp_path):
    """Catches records of an old map under the name of the new one."""
    path = tmp_path / "runs.csv"
    sweep({"hall": HALL}, ["fusion"], records=path)
    moved = SegmentMap(HALL.segments + 1e-6, HALL.scan)
    with pytest.raises(ValueError, match="records of another map called 'hall'"):
        sweep({"hall": moved}, ["fusion"], records=path)
    rescanned = SegmentMap(HALL.segments, HALL.scan + 1)
    with pytest.raises(ValueError, match="another map"):
        sweep({"hall": rescanned}, ["fusion"], records=path)


def test_other_thresholds_and_filters_are_other_runs(tmp_path):
    """Catches a key that forgets one of them, and one that hangs on the order of thresholds."""
    path, seen = tmp_path / "runs.csv", []

    def count(done, total, record):
        seen.append(record is not None)

    one, two = {"distance": 0.1, "angle": 0.2}, {"angle": 0.2, "distance": 0.1}
    for grid, least in (
        ([one], None),
        ([two], None),
        ([one], 0.10),
        ([{"distance": 0.1}], None),
    ):
        sweep(
            {"hall": HALL},
            ["hybrid"],
            {"hybrid": grid},
            filters=(least,),
            records=path,
            progress=count,
        )
    assert seen == [False, True, False, False, True, False, True]


@pytest.mark.parametrize("text", ["", "map,meth"])
def test_a_file_stopped_within_its_head_is_begun_again(tmp_path, text):
    path = tmp_path / "runs.csv"
    path.write_text(text)
    assert sweep({"hall": HALL}, ["fusion"], records=path) == Records.read(path)


@pytest.mark.parametrize("text", ["a,b\n1,2\n3", "a poem", "\n"])
def test_a_file_of_something_else_is_left_alone(tmp_path, text):
    """Catches a sweep that mends, and so destroys, a file that is not its own."""
    path = tmp_path / "poem.csv"
    path.write_text(text)
    with pytest.raises(ValueError, match=r"poem.csv, line 1: expected the head"):
        sweep({"hall": HALL}, ["fusion"], records=path)
    assert path.read_text() == text


# ------------------------------------------------------------------ records


def test_files_give_back_what_they_got(tmp_path, expected):
    """Catches rounding, lost thresholds, names with commas and quotes."""
    path = tmp_path / "runs.csv"
    odd = replace(expected[0], map='a "hall", with =;', thresholds={"a": 1, "b": 1e-17, "c": 2.0})
    records = Records([*expected, odd])
    records.write(path)
    assert Records.read(path) == records
    assert {type(v) for v in Records.read(path)[-1].thresholds.values()} == {int, float}
    assert [p.name for p in tmp_path.iterdir()] == ["runs.csv"]


def test_numbers_of_numpy_are_written_as_numbers(tmp_path):
    """Catches `np.float64(0.17)` in a file, which nobody can read back."""
    record = Record("hall", "hybrid", {"angle": np.radians(10)}, None, 9, 8, 0.1, 0.9, 0.5)
    Records([record]).write(tmp_path / "runs.csv")
    assert Records.read(tmp_path / "runs.csv")[0] == record


def test_writing_is_whole_or_not_at_all(tmp_path, expected, monkeypatch):
    """Catches a file that is emptied before the new one is there."""
    path = tmp_path / "runs.csv"
    expected[:1].write(path)
    before = path.read_bytes()

    def full(self, target):
        raise OSError("no space left")

    monkeypatch.setattr("pathlib.Path.replace", full)
    with pytest.raises(OSError, match="no space"):
        expected.write(path)
    assert path.read_bytes() == before and [p.name for p in tmp_path.iterdir()] == ["runs.csv"]


@pytest.mark.parametrize(
    ("old", "new", "line"), [("0.06", "0,06", 3), ("0.02", "open()", 2), (",60,", ",x,", 3)]
)
def test_a_damaged_line_is_named(tmp_path, old, new, line):
    """Catches damage that passes, and thresholds that are run as code."""
    path = tmp_path / "runs.csv"
    record = Record("hall", "fusion", {"tolerance": 0.02}, None, 60, 20, 0.5, 0.9, 0.1, "ab")
    Records([record, replace(record, thresholds={"tolerance": 0.06})]).write(path)
    lines = path.read_text().splitlines(keepends=True)
    lines[line - 1] = lines[line - 1].replace(old, new)
    path.write_text("".join(lines))
    with pytest.raises(ValueError, match=rf"runs.csv, line {line}: expected a record, got"):
        Records.read(path)


def test_select(expected):
    """Catches a filter that is taken for none, and thresholds compared digit by digit."""
    assert len(expected.select()) == 16
    assert len(expected.select(map="hall", method="fusion")) == 4
    assert {r.filtered for r in expected.select(filtered=True)} == {0.10}
    assert {r.filtered for r in expected.select(filtered=False)} == {None}
    assert {r.filtered for r in expected.select(filtered=0.1 + 1e-12)} == {0.10}
    assert len(expected.select(filtered=0.2)) == 0
    assert {r.method for r in expected.select(tolerance=0.06 + 1e-12)} == {"fusion"}
    assert len(expected.select(distance=0.3, angle=radians(10))) == 4


def test_sequence(expected):
    assert expected[-1] is list(expected)[15] and isinstance(expected[2:4], Records)
    assert expected[2:4][1] == expected[3] and expected[0] in expected


def test_what_a_notebook_shows(expected):
    """Catches a page of 264 rows, and names taken for HTML."""
    many = Records([*expected, *expected, replace(expected[0], map="<hall>")])
    shown = many._repr_html_()
    assert shown.count("<tr>") == 21 and "and 13 more" in shown
    assert "&lt;hall&gt;" in many[-1:]._repr_html_()
    assert repr(many).endswith("and 13 more") and repr(Records()) == "no records"
    assert "tolerance 0.02" in repr(expected) and "0.10 m" in repr(expected)
    assert "seconds" not in repr(expected.table("map", "quality"))


def test_dictionaries_can_be_stored_as_json(expected):
    """Catches numbers of numpy, which json refuses."""
    assert json.loads(json.dumps(expected.to_dicts()))[0]["thresholds"] == expected[0].thresholds


def test_numbers_of_numpy_become_pythons_own():
    grid = {"fusion": {"tolerance": np.array([0.05, 0.06])}}
    found = sweep({"hall": HALL}, ["fusion"], grid)
    assert [type(r.thresholds["tolerance"]) for r in found] == [float, float]


def test_a_frame_has_a_column_for_each_threshold(expected, monkeypatch):
    """Catches dictionaries in cells; pandas itself need not be there."""
    frame = types.SimpleNamespace(DataFrame=lambda rows: rows)
    monkeypatch.setitem(sys.modules, "pandas", frame)
    first = expected.to_frame()[0]
    assert first["distance"] == 0.1 and first["n_before"] == 70 and "thresholds" not in first


def test_without_pandas_the_error_says_what_to_do(expected, monkeypatch):
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(ImportError, match="pip install pandas"):
        expected.to_frame()
