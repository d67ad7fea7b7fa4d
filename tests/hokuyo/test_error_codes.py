"""What is no distance: one table for the driver, the emulator, the recorder and the readers."""

import numpy as np
import pytest

from segmap import read
from segmap.hokuyo import (
    Geometry,
    ScanRequest,
    encode_reply,
    encode_scan,
    laser_scan,
    parse_scan,
    record,
)
from segmap.hokuyo.emulator import Replay
from segmap.scans.error_codes import CODES, LOWEST, as_ranges

URG = Geometry(1024, 44, 725, 384, 20, 5600, 0.1)
#: Every code, and the distances about the border and below the reach.
MET = np.r_[np.arange(25), 500, 4095, 4096, 5599]


def driven():
    """The scan that the driver makes of `MET`."""
    request = ScanRequest("GD", 370, 370 + len(MET) - 1)
    return laser_scan(parse_scan(encode_scan(0, MET, 3), 3), request, URG, time=0.0)


def as_text(tmp_path):
    angles = URG.angles(370, len(MET))
    lines = [f"{r} {a!r}" for r, a in zip(MET.tolist(), angles.tolist(), strict=True)]
    (tmp_path / "scan1.txt").write_text("\n".join(lines) + "\n")
    return read(tmp_path)[0]


def as_coreslam(tmp_path):
    header, count = 24, 683
    beams = np.full(count, 1000)
    beams[: len(MET)] = MET
    (tmp_path / "one.dat").write_text(" ".join(map(str, [0] * header + beams.tolist())))
    return read(tmp_path / "one.dat")[0]


def as_rawseeds(tmp_path):
    """In metres: 0.007 is code 7."""
    beams = np.full(681, 1.0)
    beams[: len(MET)] = MET / 1000
    (tmp_path / "HOKUYO_FRONT.csv").write_text(",".join(["0", *(f"{b:.3f}" for b in beams)]))
    return read(tmp_path / "HOKUYO_FRONT.csv")[0]


def recorded(tmp_path):
    record([driven()], tmp_path / "again")
    return read(tmp_path / "again")[0]


@pytest.mark.parametrize("way", [as_text, as_coreslam, as_rawseeds, recorded])
def test_a_log_says_what_the_driver_says(way, tmp_path):
    """Catches a code that clears the map in one and says nothing in the other, as 6 once did."""
    live, log, count = driven(), way(tmp_path), len(MET)
    assert live.codes.tolist() == [*range(LOWEST), *[0] * (count - LOWEST)]
    assert log.codes[:count].tolist() == live.codes.tolist()
    assert log.ranges[:count] == pytest.approx(live.ranges, abs=1e-12, nan_ok=True)
    assert log.valid[:count].tolist() == live.valid.tolist()
    assert log.max_range == live.max_range
    if way in (as_text, recorded):
        assert len(log) == count
        assert log.angles == pytest.approx(live.angles, abs=1e-9)


def test_no_return_is_inf_and_an_error_nan():
    """Catches a code of 16 that becomes a wall at 16 mm, and an error that clears the map."""
    ranges, codes = as_ranges(np.arange(22))
    assert np.flatnonzero(np.isposinf(ranges)).tolist() == [0, 6]
    assert np.isnan(np.delete(ranges[:20], [0, 6])).all()
    assert ranges[20:].tolist() == [0.020, 0.021]
    assert codes.tolist() == [*range(20), 0, 0]
    assert len(CODES) == LOWEST
    assert all(code.words for code in CODES)


def test_what_is_no_number_is_no_code_either():
    """Catches a negative range, or one that is missing, that is taken for "nothing met"."""
    ranges, codes = as_ranges([np.nan, -0.2, -1000.0, np.inf, 6.9999999])
    assert np.isnan(ranges).tolist() == [True, True, True, False, True]
    assert codes.tolist() == [0, 0, 0, 0, 7]


def test_a_replay_gives_every_code_again():
    """Catches an emulator that makes a distance of a code."""
    request = ScanRequest("GD", 370, 370 + len(MET) - 1)
    sent = encode_reply(request.text, "00", encode_scan(0, MET, 3))
    assert Replay(sent)(0)[370 : 370 + len(MET)].tolist() == MET.tolist()


def test_a_range_too_short_for_millimetres_is_no_code(tmp_path):
    """Catches 7 mm, which a simulated sensor may meet, recorded as "the beams beside are bad"."""
    from segmap import LaserScan

    record([LaserScan([0.007, 0.0004, 0.0, 1.0], [0.0, 0.1, 0.2, 0.3])], tmp_path / "near")
    log = read(tmp_path / "near")
    assert log[0].codes.tolist() == [19, 19, 19, 0]
    assert np.isnan(log[0].ranges[:3]).all()
