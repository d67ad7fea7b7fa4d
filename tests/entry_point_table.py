"""What the test of entry points brings along: good values of all parameters, and bad ones.

See test_entry_points.
"""

from __future__ import annotations

import copy
import functools
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pandas as pd
from emulated import Wired
from matplotlib.figure import Figure

from segmap import (
    alignment,
    experiments,
    exports,
    matching,
    metrics,
    plan,
    quadtree,
    reduction,
    scans,
    segments,
    simulation,
)
from segmap.sensors import emulator
from segmap_app import files

WALLS = np.array([[(0, 0), (3, 0)], [(3, 0), (3, 2)], [(3, 2), (0, 2)], [(0, 2), (0, 0)]], float)
PATH = np.array([(1 + k / 20, 1, 0.02 * k) for k in range(4)])


class Newly(Wired):
    """A sensor that was just plugged in."""

    def __init__(self):
        super().__init__()
        Newly.last = self


def rng():
    return np.random.default_rng(1)


LOG = simulation.simulate(WALLS, PATH, sensor=simulation.SICK_LMS200, rng=rng())
POINTS = LOG[0].points()
ALIGNMENT = alignment.Alignment(PATH, np.ones(4, bool), 0.0)
TREE = quadtree.build_map(LOG, PATH, resolution=0.05)
MAP = segments.SegmentMap(WALLS)
REDUCTION = reduction.METHODS["hybrid"](MAP)
RUNS = experiments.sweep({"it": MAP}, ["fusion"], {"fusion": {"tolerance": [0.01, 0.04]}})
GRAPH = exports.PoseGraph(PATH[:2], [(0, 1)], PATH[1:2], [np.eye(3)])
PLAN = plan.floor_plan(MAP, TREE)
TIMES = pd.DataFrame(
    {"method": "hybrid", "scans": [1, 2, 4], "seconds": [1.0, 4.0, 16.0], "live": 2}
)
LIVE = alignment.LiveGraph(step=0.04)
for _scan in LOG:
    LIVE.add(_scan)
LIVE.tie(0, 3, PATH[3] - PATH[0])
STEPS = list(matching.particle_mapping(LOG, particles=2, rng=rng()))
#: Objects whose public methods are entry points too.
OBJECTS = {"matching": [matching.DistanceField(TREE), matching.LiveMap()],
           "quadtree": [TREE], "segments": [MAP], "scans": [LOG, LOG[0]],
           "simulation": [simulation.URG_04LX], "alignment": [ALIGNMENT, LIVE],
           "plan": [PLAN],
           "reduction": [REDUCTION, reduction.LiveReduction()],
           "sensors.emulator": [emulator.Room(WALLS, PATH)]}  # fmt: skip

#: Good values by the name of a parameter; `function.parameter` comes first, then
#: `package.parameter`. A parameter that is not here keeps its default.
GOOD = {
    "share": 0.5, "words": "it", "mount": (0.2, 0.0, 0.1), "mask": [(-0.2, 0.1)],
    "matching.first": LOG, "matching.second": LOG, "merge_graphs.places": lambda scan: np.zeros((0,
    3)), "match_values.first": WALLS, "match_values.second": WALLS, "alignment.first": LIVE,
    "alignment.second": LIVE, "match.first": 0, "match.second": 3, "tie.first": 0, "tie.second": 3,
    "tie.pose": PATH[3] - PATH[0], "veto.loops": 0, "angle_candidates.viewpoints": np.zeros((2, 2)),
    "write_ros_map.path": "written.yaml", "read_bag.path": "it.bag", "read_bag.scan": "/scan",
    "read_bag.odometry": "/odom", "read_bag.truth": "/odom",
    "with_trajectories.truth": "track.tum", "column_choices.path":
    "beams.csv", "with_trajectories.odometry": "track.tum",
    "read_trajectory.path": "poses.csv", "write_segments.path":
    "written.csv", "write_arrays.path": "written.npz", "write_session.path": "written.segmap",
    "files": ["good.log.gz"], "session": files.Session(LOG, {}), "read_session.path":
    "it.segmap", "settings": {"a": 1},
    "read_csv.view": (-90.0, 90.0), "read_trajectory.columns": "time_s,x_m,y_m,theta_rad",
    "read_csv.path": "beams.csv", "read_csv.columns": "angle_rad,range_m", "read_segments.path":
    "segments.csv", "SegmentMap.load.path": "segments.npz", "write_sheet.path": "written.svg",
    "write_sheet.map": WALLS, "write_segments.map": MAP, "read_graph.path": "graph.g2o",
    "write_graph.graph": GRAPH, "read_ros_map.path": "ros.yaml", "is_ros_map.path": "ros.yaml",
    "map_of_grid.cells": np.array([[0, 1, 2]]), "data_file.name": "room", "a": PATH, "a_from_b":
    PATH, "after": WALLS[:2], "angles.a": 0.1, "angles.angle": 0.1, "angles.b": 0.1, "at":
    np.array([0.5]), "axial_mean.angles": np.array([0.1, 0.2]), "b": PATH, "b_from_c": PATH,
    "before": WALLS, "box.depth": 3.0, "box.width": 3.0, "corners": WALLS[:, 0], "current": POINTS,
    "current_segments": WALLS, "differences": np.array([0.1, 0.2]), "edges": np.array([(0, 1), (1,
    2), (2, 3)]), "exports.map": TREE, "exports.path": "written.log", "extreme_projections.angle":
    0.1, "first": WALLS, "free_ends.sensor": PATH[0], "free_points": POINTS, "free_resolution":
    0.02, "global_segments.start": PATH, "ground_truth.times": None, "ground_truth.poses": None,
    "hill_climb.start": PATH[0], "incidence": np.ones(4), "information": np.tile(np.eye(3), (3, 1,
    1)), "interpolate.poses": PATH[:2], "LaserScan.angles": LOG[0].angles, "LaserScan.codes":
    np.zeros(181), "LaserScan.delays": np.zeros(181),
    "Log.order_known": True, "LaserScan.odometry": PATH[0], "LaserScan.ranges": LOG[0].ranges,
    "least_translation.weights": np.ones(4), "fuzzy_set.axes": 0.1, "doubled_walls.map":
    segments.SegmentMap(WALLS, sensors=[(0.0, 0.0)]), "doubled_walls.sensors": np.ones((1, 2)),
    "verdict_on.map": MAP, "viewing_sector.map": segments.SegmentMap(WALLS,
    sensors=[(0.0, 0.0)]), "load.name": "room", "load.path": "map.npz", "log": LOG, "map": WALLS,
    "particle_mapping.map": quadtree.QuadtreeMap(),
    "particle_mapping.odometry": None, "steps": STEPS, "systematic.weights": np.full(4, 0.25),
    "systematic.offset": 0.5, "effective_number.weights": np.full(4, 0.25), "map_scans.map":
    quadtree.QuadtreeMap(), "map_scans.rng": rng(), "match_segments.current": WALLS,
    "match_segments.reference": WALLS, "matching.map": TREE, "max_size": 5.12,
    "mean_rotation.weights": np.ones(2), "min_length": 0.1, "near": 0.3, "normals": np.eye(2)[[0, 1,
    0, 1]], "odometry_noise": simulation.OdometryNoise(), "offsets": np.ones(4), "path": PATH,
    "point_distance.points": POINTS[:4], "points": POINTS, "pose": PATH[0], "poses": PATH,
    "quadtree.map": TREE, "ranges": np.ones(4), "beams": 9, "Sensor.first": 0.0, "step": 0.1,
    "max_range": 4.0, "cast_rays.angles": np.ones(3), "SegmentMap.sensors": PATH[:, :2],
    "SegmentMap.points": None, "SegmentMap.first": None, "count": 9, "nodes": 1000, "route.start":
    PATH[0, :2], "route.goal": np.array([1.5, 1.4]), "radius": 0.2, "rate": 0.5, "readers.path":
    "good.log.gz", "reference": POINTS, "reference_segments": WALLS, "relation_errors.times":
    np.arange(4), "relations": np.array([[0, 1, 0.05, 0, 0, 0, 0, 0.02]]), "relative":
    np.tile((0.05, 0.0, 0.02), (3, 1)), "resolution": 0.05, "rng": rng(), "save.path": "saved.npz",
    "scan": LOG[0], "scans": LOG.scans, "second": WALLS, "seen": WALLS, "segments": WALLS,
    "SegmentMap.scan": np.arange(4), "sensor": simulation.SICK_LMS200, "sensor_xy": PATH[0, :2],
    "size": 2.56, "extract_polylines.sensor": scans.SensorNoise(),
    "start": PATH[0], "through": np.zeros(2), "times": np.array([0.0, 1.0]), "truth":
    PATH, "u": WALLS[0], "v": WALLS[1], "value": 0.5, "rasterize.values":
    np.zeros(len(TREE.leaves().x)), "walls": WALLS, "rasterize.shown":
    np.ones(len(TREE.leaves().x)), "waypoints": PATH[:, :2], "cropped.left": 0.0, "cropped.low":
    0.0, "cropped.right": 2.0, "cropped.high": 1.0, "latitude": 52.5, "longitude": 13.4, "north":
    0.3, "Grid.name": "EPSG:25832", "east": 5e5, "northing": 5.8e6, "world": files.Earth(52.5,
    13.4), "turned.angle": 0.1, "place": (52.5, 13.4), "placed_at.north": 30.0, "origin": "map",
    "window": np.array([0.0, 0.0, 3.0, 2.0]),
}  # fmt: skip
GOOD |= {
    "plotting.ax": Figure().subplots(), "alignment": ALIGNMENT, "alignments": {"it": PATH},
    "maps": {"it": MAP}, "draw_quadtree.map": TREE,
    "frame": RUNS, "quality": 0.9, "draw_against_walls.found": metrics.against_walls(WALLS, MAP),
    "growth.frame": TIMES, "reduction": REDUCTION,     "columns": 1,
    "draw_maps.color": "#000000", "draw_maps.truth": WALLS,
    "draw_log.path": "#000000", "draw_log.poses": PATH, "robot": PATH[0], "figure": Figure((1, 1)),
    "draw_segments.group": np.zeros(4),
    "thumbnail.value": LOG[0], "label": None,
    "ComparePanel.map": MAP, "ComparePanel.runs": RUNS, "source": LOG, "panels.poses": PATH,
    "actual": PATH, "expected": PATH, "assert_segments_equal.actual": WALLS,
    "assert_segments_equal.expected": WALLS, "draw_segments.error": None,
    "tracked.number": 0, "executor": ThreadPoolExecutor(1), "LiveMap.graph": alignment.LiveGraph(),
    "LiveMap.map": quadtree.QuadtreeMap(),
    "LiveMap.walls": reduction.LiveReduction(),
    "function": reduction.METHODS["fusion"].function, "front.points":
    PATH[:, :2], "reduction_at.points": PATH[:, :2], "names": "malaga", "load_online.name":
    "intel", "read_records.path": "runs.csv", "write_records.path": "saved.csv",
    "good_maps.frame": experiments.load_walls("tuned"), "sweep.methods": ["fusion"],
    "select.method": "fusion", "select.map": "it", "filtered": 0.0,
    "sweep.filters": (0.1,),
    "thresholds": {"distance": 0.2}, "run": {"distance": 0.2}, "sweep.grids":
    {"fusion": {"tolerance": [0.04]}},
}  # fmt: skip
GOOD |= {
    "free": TREE,
    "Join.a": (1.0, 1.0),
    "Join.b": (2.0, 1.0),
    "Split.start": (1.0, 0.0),
    "Split.end": (1.0, 2.0),
    "NewDoor.start": (1.0, 0.0),
    "NewDoor.end": (1.0, 0.9),
    "NoDoor.at": (1.0, 1.0),
    "Wall.at": (1.0, 1.0),
    "Furniture.at": (1.0, 1.0),
    "Name.at": (1.0, 1.0),
    "Name.text": "hall",
    "edited.edits": [plan.NoDoor((1.0, 1.0))],
    "write_plan.plan": PLAN,
    "PlanEditor.plan": PLAN,
    "draw_plan.plan": PLAN,
    "write_plan.path": "written.dxf",
    "write_sheet.plan": PLAN,
    "from_room": 0,
    "to_room": 0,
}
GOOD |= {
    "UrgSensor.port": Newly,
    "UrgSensor.clock": lambda: Newly.last.now,
    "sensors.text": b"00",
    "parse_scan.body": [b"JUGnD", b"06805m`"],
    "characters": 2,
    "encode.values": np.array([392, 381]),
    "world": emulator.Room(WALLS, PATH),
    "turn": 3,
    "index": 1,
    "Unit.rate": 19200,
    "SpinningLaser.model": "LD19",
    "SpinningLaser.clockwise": True,
    "SpinningLaser.port": Newly,
    "SpinningLaser.clock": lambda: Newly.last.now,
    "SpinningEmulator.scans": LOG.scans,
    "SpinningEmulator.model": "LD19",
}
GOOD |= {"localize_ekf.map": MAP, "localize_ekf.covariance": np.diag([0.1, 0.1, 0.05]) ** 2}
#: Parameters that may be anything.
FREE = {"Log.name", "simulate.name", "Log.skipped", "Sensor.name"}
#: Who listens is called where there is much to tell: see test_progress.
FREE |= {f"{name}.progress" for name in ("deskew", "pose_graph", "prepared", "read", "told")}
FREE |= {"placed_at.crs"}  # `Grid` tells of it, as of its name
#: NaN is what these say of a time or scan that has none.
NAN_IS_MEANT = {
    "doubled_walls",
    "Geometry.ranges",
    "LivePanel.source=a log",
    "interpolate",
    "localize",
    "map_scans",
    "measure",
    "reduction_at",
}
#: What a call leaves behind in what it was given.
CHANGED_BY_USE = (
    np.random.Generator,
    quadtree.QuadtreeMap,
    alignment.LiveGraph,
    reduction.LiveReduction,
)
#: What else is meant, though it looks bad: a name that no run has selects none.
#: A range that is masked is a beam without a measurement.
MEANT = {"LaserScan.ranges=masked", "LaserScan.time=nan", "measure.ranges=masked",
         "select.map=NUL", "select.method=NUL", "explain.status=NUL",
         "encode_reply.echo=NUL", "encode_reply.status=NUL",
         "encode_reply_1.echo=NUL", "encode_reply_1.status=NUL", "laser_scan.time=nan",
         "info_line.key=NUL", "info_line.text=NUL",
         "sweep.filters=objects", "UrgSensor.clock=of nothing", "Unit.clock=of nothing",
         "SpinningLaser.clock=of nothing",
         "map_of_grid.cells=cut",  # a smaller grid is one
         "placed_at.place=with huge",  # of which `Earth` and `Grid` tell
         "default_thresholds.function=of nothing",
         "default_thresholds.function=of words",
         "Session.settings=holding nothing", "Session.settings=holding a word",  # a command reads
         "Session.settings=holding ragged", "Session.settings=holding a number",  # them later
         # a call would draw from its noise: the first scan tells
         "Emulator.world=of words", "Unit.world=of words"}  # fmt: skip
#: Numbers that may be arrays: these functions work on many at once.
ARRAYS = {"angle", "a", "b", "weight_a", "weight_b", "weight_u", "weight_v", "weights", "near"}


#: A list in a list, and so on.
NESTED = functools.reduce(lambda inner, _: [inner], range(1000), 3.0)


def holds_numbers(value):
    """Whether a value is an array, or a tuple that stands for one."""
    return isinstance(value, np.ndarray) or (
        type(value) is tuple and value != () and isinstance(value[0], int | float | np.ndarray)
    )


def spoilt(value, many):
    """What must be refused in the place of a good value, by a word for it."""
    kinds = {"nothing": None, "a word": "two", "an object": object(), "ragged": [[1], [1, 2]]}
    if isinstance(value, str):
        return {"a number": 3, "nothing": None, "a list": [1, 2], "NUL": "a\0b"}
    if isinstance(value, bool):
        return {"a word": "no", "nothing": None, "many": np.ones(3)}
    if isinstance(value, int | float | np.number):
        kinds |= {"masked": np.ma.masked, "complex": 1 + 2j, "a map": MAP, "a tree": TREE}
        return kinds if many else kinds | {"many": np.ones(3), "nan": np.nan}
    if holds_numbers(value):
        array = np.array(value, float)
        kinds["masked"] = np.ma.masked_array(array, np.arange(array.size).reshape(array.shape) == 0)
        kinds["rows masked"] = list(np.ma.atleast_2d(kinds["masked"]))
        if array.ndim > 1:  # poses of two numbers, points of one
            kinds["cut"] = array[..., :-1]
        return kinds | {"complex": array + 1j, "words": array.astype(str), "a tree": TREE,
                        "objects": np.full(array.shape, None), "a log": LOG}  # fmt: skip
    kinds |= {"a number": 7, "numbers": PATH}
    if callable(value) and not isinstance(value, type):
        never = {"a class": int, "of nothing": lambda: 0.0}
        return kinds | never | {"of words": lambda *given, **named: "two"}
    if isinstance(value, pd.DataFrame):
        return kinds | {"no columns": value.iloc[:, :0], "a dictionary": {"method": "fusion"}}
    if isinstance(value, dict):
        return kinds | (held(value, kinds) if not isinstance(value[min(value)], float) else {})
    return kinds


class Own(np.ndarray):
    """A class of arrays of somebody else's."""


def backwards(array):
    """The same array as a view of another one, from its end on, that nobody may write to."""
    found = np.flip(array, range(array.ndim)).copy()[(slice(None, None, -1),) * array.ndim]
    found = np.asarray(found).view(Own)
    found.flags.writeable = False
    return found


#: Other clothes of the same numbers.
CLOTHES = {
    "none": lambda array: array,
    "lists": lambda array: array.tolist(),
    "longdouble": lambda array: array.astype(np.longdouble),
    "float32": lambda array: array.astype(np.float32),
    "other bytes": lambda array: array.astype(array.dtype.newbyteorder()),
    "a view": backwards,
}


def dressed(value, word):
    """Numbers in other clothes; as they are, where these clothes would change them."""
    if isinstance(value, bool) or not (
        holds_numbers(value) or isinstance(value, int | float | np.number)
    ):
        return copy.deepcopy(value) if isinstance(value, CHANGED_BY_USE) else value
    array = np.array(value, None if isinstance(value, int) else float)
    other = CLOTHES[word](array)
    return other if np.array_equal(np.array(other, float), array, equal_nan=True) else value


def held(value, kinds):
    """A dictionary with bad values."""
    return {f"holding {word}": dict.fromkeys(value, bad) for word, bad in kinds.items()
            if word != "numbers"}  # fmt: skip


def odd(value):
    """What may be refused or not, but must not come out as anything else."""
    if isinstance(value, bool | str) or value is None:
        return {}
    if isinstance(value, int | float | np.number):
        found = {"zero": 0, "negative": -1.0, "infinite": np.inf, "large": 1e7, "part": 2.5}
        found |= {"whole": 2**63, "longer": 2**64, "least": -1e308}
        return found | {
            "huge": 1e19,
            "far": 1e155,
            "end": 1e308,
            "tiny": 1e-300,
            "small": 1e-9,
            "least of all": 5e-324,
            "nested": NESTED,
        }
    if holds_numbers(value):
        array, found = np.array(value, float), {"none": [], "one number": 1.0, "a map": MAP}
        for word, bad in (("nan", np.nan), ("inf", np.inf), ("minus", -1), ("huge", 1e19)):
            found[f"with {word}"] = array.copy()
            found[f"with {word}"].flat[-1] = bad
        found |= {"all nan": array * np.nan, "all zero": array * 0, "too deep": array[None]}
        found |= {"turned": array.T, "far": array * 1e155, "end": array + 1e308}
        found |= {"no dimension": np.array(3.0), "nested": NESTED}
        return found | {"shorter": array[:-1], "one": array[:1]}
    found = {"a tree": TREE, "a map": MAP, "a log": LOG, "none": [], "nested": NESTED}
    found |= {"no dimension": np.array(3.0), "no thing": np.array(None, object)}
    if isinstance(value, pd.DataFrame):
        return found | {"no rows": value[:0], "words": value.astype(str), "nan": value.assign(
            **dict.fromkeys(value.select_dtypes("number"), np.nan))}  # fmt: skip
    found |= {"nobody": {}, "of 3": {3: WALLS}, "of words": {"a": "b"}}
    return found | (held(value, spoilt(1.0, False)) if isinstance(value, dict) else {})
