"""Where the rules of matching end: a little less and a little more than what they allow."""

import threading
from dataclasses import replace
from functools import partial
from inspect import signature

import numpy as np
import pytest
from planned_loops import LOG, Planned
from quadtrees import state

from segmap import LaserScan
from segmap.matching import (
    DistanceField,
    LiveMap,
    _live_map,
    _mapping,
    _particles,
    effective_number,
    field_score,
    hill_climb,
    localize,
    map_scans,
    nearest_score,
    particle_mapping,
    route,
    sample_and_rank,
    search,
    systematic,
)
from segmap.matching import _localize as localizing
from segmap.matching import _merge as joining
from segmap.matching import _search as searching
from segmap.matching._likelihoods import Likelihoods
from segmap.matching._live_map import overlap_of
from segmap.matching._particles import Particles, odometry_deviation
from segmap.matching._route import _sees
from segmap.quadtree import QuadtreeMap, Squares
from segmap.segments import SegmentMap
from segmap.simulation import URG_04LX, OdometryNoise, simulate, square_room

ROOM = SegmentMap(square_room(4.0))
ZERO = np.zeros(3)


def scan_of(points):
    x, y = np.array(points, float).T
    return LaserScan(np.hypot(x, y), np.arctan2(y, x))


# ------------------------------------------------------------------ a scan on a whole map
@pytest.mark.parametrize(
    ("other", "places"),
    [
        *(((0.3, 0, 0), 1), ((0.31, 0, 0), 2), ((0.2, -0.2, 0), 1), ((0.22, 0.22, 0), 2)),
        *(((0, 0, -0.29), 1), ((0, 0, 0.31), 2), ((0, 0, 2 * np.pi - 0.29), 1)),
    ],
)
def test_a_place_so_near_to_a_better_one_is_none_of_its_own(other, places):
    assert searching.first_distinct(np.array([ZERO, other]), 9).tolist() == [0, 1][:places]
    assert len(searching.first_distinct(np.arange(9)[:, None] * np.ones(3), 4)) == 4


def test_ends_that_lie_far_apart_count_as_a_step_of_thirty_centimetres():
    """Of six ends two gaps are of ten metres: all steps are equal."""
    x = np.array([0, 10, 20, 20.3, 20.6, 20.9])
    found = searching.sample_beams(np.column_stack([x, 0 * x]), 3)
    assert sorted(found[:, 0]) == [0, 20.3, 20.9]


@pytest.mark.parametrize(("length", "headings"), [(0.5, 126), (2.0, 252), (90.0, 889)])
def test_headings_move_the_mean_beam_by_a_cell(length, headings):
    """Not coarser than three degrees, not finer than for a beam across the map (141.4 cells)."""
    map, ends = Likelihoods(ROOM), length * np.array([(1, 0), (0, 1)])
    cells, step = searching._cells_by_heading(map, ends)
    assert cells.shape == (headings, 2, 2) and step == 2 * np.pi / headings


def test_the_covariance_of_a_pose_that_nothing_tells_is_that_of_all_poses_within_four_cells():
    map = Likelihoods(ROOM)
    scan, step = searching._cells_by_heading(map, np.array([(70.0, 0), (0, 80)]))
    found = searching._leaf_covariance(map, scan, np.array([0, 0, 9, 9]), step)
    expected = np.array([0.05, 0.05, step]) ** 2 * (60 / 9 + 1 / 12)
    np.testing.assert_allclose(found, np.diag(expected), atol=1e-15)


@pytest.mark.parametrize("cell", [0.1, 0.05, 0.03, 0.025, 0.0125, 0.01])
def test_a_map_has_half_a_metre_around_it_in_cells_of_five_centimetres_at_most(cell):
    map, side = (
        QuadtreeMap(resolution=cell),
        {0.025: 0.05, 0.0125: 0.05, 0.01: 0.04}.get(cell, cell),
    )
    map.insert_scan((1.01, 2.01), [(1.01, 2.01)])
    found, edge = Likelihoods(map), np.ceil(0.5 / side - 1e-9)
    assert found.size == pytest.approx(side) and found.shape == (2 * edge + 1, 2 * edge + 1)
    corner = (np.floor(np.array([1.01, 2.01]) / side) - edge) * side
    np.testing.assert_allclose(found.corner, corner)


@pytest.mark.parametrize(("fit", "found"), [(0.85, True), (0.849, False)])
def test_a_place_is_believed_where_it_fits(fit, found):
    map = Likelihoods(SegmentMap([[(0, 0), (3, 0)], [(0, 0), (0, 2)], [(1, 1), (2, 1.6)]]))
    map.fits = lambda points, poses: np.full(len(poses), fit)
    points = (
        [(x / 4, 0) for x in range(1, 12)] + [(0, y / 4) for y in range(8)] + [(1, 1), (2, 1.6)]
    )
    places = searching.distinct_places(map, np.array(points), margin=0.01)
    assert len(places) == 1 and places.found == found


SOUGHT = {"least": 0.5, "margin": 0.05, "most_places": 6, "beams": 60, "nodes": None}
USUAL = [
    *(
        (search, SOUGHT),
        (searching.distinct_places, SOUGHT),
        (localize, {"particles": 1000, "beams": 60}),
    ),
    (hill_climb, {"steps": "halving", "rounds": 60, "score": field_score}),
    (sample_and_rank, {"sigma": (0.02, np.radians(2)), "score": field_score}),
    (map_scans, {"settle": 1, "free": False, "graph": False, "start": (0, 0, 0)}),
    (particle_mapping, {"particles": 30, "noise": 1, "resample": 0.5, "free": False}),
    *((DistanceField, {"resolution": 0.05}), (DistanceField.around, {"resolution": 0.02})),
    (LiveMap, {"start": (0, 0, 0), "free": False}),
]


@pytest.mark.parametrize(("of", "usual"), USUAL)
def test_what_is_meant_where_nothing_is_said(of, usual):
    given = signature(of).parameters
    assert {name: given[name].default for name in usual} == usual


HERE, RNG = ([(1, 0)], ZERO), {"rng": np.random.default_rng(1)}
WRONG = [
    *(("map", of, (3, *HERE), {}) for of in (DistanceField.around, hill_climb, nearest_score)),
    *(("map", DistanceField, (3,), {}), ("map", route, (3, (0, 0), (1, 1)), {"radius": 0.1})),
    *(("map", search, (3, LOG[0]), {}), ("map", localize, (3, LOG), RNG)),
    *(
        (name, particle_mapping, (LOG,), {name: 3, **RNG})
        for name in ("odometry", "matcher", "map")
    ),
    *((name, map_scans, (LOG,), {name: 3}) for name in ("matcher", "score", "map", "graph")),
    *(("log", of, (3,), RNG) for of in (particle_mapping, map_scans)),
    *(("score", hill_climb, (ROOM, *HERE), {"score": 3}), ("scan", search, (ROOM, 3), {})),
]


@pytest.mark.parametrize(("name", "of", "given", "named"), WRONG)
def test_what_is_of_another_kind_is_named_at_once(name, of, given, named):
    with pytest.raises(ValueError, match=rf"^{name} must be"):
        of(*given, **named)


def test_a_second_session_is_sought_on_cells_of_five_centimetres(monkeypatch):
    """Scans that score less than 0.7 are passed over at once, and none is tied where none is."""
    asked, nothing = set(), searching.distinct_places(None, np.zeros((0, 2)))
    sought = lambda map, scan, *, least: asked.add((map.resolution, least)) or nothing  # noqa: E731
    monkeypatch.setattr(joining, "search", sought)
    found = joining.merge(LOG[:3], LOG[3:6])
    assert asked == {(0.05, 0.7)} and "not merged" in found.doubt


# ------------------------------------------------------------------ scan after scan
@pytest.mark.parametrize(("off", "on"), [(0.14, True), (0.15, False)])
def test_an_end_lies_on_the_map_twelve_centimetres_and_half_a_cell_from_it(off, on):
    map = QuadtreeMap(resolution=0.05)
    map.insert_scan((0, 0), [(1.025, 0.025)])
    assert overlap_of(map, np.array([(1.025, 0.025 + off)]), ZERO) == on
    assert overlap_of(map, np.zeros((0, 2)), ZERO) == 0


@pytest.mark.parametrize(("on", "found"), [(3, True), (2, False)])
def test_a_robot_is_found_where_three_fifths_of_its_scan_lie_on_the_map(on, found):
    first = [(1, y / 2) for y in range(5)]
    second = first[:on] + [(9, y) for y in range(5 - on)]
    still = partial(lambda map, points, start, *, score: start)
    *_, last = map_scans([scan_of(first), scan_of(second)], matcher=still)
    assert last.overlap == on / 5 and last.found == found
    assert Particles(np.zeros((1, 3)), np.ones(1), np.zeros(1, int), 0, on / 5, 0.0).found == found


@pytest.mark.parametrize("score", [field_score, nearest_score, lambda *given: np.zeros(1)])
def test_what_is_compiled_is_loaded_before_a_scan_is_asked_for(score, monkeypatch):
    """Of a score of the user's own nothing is compiled."""
    asked = []
    monkeypatch.setattr(_mapping, "_warm", asked.append)
    monkeypatch.setattr(_mapping, "_warm_graph", lambda: asked.append("graph"))
    scans = (asked.append("scan") or scan_of([(1, 0)]) for _ in range(1))
    list(map_scans(scans, score=score))
    list(map_scans([], graph=True))
    warm = field_score if score is not nearest_score else score
    assert asked == [warm, "scan", "graph"]
    monkeypatch.undo()
    assert any(_mapping._warm_graph()), "loops are loaded where one closes"


@pytest.mark.parametrize("step", [(3, 4, 0), (0, 0, -2), (0, 0, 0)])
def test_the_errors_of_the_odometry_add_up_as_squares(step):
    noise, way, turn = OdometryNoise(0.1, 0.2, 0.3, 0.4), np.hypot(*step[:2]), abs(step[2])
    along = noise.distance_noise**2 * way + 0.002**2
    about = noise.turn_noise**2 * turn + noise.heading_noise**2 * way
    about += (noise.turn_bias * turn) ** 2 + 0.001**2
    np.testing.assert_allclose(
        odometry_deviation(np.array(step), noise) ** 2, (along, along, about)
    )


def driven(*steps):
    """Scans of a room from places that the odometry knows."""
    poses = np.vstack([(1, 1, 0), (1, 1, 0) + np.reshape(steps, (-1, 3))])
    log = simulate(ROOM.segments, poses, sensor=URG_04LX, rng=np.random.default_rng(1))
    return [replace(scan, odometry=pose) for scan, pose in zip(log, poses, strict=True)]


@pytest.mark.parametrize(("on", "starts"), [(6, 1), (5, 8)])
def test_a_scan_of_which_a_quarter_is_off_the_map_is_turned_more(on, starts):
    map, ends, asked = QuadtreeMap(), [(1, y / 2) for y in range(8)], []
    map.insert_scan((0, 0), ends[:on])
    still = lambda map, points, start, *, score: asked.append(start) or start  # noqa: E731
    tries = [_particles.LATE_TURNS[:1], _particles.LATE_TURNS]
    pose, _ = _particles._climbed(still, map, ZERO, np.array(ends), tries)
    assert pose.tolist() == [0, 0, 0] and len(asked) == starts


@pytest.mark.parametrize("times", [1, 40])
def test_sixty_beams_of_a_scan_are_weighed_and_each_may_meet_anything(times):
    """One on its wall, one off by its standard deviation, one far away; and no map at all."""
    map = QuadtreeMap(resolution=0.05)
    map.insert_scan((0, 0), [(1.025, 0.025)])
    points = np.repeat([(1.025, 0.025), (1.025, 0.075), (1.025, 2.0)], times, axis=0)
    each, field = np.log([1, 0.9 * np.exp(-0.5) + 0.1, 0.1]), DistanceField(map)
    found = [_particles._log_likelihood(near, points, ZERO[None])[0] for near in (field, None)]
    expected = min(times, 20) * np.array([each.sum(), 3 * np.log(0.1)])
    np.testing.assert_allclose(found, expected, rtol=1e-5)


def test_a_map_that_could_not_be_made_anew_is_made_with_the_next(monkeypatch):
    live, insert, fails = LiveMap(Planned((9,))), _live_map.insert_placed, [True]

    def failing(*given, free):
        if threading.current_thread().name == "new map" and fails and fails.pop():
            raise MemoryError
        insert(*given, free=free)

    monkeypatch.setattr(_live_map, "insert_placed", failing)
    for scan in LOG[:9]:
        live.add(scan)
    with pytest.raises(MemoryError):
        live.add(LOG[9])
        live.finish()
    live.finish()
    again = QuadtreeMap()
    for (_, scan), pose in zip(live._scans, live.poses, strict=True):
        insert(again, None, scan, pose, free=False)
    assert state(live.map) == state(again) and not fails


def test_a_robot_that_is_nowhere_has_nothing_on_the_map():
    map = QuadtreeMap()
    map.insert_scan((0, 0), [(1, 1)])
    step = LiveMap(map=map, start=None, rng=np.random.default_rng(1)).add(LaserScan([], []))
    assert step.overlap == 0 and not step.found


# ------------------------------------------------------------------ a robot on a known map
@pytest.mark.parametrize(
    ("way", "errors"),
    [
        *((None, (0.1, 0.1, 0.1)), (ZERO, (0.02, 0.02, 0.01))),
        *(((3, -4, 0), (0.52, 0.52, 0.26)), ((0, 0, -2), (0.02, 0.02, 0.21))),
    ],
)
def test_particles_move_by_the_odometry_with_its_errors(way, errors):
    """At rest, for each metre and for each radian; 0.1 m and 0.1 rad where there is none."""
    first = LaserScan([], [], odometry=None if way is None else ZERO)
    second = LaserScan([], [], odometry=way)
    poses, rng = np.zeros((20_000, 3)), np.random.default_rng(1)
    found = localizing.predict(poses, first, second, rng)
    np.testing.assert_allclose(found.std(0), errors, rtol=0.03)
    np.testing.assert_allclose(found.mean(0), ZERO if way is None else way, atol=0.02)
    assert localizing.predict(poses, None, second, rng) is poses


def believed_of(fits, there, monkeypatch, places=((ZERO, 1.0),)):
    """Beliefs of a robot whose scans fit so, and those at which the whole map was searched.

    A search finds `places`, with the shares of the particles there, that fit as well as `there`.
    """
    searched, beliefs, now = [], [], iter(fits)

    class Map:
        def fits(self, points, poses):
            if searched and searched[-1] == len(beliefs) and self.fresh:
                self.fresh = False
                return np.full(len(poses), there)
            return np.full(len(poses), next(now))

    def fresh(map, ends, count, rng):
        searched.append(len(beliefs))
        map.fresh = True
        found = [np.tile(place, (round(count * share), 1)) for place, share in places]
        return np.concatenate(found)[: count if there else 0]

    monkeypatch.setattr(localizing, "fresh_poses", fresh)
    scans = [scan_of([(1, 0), (0, 1)])] * len(fits)
    for belief in localizing._beliefs(Map(), scans, np.random.default_rng(1), 300, 40):
        beliefs.append(belief)
    return beliefs, searched


def test_a_search_that_brings_nothing_is_repeated_ever_less_often(monkeypatch):
    _, searched = believed_of([0.5] * 70, 0.5, monkeypatch)
    assert searched == [0, 1, 3, 7, 15, 31, 47, 63]


def test_a_scan_that_lies_nowhere_brings_no_particles(monkeypatch):
    beliefs, searched = believed_of([0, 0], 0, monkeypatch)
    assert [belief.reason for belief in beliefs] == ["lost: no place explains the scan"] * 2
    assert searched == [0, 1]


@pytest.mark.parametrize(("fit", "searched"), [(0.93, [0]), (0.929, [0, 1])])
def test_the_map_is_searched_again_until_the_robot_is_found(fit, searched, monkeypatch):
    """Catches a robot that is not found, and fits to four fifths at a wrong place for ever."""
    assert believed_of([0, fit], fit, monkeypatch)[1] == searched


@pytest.mark.parametrize(
    ("fit", "said"), [(0.93, ""), (0.929, "not yet"), (0.7, "not yet"), (0.699, "lost")]
)
def test_how_well_scans_fit_says_whether_the_robot_is_found(fit, said, monkeypatch):
    (belief,), _ = believed_of([0], fit, monkeypatch)
    assert belief.reason.split(":")[0] == said and belief.found == (not said)


@pytest.mark.parametrize(
    ("places", "count"),
    [
        *((((ZERO, 1.0), ((1, 0, 0), 0.0)), 1), (((ZERO, 0.95), ((1, 0, 0), 0.05)), 2)),
        *((((ZERO, 0.5), ((0.3, 0.4, 0), 0.5)), 1), (((ZERO, 0.5), ((0.36, 0.36, 0), 0.5)), 2)),
        *((((ZERO, 0.5), ((0, 0, -0.5), 0.5)), 1), (((ZERO, 0.5), ((0, 0, 0.51), 0.5)), 2)),
        (((ZERO, 0.5), ((1, 0, 0), 0.3), ((2, 0, 0), 0.2)), 3),
        (((ZERO, 0.5), ((1, 0, 0), 0.46), ((2, 0, 0), 0.04)), 3),
    ],
)
def test_how_many_places_there_are(places, count, monkeypatch):
    (belief,), _ = believed_of([0], 0.95, monkeypatch, places)
    assert belief.reason == ("" if count == 1 else f"not yet: {count} places")


@pytest.mark.parametrize(("there", "added"), [(0.51, 0), (0.53, 300)])
def test_a_place_must_fit_better_by_a_twentieth(there, added, monkeypatch):
    beliefs, _ = believed_of([0, 0.5], there, monkeypatch)
    before, after = (len(belief.poses) for belief in beliefs)
    assert after - before == added


@pytest.mark.parametrize(("missing", "both"), [(2, True), (3, False)])
def test_fresh_particles_come_to_places_that_are_worse_by_a_tenth(missing, both):
    """Of two places where 25 ends were, one lacks some."""
    x, y = np.divmod(np.arange(25), 5)
    ends = np.column_stack([x + 0.3 * np.sin(9 * x + y), y + 0.3 * np.sin(x * y)]) - 1.5
    map = QuadtreeMap(resolution=0.05)
    for place in (*(ends + 5.025), *(ends[missing:] + (20.025, 5.025))):
        map.insert_scan(place, [place])
    found = localizing.fresh_poses(Likelihoods(map), ends, 9000, np.random.default_rng(1))
    assert np.unique(np.rint(found[:, 0])).tolist() == [5, 20][: 1 + both]
    if not both:  # as widely as the place is uncertain
        (spread,) = searching.distinct_places(Likelihoods(map), ends, margin=0.1).covariances
        np.testing.assert_allclose(np.cov(found.T), spread, atol=0.1 * spread.max())
    for nowhere in (9 * ends, ends[:1]):  # and where a hundred places are as good
        assert len(localizing.fresh_poses(Likelihoods(ROOM), nowhere, 40, None)) == 0


# ------------------------------------------------------------------ smaller parts
def test_a_line_through_the_corner_of_four_cells_crosses_two_of_them():
    clear = Squares(np.array([(0, 1), (1, 0)]), np.zeros(2, int))
    assert _sees(clear, np.array([0.5, 1.5]), np.array([1.5, 0.5]))
    assert not _sees(clear, np.array([0.5, 1.5]), np.array([1.5, 0.6]))


@pytest.mark.parametrize("weights", [[0.5, 0.4], [0.5, 0.5000012], [1.1, -0.1], [[1.0]]])
def test_weights_are_shares(weights):
    with pytest.raises(ValueError, match="none negative, and sum to 1"):
        effective_number(weights)
    assert systematic([0.5, 0.5], 1.0).tolist() == [1, 1]  # a tooth at the very end
    with pytest.raises(ValueError, match="offset must be"):
        systematic([0.5, 0.5], 1.01)


@pytest.mark.parametrize(("heading", "wrapped"), [(np.pi, -np.pi), (-np.pi, -np.pi), (3.0, 3.0)])
def test_a_heading_of_half_a_turn_is_that_to_the_right(heading, wrapped):
    score = lambda map, points, poses: np.zeros(len(poses))  # noqa: E731
    assert hill_climb(QuadtreeMap(), [(1, 0)], (0, 0, heading), score=score)[2] == wrapped
    with pytest.raises(ValueError, match="map must be a QuadtreeMap or a SegmentMap"):
        hill_climb(3, [(1, 0)], (0, 0, heading), score=score)
