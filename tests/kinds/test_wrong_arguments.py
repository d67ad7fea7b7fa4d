"""What each function refuses beyond `test_entry_points`, and the words that name it: a row a slip.

There anything of another kind is refused; here are values of the right kind that do not fit.
"""

from functools import partial

import driven_panels as driven
import numpy as np
import pytest
import segmap_course as course
from segmap_course.exercises import Exercise

from segmap import arrays, extraction, load, matching, metrics, simulation
from segmap.alignment import METHODS as ALIGNMENTS
from segmap.alignment import Match, align_to_truth, ground_truth, odometry, solve_graph
from segmap.matching import (
    field_score,
    hill_climb,
    localize_ekf,
    map_scans,
    nearest_score,
    sample_and_rank,
    search,
)
from segmap.panels import ComparePanel, LivePanel, QuadtreePanel, ScanPanel
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
from segmap.reduction import (
    METHODS,
    common_directions,
    fuzzy_clustering,
    mean_shift,
    weighted_line_fitting,
)
from segmap.scans import LaserScan, Log
from segmap.segments import SegmentMap
from segmap.simulation import URG_04LX, cast_rays, drive, simulate
from segmap_app import files
from segmap_app.files import Session

NAN, ZERO = float("nan"), (0.0, 0.0, 0.0)
WALL = [(1.0, -1.0), (1.0, 1.0)]
TWO = np.array([[(0, 0), (1, 0)], [(0, 1), (1, 1)]], float)
FOUR = np.zeros((4, 2))
SPREADS = *map(np.diag, ([1, 1, 1e7], [1, 1, 0.0], [1, 1, -1.0])), [[1, 9, 0]] * 3
SHAPES = np.zeros((3, 4)), np.zeros((2, 2)), np.zeros((3, 2, 3))
#: The second segment is spoilt.
NOT_FINITE = [TWO + np.reshape((0, wrong), (2, 1, 1)) for wrong in (NAN, np.inf, -np.inf)]
BEAM = LaserScan([1.0], [0.0])
OUT_OF_REACH = LaserScan([1.0, 1e12], [0.0, 0.1])
FAR_BEAM = LaserScan([1.0, 1e4], [0.0, 0.1])
ROOM, CORRIDOR = load("room"), load("corridor")
NO_TRUTH = "x must have scans, and a true pose for every scan"
SLIM = np.array([[(0, 0), (9, 0)]], float)
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


def alike(said, *rows):
    """Rows of which the same is said."""
    return [(row, said) for row in rows]


def named(name, said, *values):
    """Rows of one argument, of which the same is said."""
    return [({name: value}, said) for value in values]


def tracked(*given, **named):
    return list(localize_ekf(*given, **named))


def session(**held):
    return Session(driven.LOG, **{"settings": {}, **held})


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
        *alike(r"before must have shape \(n, 2, 2\).*got \(", np.empty((0, 4)), 1.0, *SHAPES),
    ),
    *each(arrays.segments)(*alike(r"in metres, but segments\[1\] is", *NOT_FINITE)),
    *each(SegmentMap)(*alike(r"segments\[1\]", *NOT_FINITE)),
    *each(arrays.whole, "count")(
        (2.5, "count must be a whole number of at least 1, got 2.5$"),
        (10**10, "of at least 1 and at most 1000000000, got 10000000000$"),
    ),
    *each(arrays.whole, "count", most=9)(
        (2.5, "at least 1 and at most 9, got 2.5$"),
        (10, "at least 1 and at most 9, got 10$"),
    ),
]
BASICS = [
    *refused(SegmentMap, TWO)(
        ({"points": FOUR}, "points and first must be given together"),
        ({"first": [0, 2, 4]}, "points and first must be given together"),
        ({"points": FOUR, "first": [0, 4]}, "first must rise from 0 to 4"),
        ({"points": FOUR, "first": [0, 3, 4]}, "at least 2 points a segment"),
        ({"points": FOUR, "first": [0, 2, 5]}, "first must rise from 0 to 4"),
        ({"points": FOUR, "first": [0, 2.5, 4]}, "first must be whole numbers"),
        ({"points": FOUR * NAN, "first": [0, 2, 4]}, "points must be finite"),
        ({"sensors": FOUR[:1], "scan": [0, 1]}, "sensors must hold a place for each scan"),
        ({"sensors": FOUR, "scan": [0, -1]}, "sensors must hold a place for each scan"),
        ({"sensors": [(0, 0), (NAN, 0)], "scan": [0, 1]}, "sensors must hold a place"),
        ({"sensors": [(0, 0, 0)]}, r"sensors must have shape \(n, 2\)"),
    ),
    *each(SegmentMap([]).cropped)(
        (0, 0, 0, 1, "wanted left < right and low < high"),
        (0, 1, 1, 0, "wanted left < right and low < high"),
        (2, 0, 1, 1, "wanted left < right and low < high"),
        (NAN, 0, 1, 1, "finite"),
    ),
    *refused(LaserScan, ranges=[1.0, 2.0, 3.0], angles=np.radians([-90, 0, 90]))(
        ({"ranges": [[1.0]]}, r"ranges must have shape \(n,\), got \(1, 1\)"),
        ({"angles": [0.0, 1.0]}, r"angles must have shape \(3,\), got \(2,\)"),
        ({"angles": [0.0, NAN, 1.0]}, "angles must be finite"),
        ({"odometry": (0, 0)}, r"odometry must be x, y, heading, got shape \(2,\)"),
        ({"odometry": (0, np.inf, 0)}, "odometry must be finite"),
        ({"sensor_pose": (0, NAN, 0)}, "sensor_pose must be finite"),
        ({"sensor_pose": (0, 0, 90)}, r"sensor_pose\[2\] must be in radians, .* got 90"),
        ({"angles": [-90, 0, 90]}, r"angles must be in radians, .* degrees, np.radians$"),
        ({"codes": [1]}, r"codes must have shape \(3,\)"),
        ({"delays": [0, 1]}, r"delays must have shape \(3,\)"),
        ({"delays": [0, NAN, 1]}, "delays must be finite and at least 0"),
        ({"delays": [0, -1e-9, 1]}, "delays must be finite and at least 0"),
    ),
    *each(LaserScan)(([1.0], [12.6], r"within 4 pi, got 12\.6: this looks like degrees")),
    *each(Log)(
        ("x", [BEAM] * 4, np.zeros((3, 3)), r"truth must have shape \(4, 3\), got \(3, 3\)"),
        ("x", [BEAM, ZERO], r"scans\[1\] must be a LaserScan, got tuple"),
    ),
    *each(times(0, 1).__getitem__)((np.ma.masked_less([0, 1], 0.5) < 1, "masked")),
    *each(interpolate, [0.5])(
        ([0, 1], [ZERO], r"poses must be \(2, 3\), one for each time"),
        ([[0]], [ZERO], "poses must be"),
        ([1, 0], [ZERO, ZERO], "times must .* not decrease"),
        ([NAN], [ZERO], "times must .* be finite"),
        ([], np.empty((0, 3)), "times must hold at least one time"),
    ),
    *each(extraction.fit_line)(([(0, 0)], "at least 2 points")),
    *refused(extraction.build_map, Log("one", [BEAM]))(
        *named("poses", r"poses must have shape \(1, 3\)", None, [ZERO] * 2, ZERO),
    ),
    *refused(extraction.build_map, Log("one", [BEAM]), [ZERO], keep_points=True)(
        ({"extract": lambda points: []}, "extract must be .*got '<lambda>': it does not tell"),
    ),
    *each(extraction.build_map, [ZERO] * 2)(
        (Log("far", [BEAM, OUT_OF_REACH]), r"points must be within .* but points\[1\] is"),
    ),
    *refused(simulation.city, rng=RNG)(
        ({"columns": 0}, "columns must be"),
        ({"rows": 201}, "rows must be .* at most 200"),
        ({"block": 3.0}, "block must be .* at least 4"),
        ({"street": 2.0}, "street must be .* at least 2.5"),
    ),
    *refused(cast_rays, [WALL])(
        ({"pose": (0, NAN, 0), "angles": [0.0]}, "pose must be finite"),
        ({"pose": ZERO, "angles": 0.0}, r"angles must be \(b,\) and finite"),
        ({"pose": ZERO, "angles": [NAN]}, r"angles must be \(b,\) and finite"),
        ({"pose": ZERO, "angles": [0.0], "max_range": NAN}, "max_range must be"),
    ),
    *refused(simulation.circular_room)(({"sides": 2}, "sides must be .* at least 3 .*, got 2")),
    *each(simulation.corridor_loop)((30, 5, "block inside must measure")),
    *refused(simulation.office, rng=RNG)(({"depth": 2}, "depth must be .* at least 3.5")),
    *each(simulation.box)((0, 1, "width must be a number above 0")),
    *refused(drive, [(0, 0), (1, 0)])(
        ({"step": 0}, "step must be a number above 0, in metres"),
        ({"turn": -1}, "turn must be a number above 0 .*, in radians"),
    ),
    *each(drive)(
        ([(0, 0)], "at least two points"), ([(0, 0), (0, 0)], "each unlike the one before")
    ),
    *each(simulate, sensor=URG_04LX, rng=RNG)(([], [(0, 0, NAN)], "path must be finite")),
]
ALIGNMENT = [
    *refused(solved)(
        ({"relative": np.ones((3, 3))}, "relative must"),
        ({"information": np.eye(3)}, "information must be"),
        ({"edges": [(2, 4), (4, 6), (6, 8), (8, 2)]}, "scans 0 to 7, got 2 to 8"),
        ({"edges": [(-1, 1), (1, 3), (3, 5), (5, -1)]}, "got -1 to 5"),
        ({"edges": [(0, 2), (2, 0), (4, 6), (6, 4)]}, "scan 4 is not tied"),
        ({"scale": 0.0}, "scale must be a number of at least 1e-09"),
    ),
    *each(weighed)(
        *((*free, "leaves some of them free") for free in ((0, 0, 0), (1, 0, 1), (1, 1, 0))),
    ),
    *each(ground_truth, max_gap=1.5, times=[0.0, 1.0, 3.0], poses=np.zeros((3, 3)))(
        (times(-0.1, 1), "scan 0 of log 'four', at -0.100000 s"),
        (times(0, 3.5, 9), "scan 1 of log 'four', at 3.500000 s"),
        (times(0, 1, 1.5), "scan 2 of log 'four', at 1.500000 s"),
    ),
    *refused(ground_truth, times(0, 1))(
        ({}, "log 'four' holds no ground truth"),
        ({"times": [0, 1]}, "times and poses belong together"),
        ({"poses": np.zeros((2, 3))}, "times and poses belong together"),
        ({"times": [1, 0], "poses": np.zeros((2, 3))}, "not decrease"),
        ({"times": [0], "poses": np.zeros((2, 3))}, r"poses must be \(1, 3\)"),
        ({"missing": "skip"}, "missing must be one of 'raise', 'drop', got 'skip'"),
    ),
    *each(align_to_truth)(
        ([ZERO] * 2, [ZERO] * 3, r"truth must have shape \(2, 3\), got \(3, 3\)"),
        (np.zeros((2, 2)), np.zeros((2, 2)), r"poses must have shape \(n, 3\)"),
        ([(NAN, NAN, NAN)], [ZERO], "got none"),
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
MATCHING = [
    *refused(map_scans, [])(
        ({"matcher": "climb"}, "matcher must be a function of map, points and start"),
        ({"settle": 0}, "settle must be a whole number of at least 1"),
        ({"matcher": sample_and_rank}, "sample_and_rank draws poses: give rng"),
    ),
    *refused(sample_and_rank, SegmentMap(TWO), [(1, 0)], ZERO, rng=RNG)(
        *named("sigma", "sigma must be positive", (0, 1), (0.1, -1), (NAN, 1), 0.02, ZERO),
    ),
    *refused(tracked, SegmentMap(TWO), ROOM[:2], ZERO)(
        *named("covariance", r"covariance must be \(3, 3\), symmetric", np.eye(2), *SPREADS),
    ),
    *each(tracked, np.eye(3) / 100)(
        (SegmentMap(TWO), [ROOM[0], BEAM], ZERO, "scan 1 has no odometry")
    ),
    *each(hill_climb, [(1, 0)], ZERO)(*NOTHING_TO_MATCH),
    *each(sample_and_rank, [(1, 0)], ZERO, rng=RNG)(*NOTHING_TO_MATCH),
    *each(hill_climb, [(50, 0)], (40, 40, 0))((ONE_CELL, "no occupied cell")),
    *each(field_score, [], ZERO)((SegmentMap([]), "holds no wall")),
    *each(nearest_score, [(1, 0)], ZERO)(
        (QuadtreeMap(), "insert a scan"), (SegmentMap(TWO), "map must be a QuadtreeMap")
    ),
    *each(matching.merge)((ROOM[:3], ROOM[:0], "second must hold scans")),
    *each(search, ROOM[0])(
        (TWO, "map must be a QuadtreeMap or a SegmentMap"),
        (QuadtreeMap(), "no occupied cell"),
        (SegmentMap([]), "no wall"),
        (SegmentMap([[(0, 0), (1e5, 0)]]), "too large"),
    ),
]
#: Moves below rounding never come to rest: an endless loop.
TOO_FINE = (
    ({"sigma": 1e-7}, "sigma must cut the map into at most 20000000 pieces"),
    ({"bandwidth": 1e-9}, "bandwidth must be at least 1e-9 rad a sigma"),
)
MAPS = [
    *refused(metrics.invented, TWO, TWO)(
        ({"distance": 0}, "distance"), ({"angle": 90.0}, "angle"), ({"angle": -0.1}, "angle")
    ),
    *each(metrics.segment_distance)(
        (*TWO, 0, 0, "weight_u and weight_v must not be negative"),
        (*TWO, -1, 2, "weight_u and weight_v must not be negative"),
        (*TWO, NAN, 1, "weight_u and weight_v must not be negative"),
    ),
    *refused(QuadtreeMap)(
        ({"size": 5.0}, r"size must be a power of two of cells of 0.01 m.*got 5.0 m: 500 cells"),
        ({"size": 5.125}, "size must be a power of two"),
        ({"size": -5.12}, "size must be a power of two"),
        ({"size": 0.02}, "at least 4, got 0.02 m: 2 cells"),
        ({"max_size": 2.56}, "max_size must not be below the size, 5.12 m"),
        ({"max_size": 7.0}, "max_size must be a power of two"),
        ({"max_size": 0.01 * 2.0**32}, r"nor have more than 2\^31 cells"),
        ({"bias": 2**31}, "at most 2147483647, got 2147483648"),
        ({"free_resolution": 0.03}, "free_resolution must be a power of two"),
    ),
    *refused(QuadtreeMap(resolution=0.05).to_grid)(
        *named("resolution", "resolution", 0.03, 100.0, 0.01),
        ({"value": "median"}, "value must be one of 'max', 'mean', 'variance'"),
    ),
    *each(QuadtreeMap().rasterize)((np.zeros(9), "could not broadcast")),
    *each(in_a_new_map)(
        (FAR_BEAM, "^scan 1: .*beyond max_size"),
        (BEAM, (1e5, 0, 0), "^scan 1: .*beyond max_size"),
        (LaserScan([1.0, np.inf], [0.0, 0.1], max_range=1e4), "^scan 1: .*beyond max_size"),
    ),
    *each(build_map)((ROOM[:2], [ZERO], r"poses must have shape \(2, 3\), got \(1, 3\)")),
    *each(map_of_grid, resolution=0.5)(
        *alike("cells must be a table", [[3]], [1, 2], [[]], [[0.5]]),
    ),
    *each(weighted_line_fitting, spacing=1e-9)(
        (SLIM, "spacing must make at most .* is it in metres")
    ),
    *refused(fuzzy_clustering, SLIM)(
        *named("corner", "^corner must be", NAN, (0.0, np.inf), (1.0, 2.0, 3.0)),
    ),
    *refused(mean_shift, SLIM)(*TOO_FINE),
    *refused(common_directions, SLIM)(*TOO_FINE),
    *each(mean_shift, sigma=1e-6)(
        ([[(0, 0), (0.01, 0)], [(1e5, 0), (1e5, 0.01)]], "at least 1e-10 of the extent"),
    ),
    *each(METHODS["fusion"](TWO).members)(*alike("index must be", -1, 2, 0.5)),
]
EXPORTS = [
    *each(files.Earth)(
        (139.7, 35.7, "latitude must be .* at most 90, in degrees, got 139.7"),
        (0, 181, "longitude must be .* at most 180, in degrees, got 181"),
        (NAN, 0, "latitude must be .* got nan"),
        *((0, 0, north, f"north must be .*got {north}") for north in (90, 6.3, -6.3)),
    ),
    *each(files.Grid)(
        ("25832", 0, 0, "name must be like EPSG:25832"),
        ("EPSG:4326", 0, 0, "is in degrees, no grid in metres"),
        ("EPSG:25832", np.inf, 0, "east must be .* in metres, got inf"),
    ),
    *refused(session)(
        ({"settings": {"method": "\udcff"}}, "must be what JSON holds"),
        ({"runs": [{"\ud800": 1}]}, "must be what JSON holds"),
        ({"settings": {"a": {1, 2}}}, "settings must "),
        ({"settings": 3}, "settings must "),
        ({"runs": {"a": 1}}, "runs must "),
    ),
    *each(files.write_session)(
        ("it.zip", session(), r"must end in \.segmap, got 'it\.zip'"),
        ("it.segmap", Session(ROOM[:0], {}), "must hold a scan"),
    ),
]
PICTURES = [
    *refused(draw_segments, TWO)(
        ({"group": [0]}, r"group must have shape \(2,\), one"),
        ({"error": 0.1}, r"error must have shape \(2,\)"),
        ({"scan": [0] * 2, "group": [0] * 2}, "got scan and group"),
    ),
    *each(draw_provenance)((TWO[:1], METHODS["fusion"](TWO), r"reduction.parents .* \(1,\)")),
    *refused(draw_maps, {"all": TWO})(({"color": ["red", "blue"]}, "1 entries, one a map")),
    *each(draw_alignment)((ROOM[:2], odometry(ROOM[:4]), "this log of 2 scans, got one of 4")),
    *each(draw_position_errors)(
        (ROOM[:2], {"a": [ZERO]}, r"alignments\[.a.\] must .* \(2, 3\), got"),
        (times(0), {}, "log must have truth"),
    ),
    *each(draw_log)((ROOM[:2], [ZERO], r"poses must have shape \(2, 3\), got")),
    *each(ScanPanel)(
        (times(0), r"at least one of them finite, got \(1, 3\) with 0"),
        (driven.LOG, driven.LOG.truth[:2], r"poses must be \(5, 3\), at least one"),
    ),
    *each(QuadtreePanel)(
        (Log("room", driven.LOG.scans), "log 'room' has no truth: give poses"),
        (driven.LOG, driven.LOG.truth[:2], r"poses must have shape \(5, 3\)"),
        (driven.LOG[:0], "log must hold one scan at least, got none"),
    ),
    *each(ComparePanel)(
        (driven.WALLS, driven.RUNS[:0], "runs must hold one run at least, got none"),
        (driven.WALLS, driven.RUNS.assign(method="magic"), "^runs: a method must be one of"),
    ),
    *each(LivePanel)(
        *alike("source must be a sensor, or give scans", [1.0], (ROOM[0], None)),
    ),
]
STEPS = [
    {"reach": far, "step": step}
    for far, step in ((0.1, 0), (0.1, -1), (0.1, 0.2), (NAN, 0.1), (np.inf, 1))
]
COURSE = [
    *each(course.AnglePanel)((ROOM[:1], "log must hold at least two scans, got 1")),
    *each(course.BackbonePanel)((ROOM[:0], "log must hold at least one scan, got none")),
    *each(course.GroundTruthPanel)((Log("raw", ROOM.scans), "must hold true poses")),
    *each(course.IcpPanel)((np.zeros((2, 2)), np.zeros((9, 2)), "6 points each, got 2 and 9")),
    *each(course.PoseGraphPanel)(
        (CORRIDOR, odometry(CORRIDOR), "must share a graph"), (CORRIDOR[:1], "must share a graph")
    ),
    *each(course.draw_basin)(
        ([["right"]], [0, 1], [0], "outcomes must be"),
        ([["right", "lost"]], [0, 1], [0], "outcomes must be"),
    ),
    *each(course.draw_marked)(
        *((TWO, marked, r"marked must have shape \(2,\)") for marked in ([True], [0, 1, 1])),
    ),
    *each(course.draw_cells)(
        (QuadtreeMap(), np.zeros((3, 4)), r"cells must be .* square grid, got shape \(3, 4\)")
    ),
    *each(course.draw_uncertainty)(
        (Match(np.zeros(3), np.diag([np.inf] * 3), False, "too few points"), "too few points")
    ),
    *each(course.peaks)(([1, NAN, 2], r"values must not be NaN, got one at \[1\]")),
    *refused(course.landscape, SegmentMap(TWO), [(1, 0)], ZERO)(
        *((steps, "step must be positive and reach no less") for steps in STEPS),
    ),
    *refused(course.represent, ROOM)(
        *named("poses", "^poses must", None, ROOM.truth[:-1], ROOM.truth + np.inf),
    ),
    *each(course.wall_errors)((np.zeros((1, 2)), [], "walls must hold at least one")),
    *each(course.sample_points)((TWO, 0, "spacing must be a number above 0")),
    *each(course.try_pair)(
        (course.room_walk(3), "climbing", "field", "'climbing' is none of hill climb"),
        (course.room_walk(3), "hill climbing", "best", "'best' is none of field"),
        (Log("x", course.room_walk(3).scans), "hill climbing", "field", NO_TRUTH),
        (Log("x", []), "hill climbing", "field", NO_TRUTH),
    ),
    *each(course.room_walk)(*((n, f"scans must be at least 1, got {n}") for n in (0, -1))),
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
