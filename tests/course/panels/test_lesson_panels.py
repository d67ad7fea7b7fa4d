"""Lesson panels: each answers its controls, and shows what its method finds."""

from functools import cache

import numpy as np
import pytest
import segmap_course as course
from conftest import slow
from driven_panels import LEANING, LOG, ROOM, WALLS, assert_answers, unpainted
from quadtrees import leaves_of

from segmap import SegmentMap, fusion, load, quality
from segmap.alignment import (
    backbone_steps,
    match_angles,
    match_points,
    match_segments,
    pose_graph,
)
from segmap.exports import ros_classes
from segmap.extraction import extract_polylines
from segmap.poses import between
from segmap.quadtree import QuadtreeMap, build_map
from segmap.reduction import (
    basic_online,
    fusion_online,
    fuzzy_clustering,
    fuzzy_set,
    hybrid,
    hybrid_fusion,
    least_cost,
    mean_shift,
    polyline,
    segment_similarity,
    uncertain_parameters,
    viewing_sector,
    weighted_line_fitting,
)
from segmap.simulation import URG_04LX, rectangular_room, square_room
from segmap.testing import assert_poses_equal

#: A door in the wall at y = 3: shut in scan 0, open in scan 1, which sees the wall behind.
DOOR = SegmentMap(
    [[(-2, 3), (2, 3)], [(-2, 3), (-1, 3)], [(1, 3.05), (2, 3.05)], [(-2, 5), (2, 5)]],
    [0, 1, 1, 1],
    sensors=[(0, 0), (0, 0)],
)
#: A wall with a hole of 0.08 m.
BROKEN = SegmentMap([[(0, 0), (2, 0)], [(2.08, 0), (4, 0)]])
#: Three walls in two scans that are a chain, and one 0.2 m beside them.
BENT = SegmentMap(
    [[(0, 0), (1, 0)], [(0.9, 0.02), (2, 0.3)], [(1.8, 0.3), (3, 0.3)], [(2, 0.5), (4, 0.5)]],
    [0, 1, 0, 2],
)
#: Three pieces of a bend, seen one after the other: on-line and off-line differ.
BEND = SegmentMap(
    [[(0, 0), (1, 0)], [(2.1, 0.1), (3, 0.2)], [(1.05, 0), (2.05, 0.1)]], scan=[0, 1, 2]
)
CORNER = SegmentMap([[(0, 0), (2, 0)], [(0, 0.01), (1.95, 0.3)]])
LOOP = load("corridor")
#: Half a square room, seen from its middle.
OPEN = QuadtreeMap(resolution=0.05, free_resolution=0.1)
OPEN.insert_scan((1, 1), [(x, y) for x in np.arange(0, 2, 0.05) for y in (0, 2)])


@cache
def looped():
    return pose_graph(LOOP)


#: The other face of the walls of a room that are 0.3 m thick.
SHELL = rectangular_room(4.6, 3.6) - 0.3
#: Every lesson panel, a control of it, and a value that must change what is seen.
PANELS = {
    "AnglePanel": ((LOG,), "rank", 2),
    "BackbonePanel": ((LOG,), "scan", 3),
    "BasicPanel": ((WALLS,), "distance", 0.05),
    "EarlyMethodsPanel": ((BENT,), "tolerance", 0.4),
    "EndsPanel": ((LOG, LOG.truth), "doublings", 2),
    "ClassesPanel": ((build_map(LOG, LOG.truth),), "occupied", 0.9),
    "ClusterPanel": ((LOG[0],), "gap", 0.05),
    "FinderPanel": ((), "view", 3),
    "FusionPanel": ((WALLS,), "tolerance", 0.12),
    "GlobalPanel": ((LOOP[:12],), "similar", 0.05),
    "GroundTruthPanel": ((LOG,), "late", 0.1),
    "HybridPanel": ((LEANING,), "origin", 20),
    "IcpPanel": ((LOG[0].points(), LOG[1].points(), (0.5, 0, 0)), "x", -0.2),
    "KalmanPanel": ((SegmentMap(np.concatenate([ROOM, SHELL])), LOG), "off", -40),
    "LandscapePanel": ((LOG,), "turn", 12),
    "LeastCostPanel": ((WALLS,), "penalty", 0.005),
    "MatcherPanel": (
        (build_map(LOG[:1], LOG.truth[:1], resolution=0.02), LOG[1].points(), LOG.truth[1]),
        "step",
        3,
    ),
    "MeanShiftPanel": ((WALLS,), "sigma", 0.60),
    "OnePerWallPanel": ((WALLS,), "factor", 4.0),
    "PlacePanel": ((build_map(LOG, LOG.truth, resolution=0.05), LOG), "scan", 0),
    "ParticlePanel": ((LOG,), "particles", 2),
    "MovingPanel": ((ROOM, (1, 1, 0)), "turn", 150),
    "PolylinePanel": ((LOG[0],), "tolerance", 0.005),
    "PoseGraphPanel": ((LOOP,), "scan", 60),
    "RayPanel": ((), "mask", False),
    "RoomPanel": ((ROOM, (1, 1, 0)), "beams", 51),
    "RoutePanel": ((OPEN, (1, 1), (1, 1.5)), "goal_x", 2.0),
    "SectorPanel": ((DOOR,), "scan", 0),
    "SegmentIcpPanel": ((LOG,), "x", 1.5),
    "StoragePanel": ((LOG, LOG.truth, ROOM), "resolution", 10.0),
    "TapePanel": ((course.unknown_building(),), "scan", 12),
    "LineErrorPanel": ((WALLS,), "place", 0.10),
}


def test_all_lesson_panels_are_here():
    """Catches a new panel that these tests do not drive."""
    assert set(PANELS) == {name for name in dir(course) if name.endswith("Panel")}


#: One of each kind; chapters drive every panel.
QUICK = ("BasicPanel", "ClusterPanel", "FusionPanel", "RayPanel", "IcpPanel")


@pytest.mark.parametrize("name", [name if name in QUICK else slow(name) for name in PANELS])
def test_a_lesson_panel_answers_its_controls_and_is_shown_without_a_kernel(name, monkeypatch):
    shown, control, value = PANELS[name]
    more = (looped(),) if name == "PoseGraphPanel" else ()
    panel = getattr(course, name)(*shown, *more)
    assert repr(panel).startswith(f"{name}(")
    assert_answers(panel, control, value, monkeypatch)


@unpainted
def test_keywords_of_the_method_are_shown_at_first_in_one_unit_whatever_the_panel():
    """Catches an angle that one panel takes in degrees and its sibling in radians."""
    for panel in (course.BasicPanel, course.HybridPanel):
        shown = panel(WALLS, distance=0.3, angle=np.radians(20))
        assert (shown.distance.value, shown.angle.value) == (0.3, 20)
        assert shown.angle.description == "angle [degrees]" and shown.angle.min == 1
        assert shown.chosen().items() >= {"distance": 0.3, "angle": np.radians(20)}.items()
    assert course.LineErrorPanel(WALLS, place=0.1).chosen()["sigma_place"] == 0.1
    with pytest.raises(TypeError, match="BasicPanel has no keyword count, tolerance"):
        course.BasicPanel(WALLS, tolerance=0.3, count=4)


@unpainted
@pytest.mark.parametrize(
    ("name", "map", "method", "settings"),
    [
        ("FusionPanel", WALLS, fusion, {"tolerance": 0.06}),
        ("BasicPanel", BEND, basic_online, {"distance": 0.15, "angle": 4}),
        ("HybridPanel", LEANING, hybrid, {"angle": 5, "distance": 0.05}),
        ("MeanShiftPanel", CORNER, mean_shift, {"sigma": 0.5, "angle": 10}),
        ("LineErrorPanel", WALLS, weighted_line_fitting, {"place": 0.1, "heading": 2, "chi2": 3}),
        ("LeastCostPanel", WALLS, least_cost, {"penalty": 0.4, "distance": 0.2}),
        ("EarlyMethodsPanel", BENT, polyline, {"tolerance": 0.4, "far": 0.25}),
        ("LineErrorPanel", WALLS, uncertain_parameters, {"distance": 0.2, "angle": 20}),
        ("LineErrorPanel", WALLS, segment_similarity, {"cost": 0.1}),
        ("EarlyMethodsPanel", WALLS, fuzzy_set, {"across": 0.04, "along": 0.1, "angle": 5}),
        ("EarlyMethodsPanel", WALLS, fuzzy_clustering, {"cell": 1, "noise": 0.3}),
        ("FusionPanel", BENT, hybrid_fusion, {"tolerance": 0.2, "every": 1, "distance": 0.4}),
        ("FusionPanel", BENT, fusion_online, {"tolerance": 0.2}),
        ("SectorPanel", DOOR, viewing_sector, {"forget": False}),
        ("SectorPanel", DOOR, viewing_sector, {"min_length": 1.0, "distance": 0.02}),
    ],
)
def test_a_panel_of_a_reduction_shows_what_the_method_finds(name, map, method, settings):
    """Catches degrees taken for radians, thresholds not handed on, a box without effect."""
    panel = getattr(course, name)(map)
    if method.__name__ in getattr(getattr(panel, "by", None), "options", ()):
        panel.by.value = method.__name__
    for control, value in settings.items():
        getattr(panel, control).value = value
    if method is basic_online:
        panel.online.value = True
    named = {"place": "sigma_place", "heading": "sigma_heading", "cost": "distance"}
    given = {named.get(k, k): v for k, v in settings.items()}
    given |= {k: np.radians(given[k]) for k in ("angle", "sigma_heading") if k in given}
    if method is mean_shift:
        given["bandwidth"] = given.pop("angle") / 0.20
    found = method(map, **given)
    assert np.array_equal(panel.reduction.segments, found.segments)
    assert panel.reduction.method == method.__name__
    assert panel.count.value == f"{len(found)} of {len(map)} segments left"
    assert panel.quality.value.startswith(f"quality {quality(map, found):.1%}")


@unpainted
def test_thresholds_of_other_methods_are_grey_and_not_handed_on():
    """Catches a slider that moves and changes nothing, and one that stays grey."""
    panel = course.LineErrorPanel(WALLS)
    assert not panel.chi2.disabled and panel.angle.disabled and panel.cost.disabled
    panel.by.value = "segment_similarity"
    assert panel.chosen() == {"distance": 0.03}
    assert panel.chi2.disabled and panel.angle.disabled and not panel.cost.disabled
    panel.reset()
    assert not panel.chi2.disabled and panel.cost.disabled


@unpainted
def test_segment_icp_panel_begins_off_the_truth_and_ends_in_the_match():
    """Catches degrees taken for radians, thresholds not handed on, a start about another pose."""
    panel = course.SegmentIcpPanel(LOG, apart=2)
    first, second = (extract_polylines(LOG[k].points()) for k in (0, 2))
    real = between(LOG.truth[0], LOG.truth[2])
    for chosen in ({"angle": 30, "distance": 0.5}, {"share": 0.9, "angle": 2}):
        for control, value in chosen.items():
            getattr(panel, control).value = value
        turned = {k: np.radians(v) if k == "angle" else v for k, v in chosen.items()}
        found = match_segments(first, second, real + [0.2, 0.2, np.radians(5)], **turned)
        assert panel.match.matched == found.matched
        np.testing.assert_allclose(panel.match.pose, found.pose, atol=1e-12)
        panel.reset()


def test_sector_panel_forgets_the_door_when_it_has_seen_through_it(figures):
    """Catches a panel that shows all scans whichever is chosen, or the sensor of another one."""
    panel = course.SectorPanel(DOOR)
    assert panel.count.value == "3 of 4 segments left" and len(panel.map) == 4
    panel.scan.value = 0
    assert panel.count.value == "1 of 1 segments left" and len(panel.map) == 1
    assert figures[-1].axes[0].lines[-1].get_xydata().tolist() == [[0, 0]]
    assert figures[-1].axes[0].get_ylim() == pytest.approx((-0.3, 5.3))  # of the whole map


@unpainted
def test_least_cost_panel_tells_what_is_promised_and_what_quality_does_not_see():
    """Catches a promise in per cent of the penalty alone, and metres that are swapped."""
    panel = course.LeastCostPanel(BROKEN)
    assert panel.promised.value == "quality promised 100.0%"  # nothing merged, nothing lost
    panel.gap.value = 0.09
    assert panel.unseen.value == "invented 0.08 m, missed 0.00 m"
    assert panel.promised.value == f"quality promised {np.exp(-0.05 * 1 / 2 / 0.05):.1%}"


@unpainted
def test_hybrid_panel_moves_the_origin_and_not_the_map():
    """Catches a result in the frame of the moved origin, or moved the wrong way; a lost filter."""
    panel = course.HybridPanel(LEANING)
    assert panel.dropped.value == "1 dropped as too short"
    panel.origin.value = 3
    found = hybrid(SegmentMap(LEANING.segments - [3, 0]))
    assert panel.reduction.segments == pytest.approx(found.segments + [3, 0])
    assert [len(panel.reduction), panel.origin.value] == [1, 3]
    panel.origin.value = 20
    assert panel.count.value == "2 of 3 segments left"


@unpainted
def test_room_panel_without_noise_measures_exactly_and_keeps_the_field_of_view():
    """Catches beams that are left out at one side instead of spread."""
    panel = course.RoomPanel(ROOM, (1, 1, 0))
    assert "0.0 mm" not in panel.spread.value
    panel.noise.value, panel.beams.value = 0, 51
    assert panel.spread.value == "range error 0.0 mm (root mean square)"
    assert panel.scan.angles[[0, -1]] == pytest.approx(URG_04LX.angles[[0, -1]])


@unpainted
def test_moving_panel_carries_the_beams_back_onto_the_walls():
    """Catches a motion the wrong way round, and metres where centimetres are said."""
    panel = course.MovingPanel(ROOM, (1, 1, 0))
    assert panel.moved.value == "moved by 10.9 degrees and 5.5 cm in a scan"
    assert float(panel.off.value.split()[2]) > 20
    panel.deskewed.value = True
    assert panel.off.value == "up to 0.0 cm off the walls"
    panel.deskewed.value, panel.speed.value, panel.turn.value = False, 0.0, 0
    assert panel.off.value == "up to 0.0 cm off the walls"


@unpainted
def test_angle_panel_shows_what_match_angles_finds():
    """Catches the wrong pair of scans, a rank beyond the last, a second scan beyond the log."""
    panel = course.AnglePanel(load("room"), scan=3, apart=2)
    first, second = (extract_polylines(panel.log[k].points()) for k in (3, 5))
    found = match_angles(first, second, rng=np.random.default_rng(0))
    assert panel.match.pose == pytest.approx(found.pose, abs=1e-9)
    assert panel.verdict.value == f"match, overlap {found.overlap:.2f}"
    panel.rank.value = 10
    last = panel.candidates[-1]
    assert panel.found.value.startswith(f"{len(panel.candidates)} of {len(panel.candidates)}: ")
    assert f"{last.value:.2f} m match" in panel.found.value
    panel.scan.value, panel.apart.value = panel.scan.max, 40
    assert panel.verdict.value.startswith("match")  # the last two scans


@unpainted
def test_ground_truth_panel_measures_the_scans_whose_pose_it_withholds():
    """Catches an error over the poses that were given, a clock that is moved the other way."""
    panel = course.GroundTruthPanel(LOG, max_gap=10.0)
    assert panel.error.value == "wrong by 0.000 m on average"
    panel.late.value = 0.05
    speed = 0.5 / (LOG[1].time - LOG[0].time)
    used = panel.alignment.used
    off = np.mean(panel.alignment.poses[used, 0] - LOG.truth[used, 0])
    assert off == pytest.approx(-0.05 * speed, rel=1e-6)
    panel.late.value = 0
    panel.every.value = 3
    assert panel.alignment.used.tolist() == [True, True, True, True, False][: len(LOG)]


@unpainted
def test_icp_panel_ends_in_the_match_and_starts_where_it_is_told():
    """Catches degrees taken for radians, and a step beyond the last."""
    before, now = LOG[0].points(), LOG[1].points()
    panel = course.IcpPanel(before, now, (0.5, 0, 0))
    panel.turn.value = 5
    np.testing.assert_allclose(panel.steps[0].pose - panel.pose, [0.3, 0.3, np.radians(5)])
    panel.step.value = 60
    found = match_points(before, now, panel.steps[0].pose)
    np.testing.assert_allclose(panel.steps[-1].pose, found.pose, atol=1e-12)
    last = len(panel.steps) - 1
    assert panel.count.value.startswith(f"step {last} of {last}: ")


@unpainted
def test_backbone_panel_shows_what_the_method_does():
    """Catches a panel one scan off, a rotation in radians, and a threshold without effect."""
    log = load("corridor")[:60]
    steps, panel = backbone_steps(log), course.BackbonePanel(log)
    for k in (2, 50):
        panel.scan.value = k
        turned = f"turned by {np.degrees(steps[k].rotation):.2f} deg"
        assert panel.turned.value == f"{turned}, {len(steps[k].lines.angle)} lines"
        assert panel.state.value == (steps[k].reason or "used")
    panel.min_length.value = 3.0
    assert len(panel.now.segments) < len(steps[50].segments)


@unpainted
def test_pose_graph_panel_takes_loops_only_when_they_are_found_and_wanted():
    """Catches a box without effect, and a loop known before its second end was seen."""
    panel = course.PoseGraphPanel(LOOP, looped())
    panel.odometry.value = True
    assert float(panel.gap.value.split()[-2]) < 0.1
    panel.loops.value = False
    assert_poses_equal(panel.poses, LOOP.odometry, atol=1e-6)
    assert "loops not used" in panel.count.value and float(panel.gap.value.split()[-2]) > 1
    panel.loops.value, panel.scan.value = True, 140
    assert_poses_equal(panel.poses, LOOP.odometry[:141], atol=1e-6)
    assert panel.count.value.endswith(" 0 loops")


# ------------------------------------------------------- quadtrees, and the rays that fail
@pytest.mark.parametrize("seed", range(4))
def test_without_a_failure_the_variant_is_the_map(seed):
    """Catches a variant that differs by more than what it is to show."""
    rng = np.random.default_rng(seed)
    maps = [QuadtreeMap(resolution=0.1, size=1.6) for _ in range(2)]
    for _ in range(3):
        sensor, ends = rng.normal(0, 1, 2), rng.normal(0, 3, (12, 2))
        maps[0].insert_scan(sensor, ends)
        course.insert_variant(maps[1], sensor, ends)
    assert leaves_of(maps[0]) == leaves_of(maps[1])


def test_without_the_mask_a_ray_crosses_the_neighbours_of_its_end():
    """By hand: of five cells in a row the mask spares two, without it only the end is spared."""
    counts = {}
    for mask in (True, False):
        map = QuadtreeMap(resolution=1, size=4)
        course.insert_variant(map, (0.5, 0.5), [(x + 0.5, 0.5) for x in range(4)])
        course.insert_variant(map, (0.5, 0.5), [(3.5, 0.5)], mask=mask)
        counts[mask] = np.array([leaves_of(map)[(x, 0, 1)][0] for x in range(4)])
    assert (counts[False] - counts[True]).tolist() == [0, 0, 1, 0]


@pytest.mark.parametrize("seed", range(4))
def test_touched_cells_are_those_whose_square_the_ray_meets(seed):
    """Against every cell of a box, by clipping the ray, between corners of cells, to its square."""
    rng = np.random.default_rng(seed)
    start, end = rng.integers(-6, 7, (2, 2))
    cells = np.stack(np.meshgrid(np.arange(-9, 9), np.arange(-9, 9)), -1).reshape(-1, 2)
    map = QuadtreeMap(resolution=1, size=32, corner=(-16, -16))
    map.insert_scan((-8.5, -8.5), cells + 0.5)  # a leaf for each cell
    before = leaves_of(map)
    course.insert_variant(map, start + 0.5, [end + 0.5], touched=True, mask=False)
    expected = {tuple(end.tolist())}
    for x in range(-9, 9):
        for y in range(-9, 9):
            low, high = 0.0, 1.0
            for a, d, c in ((start[0], end[0] - start[0], x), (start[1], end[1] - start[1], y)):
                if d == 0:
                    low = low if c <= a <= c + 1 else 2.0
                else:
                    t = sorted(((c - a) / d, (c + 1 - a) / d))
                    low, high = max(low, t[0]), min(high, t[1])
            if low <= high + 1e-12 and (x, y) != tuple(end.tolist()):
                expected.add((x, y))
    after = leaves_of(map)
    seen = [leaf for leaf, count in after.items() if count[0] > before[leaf][0]]
    assert {(x - 16, y - 16) for x, y, _ in seen} == expected  # of the map's corner


@unpainted
def test_free_outside_is_measured_beyond_the_walls():
    """Catches an area that counts the room itself, or leaves that the walls cut."""
    panel = course.RayPanel(square_room(4.0), [(1.5, 1.6, 0.2)])
    assert panel.free_outside() == 0
    panel.map.tree.vis[panel.map.tree.vis == 1] = 50
    leaves = panel.map.leaves()
    assert 0 < panel.free_outside() < (leaves.side**2).sum() - 16


@unpainted
def test_classes_panel_shows_what_is_exported():
    """Catches thresholds that are not handed on."""
    log = load("room")
    map = build_map(log, log.truth)
    panel = course.ClassesPanel(map)
    for occupied, free, k in ((0.5, 0.25, 0), (0.9, 0.25, 0), (0.5, 0.0, 2)):
        panel.occupied.value, panel.free.value, panel.doublings.value = occupied, free, k
        found = ros_classes(map, resolution=0.05 * 2**k, occupied=occupied, free=free)
        assert np.array_equal(panel.classes.greys, found.greys)
        counts = [int(part.split()[0]) for part in panel.counts.value.split(", ")]
        assert counts == [(found.greys == grey).sum() for grey in (254, 205, 0)]
