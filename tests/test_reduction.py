"""What every reduction method promises, whatever it does inside."""

import inspect

import numpy as np
import pytest

from segmap import reduction
from segmap.reduction import METHODS, Reduction
from segmap.segments import SegmentMap, length

methods = pytest.mark.parametrize("name", METHODS)


def noisy_building(seed: int = 0, seen: int = 6) -> SegmentMap:
    """Four rooms, each wall seen several times by several scans."""
    rng = np.random.default_rng(seed)
    x, y = (np.array(v, float) for v in ([0, 4, 8], [0, 3, 6]))
    walls = [[(a, y[0]), (a, y[-1])] for a in x] + [[(x[0], b), (x[-1], b)] for b in y]
    segments = np.repeat(np.array(walls), seen, axis=0)
    return SegmentMap(
        segments + rng.normal(0, 0.01, segments.shape), np.arange(len(segments)) % seen
    )


@methods
def test_metadata_and_signature(name):
    """A method that is registered under another name, or takes its thresholds by position."""
    method = METHODS[name]
    assert method.function is getattr(reduction, name)
    assert method.merges in ("2 -> 1", "m -> 1", "m -> n")
    assert method.source.startswith("A ")
    first, *others = inspect.signature(method.function).parameters.values()
    assert first.name == "map"
    assert all(p.kind is p.KEYWORD_ONLY and p.default is not p.empty for p in others)


@methods
def test_every_input_is_accounted_for(name):
    """Parents point at outputs that exist, every output has one, seconds are measured."""
    map = noisy_building()
    found = METHODS[name](map)
    assert isinstance(found, Reduction)
    assert found.method == name
    assert found.parents.shape == (len(map),)
    assert set(found.parents) - {-1} == set(range(len(found)))
    assert 0 < len(found) < len(map)
    assert found.seconds > 0
    np.testing.assert_array_equal(found.members(0), np.flatnonzero(found.parents == 0))


@methods
def test_the_map_is_left_as_it_was(name):
    """A method that works in place spoils the map for the next one."""
    segments = np.array(noisy_building().segments)
    before = segments.copy()
    METHODS[name](segments)
    np.testing.assert_array_equal(segments, before)


@methods
def test_maps_arrays_and_reductions_are_all_accepted(name):
    map = noisy_building()
    once = METHODS[name](map)
    np.testing.assert_array_equal(METHODS[name](map.segments).segments, once.segments)
    assert len(METHODS[name](once)) <= len(once)


@methods
def test_the_same_input_gives_the_same_output(name):
    a, b = METHODS[name](noisy_building()), METHODS[name](noisy_building())
    np.testing.assert_array_equal(a.segments, b.segments)


@methods
def test_segments_without_length_are_left_out_first(name):
    """They have no angle: parents -1, and the rest is reduced as if they were not there."""
    map = noisy_building()
    with_points = np.concatenate([np.ones((1, 2, 2)), map.segments, np.zeros((1, 2, 2))])
    found, expected = METHODS[name](with_points), METHODS[name](map.segments)
    np.testing.assert_array_equal(found.segments, expected.segments)
    np.testing.assert_array_equal(found.parents, [-1, *expected.parents, -1])
    assert length(found.segments).min() > 0


@methods
@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_coordinates_must_be_finite(name, bad):
    with pytest.raises(ValueError, match="map must be finite, in metres, but map"):
        METHODS[name](np.array([[(0, 0), (bad, 1)]]))


@methods
def test_empty_map(name):
    found = METHODS[name](SegmentMap([]))
    assert found.segments.shape == (0, 2, 2)
    assert found.parents.shape == (0,)


def test_repr_has_no_address():
    """nbval compares it."""
    found = Reduction(np.zeros((1, 2, 2)), np.zeros(3, int), 0.1, "fusion")
    assert repr(found) == "Reduction(fusion: 3 -> 1 segments)"
