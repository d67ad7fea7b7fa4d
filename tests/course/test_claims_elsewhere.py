"""What a chapter says of more than its own case: other sensors, other offices."""

import re
import sys
from dataclasses import replace
from inspect import getsource

import numpy as np
import pytest
import segmap_course as course
from chapter_rules import CHAPTERS
from past_a_wall import NOISE, STOPS, drive_past_a_wall, thickness
from segmap_course import clinic_walls
from segmap_course.literal.reduction import least_cost as literal_least_cost
from segmap_course.literal.reduction import one_per_wall as literal_walls

import segmap
from segmap import simulation
from segmap.alignment import (
    match_angles,
    match_points,
    match_segments,
    pose_graph,
)
from segmap.poses import between
from segmap.quadtree import build_map
from segmap.reduction import hybrid, least_cost, one_per_wall, viewing_sector

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


@pytest.mark.parametrize(
    ("number", "module"),
    [
        ("20", sys.modules[viewing_sector.__module__]),
        ("21", literal_least_cost),
        ("22", literal_walls),
    ],
)
def test_a_table_of_steps_left_out_has_their_lines(number, module):
    """Catches a step of the table that has grown or has another name."""
    (path,) = [path for path in CHAPTERS if path.name.startswith(f"{number}_")]
    rows = re.findall(r"\| `(\w+)` \| (\d+) \|", path.read_text("utf-8"))
    assert len(rows) >= 5
    for name, lines in rows:
        assert len(getsource(getattr(module, name)).splitlines()) == int(lines), name


@pytest.mark.parametrize("building", ["clinic", 0, 1])
@pytest.mark.parametrize("noise", NOISE, ids=str)
def test_a_tolerance_of_40_mm_keeps_a_wall_of_10_cm_and_70_mm_does_not(noise, building):
    """Chapter 17: over true poses; catches a strip as wide as one tolerance, or as four."""
    for seed in range(5):
        log, middle = drive_past_a_wall(building, noise, seed)
        before = segmap.build_map(log, log.truth)
        narrow, wide = (segmap.fusion(before, tolerance=t).segments for t in (0.04, 0.07))
        assert 0.09 < thickness(narrow, middle) < 0.13 and thickness(wide, middle) < 0.01


@pytest.mark.parametrize("building", ["clinic", 0, 1])
@pytest.mark.parametrize("noise", NOISE, ids=str)
def test_basic_keeps_a_wall_at_half_its_thickness_and_leaves_what_the_order_decides(
    noise, building
):
    """Chapter 14: over true poses, 5 cm for a wall of 10 cm; catches a result without an order."""
    for seed in range(2):
        log, middle = drive_past_a_wall(building, noise, seed)
        before, rng = segmap.build_map(log, log.truth), np.random.default_rng(seed)
        narrow = segmap.reduction.basic_offline(before, distance=0.05).segments
        assert 0.09 < thickness(narrow, middle) < 0.13
        orders = [rng.permutation(len(before)) for _ in range(4)]
        counts = {len(segmap.reduction.basic_offline(before.segments[k])) for k in orders}
        assert len(counts) > 1


@pytest.mark.parametrize("building", ["clinic", 0, 1])
@pytest.mark.parametrize("noise", NOISE, ids=str)
def test_hybrid_leaves_more_the_farther_the_origin_is_and_as_many_about_each_pair(noise, building):
    """Chapter 15: over true poses, for maps that lie 50 m and 500 m away."""
    for seed in range(5):
        log, _ = drive_past_a_wall(building, noise, seed)
        before = segmap.build_map(log, log.truth)
        there = [segmap.SegmentMap(before.segments + (x, 0), before.scan) for x in (0, 50, 500)]
        counts = [[len(hybrid(m, origin=o)) for m in there] for o in ("map", "pair")]
        assert 1.3 * counts[0][0] < counts[0][1] < counts[0][2] and len(set(counts[1])) == 1


@pytest.mark.parametrize("noise", NOISE, ids=str)
def test_one_per_wall_keeps_a_wall_of_10_cm_where_each_pose_is_off_by_1_cm(noise):
    """Chapter 22: of the clinic, five seeds; catches scans that move away from each other."""
    for seed in range(5):
        log, middle = drive_past_a_wall("clinic", noise, seed)
        off = np.random.default_rng(seed).normal(size=log.truth.shape)
        poses = log.truth + off * (0.01, 0.01, np.radians(0.15))
        plan = one_per_wall(segmap.build_map(log, poses, keep_points=True))
        assert 0.09 < thickness(plan.segments, middle) < 0.12 and 0.009 < plan.noise < 0.02


@pytest.mark.parametrize("times", [2, 4, 10, 40])
@pytest.mark.parametrize("sigma", [0.1, 0.2, 0.3])
def test_mean_shift_keeps_walls_from_043_sigma_on_however_often_one_was_seen(sigma, times):
    """Chapter 16: nearer ones are lost, as 8 cm at 20 cm are where one was seen four times."""
    for apart, lines in ((0.33 * sigma, 1), (0.43 * sigma, 2)):
        walls = np.array([[(0, 0), (3, 0)]] * times + [[(0, apart), (3, apart)]])
        assert len(segmap.reduction.mean_shift(walls, sigma=sigma)) == lines
    lower, upper = [(0, 0), (3, 0)], [(0, 0.08), (3, 0.08)]
    assert len(segmap.reduction.mean_shift(np.array([*[lower] * 4, upper]))) == 1


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


def kinds_of_angle_matches(**rules):
    """Right, no match and wrong, of all pairs of scans of the clinic that are six steps apart."""
    log, kinds = segmap.load("clinic"), []
    walls = [segmap.extract_polylines(scan.points()) for scan in log]
    for k in range(len(log) - 6):
        pair, rng = (walls[k], walls[k + 6]), np.random.default_rng(1)
        match = match_angles(*pair, rng=rng, **rules)
        x, y, turn = between(between(log.truth[k], log.truth[k + 6]), match.pose)
        right = np.hypot(x, y) < 0.1 and abs(turn) < np.radians(3)
        kinds.append((0 if right else 2) if match.matched else 1)
    return np.bincount(kinds, minlength=3).tolist()


def test_the_table_of_rules_of_angle_correspondence():
    """Chapter 5: each rule that is added, and few pairs of walls by three heuristics."""
    told = {"penalty": 0.0, "rival": 1.0, "least_share": 1e-6, "least_across": 1e-6}
    rules = [told | {"whole": True}, told, told | {"penalty": 4.0}, {}]
    (path,) = [path for path in CHAPTERS if path.name.startswith("05_")]
    text = path.read_text("utf-8")
    table = [[int(n) for n in row] for row in re.findall(r"\| (\d+) \| (\d+) \| (\d+) \|", text)]
    assert [kinds_of_angle_matches(**rule) for rule in rules] == table
    few = [
        kinds_of_angle_matches(heuristic=name, most_pairs=10)[0]
        for name in ("consecutive", "random", "perpendicular")
    ]
    assert "{}, {} and {} of the 244 are right".format(*few) in text


def test_a_match_is_surer_than_it_should_be_since_the_first_scan_errs_too():
    """Chapter 8: at five places, with noise in both scans and in the second alone."""
    log, ratios = segmap.load("clinic"), []
    for pair in ((194, 218), (60, 72), (58, 62), (132, 156), (192, 198)):
        true = between(*log.truth[list(pair)])
        for sigma in (0.01, 1e-4):
            sensors = [replace(simulation.URG_04LX, sigma=s) for s in (sigma, 0.01)]
            rng, off, claimed = np.random.default_rng(8), [], []
            for _ in range(40):
                scans = [
                    simulation.simulate(clinic_walls(), log.truth[[k]], sensor=sensor, rng=rng)[0]
                    for k, sensor in zip(pair, sensors, strict=True)
                ]
                match = match_points(*(scan.points() for scan in scans), true)
                off.append(((match.pose - true)[:2] ** 2).sum())
                claimed.append(np.trace(match.covariance[:2, :2]))
            ratios.append(np.sqrt(np.mean(off) / np.mean(claimed)))
            if pair == (194, 218) and sigma == 1e-4:
                assert round(1000 * np.sqrt(np.mean(off)), 1) == 1.4
    both, second = ratios[::2], ratios[1::2]
    assert max(second) < 1 < min(both) and (round(min(both), 1), round(max(both), 1)) == (1.0, 1.9)


def test_a_mirrored_log_is_called_good_and_keeps_every_distance():
    """Chapter 13: neither the log nor the tape sees a mirror."""
    case = course.unknown_building()
    scans = [
        replace(scan, angles=-scan.angles, odometry=scan.odometry * (1, -1, -1))
        for scan in case.log
    ]
    log = segmap.Log("mirrored", scans)
    graph = pose_graph(log)
    seen = segmap.build_map(log, graph).filtered(0.3)
    assert graph.verdict_on(seen).grade == "good"
    for taped in case.tape:
        both = [-taped.turn, np.pi - taped.turn]
        metres = simulation.cast_rays(seen.segments, graph.poses[taped.scan], both, max_range=50)
        assert abs(metres.sum() - taped.metres) < 0.05


def test_the_end_is_the_worst_place_of_a_straight_way_and_not_of_a_round():
    """Chapter 2: catches errors that do not add up along the way."""
    worst = []
    for way in (simulation.drive([(0, 0), (20, 0)], step=0.3), segmap.load("clinic").truth):
        last = 0
        for seed in range(40):
            noise = {"odometry_noise": simulation.CHEAP_WHEELS, "rng": np.random.default_rng(seed)}
            off = np.hypot(*(simulation.drifting_odometry(way, **noise) - way)[:, :2].T)
            last += off[-1] == off.max()
        worst.append(last)
    straight, around = worst
    assert straight > 30 and around < 10


def test_segments_find_no_way_home_around_a_corner():
    """Chapter 6: scans 57 and 69 share little; five lasers were tried. Catches a match at all."""
    log = segmap.load("clinic")
    corner = [segmap.extract_polylines(log[k].points()) for k in (57, 69)]
    true = between(*log.truth[[57, 69]])
    for way in np.arange(24) * np.pi / 12:
        found = match_segments(*corner, true + (0.25 * np.cos(way), 0.25 * np.sin(way), 0))
        assert not found.matched or np.hypot(*between(true, found.pose)[:2]) > 0.1
