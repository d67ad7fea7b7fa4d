"""Recording: every scan whole or absent, whenever the recorder dies."""

import itertools
import os

import numpy as np
import pytest
from programs import program

from segmap import LaserScan, read
from segmap.sensors import record

recorder = program("segmap.sensors")

ANGLES = (np.arange(682) - 340) * 2 * np.pi / 1024


def scan(number: int) -> LaserScan:
    """A scan whose every range tells its number, and a few errors."""
    ranges = 1.0 + number / 1000 + np.zeros(682)
    codes = np.zeros(682, np.int64)
    codes[:3] = 7, 0, 16
    ranges[:3] = np.nan, np.inf, np.nan
    return LaserScan(ranges, ANGLES, 100 + 0.1 * number, max_range=5.6, codes=codes)


def numbers(path) -> list[int]:
    """Which scans a log holds; fails where one is not whole."""
    found = []
    for one in read(path):
        number = np.rint(1000 * (one.ranges[3:] - 1.0)).astype(int)
        assert len(one) == 682
        assert (number == number[0]).all()
        found.append(int(number[0]))
    return found


@pytest.mark.parametrize("name", ["some.log", "BENCH.LOG"])
def test_there_and_back(name, tmp_path):
    path = tmp_path / name
    assert record(map(scan, range(3)), path) == 3
    assert record(map(scan, itertools.count(3)), path, count=2) == 2
    assert numbers(path) == [0, 1, 2, 3, 4]
    log = read(path)
    assert log[1].angles == pytest.approx(ANGLES, abs=1e-6)
    assert np.isinf(log[1].ranges[1])
    assert not log[1].valid[:3].any()
    assert log.times == pytest.approx(100 + 0.1 * np.arange(5), abs=1e-6)
    assert log.truth is None


# ---------------------------------------------------------------- before the sensor is asked


@pytest.mark.parametrize("name", ["new.log", "old.log"])
def test_trying_out_leaves_nothing(name, tmp_path, capsys, monkeypatch):
    """Catches an empty log of a recording that never began.

    Root, who may run the tests, is refused nothing by itself.
    """

    def refused(*arguments, **named):
        raise PermissionError(13, "Permission denied", name)

    (tmp_path / "old.log").write_text("mine")
    before = sorted(tmp_path.rglob("*"))
    command = ["record", str(tmp_path / name), "--port", "/no-port"]
    for more, said in (
        ([], "cannot open /no-port"),
        (["--count", "0"], "count must be a whole number of at least 1, got 0"),
        ([], "PermissionError: "),
    ):
        if said.startswith("Permission"):
            monkeypatch.setattr(os, "open", refused)
        assert recorder(command + more) == 1
        assert said in capsys.readouterr().err
    monkeypatch.undo()
    assert sorted(tmp_path.rglob("*")) == before
    assert (tmp_path / "old.log").read_text() == "mine"
    with pytest.raises(ValueError, match="count must be"):
        record(iter(()), tmp_path / "it", count=-3)


# ------------------------------------------------------------- nothing that `read` refuses
ODD_SCANS = {
    "no beam": LaserScan([], []),
    "no time": LaserScan([1.0], [0.0], time=np.nan),
    "limit below zero": LaserScan([1.0, np.inf], [0.0, 0.1], max_range=-1.0),
    "short": LaserScan([1e-9, 1e-4, 1.0], [0.0, 0.1, 0.2]),
    "errors only": LaserScan([np.nan] * 3, [0.0, 0.1, 0.2]),
    "uneven": LaserScan([1.0, 1.0, 1.0], [0.0, 0.1, 0.3]),
}


@pytest.mark.parametrize("name", ODD_SCANS)
def test_what_is_recorded_can_be_read(name, tmp_path):
    """Catches one odd scan that spoils the whole log for its reader."""
    path = tmp_path / "it.log"
    record([scan(0)], path)
    try:
        record([ODD_SCANS[name]], path)
    except ValueError:
        assert len(read(path)) == 1
    else:
        assert [len(one) for one in read(path)] == [682, len(ODD_SCANS[name])]
