"""Every public function refuses bad arguments with a ValueError: a table found by introspection.

Each function is called once as it should be, with good values chosen by the names of its
parameters. Then one argument at a time is spoilt, in every way that fits its kind. Nothing but a
ValueError that names the argument may come out (LogError and SensorError are such), and what has no
meaning must not pass, nor end as NaN. A new function joins by itself; a parameter with a new name
asks for a good value here.
"""

from __future__ import annotations

import copy
import faulthandler
import importlib
import inspect
import re
import resource
import warnings

import numpy as np
import pytest

from segmap import matching, quadtree, readers, segments, simulation
from segmap.scans import LaserScan

#: The library as far as it takes arrays and numbers. `literal` is loops to read, without checks.
ROOMS = [
    "angles", "poses", "segments", "scans", "extraction", "metrics", "simulation", "alignment",
    "reduction", "quadtree", "matching", "exports", "readers",
]  # fmt: skip
#: What the library makes itself and hands out: nobody else has to call these.
MADE = {"Alignment", "Graph", "LogError", "Match", "Methods", "Reduction", "take_points", "Tree"}

WALLS = np.array([[(0, 0), (3, 0)], [(3, 0), (3, 2)], [(3, 2), (0, 2)], [(0, 2), (0, 0)]], float)
PATH = np.array([(1 + k / 20, 1, 0.02 * k) for k in range(4)])


def rng():
    return np.random.default_rng(1)


LOG = simulation.simulate(WALLS, PATH, sensor=simulation.SICK_LMS200, rng=rng())
POINTS = LOG[0].points()
TREE = quadtree.build_map(LOG, PATH, resolution=0.05)
MAP = segments.SegmentMap(WALLS)
#: Objects whose public methods are doors too.
OBJECTS = {"matching": [matching.DistanceField(TREE)], "quadtree": [TREE], "segments": [MAP],
           "scans": [LOG, LOG[0]], "simulation": [simulation.URG_04LX]}  # fmt: skip

#: Good values by the name of a parameter; `function.parameter` comes first, then `room.parameter`.
#: A parameter that is not here keeps its default.
GOOD = {
    "angle_candidates.viewpoints": np.zeros((2, 2)), "write_ros_map.path": "written.yaml",
    "read_trajectory.path": "poses.csv", "data_file.name": "room", "a": PATH, "a_from_b": PATH,
    "after": WALLS[:2], "angles.a": 0.1, "angles.angle": 0.1,
    "angles.b": 0.1, "at": np.array([0.5]), "axial_mean.angles": np.array([0.1, 0.2]), "b": PATH,
    "b_from_c": PATH, "before": WALLS, "box.depth": 3.0, "box.width": 3.0,
    "corners": WALLS[:, 0], "current": POINTS, "current_segments": WALLS,
    "differences": np.array([0.1, 0.2]), "edges": np.array([(0, 1), (1, 2), (2, 3)]),
    "exports.map": TREE, "exports.path": "written.log", "extreme_projections.angle": 0.1,
    "file": "room", "first": WALLS, "free_ends.sensor": PATH[0], "free_points": POINTS,
    "free_resolution": 0.02, "global_segments.start": PATH, "ground_truth.times": None,
    "ground_truth.poses": None, "hill_climb.start": PATH[0], "incidence": np.ones(4),
    "information": np.tile(np.eye(3), (3, 1, 1)), "interpolate.poses": PATH[:2],
    "LaserScan.angles": LOG[0].angles, "LaserScan.codes": np.zeros(181),
    "LaserScan.odometry": PATH[0], "LaserScan.ranges": LOG[0].ranges, "least_translation.weights":
    np.ones(4), "fuzzy_set.axes": 0.1,
    "viewing_sector.map": segments.SegmentMap(WALLS, sensors=[(0.0, 0.0)]),
    "load.name": "room", "load.path": "map.npz", "log": LOG, "map": WALLS,
    "map_scans.map": quadtree.QuadtreeMap(), "map_scans.rng": rng(), "match_segments.current":
    WALLS, "match_segments.reference": WALLS, "matching.map": TREE, "max_size": 5.12,
    "mean_rotation.weights": np.ones(2), "min_length": 0.1, "near": 0.3,
    "normals": np.eye(2)[[0, 1, 0, 1]], "odometry_noise": simulation.OdometryNoise(), "offsets":
    np.ones(4), "path": PATH, "point_distance.points": POINTS[:4], "points": POINTS,
    "pose": PATH[0], "poses": PATH, "quadtree.map": TREE, "ranges": np.ones(4),
    "beams": 9, "Sensor.first": 0.0, "step": 0.1, "max_range": 4.0, "cast_rays.angles": np.ones(3),
    "SegmentMap.sensors": PATH[:, :2], "SegmentMap.points": None, "SegmentMap.first": None,
    "count": 9,
    "rate": 0.5, "readers.path": "good.log.gz", "reference": POINTS, "reference_segments": WALLS,
    "relation_errors.times": np.arange(4), "relations": np.array([[0, 1, 0.05, 0, 0, 0, 0, 0.02]]),
    "relative": np.tile((0.05, 0.0, 0.02), (3, 1)), "resolution": 0.05, "rng": rng(),
    "save.path": "saved.npz", "scan": LOG[0], "scans": LOG.scans, "second": WALLS,
    "segments": WALLS, "SegmentMap.scan": np.arange(4), "sensor": simulation.SICK_LMS200,
    "sensor_xy": PATH[0, :2], "size": 2.56, "start": PATH[0], "through": np.zeros(2),
    "times": np.array([0.0, 1.0]), "truth": PATH, "u": WALLS[0], "v": WALLS[1], "value": 0.5,
    "rasterize.values": np.zeros(len(TREE.leaves().x)), "walls": WALLS,
    "rasterize.shown": np.ones(len(TREE.leaves().x)), "waypoints": PATH[:, :2],
    "origin": "map", "window": np.array([0.0, 0.0, 3.0, 2.0]),
}  # fmt: skip
#: Parameters that may be anything.
FREE = {"Log.name", "simulate.name", "Log.skipped", "Sensor.name"}
#: NaN is what these say of a time or scan that has none.
NAN_IS_MEANT = {"interpolate", "map_scans", "measure"}
#: Numbers that may be arrays: these functions work on many at once.
ARRAYS = {"angle", "a", "b", "weight_a", "weight_b", "weight_u", "weight_v", "weights", "near"}


def public(room):
    """Functions, constructors and methods of a room, each with its name."""
    module = importlib.import_module(f"segmap.{room}")
    for name in getattr(module, "__all__", vars(module)):
        found = getattr(module, name)
        made_here = getattr(found, "__module__", "").startswith(module.__name__)
        is_door = inspect.isfunction(found) or (
            inspect.isclass(found) and not issubclass(found, tuple)
        )
        if made_here and is_door and not name.startswith("_") and name not in MADE:
            yield name, found
    for thing in OBJECTS.get(room, []):
        for name, method in inspect.getmembers(thing, inspect.ismethod):
            if not name.startswith("_") and name in vars(type(thing)):
                yield f"{type(thing).__name__}.{name}", method


DOORS = [(room, name, found) for room in ROOMS for name, found in public(room)]


def parameters(function):
    kept = inspect.signature(function).parameters.values()
    return [p for p in kept if p.kind is not p.VAR_KEYWORD]


def good(room, door, parameter):
    """A good value of a parameter."""
    name = parameter.name
    if f"{door}.{name}" in FREE:
        return "it"
    for key in (f"{door.split('.')[-1]}.{name}", f"{room}.{name}", name):
        if key in GOOD and (parameter.default in (None, parameter.empty) or "." in key):
            return GOOD[key]
    assert parameter.default not in (None, parameter.empty), (
        f"{room}.{door}: give its parameter {name!r} a value in GOOD, or a place in FREE"
    )
    return parameter.default


def spoilt(value, many):
    """What must be refused in the place of a good value, by a word for it."""
    kinds = {"nothing": None, "a word": "two", "an object": object(), "ragged": [[1], [1, 2]]}
    if isinstance(value, str):
        return {"a number": 3, "nothing": None, "a list": [1, 2], "NUL": "a\0b"}
    if isinstance(value, bool):
        return {"a word": "no", "nothing": None, "many": np.ones(3)}
    if isinstance(value, int | float | np.number):
        kinds |= {"complex": 1 + 2j, "a map": MAP, "a tree": TREE}
        return kinds if many else kinds | {"many": np.ones(3), "nan": np.nan}
    if isinstance(value, np.ndarray) or (isinstance(value, tuple) and np.ndim(value[0]) < 2
                                         and not isinstance(value[0], LaserScan)):  # fmt: skip
        array = np.array(value, float)
        return kinds | {"complex": array + 1j, "words": array.astype(str), "a tree": TREE,
                        "objects": np.full(array.shape, None), "a log": LOG}  # fmt: skip
    return {"nothing": None, "a number": 7, "a word": "two", "an object": object(), "numbers": PATH}


def odd(value):
    """What may be refused or not, but must not come out as anything else."""
    if isinstance(value, bool | str) or value is None:
        return {}
    if isinstance(value, int | float | np.number):
        found = {"zero": 0, "negative": -1.0, "infinite": np.inf, "large": 1e7, "part": 2.5}
        return found | {"huge": 1e19, "far": 1e155, "end": 1e308, "tiny": 1e-300, "small": 1e-9}
    if isinstance(value, np.ndarray | tuple) and not isinstance(value[0], LaserScan):
        array, found = np.array(value, float), {"none": [], "one number": 1.0, "a map": MAP}
        for word, bad in (("nan", np.nan), ("inf", np.inf), ("minus", -1), ("huge", 1e19)):
            found[f"with {word}"] = array.copy()
            found[f"with {word}"].flat[-1] = bad
        found |= {"all nan": array * np.nan, "all zero": array * 0, "too deep": array[None]}
        found |= {"turned": array.T, "far": array * 1e155, "end": array + 1e308}
        return found | {"cut": array[..., :-1], "shorter": array[:-1], "one": array[:1]}
    return {"a tree": TREE, "a map": MAP, "a log": LOG, "none": []}


def cases(room, door, function):
    """Each bad argument of a door: its name, a word for it, itself, whether it must not pass."""
    for parameter in parameters(function):
        name = parameter.name
        if f"{door}.{name}" in FREE or (value := good(room, door, parameter)) is None:
            continue
        for must, bad in ((True, spoilt(value, name in ARRAYS)), (False, odd(value))):
            for word, thing in bad.items():
                meant = f"{door}.{name}" == "LaserScan.time" and word == "nan"
                if not meant and (thing is not None or parameter.default is not None):
                    yield name, word, thing, must


@pytest.fixture(scope="module", autouse=True)
def bounded(tmp_path_factory):
    """No case may fill the memory, and files are written and read in a folder of the test."""
    folder = tmp_path_factory.mktemp("doors")
    (folder / "good.log.gz").write_bytes(readers.data_file("room/room.log.gz").read_bytes())
    (folder / "poses.csv").write_text("10.5, 1, 2, 0.5" + ", 0" * 9)
    TREE.save(folder / "map.npz")
    soft, hard = resource.getrlimit(resource.RLIMIT_AS)
    resource.setrlimit(resource.RLIMIT_AS, (12 << 30, hard))
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        yield
    resource.setrlimit(resource.RLIMIT_AS, (soft, hard))


def call(room, door, function, **changed):
    """Call with good values where there is no default, and what is changed."""
    given, positional, owner = {}, [], getattr(function, "__self__", None)
    if owner is not None and not inspect.isclass(owner):
        function = getattr(copy.deepcopy(owner), function.__name__)
    for p in parameters(function):
        if p.default is p.empty or p.name in changed or f"{door}.{p.name}" in GOOD:
            value = changed[p.name] if p.name in changed else good(room, door, p)
            if p.kind is p.POSITIONAL_OR_KEYWORD and len(given) == 0:
                positional.append(value)
            else:
                given[p.name] = value
        elif p.kind is p.POSITIONAL_OR_KEYWORD:
            positional.append(p.default)
    found = function(*positional, **given)
    return list(found) if inspect.isgenerator(found) else found


def numbers_in(found):
    """All numbers of a result, in one array."""
    if isinstance(found, np.ndarray | float):
        return np.ravel(np.asarray(found, float)) if np.asarray(found).dtype.kind == "f" else []
    parts = found
    if not isinstance(found, list | tuple):
        names = ("pose", "poses", "segments")
        parts = [getattr(found, name) for name in names if hasattr(found, name)]
    return np.concatenate([np.empty(0), *map(numbers_in, parts)])


@pytest.mark.parametrize(("room", "door", "function"), DOORS, ids=lambda v: v if v in ROOMS else "")
def test_the_good_call_is_good(room, door, function):
    """Catches a table whose calls fail for another reason than the one tested."""
    call(room, door, function)


#: What a value that is allowed is warned of: see test_units.
SLIPS = ".*(look like|looks like|is empty: |neither map holds)"


def complaint(room, door, function, name, bad, must):
    """What is wrong with the answer to a bad argument; nothing where it is as it should be."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        warnings.filterwarnings("ignore", SLIPS, UserWarning)
        try:
            found = call(room, door, function, **{name: bad})
        except ValueError as error:
            words = ["max_size", "window", "corner", r"scan \d"] + [
                p.name for p in parameters(function)
            ]
            named = any(re.search(rf"\b{word}\b", str(error)) for word in words)
            return "" if named or "broadcast" in str(error) else f"does not name {name}: {error}"
        except Exception as error:
            return f"{type(error).__name__}: {error}"
    if must:
        return "was accepted"
    fine = door in NAN_IS_MEANT or (isinstance(bad, np.ndarray) and np.isnan(bad).any())
    return "" if fine or not np.isnan(numbers_in(found)).any() else "gives NaN in silence"


@pytest.mark.parametrize(("room", "door", "function"), DOORS, ids=lambda v: v if v in ROOMS else "")
def test_bad_arguments_are_value_errors(room, door, function):
    """Catches a traceback of numpy, numba or scipy, nonsense that passes in silence, and a hang."""
    wrong = []
    for name, word, bad, must in cases(room, door, function):
        faulthandler.dump_traceback_later(300, exit=True)
        if said := complaint(room, door, function, name, bad, must):
            wrong.append(f"{door}({name}={word}) {said}")
        faulthandler.cancel_dump_traceback_later()
    assert not wrong, "\n".join(wrong)
