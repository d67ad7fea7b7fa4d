"""What chapters 26 and 27 say of more than their own scans: other lasers, other buildings."""

from dataclasses import replace

import numpy as np
import pytest
import segmap_course as course
from past_a_wall import STOPS

import segmap
from segmap import simulation
from segmap.alignment import pose_graph
from segmap.matching import nearest_score, occupancy_score
from segmap.quadtree import build_map

pytestmark = pytest.mark.slow  # many seeds are what they are worth


@pytest.mark.parametrize("building", ["clinic", "office", "room"])
@pytest.mark.parametrize(
    ("sigma", "share"), [(0.005, 0), (0.01, 0), (0.02, 0), (0.03, 0), (0.005, 0.006)]
)
def test_hits_have_many_peaks_and_distances_one_or_two(building, sigma, share):
    """Chapter 26: a scan on the map of those before, within 30 cm of its place; five seeds."""
    walls, path = {
        "clinic": (course.clinic_walls(), segmap.load("clinic").truth[::2]),
        "office": (
            simulation.office(rng=np.random.default_rng(0)),
            simulation.drive(STOPS, step=0.4),
        ),
        "room": (course.room_walls(), course.room_walk(100).truth),
    }[building]
    sensor = replace(simulation.URG_04LX, sigma=sigma, range_share=share)
    for seed in range(5):
        log = simulation.simulate(walls, path, sensor=sensor, rng=np.random.default_rng(seed))
        k = len(log) - 1 - 9 * seed
        poses = pose_graph(log).poses if seed == 0 and sigma == 0.01 else log.truth
        map, points = build_map(log[:k], poses[:k], resolution=0.02), log[k].points()
        hits, distances = (
            course.landscape(map, points, poses[k], score=score, step=0.02)
            for score in (occupancy_score, nearest_score)
        )
        assert len(course.peaks(hits.values)) > 10 and len(course.peaks(distances.values)) <= 2
