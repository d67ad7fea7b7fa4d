"""What a chapter says of more than its own case: other sensors, other offices."""

from dataclasses import replace

import numpy as np
import pytest
from segmap_course import LINE_SENSORS, clinic_walls

import segmap
from segmap import simulation
from segmap.alignment import match_points
from segmap.poses import between

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


@pytest.mark.parametrize("building", ["clinic", "office"])
@pytest.mark.parametrize(("sigma", "share"), [(0.005, 0), (0.02, 0), (0.03, 0), (0.005, 0.006)])
def test_a_match_usually_ends_nearer_to_the_truth_than_one_point_could_tell(building, sigma, share):
    """Chapter 7: other lasers, from 14 cm and 6 degrees off; catches a match that does not rest."""
    walls, path = clinic_walls(), segmap.load("clinic").truth
    if building == "office":
        walls, path = (
            simulation.office(rng=np.random.default_rng(0)),
            simulation.drive(STOPS, step=0.4),
        )
    sensor = replace(simulation.URG_04LX, sigma=sigma, range_share=share)
    log = simulation.simulate(walls, path, sensor=sensor, rng=np.random.default_rng(11))
    off = []
    for k in range(4, len(log) - 2, 9):
        truth = between(log.truth[k], log.truth[k + 2])
        start = truth + (0.1, -0.1, 0.1)
        match = match_points(log[k].points()[::3], log[k + 2].points()[::3], start)
        if match.matched and match.free is None and match.overlap > 0.7:
            off.append(np.hypot(*between(truth, match.pose)[:2]))
    assert len(off) > 4 and np.mean(np.array(off) < sigma + 2 * share) >= 0.8
    assert np.median(off) < 0.5 * (sigma + 2 * share)
