"""What each function refuses beyond `test_entry_points`, and the words that name it: a row a slip.

There anything of another kind is refused; here are values of the right kind that do not fit.
"""

from dataclasses import replace
from functools import partial

import driven_panels as driven
import numpy as np
import pytest
import segmap_course as course
from damage import a_graph
from segmap_course.exercises import Exercise

from segmap import arrays, exports, extraction, load, matching, metrics, simulation
from segmap.alignment import METHODS as ALIGNMENTS
from segmap.alignment import Graph, Match, align_to_truth, ground_truth, odometry, solve_graph
from segmap.matching import (
    DistanceField,
    field_score,
    hill_climb,
    localize,
    localize_ekf,
    map_scans,
    nearest_score,
    sample_and_rank,
    search,
)
from segmap.panels import ComparePanel, LivePanel, ScanPanel
from segmap.plotting import (
    draw_alignment,
    draw_log,
    draw_maps,
    draw_position_errors,
    draw_provenance,
    draw_segments,
)
from segmap.poses import interpolate
from segmap.quadtree import QuadtreeMap, build_map, map_of_grid
from segmap.reduction import METHODS, common_directions, mean_shift, weighted_line_fitting
from segmap.scans import LaserScan, Log, SensorNoise
from segmap.segments import SegmentMap
from segmap.simulation import drive
from segmap_app import files
from segmap_app.files import Session
from segmap_app.page import Workbench

NAN, ZERO = float("nan"), (0.0, 0.0, 0.0)
TWO = np.array([[(0, 0), (1, 0)], [(0, 1), (1, 1)]], float)
FOUR = np.zeros((4, 2))
SPREADS = np.diag([1, 1, 1e7]), np.diag([1, 1, -1.0]), [[1, 9, 0]] * 3
BEAM = LaserScan([1.0], [0.0])
OUT_OF_REACH = LaserScan([1.0, 1e12], [0.0, 0.1])
FAR_BEAM = LaserScan([1.0, 1e4], [0.0, 0.1])
ROOM, CORRIDOR = load("room"), load("corridor")
NO_TRUTH = "x must have scans, and a true pose for every scan"
SLIM, BEAMS = np.array([[(0, 0), (9, 0)]], float), Log("one", [BEAM])
RNG = np.random.default_rng(1)
easy = Exercise("double(x)", lambda x: 2 * x, lambda _: {"2": (2,)}, {"square": np.square})


def times(*when):
    """A log of which nothing but the times is known."""
    return Log("four", [LaserScan([1.0], [0.0], time) for time in when])


def refused(of, *given, **named):
    """Rows of one function: what is changed of its arguments, and what is said."""
    return lambda *rows: [(partial(of, *given, **{**named, **row}), said) for row, said in rows]


def each(of, *last, **named):
    """The same, where a row holds the first arguments."""
    return lambda *rows: [(partial(of, *first, *last, **named), said) for *first, said in rows]


def tracked(*given, **named):
    return list(localize_ekf(*given, **named))


def located(*given):
    return list(localize(*given, rng=RNG))


def session(**held):
    return Session(driven.LOG, **{"settings": {}, **held})


def opened(source):
    Workbench(BEAMS).open(source)


def in_a_new_map(scan, pose=ZERO):
    return build_map(Log("two", [BEAM, scan]), [ZERO, pose], resolution=0.01, free=True)


def solved(**changed):
    """A square that is driven round twice."""
    edges = np.array([(0, 2), (2, 4), (4, 6), (6, 0)])
    given = {"poses": np.zeros((8, 3)), "edges": edges, "relative": np.ones((4, 3))} | changed
    return solve_graph(given.pop("poses"), given.pop("edges"), given.pop("relative"), **given)


def weighed(*free):
    """A chain of which one edge says nothing in some directions: a pivot is rounding there."""
    weights = np.array([np.eye(3), np.diag(np.array(free, float))])
    motions = [(1, 0, 0.3), (1, 0.2, 0.1)]
    return solve_graph(np.zeros((3, 3)), [(0, 1), (1, 2)], motions, information=weights)


ARRAYS = [
    *each(arrays.segments, "before")(
        (np.zeros((3, 4)), r"before must have shape \(n, 2, 2\).*got \(")
    ),
    *each(arrays.whole, "count", most=9)((2.5, "count must"), (10, "count must")),
]
BASICS = [
    *refused(SegmentMap, TWO)(
        ({"points": FOUR}, "points and first"),
        ({"first": [0, 2, 4]}, "points and first"),
        ({"points": FOUR, "first": [0, 4]}, "first must rise"),
        ({"points": FOUR, "first": [0, 3, 4]}, "at least 2 points"),
        ({"points": FOUR, "first": [0, 2, 5]}, "first must rise"),
        ({"sensors": FOUR[:1], "scan": [0, 1]}, "sensors must"),
        ({"sensors": FOUR, "scan": [0, -1]}, "sensors must"),
    ),
    *each(SegmentMap([]).cropped)((2, 0, 1, 1, "left < right"), (0, 1, 1, 0, "low < high")),
    *refused(LaserScan, ranges=[1.0, 2.0, 3.0], angles=np.radians([-90, 0, 90]))(
        ({"angles": [0.0, 1.0]}, "angles must"),
        ({"sensor_pose": (0, 0, 90)}, r"sensor_pose\[2\] .* radians"),
        ({"angles": [-90, 0, 90]}, r"angles must .* degrees, np.radians$"),
        ({"codes": [1]}, "codes must"),
        ({"delays": [0, -1e-9, 1]}, "delays must"),
    ),
    *each(LaserScan)(([1.0], [12.6], "looks like degrees")),
    *each(Log)(("x", [BEAM, ZERO], r"scans\[1\]")),
    *each(times(0, 1).__getitem__)((np.ma.masked_less([0, 1], 0.5) < 1, "masked")),
    *each(interpolate, [0.5])(
        ([0, 1], [ZERO], "poses must be"),
        ([1, 0], [ZERO, ZERO], "times must .* not decrease"),
        ([], np.empty((0, 3)), "times must"),
    ),
    *refused(extraction.build_map, Log("one", [BEAM]))(({"poses": [ZERO] * 2}, "poses must")),
    *refused(extraction.build_map, ROOM[:2], ROOM.truth[:2])(
        ({"sensor": 0.01}, "sensor must be a SensorNoise")
    ),
    *refused(SensorNoise)(
        ({"range_m": -0.01}, "range_m"), ({"range_share": 1.5}, "share"), ({"step_m": NAN}, "step")
    ),
    *refused(extraction.build_map, Log("one", [BEAM]), [ZERO], keep_points=True)(
        ({"extract": lambda points: []}, "extract must be .*got '<lambda>'")
    ),
    *each(extraction.build_map, [ZERO] * 2)(
        (Log("far", [BEAM, OUT_OF_REACH]), "points must be within .* metres")
    ),
    *refused(simulation.city, rng=RNG)(
        ({"rows": 201}, "rows must"),
        ({"block": 3.0}, "block must"),
        ({"street": 2.0}, "street must"),
    ),
    *refused(simulation.circular_room)(({"sides": 2}, "sides must")),
    *each(simulation.corridor_loop)((30, 5, "block inside")),
    *refused(simulation.office, rng=RNG)(({"depth": 2}, "depth must")),
    *each(drive)(([(0, 0)], "at least two points"), ([(0, 0), (0, 0)], "unlike the one before")),
]
ALIGNMENT = [
    *refused(solved)(
        ({"relative": np.ones((3, 3))}, "relative must"),
        ({"information": np.eye(3)}, "information must"),
        ({"edges": [(2, 4), (4, 6), (6, 8), (8, 2)]}, "scans 0 to 7, got 2 to 8"),
        ({"edges": [(0, 2), (2, 0), (4, 6), (6, 4)]}, "scan 4 is not tied"),
    ),
    *each(weighed)((1, 0, 1, "leaves some of them free")),
    *refused(ground_truth, times(0, 1))(
        ({}, "no ground truth"),
        ({"times": [0, 1]}, "belong together"),
        ({"times": [0, 0.3], "poses": np.zeros((2, 3))}, "scan 1 of log 'four'"),
        ({"missing": "skip"}, "missing must"),
    ),
    *each(align_to_truth)(
        ([ZERO] * 2, [ZERO] * 3, "truth must"), ([(NAN, NAN, NAN)], [ZERO], "got none")
    ),
    *each(ALIGNMENTS["point_icp"], turn=20)((ROOM[:2], r"of degrees np.radians\(20\)")),
]
ONE_CELL = QuadtreeMap()
ONE_CELL.insert_scan((0, 0), [(1, 1)])
NOTHING_TO_MATCH = [
    (QuadtreeMap(), "insert a scan"),
    (SegmentMap([]), "holds no wall"),
    (TWO, "a QuadtreeMap or a SegmentMap"),
]
#: Occupied at two places 400 m apart.
FAR_CELLS = QuadtreeMap(resolution=0.01)
FAR_CELLS.insert_scan((0, 0), [(1, 1), (400, 1)])
ONE_WALL = SegmentMap([[(0, 0), (4, 0)]])
MATCHING = [
    *each(partial(DistanceField, FAR_CELLS))(
        ((0, 0, 1), "left, low, right, high"),
        ((1, 0, 0, 1), "left, low, right, high"),
        ((0, 0, NAN, 1), "left, low, right, high"),
        ((0, 0, 163.85, 0.01), "16385 x 1 cells is too large"),
        ((0, 0, 163.84, 40.97), "16384 x 4097 cells is too large"),
        ((40, 40, 41, 41), "no occupied cell"),
        ((1e300, 0, 1.0000001e300, 1), "left, low|too large|no occupied|beyond"),
        (None, r"65536 x 65536 cells is too large: .* a smaller"),
    ),
    *each(partial(DistanceField.around, FAR_CELLS))(
        ([(1, 2)], np.empty((0, 3)), "poses must hold at least one pose"),
        ([(1e300, 0)], ZERO, r"a window of \d\S* x \d\S* cells is too large: at most"),
    ),
    *each(DistanceField)(
        (ONE_WALL, (0, 30, 4, 31), "no wall"),
        (ONE_WALL, (1e6, 0, 1e6 + 1, 1), "no wall"),
        (SegmentMap([]), "no wall"),
    ),
    *refused(DistanceField, ONE_WALL)(({"resolution": 1e-5}, "too large")),
    *each(matching.effective_number)(
        ([0.5, 0.5000012], "none negative, and sum to 1"), ([1.1, -0.1], "none negative")
    ),
    *each(matching.systematic)(([0.5, 0.5], 1.01, "offset must be")),
    *each(located)(
        (SegmentMap(TWO), [BEAM, 3], "scan 1"), (SegmentMap([]), [BEAM], "holds no wall")
    ),
    *refused(map_scans, [])(
        ({"matcher": "climb"}, "matcher must"), ({"matcher": sample_and_rank}, "give rng")
    ),
    *refused(sample_and_rank, SegmentMap(TWO), [(1, 0)], ZERO, rng=RNG)(
        ({"sigma": (0, 1)}, "sigma must")
    ),
    *refused(tracked, SegmentMap(TWO), ROOM[:2], ZERO)(
        *(({"covariance": spread}, "covariance must") for spread in SPREADS)
    ),
    *each(tracked, np.eye(3) / 100)(
        (SegmentMap(TWO), [ROOM[0], BEAM], ZERO, "scan 1 has no odometry")
    ),
    *each(hill_climb, [(1, 0)], ZERO)(*NOTHING_TO_MATCH),
    *each(hill_climb, [(50, 0)], (40, 40, 0))((ONE_CELL, "no occupied cell")),
    *each(field_score, [], ZERO)((SegmentMap([]), "holds no wall")),
    *each(nearest_score, [(1, 0)], ZERO)((SegmentMap(TWO), "map must")),
    *each(matching.merge)((ROOM[:3], ROOM[:0], "second must")),
    *each(search, ROOM[0])(
        (QuadtreeMap(), "no occupied cell"),
        (SegmentMap([]), "no wall"),
        (SegmentMap([[(0, 0), (1e5, 0)]]), "too large"),
    ),
]
#: Moves below rounding never come to rest: an endless loop.
TOO_FINE = ({"sigma": 1e-7}, "sigma must"), ({"bandwidth": 1e-9}, "bandwidth must")
MAPS = [
    *each(metrics.segment_distance)((*TWO, 0, 0, "weight_u"), (*TWO, -1, 2, "weight_u")),
    *refused(QuadtreeMap)(
        ({"size": 5.0}, "size must be a power of two.*got 5.0 m: 500 cells"),
        ({"size": 0.02}, "got 0.02 m: 2 cells"),
        ({"max_size": 2.56}, "max_size must not be below"),
        ({"max_size": 0.01 * 2.0**32}, "nor have more than"),
        ({"free_resolution": 0.03}, "free_resolution must"),
    ),
    *refused(QuadtreeMap(resolution=0.05).to_grid)(
        ({"resolution": 0.03}, "resolution"), ({"value": "median"}, "value must")
    ),
    *each(in_a_new_map)(
        (FAR_BEAM, "^scan 1: .*beyond max_size"),
        (BEAM, (1e5, 0, 0), "^scan 1: .*beyond max_size"),
        (LaserScan([1.0, np.inf], [0.0, 0.1], max_range=1e4), "^scan 1: .*beyond max_size"),
    ),
    *each(build_map)((ROOM[:2], [ZERO], "poses must")),
    *each(map_of_grid, resolution=0.5)(([[3]], "cells must"), ([[0.5]], "cells must")),
    *each(weighted_line_fitting, spacing=1e-9)((SLIM, "spacing must")),
    *refused(mean_shift, SLIM)(*TOO_FINE),
    *refused(common_directions, SLIM)(*TOO_FINE),
    *each(mean_shift, sigma=1e-6)(
        ([[(0, 0), (0.01, 0)], [(1e5, 0), (1e5, 0.01)]], "at least 1e-10 of the extent")
    ),
    *each(METHODS["fusion"](TWO).members)((2, "index must")),
]
GRAPH = a_graph(2, 3, 0)
UNWEIGHED = Graph(np.array([(0, 1)]), np.zeros((1, 3)), np.zeros(1, bool), np.zeros(1))
EXPORTS = [
    *each(files.Earth)(
        (139.7, 35.7, "latitude must .* got 139.7"),
        (0, 181, "longitude must"),
        (0, 0, 90, "north must"),
    ),
    *each(files.Grid)(
        ("25832", 0, 0, "like EPSG:25832"),
        ("EPSG:4326", 0, 0, "in degrees, no grid"),
        ("EPSG:25832", np.inf, 0, "east must"),
    ),
    *refused(session)(({"settings": {"a": {1, 2}}}, "settings must "), ({"runs": 1}, "runs must ")),
    *refused(files.write_ros_map, "it.yaml", QuadtreeMap())(
        ({"resolution": 0.3}, "resolution must be a power of two"),
        ({"free": 0.5}, "wanted 0 <= free < 0.5 <= occupied < 1"),
    ),
    *each(partial(exports.write_graph, "it.g2o"))(
        (odometry(ROOM[:2]), "graph that weighs its edges"),
        (replace(odometry(ROOM[:2]), graph=UNWEIGHED), "weighs"),
        (GRAPH._replace(edges=[(0, 1), (1, 3)]), "must name rows 0 to 2 of poses"),
        (GRAPH._replace(relative=[(0, 0, 0)]), "graph.relative must"),
        (GRAPH._replace(information=-GRAPH.information), "nowhere negative"),
        (GRAPH._replace(ids=[1, 1, 2]), "graph.ids must be 3 different numbers"),
    ),
    *each(files.write_ros_map, QuadtreeMap())(("it.yml", r"must end in \.yaml, got 'it.yml'")),
    *each(Workbench)(("malaga", "log must be a Log, got 'malaga'")),
    *each(opened)((3, "source must be the path"), (Log("empty", []), "must hold one scan")),
    *each(files.write_session)(
        ("it.zip", session(), r"must end in \.segmap"),
        ("it.segmap", Session(ROOM[:0], {}), "must hold a scan"),
    ),
]
PICTURES = [
    *refused(draw_segments, TWO)(
        ({"group": [0]}, "group must"),
        ({"error": 0.1}, "error must"),
        ({"error": [0] * 2, "group": [0] * 2}, "got both"),
    ),
    *each(draw_provenance)((TWO[:1], METHODS["fusion"](TWO), "reduction.parents")),
    *refused(draw_maps, {"all": TWO})(({"color": "reddish"}, "color must be a colour")),
    *each(draw_alignment)((ROOM[:2], odometry(ROOM[:4]), "this log of 2 scans")),
    *each(draw_position_errors)(
        (ROOM[:2], {"a": [ZERO]}, r"alignments\[.a.\] must"), (times(0), {}, "log must have truth")
    ),
    *each(draw_log)((ROOM[:2], [ZERO], "poses must")),
    *each(ScanPanel)((driven.LOG, driven.LOG.truth[:2], "poses must")),
    *each(ComparePanel)(
        (driven.WALLS, driven.RUNS[:0], "runs must hold one run"),
        (driven.WALLS, driven.RUNS.assign(method="magic"), "^runs: a method"),
    ),
    *each(LivePanel)(([1.0], "source must")),
]
COURSE = [
    *each(course.AnglePanel)((ROOM[:1], "log must")),
    *each(course.BackbonePanel)((ROOM[:0], "log must")),
    *each(course.GroundTruthPanel)((Log("raw", ROOM.scans), "true poses")),
    *each(course.IcpPanel)((np.zeros((2, 2)), np.zeros((9, 2)), "6 points each")),
    *each(course.PoseGraphPanel)((CORRIDOR, odometry(CORRIDOR), "must share a graph")),
    *each(course.draw_basin)(([["right"]], [0, 1], [0], "outcomes must")),
    *each(course.draw_marked)((TWO, [True], "marked must")),
    *each(course.draw_cells)((QuadtreeMap(), np.zeros((3, 4)), "cells must")),
    *each(course.draw_uncertainty)(
        (Match(np.zeros(3), np.diag([np.inf] * 3), False, "too few points"), "too few points")
    ),
    *each(course.peaks)(([1, NAN, 2], "values must")),
    *refused(course.landscape, SegmentMap(TWO), [(1, 0)], ZERO)(
        ({"reach": 0.1, "step": 0.2}, "step must")
    ),
    *refused(course.represent, ROOM)(({"poses": ROOM.truth[:-1]}, "^poses must")),
    *each(course.wall_errors)((np.zeros((1, 2)), [], "walls must")),
    *each(course.sample_points)((TWO, 0, "spacing must")),
    *each(course.try_pair)(
        (course.room_walk(3), "climbing", "field", "'climbing' is none"),
        (course.room_walk(3), "hill climbing", "best", "'best' is none"),
        (Log("x", []), "hill climbing", "field", NO_TRUTH),
    ),
    *each(course.room_walk)((0, "scans must")),
    *each(easy.fresh)((1, r"double: no draw tells \['square'\]")),
]


@pytest.mark.usefixtures("agg", "no_png")
@pytest.mark.parametrize(
    ("call", "said"), [*ARRAYS, *BASICS, *ALIGNMENT, *MATCHING, *MAPS, *EXPORTS, *PICTURES, *COURSE]
)
def test_what_does_not_fit_is_refused_in_words(call, said, tmp_path, monkeypatch):
    """Catches what would fail much later, far from where it came in, or end as a wrong map."""
    monkeypatch.chdir(tmp_path)
    with pytest.raises(ValueError, match=said):
        call()
    assert not any(tmp_path.iterdir())
