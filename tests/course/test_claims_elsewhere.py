"""What a chapter says of more than its own case: other sensors, other offices."""

from dataclasses import replace

import numpy as np
import pytest
from past_a_wall import STOPS
from segmap_course import clinic_walls

import segmap
from segmap import simulation
from segmap.alignment import pose_graph
from segmap.quadtree import build_map
from segmap.reduction import least_cost

pytestmark = pytest.mark.slow  # many seeds are what they are worth


@pytest.mark.parametrize("building", ["clinic", "office"])
def test_the_true_walls_are_behind_least_cost_and_the_more_so_the_larger_the_noise(building):
    """Chapter 12: what repeats the noise is preferred, the more so the larger it is."""
    walls, path = clinic_walls(), segmap.load("clinic").truth[::4]
    if building == "office":
        walls, path = (
            simulation.office(rng=np.random.default_rng(0)),
            simulation.drive(STOPS, step=0.6),
        )
    judged = []
    for sigma, share in ((0.001, 0), (0.005, 0), (0.01, 0), (0.02, 0), (0.03, 0), (0.005, 0.006)):
        sensor = replace(simulation.URG_04LX, sigma=sigma, range_share=share)
        log = simulation.simulate(walls, path, sensor=sensor, rng=np.random.default_rng(3))
        before = segmap.build_map(log, log.truth).filtered(0.10)
        judged.append([segmap.quality(before, map) for map in (walls, least_cost(before))])
    true, cheapest = np.transpose(judged)
    assert (true + 0.005 < cheapest).all() and (np.diff(true[:5]) < -0.01).all()


def clinic_seen(share, sigma, poses, seed):
    """The clinic's map by a laser with this noise, on its way; from true poses or the graph's."""
    sensor = replace(simulation.URG_04LX, sigma=sigma, range_share=share)
    way, rng = segmap.load("clinic").truth[::2], np.random.default_rng(seed)
    log = simulation.simulate(clinic_walls(), way, sensor=sensor, rng=rng)
    at = log.truth if poses == "true" else pose_graph(log).poses
    return segmap.build_map(log, at)


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize(
    ("share", "sigma"), [(0, 0.005), (0, 0.01), (0, 0.02), (0, 0.03), (0.006, 0.005)]
)
def test_quality_prefers_the_smaller_penalty_of_least_cost(share, sigma, seed):
    """Chapter 21: quality is not the judge of the penalty."""
    map = clinic_seen(share, sigma, "true" if seed else "graph", seed)
    penalties = (0.05, 0.2, 0.5, 1.0, 1.6)
    qualities = [segmap.quality(map, least_cost(map, penalty=p)) for p in penalties]
    assert (np.diff(qualities) < 0).all()


@pytest.mark.parametrize(("name", "side", "least", "most"), [
    ("clinic", 0.05, 0, 0.01), ("clinic", 0.1, 0, 0.01), ("malaga", 0.1, 0.1, 0.3)
])  # fmt: skip
def test_a_map_guesses_free_cells_in_the_open_and_hardly_any_in_small_rooms(
    name, side, least, most
):
    """Chapter 25: catches a map whose large leaves no longer count rays as a whole."""
    log = segmap.load(name)
    rule, grid = (
        build_map(log, log.truth, resolution=side, free_resolution=finest).to_grid()
        for finest in (None, side)
    )
    free = rule <= 0.25
    assert least <= (free & (grid == 0.5)).sum() / free.sum() < most


@pytest.mark.parametrize("sigma", [0.005, 0.01, 0.02])
def test_a_tolerance_below_three_standard_deviations_loses_walls_and_a_larger_one_gains_none(sigma):
    """Chapter 4: another seed than the chapter's, and a corridor beside the clinic."""
    sensor = replace(simulation.URG_04LX, sigma=sigma)
    clinic, corridor = segmap.load("clinic"), segmap.load("corridor")
    for walls, poses in (
        (clinic_walls(), clinic.truth[::10]),
        (simulation.corridor_loop(), corridor.truth[::8]),
    ):
        log = simulation.simulate(walls, poses, sensor=sensor, rng=np.random.default_rng(0))
        maps = [segmap.build_map(log, log.truth, tolerance=sigma * k) for k in (1, 3, 4, 6)]
        one, three, *more = (segmap.segments.length(map.segments).sum() for map in maps)
        assert one < 0.75 * three and np.allclose(more, three, rtol=0.03)
