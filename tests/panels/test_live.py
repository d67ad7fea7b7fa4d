"""Live mapping: what comes too fast is left out, and never queued."""

import re
import threading
import time
from dataclasses import replace

import numpy as np
import pytest
from emulated import emulator_threads, needs_terminals, pattern, wait_for
from planned_loops import LOG, Planned, held_back

from segmap import LaserScan, carried, load
from segmap.panels import LivePanel, _live
from segmap.panels._live_picture import Greys
from segmap.sensors import Newest, UrgSensor
from segmap.sensors.emulator import Emulator, furnished_room


@pytest.fixture(scope="module", autouse=True)
def compiled():
    """Loops are compiled before a sensor or a deadline waits for them."""
    LivePanel(load("room")).run(3)


def many(count, seconds=0.0):
    for k in range(count):
        time.sleep(seconds)
        yield LaserScan([1.0], [0.0], time=k)


def test_a_slow_reader_gets_the_newest():
    """Catches a queue: the reader would see scans of seconds ago, and memory would grow."""
    with Newest(many(60, 0.002)) as newest:
        times = []
        for scan in newest:
            times.append(scan.time)
            time.sleep(0.03)
    assert times == sorted(times)
    assert times[-1] == 59
    assert len(times) + newest.skipped == 60
    assert newest.skipped > 10


def test_the_panel_says_found_or_lost():
    """Catches a robot that is lost while the panel goes on as if all were well."""
    panel, scans = LivePanel(load("room")), list(load("room")[:4])
    for scan in scans[:3]:
        panel.take(scan)
    assert re.fullmatch(r"found: \d+% of the scan lies on the map", panel.place.value)
    assert panel.place.style.text_color is None
    for count, words in ((1, "scan"), (2, "scans")):
        panel.take(LaserScan([np.inf], [0.0]))
        lost = "LOST: go back to where the map is, and turn slowly: 0% of the scan lies on the map"
        assert panel.place.value == f"{lost}; {count} {words} lost on this map"
        assert panel.place.style.text_color is not None
    panel.loops.value = False
    panel.take(scans[3])
    assert panel.place.value == "found: 100% of the scan lies on the map"


@needs_terminals
def test_start_and_stop():
    """The buttons: the map grows, the sensor is left with its laser off, no thread stays."""
    pytest.importorskip("serial", reason="the driver opens ports with pyserial")
    room = furnished_room()
    with Emulator(room) as emulator, UrgSensor(emulator.port) as sensor:
        panel = LivePanel(sensor, start=room.pose(0))
        panel.start.click()
        wait_for(lambda: panel.taken >= 5)
        panel.stop.click()
        assert panel.taken >= 5
        assert panel.state.value == "stopped"
        assert not emulator.unit.laser
        assert "live map" not in [thread.name for thread in threading.enumerate()]
        first = panel.taken
        panel.start.click()
        wait_for(lambda: panel.taken > first + 3)  # it does not stop at once
        panel.stop.click()
        leaves = panel.map.leaves()
        assert np.ptp(leaves.y[leaves.occ > 0]) > 3.5
    assert emulator_threads() == []


@needs_terminals
def test_the_panel_tells_of_a_lost_sensor():
    """Catches an error that dies with its thread."""
    pytest.importorskip("serial", reason="the driver opens ports with pyserial")
    with Emulator(pattern) as emulator, UrgSensor(emulator.port) as sensor:
        panel = LivePanel(sensor)
        panel.start.click()
        wait_for(lambda: panel.taken)
        emulator.stop()
        wait_for(lambda: "the sensor is gone" in panel.state.value)
        panel.stop.click()
        assert panel.taken and "live map" not in [each.name for each in threading.enumerate()]


def planned_by(tracking, closing):
    """A graph that closes loops at two scans, where a way may be long enough for one."""
    return Planned((5, 9) if closing.min_path < 100 else ())


@pytest.fixture
def planned(monkeypatch):
    """The panel's graph closes loops at two scans; the thread that draws anew waits for a sign."""
    monkeypatch.setattr(carried, "LiveGraph", planned_by)
    return held_back(monkeypatch)


def test_a_loop_draws_the_map_anew(planned):
    """The old map is shown until the new one is ready; then every cell is that of the new one."""
    panel, old = LivePanel(LOG, resolution=0.05), LivePanel(LOG, resolution=0.05)
    old.loops.value = False
    for scan in LOG[:12]:
        panel.take(scan)
    before, tree = panel.picture.value, panel.map.tree
    assert panel.map.scans == 12
    planned.set()
    panel.finish()
    assert panel.map.scans == 12 and panel.map.tree is not tree
    assert panel.picture.value != before
    fresh = Greys()
    fresh.update(panel.map, LOG[0].points())
    assert np.array_equal(panel._picture.greys.grid, fresh.grid)
    drawn = panel._picture.reduced.get_xdata()
    assert 0 < len(drawn) == 3 * len(panel._live.walls.segments)
    old.run(12)
    assert panel.graph.value.startswith("LiveGraph(") and old.map.scans == 12
    old.finish()
    assert not np.array_equal(old._live.poses, panel._live.poses)


def test_scans_of_a_laser_that_turns_are_carried(monkeypatch):
    """Catches a panel that takes scans of a moving hand as they came."""

    class Spinning:
        def scans(self):
            yield from (replace(scan, delays=0.001 * np.arange(len(scan))) for scan in LOG)

    monkeypatch.setattr(_live, "SpinningLaser", Spinning)
    panel = LivePanel(Spinning())
    panel.run(4)
    assert panel._live.graph.tracked(3).as_measured is not None and panel._scan.delays is None


def test_stop_while_the_map_is_made_anew(planned):
    """Catches a map that stays the old one, since no scan comes any more that exchanges it."""
    more = threading.Event()

    def source():
        for k, scan in enumerate(LOG[:8]):
            yield scan
            wait_for(lambda k=k: panel.taken > k)
        more.wait(20)

    panel = LivePanel(source(), resolution=0.05)
    panel.start.click()
    wait_for(lambda: panel.taken == 8)
    assert panel._live._anew is not None
    times = panel._times
    rate = (len(times) - 1) / (times[-1] - times[0])
    wait_for(lambda: panel.rate.value == f"{rate:.1f} scans a second")
    assert panel.dropped.value == "0 dropped, 0 left out"
    tree = panel.map.tree
    planned.set()
    more.set()
    panel.stop.click()
    wait_for(lambda: panel.state.value == "stopped")
    assert panel.map.tree is not tree and panel.map.scans == panel.taken


def test_the_choice_begins_a_new_map_where_the_robot_is():
    log = load("room")[:6]
    panel = LivePanel(log, start=(1, 2, 0.5))
    panel.loops.value = False
    for scan in log[:3]:
        panel.take(scan)
    pose = panel._step.pose
    panel.loops.value = True
    panel.take(log[3])
    assert panel.map.scans == 1 and panel._step.pose == pytest.approx(pose)
    panel.loops.value = False
    panel.take(log[4])
    assert panel.map.scans == 1 and panel.graph.value.startswith("LiveGraph(1 scans")


@pytest.mark.parametrize("after", [0, 3])
def test_goes_on_after_a_step_that_was_interrupted(after, monkeypatch):
    """Catches a panel that Control-C in one cell, or one scan that does not fit, ends for good."""

    def interrupted(*arguments):
        raise KeyboardInterrupt

    log = load("room")[:8]
    whole, panel = LivePanel(log), LivePanel(log)
    whole.run(8)
    for scan in log[:after]:
        panel.take(scan)
    with monkeypatch.context() as patched:
        patched.setattr(panel.map, "insert_scan", interrupted)
        with pytest.raises(KeyboardInterrupt):
            panel.take(log[after])
    panel.tolerance.value = 0.05  # draws the last scan that has a place, or none
    for scan in log[after:]:
        panel.take(scan)
    assert panel.taken == 8
    assert panel._step is not None and whole._step is not None
    assert panel._step.pose == pytest.approx(whole._step.pose, abs=0.05)


def broken_source():
    """A source whose driver has a mistake."""
    yield from ()
    raise AttributeError("no such port")


@pytest.mark.parametrize(
    ("source", "words"),
    [
        (iter([1.0, 2.0]), "scan must be a LaserScan"),
        (broken_source(), "AttributeError: no such port"),
    ],
)
def test_a_fault_of_the_source_ends_in_words(source, words):
    """Catches a state that says "running" while the thread has died."""
    panel = LivePanel(source)
    panel.start.click()
    wait_for(lambda: words in panel.state.value)
    assert panel.taken == 0


def test_stop_does_not_wait_for_ever(monkeypatch):
    """Catches a chapter that hangs, because its sensor is silent or looked for."""
    assert _live.LEAVE == 3
    monkeypatch.setattr(_live, "LEAVE", 0.2)
    here = threading.Event()

    def silent():
        yield LaserScan([1.0, 1.0], [0.0, 0.1])
        here.wait(20)

    panel = LivePanel(silent())
    panel.start.click()
    wait_for(lambda: panel.taken)
    begun = time.monotonic()
    panel.stop.click()
    assert time.monotonic() - begun < 5 and panel._thread.daemon
    assert panel.state.value.startswith("stops when the sensor")
    here.set()
    wait_for(lambda: panel.state.value == "stopped")
