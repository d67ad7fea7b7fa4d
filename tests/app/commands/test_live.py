"""`segmap live`: what is recorded of a laser that is carried, how it ends, and the map after it."""

import signal
import subprocess
import sys
import time
from dataclasses import replace

import numpy as np
import pytest
from emulated import NetworkEmulator, needs_terminals, spoiled, wait_for

from segmap import load, read, warm
from segmap.carried import CASES, CarriedMap
from segmap.progress import told
from segmap.scans import LaserScan
from segmap.sensors.emulator import SpinningEmulator
from segmap.simulation import Sensor, rectangular_room, simulate
from segmap_app import drives
from segmap_app.commands import main

pytest.importorskip("lds2d")


def turns():
    """A room seen all round, from places 2 cm apart, ten turns a second."""
    angles = np.radians(0.8 * np.arange(450) - 180)
    scans = []
    for k in range(60):
        x = 0.02 * k
        across = np.where(np.cos(angles) > 0, 4 - x, 1 + x) / np.maximum(abs(np.cos(angles)), 1e-9)
        up = np.where(np.sin(angles) > 0, 2.0, 1.5) / np.maximum(abs(np.sin(angles)), 1e-9)
        scans.append(LaserScan(np.minimum(across, up), angles, 0.1 * k))
    return scans


@needs_terminals
def test_a_laser_is_followed_recorded_and_mapped(tmp_path):
    """Catches a log that its own reader refuses, a map of nothing, and no word while it runs."""
    log, map = tmp_path / "drive.csv", tmp_path / "map.csv"
    command = [sys.executable, "-m", "segmap", "live", "ld19"]
    with SpinningEmulator(turns()) as emulator:
        process = subprocess.Popen(
            [*command, emulator.port, "--log", log, "-o", map], stdout=-1, stderr=-2, text=True
        )
        until = time.monotonic() + 120
        while (not log.exists() or log.stat().st_size < 500_000) and time.monotonic() < until:
            time.sleep(0.1)
        process.send_signal(signal.SIGINT)
        said = process.communicate(timeout=240)[0]
    assert process.returncode == 0, said
    assert " sure" in said and "GOOD" in said and map.exists()
    scans = read(log)
    assert len(scans) > 20 and {len(scan) for scan in scans[1:]} <= {449, 450, 451}
    assert np.median([scan.delays.max() for scan in scans]) < 0.3


def test_the_laser_goes_off_whatever_ends_the_program(tmp_path):
    """Catches a laser left on by `kill`, or by a terminal that is closed and says so twice.

    The sensor is silent, so that the others come while the laser is switched off.
    """
    log = tmp_path / "drive.csv"
    code = (
        "import signal, sys; from segmap.__main__ import main\n"
        "signal.signal(signal.SIGHUP, signal.SIG_DFL); sys.exit(main())"
    )
    with spoiled(NetworkEmulator(speed=5.0)) as emulator:
        command = [sys.executable, "-c", code, "live", "hokuyo", emulator.port, "--log", str(log)]
        process = subprocess.Popen(command, stdout=subprocess.DEVNULL)
        wait_for(lambda: log.exists() and log.stat().st_size > 200_000, 120)
        assert emulator.unit.laser
        emulator.inject("silence", seconds=0.4)
        for sent in (signal.SIGTERM, signal.SIGHUP, signal.SIGTERM):
            process.send_signal(sent)
            time.sleep(0.05)
        wait_for(lambda: not emulator.unit.laser)
        process.wait(120)
    assert len(read(log)) > 5


@needs_terminals
def test_what_was_measured_stays_where_the_laser_falls_silent(tmp_path, capsys):
    """Catches a log that is lost with the laser, and an end that is called a success."""
    log = tmp_path / "drive.csv"
    warm.dispatch(CASES)  # it sends meanwhile
    with spoiled(SpinningEmulator(turns(), speed=3)) as emulator:
        emulator.inject("unplug", after=120_000)
        assert main(["live", "LD19", emulator.port, "--log", str(log)]) == 1
    said = capsys.readouterr()
    assert "nothing came" in said.err or "gone" in said.err
    assert "verdict" in said.out and len(read(log)) > 10


def test_what_is_missing_is_listed_and_no_log_is_overwritten(tmp_path, capsys):
    """Catches a command that asks for names that it could list, and one that empties a log."""
    assert main(["live"]) == 2
    said = capsys.readouterr()
    assert "RPLIDAR-A1" in said.out and "segmap live LD19 /dev/ttyUSB0" in said.err
    log = tmp_path / "drive.csv"
    log.write_text("mine")
    assert main(["live", "LD19", "/dev/none", "--log", str(log)]) == 2
    assert log.read_text() == "mine" and "must be a new file" in capsys.readouterr().err
    log.unlink()
    assert main(["live", "LD19", "/dev/none", "--log", str(log)]) == 1
    assert not log.exists() and "it is not there" in capsys.readouterr().err


def test_a_log_that_comes_with_segmap_reads_as_it_was_written(tmp_path):
    """Catches beams that change places or times on their way through the table."""
    log = load("clinic")[:5]
    assert len(list(drives.save_each(log, tmp_path / "it.csv"))) == 5
    for ours, theirs in zip(read(tmp_path / "it.csv"), log, strict=True):
        assert np.allclose(ours.points(), theirs.points(), atol=2e-4)


@pytest.mark.parametrize("other", [False, True])
def test_beams_in_the_other_order_are_told(other):
    """Catches a velocity against that of the poses, which no map shows, and a false alarm."""
    turns = np.radians(8.0 * np.repeat([1, -1, 1, -1], 8))
    path = np.column_stack(
        [2 + 0.5 * np.sin(np.arange(32) / 10), np.full(32, 1.5), np.cumsum(turns)]
    )
    sensor = Sensor("it", 450, 0.0, 2 * np.pi / 450, max_range=12.0, sigma=0.005)
    rng, walls = np.random.default_rng(0), rectangular_room(5, 4)
    log = simulate(walls, path, sensor=sensor, rng=rng, moving=True)
    live = CarriedMap()
    for scan in log:
        times = scan.delays.max() - scan.delays if other else scan.delays
        live.add(replace(scan, odometry=None, delays=times))
    assert live.advice.startswith("ORDER") == other and (other or not live.advice)


def test_a_hand_that_turns_otherwise_while_scans_are_left_out_is_not_in_the_other_order():
    """Catches a velocity that is taken for that of the whole time since the scan before."""
    turns = np.radians(np.r_[np.zeros(6), np.tile([20.0, 20.0, -20.0], 6)])
    path = np.column_stack([np.full(24, 2.0), np.full(24, 1.5), np.cumsum(turns) - turns])
    sensor = Sensor("it", 450, 0.0, 2 * np.pi / 450, max_range=12.0, sigma=0.005)
    rng, walls = np.random.default_rng(0), rectangular_room(5, 4)
    live, advice = CarriedMap(), []
    log = simulate(walls, path, sensor=sensor, rng=rng, moving=True)
    for scan in [*log[:6], *log[8:-1:3]]:
        step = live.add(replace(scan, odometry=None))
        advice.append(live.advice)
    assert not any(advice) and np.degrees(step.motion[2] * 0.1) == pytest.approx(-20, abs=1)


@pytest.mark.parametrize(("turn", "words"), [(20, "sure"), (60, "SLOWER")])
def test_a_hand_that_turns_too_fast_is_told(turn, words):
    """Catches scans that are taken as they come, bent, and a word that waits until all is lost."""
    turns = np.radians(np.r_[np.linspace(0, turn, 12), np.full(8, turn)])
    path = np.column_stack([np.full(20, 2.0), np.full(20, 1.5), np.cumsum(turns)])
    sensor = Sensor("it", 450, 0.0, 2 * np.pi / 450, max_range=12.0, sigma=0.005)
    rng, walls = np.random.default_rng(0), rectangular_room(5, 4)
    log = simulate(walls, path, sensor=sensor, rng=rng, moving=True)
    lines = []
    with told(lambda share, words: lines.append(words)):
        drives.follow(replace(scan, odometry=None) for scan in log)
    assert words in lines[-1]
    assert ("SLOWER" in "".join(lines)) == (turn > 45)
