"""Lesson panels: each answers its controls, and shows what its method finds."""

from functools import cache

import numpy as np
import pytest
import segmap_course as course
from conftest import slow
from driven_panels import LEANING, LOG, ROOM, WALLS, assert_answers, unpainted
from quadtrees import leaves_of

from segmap import SegmentMap, fusion, load, quality
from segmap.alignment import pose_graph
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
from segmap.simulation import rectangular_room

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
def test_least_cost_panel_tells_what_is_promised_and_what_quality_does_not_see():
    """Catches a promise in per cent of the penalty alone, and metres that are swapped."""
    panel = course.LeastCostPanel(BROKEN)
    assert panel.promised.value == "quality promised 100.0%"  # nothing merged, nothing lost
    panel.gap.value = 0.09
    assert panel.unseen.value == "invented 0.08 m, missed 0.00 m"
    assert panel.promised.value == f"quality promised {np.exp(-0.05 * 1 / 2 / 0.05):.1%}"


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
