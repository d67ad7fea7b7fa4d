"""What a chapter says of more than its own case: other sensors, other offices."""

import re
from dataclasses import replace
from inspect import getsource

import numpy as np
import pytest
import segmap_course as course
from chapter_rules import CHAPTERS
from segmap_course import LINE_SENSORS, clinic_walls
from segmap_course.literal.reduction import least_cost as literal_least_cost
from segmap_course.literal.reduction.least_cost_merges import merge_all

import segmap
from segmap import simulation
from segmap.alignment import match_points, pose_graph
from segmap.poses import between
from segmap.reduction import least_cost

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


def test_what_malaga_misses_is_short():
    """Chapter 21: nine tenths of it in looks below .5 m; 25 looks at a wall become one line."""
    log = segmap.load("malaga")
    looks = segmap.build_map(log, log.truth).segments
    plan = least_cost(looks, penalty=1.0)
    wall = (abs(looks[..., 0] - 8.35) < 0.25) & (abs(looks[..., 1] + 9.1) < 1)
    assert wall.all(axis=1).sum() == 25 and len(set(plan.parents[wall.all(axis=1)])) == 1
    missed = np.array([segmap.metrics.missed(look[None], plan) for look in looks])
    assert 0.85 < missed[segmap.segments.length(looks) < 0.5].sum() / missed.sum() < 0.95


def test_the_table_of_least_cost_has_the_lines_of_its_steps():
    """Catches a step of chapter 21's table that has grown or has another name."""
    (path,) = [path for path in CHAPTERS if path.name.startswith("21_")]
    rows = re.findall(r"\| `(\w+)` \| (\d+) \|", path.read_text("utf-8"))
    assert len(rows) == 7
    for name, lines in rows:
        assert len(getsource(getattr(literal_least_cost, name)).splitlines()) == int(lines), name


def test_two_faces_stay_where_the_exercise_of_least_cost_is_solved():
    """Chapter 21: six looks, and any penalty; the chapter's own cost merges them at 1.0 m."""
    log = segmap.load("clinic")[::10]
    looks = segmap.build_map(log, log.truth).segments
    near = (abs(looks[..., 0] - 5.45) < 0.09) & (looks[..., 1] > 1.45) & (looks[..., 1] < 4.42)
    few, cost = looks[near.all(axis=1)], course.check_cost_of_faces.solution
    assert len(few) == 6 and len(merge_all(few, 1.0)) == 1
    assert len(merge_all(few, 1.0, cost)) == len(merge_all(few, 100.0, cost)) == 2
