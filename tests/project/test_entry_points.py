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
from dataclasses import fields, is_dataclass

import bag_samples
import numpy as np
import pytest
from conftest import without_pictures
from entry_point_table import (
    ARRAYS,
    CHANGED_BY_USE,
    CLOTHES,
    FREE,
    GOOD,
    MAP,
    MEANT,
    NAN_IS_MEANT,
    OBJECTS,
    TREE,
    dressed,
    odd,
    spoilt,
)
from matplotlib import pyplot

from segmap import experiments, exports, readers, sensors
from segmap_app import files

#: The library as far as it takes arrays and numbers. `literal` is loops to read, without checks.
PACKAGES = [
    "angles", "poses", "segments", "scans", "extraction", "metrics", "simulation", "alignment",
    "reduction", "quadtree", "matching", "exports", "readers", "plotting", "experiments",
    "panels", "testing", "sensors", "sensors.emulator", "plan",
]  # fmt: skip
#: What the library makes itself and hands out: nobody else has to call these.
MADE = {"AgainstWalls", "Alignment", "Belief", "ColumnChoices", "Door", "FloorPlan", "Graph",
        "HeadError",
        "LogError", "Match", "Methods", "NoRoute", "Places", "Port",
        "Reduction", "Room", "SensorError", "SensorGone", "Squares", "Tree", "Uncertainty",
        "UnknownFormat", "Verdict", "cut_evenly", "take_points"}  # fmt: skip
#: What drawings and panels are made of: these take what a drawing or a panel has checked.
PARTS = {"axes_grid", "axes_or_new", "axes_row", "group_colors", "map_axes", "method_style",
         "square_corners", "Panel", "control", "player", "slider", "text"}  # fmt: skip


def public(package):
    """Functions, constructors and methods of a package, each with its name."""
    module = importlib.import_module(f"segmap.{package}")
    for name in getattr(module, "__all__", vars(module)):
        found = getattr(module, name)
        made_here = getattr(found, "__module__", "").startswith(module.__name__)
        is_entry = inspect.isfunction(found) or (
            inspect.isclass(found) and not issubclass(found, tuple)
        )
        if made_here and is_entry and not name.startswith("_") and name not in MADE | PARTS:
            yield name, found
    for thing in OBJECTS.get(package, []):
        for name, method in inspect.getmembers(thing, inspect.ismethod):
            if not name.startswith("_") and name in vars(type(thing)):
                yield f"{type(thing).__name__}.{name}", method


ENTRY_POINTS = [(package, name, found) for package in PACKAGES for name, found in public(package)]


def parameters(function):
    kept = inspect.signature(function).parameters.values()
    return [p for p in kept if p.kind is not p.VAR_KEYWORD]


def good(package, called, parameter):
    """A good value of a parameter."""
    name = parameter.name
    if f"{called}.{name}" in FREE:
        return "it"
    for key in (f"{called}.{name}", f"{called.split('.')[-1]}.{name}", f"{package}.{name}", name):
        if key in GOOD and (parameter.default in (None, parameter.empty) or "." in key):
            return GOOD[key]() if isinstance(GOOD[key], type) else GOOD[key]
    assert parameter.default not in (None, parameter.empty), (
        f"{package}.{called}: give its parameter {name!r} a value in GOOD, or a place in FREE"
    )
    return parameter.default


def cases(package, called, function):
    """Each bad argument of a function: name, word for it, value, whether it must not pass."""
    for parameter in parameters(function):
        name = parameter.name
        if f"{called}.{name}" in FREE or (value := good(package, called, parameter)) is None:
            continue
        for must, bad in ((True, spoilt(value, name in ARRAYS)), (False, odd(value))):
            for word, thing in bad.items():
                meant = f"{called}.{name}={word}" in MEANT
                if not meant and (thing is not None or parameter.default is not None):
                    yield name, word, thing, must


@pytest.fixture(scope="module", autouse=True)
def bounded(tmp_path_factory):
    """No case may fill the memory, and files are written and read in a folder of the test."""
    folder = tmp_path_factory.mktemp("entry_points")
    (folder / "good.log.gz").write_bytes(readers.data_file("room/room.log.gz").read_bytes())
    bag_samples.write(folder, "ros1")
    (folder / "beams.csv").write_text("0,1\n1,2\n")
    (folder / "track.tum").write_text("-1 0 0 0 0 0 0 1\n9 1 0 0 0 0 0 1\n")
    (folder / "poses.csv").write_text("time_s,x_m,y_m,theta_rad\n10.5,1,2,0.5\n")
    TREE.save(folder / "map.npz")
    for name in ("segments.csv", "segments.npz"):
        exports.write_segments(folder / name, MAP)
    files.write_session(folder / "it.segmap", GOOD["session"])
    exports.write_graph(folder / "graph.g2o", GOOD["write_graph.graph"])
    files.write_ros_map(folder / "ros.yaml", GOOD["exports.map"])
    experiments.write_records(GOOD["frame"], folder / "runs.csv")
    soft, hard = resource.getrlimit(resource.RLIMIT_AS)
    resource.setrlimit(resource.RLIMIT_AS, (12 << 30, hard))
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        without_pictures(patch)
        yield
    resource.setrlimit(resource.RLIMIT_AS, (soft, hard))


def call(package, called, function, /, **changed):
    """Call with good values where there is no default, and what is changed."""
    given, positional, owner = {}, [], getattr(function, "__self__", None)
    if owner is not None and not inspect.isclass(owner):
        function = getattr(copy.deepcopy(owner), function.__name__)
    for p in parameters(function):
        chosen = {f"{called}.{p.name}", f"{package}.{p.name}"} & set(GOOD)
        if p.default is p.empty or p.name in changed or chosen:
            value = changed[p.name] if p.name in changed else good(package, called, p)
            if p.kind in (p.POSITIONAL_OR_KEYWORD, p.VAR_POSITIONAL) and len(given) == 0:
                positional.append(value)
            else:
                given[p.name] = value
        elif p.kind is p.POSITIONAL_OR_KEYWORD:
            positional.append(p.default)
    found = function(*positional, **given)
    pyplot.close("all")
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


#: What a value that is allowed is warned of: see test_units.
SLIPS = ".*(look like|looks like|is empty: |neither map holds)"


def complaint(package, called, function, name, bad, must):
    """What is wrong with the answer to a bad argument; nothing where it is as it should be."""
    bad = copy.deepcopy(bad) if isinstance(bad, CHANGED_BY_USE) else bad  # others get it too
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        warnings.filterwarnings("ignore", SLIPS, UserWarning)
        try:
            found = call(package, called, function, **{name: bad})
        except ValueError as error:
            words = ["max_size", "window", "corner", r"scan \d", r"saved\.csv, line \d"] + [
                p.name for p in parameters(function)
            ]
            named = any(re.search(rf"\b{word}\b", str(error)) for word in words)
            if pyplot.get_fignums():
                pyplot.close("all")
                return f"leaves an empty figure behind: {error}"
            return "" if named or "broadcast" in str(error) else f"does not name {name}: {error}"
        except sensors.SensorError as error:  # what a sensor sends is judged by its own words
            return "" if package == "sensors" and str(error) else f"SensorError: {error}"
        except AssertionError:
            return "" if called.startswith("assert_") else "AssertionError"
        except TypeError as error:  # what is called says so itself
            return "" if callable(bad) and f"{name}: " in str(error) else f"TypeError: {error}"
        except Exception as error:
            pyplot.close("all")
            return f"{type(error).__name__}: {error}"
    if must:
        return "was accepted"
    fine = called in NAN_IS_MEANT or (isinstance(bad, np.ndarray) and np.isnan(bad).any())
    return "" if fine or not np.isnan(numbers_in(found)).any() else "gives NaN in silence"


@pytest.mark.parametrize(
    ("package", "called", "function"), ENTRY_POINTS, ids=lambda v: v if v in PACKAGES else ""
)
def test_bad_arguments_are_value_errors(package, called, function):
    """Catches a traceback of numpy, numba or scipy, nonsense that passes in silence, and a hang."""
    call(
        package, called, function
    )  # as it should be: else all that follows fails for another reason
    wrong = []
    for name, word, bad, must in cases(package, called, function):
        faulthandler.dump_traceback_later(300, exit=True)
        if said := complaint(package, called, function, name, bad, must):
            wrong.append(f"{called}({name}={word}) {said}")
        faulthandler.cancel_dump_traceback_later()
    assert not wrong, "\n".join(wrong)


def told(found):
    """What a result tells, and not how long it took."""
    if isinstance(found, np.ndarray):
        return found.dtype.str, found.tolist()
    if isinstance(found, tuple | list):
        names = getattr(found, "_fields", range(len(found)))
        return [told(part) for name, part in zip(names, found, strict=True) if name != "seconds"]
    if is_dataclass(found):
        return {f.name: told(getattr(found, f.name)) for f in fields(found) if "sec" not in f.name}
    return found if isinstance(found, int | float | str | bytes) else type(found).__name__


@pytest.mark.parametrize(
    ("package", "called", "function"),
    [
        called for called in ENTRY_POINTS if called[0] not in ("plotting", "panels")
    ],  # which give pictures
    ids=lambda v: v if v in PACKAGES else "",
)
def test_the_same_call_in_other_clothes_gives_the_same_result(package, called, function):
    """Catches a compiler's error for a long number, a list that adds itself, and what is kept."""
    kept = [p for p in parameters(function) if f"{called}.{p.name}" not in FREE]
    value, said = {p.name: good(package, called, p) for p in kept}, {}
    for word in CLOTHES:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            found = call(
                package, called, function, **{n: dressed(v, word) for n, v in value.items()}
            )
        said[word] = repr(told(found))
    assert [word for word in CLOTHES if said[word] != said["none"]] == []
