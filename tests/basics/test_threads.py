"""Work on all cores: the same results as on one, in the same order."""

import signal
import subprocess
import sys
import threading
import time
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from dataclasses import replace

import numpy as np
import pytest

from segmap import load, threads
from segmap.extraction import build_map, extract_polylines
from segmap.metrics import errors
from segmap.poses import transform
from segmap.scans import Log
from segmap.threads import THREADS, in_threads, shares


@pytest.fixture
def three(monkeypatch):
    monkeypatch.delenv(THREADS, raising=False)
    monkeypatch.setattr(threads, "cores", lambda: 3)


def test_what_is_found_comes_in_the_order_of_the_things(three):
    """The order in which threads end: here the first waits for the last."""
    last = threading.Event()

    def work(thing: int) -> int:
        assert thing > 0 or last.wait(10)
        if thing == 2:
            last.set()
        return thing * thing

    assert in_threads(work, range(3)) == [0, 1, 4]
    assert in_threads(work, []) == []


def test_one_core_or_one_thing_needs_no_thread(monkeypatch, three):
    here = threading.get_ident()
    assert in_threads(lambda _: threading.get_ident(), [1]) == [here]
    before = threading.active_count()
    for count in ("2", "3"):
        monkeypatch.setenv(THREADS, count)
        assert here not in in_threads(lambda _: threading.get_ident(), [1, 2])
        assert threading.active_count() == before  # none stays behind
    monkeypatch.delenv(THREADS)
    monkeypatch.setattr(threads, "cores", lambda: 1)
    assert in_threads(lambda _: threading.get_ident(), [1, 2]) == [here, here]


def test_workers_of_several_have_one_thread(monkeypatch, three):
    """Threads inside threads, or in each process of a sweep: more of them than there are cores."""
    assert threads.threads() == 3
    assert in_threads(lambda _: threads.threads(), [1, 2]) == [1, 1]
    for kind in (ThreadPoolExecutor, ProcessPoolExecutor):
        with kind(1) as pool:
            assert pool.submit(threads.threads).result(60) == 1


def test_the_number_of_threads_is_what_the_environment_says(monkeypatch, three):
    monkeypatch.setenv(THREADS, "2")
    assert threads.threads() == 2
    assert [each.tolist() for each in shares(np.arange(5), 2)] == [[0, 2, 4], [1, 3]]
    assert len(shares(np.arange(5), 3)) == len(shares(np.arange(0), 3)) == 1
    monkeypatch.setenv(THREADS, "two")
    with pytest.raises(ValueError, match=f"{THREADS} must be a whole number of at least 1, got"):
        threads.threads()


@pytest.mark.parametrize("count", ["1", "3"])
def test_a_map_is_what_each_scan_gives_and_its_quality_what_each_segment(monkeypatch, count):
    """Catches blocks out of order, and scans that see each other's points: equal bit for bit."""
    monkeypatch.setenv(THREADS, count)
    room = load("room")
    scans = [replace(s, sensor_pose=(0.1, k, 0.3)) for k, s in enumerate([*room] * 6)]
    poses = np.tile(room.truth, (6, 1)) + np.arange(len(scans))[:, None]
    poses[[0, 40]] = np.nan
    map = build_map(Log("six rounds", scans), poses, min_points=3)
    own = [extract_polylines(scan.points(), min_points=3) for scan in scans]
    own = [transform(pose, s) for pose, s in zip(poses, own, strict=True) if pose[0] == pose[0]]
    np.testing.assert_array_equal(map.segments, np.concatenate(own))
    assert np.bincount(map.scan)[np.isfinite(poses[:, 0])].tolist() == [len(s) for s in own]
    few, after = map[:1500], map[::70]
    each = [errors(segment[None], after)[0] for segment in few.segments]
    many = np.tile(few.segments, (6, 1, 1))  # enough for two threads
    np.testing.assert_array_equal(errors(many, after), np.tile(each, 6))


@pytest.mark.skipif(sys.platform == "win32", reason="no interrupt for one process")
def test_an_interrupt_ends_the_work_at_once():
    """Control-C that all work which has not begun outlives."""
    code = (
        "import signal, time; from segmap.threads import in_threads\n"
        "signal.signal(signal.SIGINT, signal.default_int_handler)\n"
        "in_threads(lambda k: print(k, flush=True) or time.sleep(0.2), range(999))"
    )
    process = subprocess.Popen(
        [sys.executable, "-c", code], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL
    )
    with process:
        assert process.stdout.read(1) in (b"0", b"1")  # the lines of two threads may run together
        process.send_signal(signal.SIGINT)
        begun = time.monotonic()
        assert process.wait(20) != 0
    assert time.monotonic() - begun < 10  # .2 s where the machine is quiet


def test_two_objects_are_computed_at_once():
    """Catches one lock for all objects: threads wait."""
    both = threading.Barrier(2, timeout=20)

    class Slow:
        @threads.computed
        def place(self):
            return both.wait()

    work = [threading.Thread(target=lambda: Slow().place) for _ in range(2)]
    for thread in work:
        thread.start()
    for thread in work:
        thread.join()
    assert not both.broken
