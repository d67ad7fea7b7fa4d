"""What de-skewing believes of clocks and of the order of beams: by hand, at its limits."""

import numpy as np
import pytest

from segmap.alignment import _deskew, deskew
from segmap.alignment._deskew import ENTROPY_MARGIN_NATS, _clock, _entropy, _margin
from segmap.scans import LaserScan, Log

#: A robot that turns to and fro, and shows it in 101 poses of its wheels in ten seconds.
TIMES = np.linspace(-2, 12, 281)
TRACK = np.column_stack([TIMES, 0 * TIMES, 0 * TIMES, np.sin(TIMES) + 0.5 * np.sin(2.7 * TIMES)])
AT = np.linspace(0, 10, 41)


def log_of(track=TRACK, times=AT) -> Log:
    return Log("it", [LaserScan([1.0], [0.0], time=time) for time in times], track=track)


def turned(late) -> np.ndarray:
    """Poses of the scans by wheels that show each turn so many seconds late."""
    return np.column_stack([AT, 0 * AT, np.interp(AT + late, TIMES, TRACK[:, 3])])


@pytest.mark.parametrize(
    ("late", "found"), [(0.0, True), (0.495, True), (-0.495, True), (0.5, False), (-0.5, False)]
)
def test_a_clock_is_found_within_half_a_second(late, found):
    """At the last of the shifts that are tried it may lie farther off."""
    offset = _clock(log_of(), turned(late))
    assert offset == pytest.approx(late, abs=1e-9) if found else np.isnan(offset)


@pytest.mark.parametrize(("apart", "found"), [(0.02, True), (0.03, False)])
def test_both_halves_of_a_log_must_find_one_clock(apart, found):
    both = np.where(AT[:, None] < 5, turned(0.1), turned(0.1 + apart))
    assert np.isfinite(_clock(log_of(), both)) == found


@pytest.mark.parametrize(
    "log",
    [log_of(None), log_of(TRACK[:0]), log_of(TRACK + (1e6, 0, 0, 0)), log_of(times=0 * AT)],
    ids=["no track", "an empty one", "of another time", "no time passes"],
)
def test_without_wheels_there_is_no_clock(log):
    assert np.isnan(_clock(log, turned(0.1)))


def test_the_entropy_is_that_of_cells_of_five_centimetres():
    points = np.array([(0.01, 0.01), (0.04, 0.049), (0.02, 0), (0.051, 0.01), (0.01, -0.01)])
    share = np.array([0.6, 0.2, 0.2])
    assert _entropy(points) == pytest.approx(-(share * np.log(share)).sum())


@pytest.mark.parametrize(
    ("scans", "speed", "found"), [(20, 0.3, True), (20, 0.17, False), (19, 0.3, False)]
)
def test_the_order_shows_in_twenty_scans_that_turn_by_a_degree(scans, speed, found):
    """A square room in 0.1 s, by a robot that turns to and fro: the right order makes one of it."""
    delays, angles = np.linspace(0, 0.1, 720), np.linspace(-3.14, 3.14, 720)
    ranges = 2.02 / np.maximum(abs(np.cos(angles)), abs(np.sin(angles)))
    turns = speed * (-1.0) ** np.arange(scans)
    seen = [LaserScan(ranges, angles - turn * (delays - 0.05), delays=delays) for turn in turns]
    margin = _margin(Log("it", seen), np.zeros((scans, 3)), turns[:, None] * (0, 0, 1))
    assert margin < -ENTROPY_MARGIN_NATS if found else np.isnan(margin)


@pytest.mark.parametrize(
    ("margin", "clock", "said"),
    [
        *((margin, 0.0, "nothing tells in which order") for margin in (np.nan, 0.049, -0.049)),
        *((-0.05, clock, "") for clock in (0.125, 0.0, 0.25, np.nan)),
        *((-0.05, clock, "scans and odometry differ by 0.13 s") for clock in (-0.005, 0.255)),
        (0.05, 0.255, "the beams are in the other order than the file says; scans and odometry"),
    ],
)
def test_what_is_said_of_order_and_clock(margin, clock, said, monkeypatch):
    """From a twentieth of a nat on, and beyond half of a turn of 0.25 s about the middle of one."""
    monkeypatch.setattr(_deskew, "_margin", lambda *given: margin)
    monkeypatch.setattr(_deskew, "_clock", lambda *given: clock)
    scans = [LaserScan([1.0, 1.0], [0.0, 1.0], time=k, delays=[0.0, 0.25]) for k in range(3)]
    found = deskew(Log("it", scans, order_known=False), np.zeros((3, 3)))
    assert found.doubt.startswith(said) and bool(found.doubt) == bool(said)
    assert found.order_known == (margin == 0.05)
