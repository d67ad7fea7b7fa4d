"""The driver and the emulator over TCP, on this machine: ranges, reconnecting, damage."""

import contextlib
import gc
import itertools
import signal
import socket
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from functools import partial

import numpy as np
import pytest
from emulated import (
    BOUND,
    FAULTS,
    Wired,
    connected,
    emulator_threads,
    open_files,
    pattern,
    run,
    turn_of,
    wait_for,
)

from segmap import LaserScan, read
from segmap.hokuyo import (
    SensorError,
    SensorGone,
    UrgSensor,
    _sensor,
    checksum,
    encode_reply,
    encode_scan,
    parse_geometry,
    parse_info,
    record,
)
from segmap.hokuyo.__main__ import main as bench
from segmap.hokuyo._tcp import open_tcp, parse_address
from segmap.hokuyo.emulator import Emulator, Replay, Room
from segmap.hokuyo.emulator._worlds import MODELS
from segmap.scans.error_codes import as_far_ranges
from segmap.simulation import rectangular_room

UST = {"model": "UST-10LX"}
FAST = {"tcp": "0", "speed": 10.0}


@pytest.fixture(autouse=True, scope="module")
def nothing_is_left():
    """Catches a connection or a thread that a test leaves behind; waits are short."""
    gc.collect()
    before = open_files()
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(_sensor, "BACK_OFF", (0.02, 0.1))
        yield
    gc.collect()
    assert emulator_threads() == []
    assert open_files() == before


def far_pattern(turn):
    """Millimetres of a UST-10LX, to 29.9 m, that grow by 31 a step and 7919 a turn."""
    return 100 + (7919 * turn + 31 * np.arange(1081)) % 29800


def far_turn(scan):
    """That all beams of a scan are of one turn of `far_pattern`."""
    met = np.rint(1000 * scan.ranges).astype(int)
    starts = (met - 100 - 31 * np.arange(1081)) % 29800
    assert (starts == starts[0]).all(), "a range that the sensor never measured"
    return int(starts[0])


def of(emulator, **settings):
    return UrgSensor(emulator.port, **({"timeout": 0.3} | settings))


# ------------------------------------------------------------------------------ scans
def test_scans_of_1081_beams_to_30_metres():
    """Catches two characters a distance, geometry of a URG-04LX, and a lost or doubled byte."""
    with Emulator(far_pattern, **UST, **FAST) as emulator, of(emulator) as sensor:
        scan = sensor.scan()
        far_turn(scan)
        assert len(scan) == 1081 and scan.valid.all()
        assert scan.ranges.max() > 29 and scan.max_range == 30.0
        assert np.degrees(scan.angles[[0, 540, -1]]) == pytest.approx([-135, 0, 135])
        assert sensor.geometry.turn == 0.025 and sensor.info["MODL"] == "UST-10LX"
        with contextlib.closing(sensor.scans()) as scans:
            turns = [far_turn(scan) for scan in itertools.islice(scans, 20)]
        assert len(set(turns)) == 20 and (sensor.delivered, sensor.dropped) == (21, 0)
        assert emulator.unit.received[-1] == "QT" and not emulator.unit.laser
        assert not {text for text in emulator.unit.received if text[:2] in ("SS", "MS", "GS")}
        assert sensor.rate == 100_000_000


def test_an_urg_over_tcp_and_ipv6():
    """Catches a model that is bound to its line, and an address that ends at its first colon."""
    with contextlib.ExitStack() as stack:
        try:
            emulator = stack.enter_context(Emulator(pattern, tcp="[::1]:0", speed=10.0))
        except OSError:
            pytest.skip("this machine has no IPv6")
        assert emulator.port.startswith("tcp://[::1]:")
        turn_of(stack.enter_context(of(emulator)).scan())


def test_a_large_room_is_seen_as_it_is():
    """Catches steps that lie elsewhere, in the driver or in the emulator."""
    world = Room(
        rectangular_room(20, 12), [(8.0, 5.0, 0.0)], MODELS["UST-10LX"].sensor.ideal(), **UST
    )
    with connected(Wired(world=world, **UST)) as sensor:
        x, y = (sensor.scan().points() + (8.0, 5.0)).T
    assert len(x) == 1081
    assert np.min([abs(x), abs(x - 20), abs(y), abs(y - 12)], 0).max() < 0.001


def test_codes_are_those_of_the_model():
    """Catches 65533 that becomes a wall at 65 m, and 21 mm that is one of a UTM-30LX-EW.

    1 to 5 as in table 4 of SCIP 2.0, 65533 as such sensors are reported to send it.
    """
    sent = [0, 1, 2, 3, 5, 19, 22, 23, 60000, 60001, 65533, 65534]
    nan, inf = np.nan, np.inf
    ranges, codes = as_far_ranges(sent, least=23, most=60000)
    expected = [nan, inf, nan, nan, nan, nan, nan, 0.023, 60.0, inf, inf, nan]
    assert np.array_equal(ranges, expected, equal_nan=True)
    assert codes.tolist() == [0, 1, 2, 3, 5, 19, 22, 0, 0, 60001, 65533, 65534]
    for model, meant in (("UST-10LX", nan), ("URG-04LX", inf)):
        six = np.full(MODELS[model].steps, 6)
        with connected(Wired(world=lambda turn, six=six: six, model=model)) as sensor:
            scan = sensor.scan()
        assert np.array_equal(scan.ranges, np.full(len(scan), meant), equal_nan=True)
        assert set(scan.codes) == {6}


def test_what_a_model_is():
    """Catches one wrong bit that changes the table of codes: no sum sees the upper two bits."""
    told = MODELS["URG-04LX"].limits
    for model in ("UTM-30LX-EW", "UST-20LX", "UXM-30LX-EW(Hokuyo)"):
        assert parse_geometry(told | {"MODL": model}).is_far
    for model in ("URG-04LX-UG01(Simple-URG)", "UBG-04LX-F01", "UHG-08LX"):
        assert not parse_geometry(told | {"MODL": model}).is_far
    for at, bit in itertools.product((5, 6, 7), (6, 7)):
        line = bytearray(b"MODL:URG-04LX;" + checksum(b"MODL:URG-04LX"))
        line[at] ^= 1 << bit
        with pytest.raises(SensorError, match="no line of information"):
            parse_info([bytes(line)], strict=True)


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"model": "UST-99"}, "model must be one of"),
        ({"protocol": "1.1"}, "protocol must be one of"),
        ({"world": Room(rectangular_room(4, 3), [(1, 1, 0)])}, "model must be 'URG-04LX'"),
        ({"tcp": "0", "usb": False}, "tcp goes with neither"),
        *(({"tcp": w}, "tcp must be") for w in ("", "x", "1:", "99999", "::1:0", "\u0661")),
    ],
)
def test_emulators_that_cannot_be(wrong, message):
    with pytest.raises(ValueError, match=message):
        Emulator(**({"world": far_pattern} | UST | wrong))


def test_a_replay_is_of_a_model():
    """Catches a capture of 1081 steps that is cut to 769, or ends in numpy's words."""
    sent = encode_reply("GD0000108001", "00", encode_scan(0, far_pattern(1), 3))
    assert (Replay(sent, **UST)(0) == far_pattern(1)).all()
    with pytest.raises(SensorError, match="more than 769 steps"):
        Replay(sent)


# ---------------------------------------------------------------------------- leaving
@pytest.mark.parametrize("single", [True, False])
def test_comes_back_when_the_connection_is_closed(single):
    """Catches a driver that reconnects over serial only, and scans from before."""
    with Emulator(far_pattern, **UST, **FAST) as emulator, of(emulator, reconnect=10.0) as sensor:
        source = iter(sensor.scan, None) if single else sensor.scans()
        far_turn(next(source))
        for back in (1, 2):
            emulator.replug()
            for scan in itertools.islice(source, 20):  # some were on their way
                far_turn(scan)
                if sensor.reconnects == back:
                    break
            assert sensor.reconnects == back


@pytest.mark.parametrize("single", [True, False])
def test_comes_back_when_the_cable_was_pulled(single):
    """Catches a driver that waits for ever where nobody tells it that the sensor has gone."""
    with (
        Emulator(far_pattern, **UST, **FAST) as emulator,
        of(emulator, reconnect=10.0, timeout=0.2) as sensor,
    ):
        source = iter(sensor.scan, None) if single else sensor.scans()
        far_turn(next(source))
        emulator.inject("silence", seconds=1.5)
        far_turn(next(source))
        assert sensor.reconnects >= 1


def test_comes_back_when_the_sensor_is_ready():
    """Catches a sensor that was switched off and on, and is refused for its first seconds."""
    with Emulator(far_pattern, **UST, **FAST) as emulator, of(emulator, reconnect=10.0) as sensor:
        light, asked = emulator.unit._do_bm, []
        sensor.scan()
        emulator.unit._do_bm = lambda text: (
            asked.append(text) or (light(text) if len(asked) > 3 else encode_reply(text, "0M"))
        )
        emulator.replug()
        far_turn(sensor.scan())
        assert len(asked) == 4 and sensor.reconnects == 1


def test_a_sensor_that_measures_no_more(monkeypatch):
    """Catches a driver that reconnects for ever to one that answers all but requests for scans."""
    monkeypatch.setattr(_sensor, "MOST_FAILURES", 2)
    with (
        Emulator(far_pattern, **UST, **FAST) as emulator,
        of(emulator, reconnect=10.0, timeout=0.2) as sensor,
    ):
        emulator.unit._do_md = lambda text: b""
        with pytest.raises(SensorError, match="no whole scan in 2 attempts: no answer to MD"):
            next(sensor.scans())
        assert sensor.reconnects == 2


def test_what_a_lost_sensor_says():
    with Emulator(far_pattern, **UST, **FAST) as emulator:
        with of(emulator) as sensor:
            emulator.replug()
            with pytest.raises(SensorGone, match="it closed the connection"):
                sensor.scan()
        with of(emulator, timeout=0.2) as sensor:
            emulator.inject("silence", seconds=1.5)
            with pytest.raises(SensorError, match="no answer to"):
                sensor.scan()
            assert "closed" not in repr(sensor), "it may be asked again"
        emulator.mend()
    with Emulator(far_pattern, **UST, **FAST) as emulator, of(emulator, reconnect=0.2) as sensor:
        emulator.unplug()
        with pytest.raises(SensorGone, match=r"not back within 0.2 s: .*nothing listens there"):
            sensor.scan()


def test_one_program_at_a_time():
    """Catches two that get each other's answers; the next is served as soon as the first leaves."""
    with Emulator(far_pattern, **UST, **FAST) as emulator:
        for _ in range(3):
            with of(emulator) as sensor:
                far_turn(sensor.scan())
                with pytest.raises(SensorGone, match="perhaps another program uses it"):
                    of(emulator)
                far_turn(sensor.scan())


def test_a_program_that_crashed_left_it_streaming():
    with Emulator(far_pattern, **UST, **FAST) as emulator:
        host, port = parse_address(emulator.port)
        with socket.create_connection((host, port)) as crashed:
            crashed.sendall(b"MD0000108001000\n")
            assert crashed.recv(10)
        with of(emulator) as sensor:
            assert emulator.unit.stream is None
            far_turn(sensor.scan())


def through_the_network(fault, seed):
    with Emulator(pattern, rng=np.random.default_rng(seed), **FAST, **FAULTS[fault]) as emulator:
        run(partial(of, emulator), emulator.unit, emulator.wire, fault, seed)


def test_faults_through_the_network():
    """Catches a wrong range and a hang; `run` checks each beam, and the advice of each error."""
    faults = [fault for fault in FAULTS if fault not in ("wrong rate", "silence")]
    with ThreadPoolExecutor(len(faults)) as pool:
        running = [pool.submit(through_the_network, fault, k) for k, fault in enumerate(faults)]
        for one in running:
            one.result(BOUND)


def test_the_recorder_is_stopped(tmp_path):
    """Catches a laser left on by `kill`, and a log of a far sensor that is cut at 5.6 m."""
    log = tmp_path / "until.log"
    command = [sys.executable, "-m", "segmap.hokuyo", "record", str(log), "--port"]
    with Emulator(far_pattern, **UST, **FAST) as emulator:
        with subprocess.Popen([*command, emulator.port], stdout=subprocess.PIPE) as process:
            wait_for(lambda: log.exists() and log.stat().st_size > 20_000)
            process.send_signal(signal.SIGTERM)
            said, _ = process.communicate(timeout=20)
            assert process.returncode == 0 and b" scans, 0 dropped" in said
        wait_for(lambda: not emulator.unit.laser)
    scans = read(log)
    assert len(scans) >= 2 and len(scans[0]) == 1081
    assert far_turn(scans[0]) != far_turn(scans[1])
    assert scans[0].valid.all() and scans[0].max_range == 30.0


def test_from_a_terminal(tmp_path, capsys, monkeypatch):
    """An emulator in a process of its own; `info` and `record` without pyserial.

    Catches Ethernet that needs a serial library, and an address that is not told at once.
    """
    monkeypatch.setitem(sys.modules, "serial", None)
    capture = encode_reply("GD0000108001", "00", encode_scan(0, far_pattern(1), 3))
    (tmp_path / "ust.scip").write_bytes(capture)
    command = [sys.executable, "-m", "segmap.hokuyo.emulator", "--tcp", "0", "--model", "UST-10LX"]
    command += ["--replay", str(tmp_path / "ust.scip")]
    with subprocess.Popen(command, stdout=subprocess.PIPE) as process:
        assert process.stdout is not None
        port = ["--port", process.stdout.readline().decode().strip()]
        assert port[1].startswith("tcp://127.0.0.1:")
        assert bench(["info", *port]) == 0
        assert bench(["record", str(tmp_path / "some.log"), "--count", "2", *port]) == 0
        process.terminate()
        assert process.wait(10) == 0
    said = capsys.readouterr().out
    assert "MODL  UST-10LX" in said and "1081 beams" in said and "2 scans, 0 dropped" in said
    assert bench(["info", *port]) == 1
    assert "nothing listens there" in capsys.readouterr().err


def test_a_folder_of_texts_keeps_what_it_can(tmp_path):
    """Catches 65533 read again as a wall, an error that clears the map, and lost ranges."""
    beams = np.array([np.inf, np.nan, np.inf, np.nan, 5.5]), np.arange(5) / 10
    codes = np.array([65533, 2, 1, 65535, 0])
    assert record([LaserScan(*beams, max_range=30.0, codes=codes)], tmp_path / "near") == 1
    found = read(tmp_path / "near")[0]
    assert np.array_equal(found.ranges, beams[0], equal_nan=True)
    assert found.codes.tolist() == [0, 2, 0, 19, 0]
    with pytest.raises(ValueError, match=r"to 5.6 m, but a range is 9.500 m: .*ends in .log"):
        record([LaserScan([1.0, 9.5], [0.0, 0.1], max_range=30.0)], tmp_path / "far")


def test_a_port_that_is_handed_in():
    with Emulator(far_pattern, **UST, **FAST) as emulator:
        with UrgSensor(open_tcp(emulator.port), timeout=0.3) as sensor:
            far_turn(sensor.scan())
            assert sensor.rate == 100_000_000
        with pytest.raises(ValueError, match="reconnect needs the name"):
            UrgSensor(Wired(), reconnect=1.0)
