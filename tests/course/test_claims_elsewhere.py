"""What a chapter says of more than its own case: other sensors, other offices."""

import numpy as np
import pytest
from segmap_course import LINE_SENSORS

import segmap
from segmap import simulation

STOPS = [(0.7, 5), (11.3, 5), (10, 5), (10, 7.4), (10, 2.6), (10, 5), (6, 5), (6, 7.4)]


@pytest.mark.parametrize("office", range(3))
@pytest.mark.parametrize("sensor", LINE_SENSORS, ids=lambda sensor: sensor.name.split()[0])
def test_to_drop_the_shortest_is_worst_and_the_longest_is_worse_than_blind(sensor, office):
    """Chapter 12: at quality 0.80, over poses that each err by 2 cm."""
    rng = np.random.default_rng(office)
    walls = simulation.office(rng=np.random.default_rng(office))
    path = simulation.drive(STOPS, step=0.6)
    log = simulation.simulate(walls, path, sensor=sensor, rng=rng)
    slips = rng.normal(0, 1, (len(log), 3)) * (0.02, 0.02, 0.005)
    before = segmap.build_map(log, log.truth + slips).filtered().segments
    by_length = before[np.argsort(segmap.segments.length(before))]
    orders = {"longest": by_length, "shortest": by_length[::-1], "blind": rng.permutation(before)}
    shares, reduction = np.linspace(0, 0.9, 10), {}
    for name, order in orders.items():
        left = [order[: len(order) - int(share * len(order))] for share in shares]
        quality = np.array([segmap.quality(before, map) for map in left])
        reduction[name] = np.interp(-0.8, -quality, shares)
    assert reduction["shortest"] + 0.1 < reduction["longest"] < reduction["blind"]
