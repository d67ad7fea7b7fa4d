"""What is no distance: one table for the driver, the emulator, the recorder and the readers."""

from dataclasses import replace

import numpy as np
import pytest
from emulated import Wired, connected

from segmap import read
from segmap.scans.error_codes import LOWEST_MM, as_far_ranges, as_ranges
from segmap.sensors.emulator import _worlds

#: Every code, and the distances about the border and below the reach.
MET = np.r_[np.arange(25), 500, 4095, 4096, 5599]


def driven():
    """The part of a scan of the driver that shows `MET`."""
    steps = np.full(769, 1000)
    steps[370 : 370 + len(MET)] = MET
    with connected(Wired(world=lambda turn: steps)) as sensor:
        scan = sensor.scan()
    part = slice(370 - 44, 370 - 44 + len(MET))
    beams = {name: getattr(scan, name)[part] for name in ("ranges", "angles", "codes", "delays")}
    return replace(scan, time=0.0, **beams)


def read_text(tmp_path, name, text):
    (tmp_path / name).write_text(text)
    return read(tmp_path / name)[0]


def as_text(tmp_path):
    lines = [f"{r} {a!r}" for r, a in zip(MET.tolist(), driven().angles.tolist(), strict=True)]
    return read_text(tmp_path, "scan1.txt", "\n".join(["# urg_mm angle_rad", *lines]) + "\n")


def as_coreslam(tmp_path):
    beams = np.r_[np.zeros(24, int), MET, np.full(683 - len(MET), 1000)]
    return read_text(tmp_path, "one.dat", " ".join(map(str, beams.tolist())))


def as_rawseeds(tmp_path):
    """In metres: 0.007 is code 7."""
    beams = np.r_[MET / 1000, np.ones(681 - len(MET))]
    return read_text(tmp_path, "HOKUYO_FRONT.csv", ",".join(["0", *(f"{b:.3f}" for b in beams)]))


@pytest.mark.parametrize("way", [as_text, as_coreslam, as_rawseeds])
def test_a_log_says_what_the_driver_says(way, tmp_path):
    """Catches a code that clears the map in one and says nothing in the other, as 6 once did."""
    live, log, count = driven(), way(tmp_path), len(MET)
    assert live.codes.tolist() == [*range(LOWEST_MM), *[0] * (count - LOWEST_MM)]
    assert log.codes[:count].tolist() == live.codes.tolist()
    assert log.ranges[:count] == pytest.approx(live.ranges, abs=1e-12, nan_ok=True)
    assert log.valid[:count].tolist() == live.valid.tolist()
    assert log.max_range == (np.inf if way is as_text else live.max_range)
    if way is as_text:
        assert len(log) == count
        assert log.angles == pytest.approx(live.angles, abs=1e-9)


def test_no_return_is_inf_and_an_error_nan():
    """Catches a code of 16 that becomes a wall at 16 mm, and an error that clears the map."""
    ranges, codes = as_ranges(np.arange(22))
    assert np.flatnonzero(np.isposinf(ranges)).tolist() == [0, 6]
    assert np.isnan(np.delete(ranges[:20], [0, 6])).all()
    assert ranges[20:].tolist() == [0.020, 0.021]
    assert codes.tolist() == [*range(20), 0, 0]
    ranges, codes = as_ranges([np.nan, -0.2, -1000.0, np.inf, 6.9999999])  # no number, no code
    assert np.isnan(ranges).tolist() == [True, True, True, False, True]
    assert codes.tolist() == [0, 0, 0, 0, 7]


def test_codes_are_those_of_the_model(monkeypatch):
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
        monkeypatch.setitem(_worlds.LIMITS, "MODL", model)
        with connected(Wired(world=lambda turn: np.full(769, 6))) as sensor:
            scan = sensor.scan()
        assert np.array_equal(scan.ranges, np.full(len(scan), meant), equal_nan=True)
        assert set(scan.codes) == {6}
