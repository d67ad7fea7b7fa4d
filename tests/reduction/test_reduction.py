"""What every reduction method promises, whatever it does inside."""

from dataclasses import replace

import numpy as np
import pytest

from segmap.progress import told
from segmap.reduction import METHODS, _points
from segmap.reduction._runner import run_offline, run_online
from segmap.segments import SegmentMap, length

methods = pytest.mark.parametrize("name", METHODS)
#: Those that take an array, which does not tell where the sensor was.
anywhere = pytest.mark.parametrize("name", [n for n in METHODS if not METHODS[n].needs_sensors])


def noisy_building(seed: int = 0, seen: int = 6) -> SegmentMap:
    """Four rooms, each wall seen several times by several scans."""
    rng = np.random.default_rng(seed)
    x, y = (np.array(v, float) for v in ([0, 4, 8], [0, 3, 6]))
    walls = [[(a, y[0]), (a, y[-1])] for a in x] + [[(x[0], b), (x[-1], b)] for b in y]
    segments = np.repeat(np.array(walls), seen, axis=0)
    noisy = segments + rng.normal(0, 0.01, segments.shape)
    sensors = np.tile((2.0, 1.5), (seen, 1))
    return SegmentMap(noisy, np.arange(len(segments)) % seen, sensors=sensors)


@methods
def test_every_input_is_accounted_for(name):
    """Beside what the runner checks: its name, its members, that seconds are measured."""
    map = noisy_building()
    found = METHODS[name](map)
    assert found.method == name
    assert 0 < len(found) < len(map)
    assert found.seconds > 0
    assert (found.scan_live is not None) == METHODS[name].online
    np.testing.assert_array_equal(found.members(0), np.flatnonzero(found.parents == 0))


@methods
def test_the_map_is_left_as_it_was(name):
    """A method that works in place spoils the map for the next one."""
    map = noisy_building()
    segments, sensors = map.segments.copy(), map.sensors.copy()
    METHODS[name](map)
    np.testing.assert_array_equal(map.segments, segments)
    np.testing.assert_array_equal(map.sensors, sensors)
    if not METHODS[name].needs_sensors:
        METHODS[name](given := segments.copy())
        np.testing.assert_array_equal(given, segments)


@anywhere
def test_maps_arrays_and_reductions_are_all_accepted(name):
    map = replace(noisy_building(), sensors=None)
    once = METHODS[name](map)
    alone = METHODS[name](SegmentMap(map.segments))
    np.testing.assert_array_equal(METHODS[name](map.segments).segments, alone.segments)
    assert len(METHODS[name](once)) <= len(once)


@methods
def test_segments_without_length_are_left_out_first(name):
    """They have no angle: parents -1, and the rest is reduced as if they were not there."""
    map = noisy_building()
    segments = np.concatenate([np.ones((1, 2, 2)), map.segments, np.zeros((1, 2, 2))])
    with_points = SegmentMap(segments, [0, *map.scan, 0], sensors=map.sensors)
    found, expected = METHODS[name](with_points), METHODS[name](map)
    np.testing.assert_array_equal(found.segments, expected.segments)
    np.testing.assert_array_equal(found.parents, [-1, *expected.parents, -1])
    assert length(found.segments).min() > 0


@pytest.mark.parametrize("name", [n for n in METHODS if METHODS[n].needs_sensors])
def test_a_map_that_does_not_tell_where_its_sensor_was_is_refused(name):
    with pytest.raises(ValueError, match=r"^map must tell where its sensor was: build_map.*"):
        METHODS[name](noisy_building().segments)


def test_as_many_points_as_are_allowed_are_made(monkeypatch):
    monkeypatch.setattr(_points, "MOST_SPACED_POINTS", 10)
    assert len(_points.stand_ins(np.array([[(0, 0), (1, 0)]], float), 0.1)[0]) == 11
    with pytest.raises(ValueError, match="at most 10 points"):
        _points.stand_ins(np.array([[(0, 0), (1.1, 0)]], float), 0.1)


WALLS = np.array([[(0, 0), (1, 0)], [(1, 1), (1, 1)], [(0, 1), (1, 1)]], float)


def test_the_runner_sorts_by_scan_and_carries_back():
    """An order that is not undone, a sort that is not stable, a point that shifts all rows."""
    map = SegmentMap(WALLS[[0, 2, 1, 0, 2]], [5, 2, 2, 2, 5])

    def steps(rows):
        assert list(rows.scans()) == [(0, 2), (2, 4)]
        assert rows.source_row.tolist() == [1, 3, 0, 4]
        yield 2
        yield 4
        return rows.segments, np.arange(4)

    found = run_online("kept", map, steps)
    assert found.parents.tolist() == [2, 0, -1, 1, 3]
    assert found.scan_live.tolist() == [2, 4]
    assert found.seconds >= found.scan_seconds.sum() > 0
    whole = run_offline("kept", map, lambda rows: (rows.segments, np.arange(4)))
    assert whole.parents.tolist() == [0, 1, -1, 2, 3]
    assert whole.scan_seconds is None


@pytest.mark.parametrize("name", [n for n in METHODS if METHODS[n].online])
def test_an_on_line_method_says_after_each_scan_how_far_it_is(name):
    """Catches a share beyond 1, or one that never moves."""
    said = []
    with told(lambda share, words: said.append((share, words))):
        METHODS[name](noisy_building())
    shares, words = zip(*said, strict=True)
    assert shares[0] == 0 and (np.diff(shares) > 0).all() and shares[-1] <= 1
    assert [f"{k} of 6" in text for k, text in enumerate(words)] == 7 * [True]
