"""Every reduction and alignment method comes to an end, however large the walls beside a threshold.

`hybrid` once never returned for a wall longer than 1536 times its distance. A call that takes
longer than five minutes ends the whole run, and shows where it hung.
"""

from __future__ import annotations

import faulthandler
import inspect
from itertools import product

import numpy as np
import pytest
from conftest import slow

from segmap import alignment, reduction, simulation
from segmap.segments import SegmentMap

#: Sizes of a room from a millimetre to a hundred kilometres, and lengths of thresholds, metres.
SIZES = (slow(1e-3), slow(0.1), slow(10), slow(310), slow(1e3), 1e5)
LENGTHS = (1e-4, 0.2, 1e3)
#: Parameters that are lengths; the other thresholds are angles, shares and counts.
NAMED = {"distance", "min_length", "reach", "sigma", "similar", "spacing", "spread", "step",
         "tolerance", "window", "gap"}  # fmt: skip
#: A threshold that asks for too much is refused at once, naming itself.
REFUSED = {"sigma must cut the map", "window must be"}
#: So many pieces `mean_shift` works on for seconds to minutes: 30 microseconds each.
LONG = (30_000, 20_000_000)

pytestmark = pytest.mark.filterwarnings("ignore:.*millimetres:UserWarning")
ROOM = np.array([(0, 0), (1, 0), (1, 0.7), (0.6, 0.7), (0.6, 0.9), (0, 0.9)])


@pytest.fixture(autouse=True)
def watch():
    faulthandler.dump_traceback_later(300, exit=True)
    yield
    faulthandler.cancel_dump_traceback_later()


def lengths(function):
    return [name for name in inspect.signature(function).parameters if name in NAMED]


def outcome(function, given, **threshold):
    """What a method gives; nothing where it refuses the threshold, saying so."""
    try:
        return function(given, **threshold)
    except ValueError as error:
        assert any(str(error).startswith(word) for word in REFUSED), error
    return None


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("name", reduction.METHODS)
def test_every_reduction_returns(name, size):
    """Catches a loop over cells or pieces that grows without end, and a count that overflows."""
    function = reduction.METHODS[name].function
    walls = simulation.polyline(ROOM * size, closed=True)
    segments = np.concatenate([walls, walls * 0.99])
    first = np.arange(0, 2 * len(segments) + 1, 2)
    map = SegmentMap(segments, points=segments.reshape(-1, 2), first=first, sensors=[(0.0, 0.0)])
    for threshold, length in product(lengths(function), LENGTHS):
        if name != "mean_shift" or not LONG[0] < 8 * size / length < LONG[1]:
            found = outcome(function, map, **{threshold: length})
            assert found is None or len(found.parents) == len(segments)


@pytest.mark.parametrize("size", SIZES)
@pytest.mark.parametrize("name", alignment.METHODS)
def test_every_alignment_returns(name, size):
    """Catches a search whose steps never end, or whose window fills the memory."""
    function = alignment.METHODS[name].function
    round_about = simulation.Sensor("round", 180, -np.pi, np.pi / 90, max_range=np.inf)
    path = [((0.3 + 0.01 * k) * size, 0.3 * size, 0.02 * k) for k in range(5)]
    still = simulation.OdometryNoise().ideal()
    walls, rng = simulation.polyline(ROOM * size, closed=True), np.random.default_rng(1)
    log = simulation.simulate(walls, path, sensor=round_about, rng=rng, odometry_noise=still)
    for threshold, length in product(lengths(function), LENGTHS):
        found = outcome(function, log, **{threshold: length})
        assert found is None or len(found.poses) == len(log)


@pytest.mark.parametrize("wall", [(310, 0.2), (16, 0.01), (1e5, 1e-4)])
@pytest.mark.parametrize("name", ["hybrid", "hybrid_fusion"])
def test_a_wall_of_more_than_1536_distances_is_reduced(name, wall):
    length, distance = wall
    found = reduction.METHODS[name]([[(0, 0), (length, 0)]], distance=distance)
    assert found.segments.tolist() == [[[0, 0], [length, 0]]]
