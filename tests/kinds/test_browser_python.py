"""A Python without numba, threads and processes, as in a browser or on Windows: a map is made."""

import os
import subprocess
import sys

#: What such a Python lacks, before segmap is imported. Windows has no `termios`: only what is asked
#: for in our own files is withheld, for others look after themselves.
LACKING = """
import builtins, os, sys, threading
known = builtins.__import__
def withheld(name, globals=None, *rest, **named):
    absent = name in ("termios", "fcntl", "resource", "pty", "tty", "pwd", "grp")
    if absent and (globals or {}).get("__name__", "").startswith("segmap"):
        raise ModuleNotFoundError(name)
    return known(name, globals, *rest, **named)
builtins.__import__ = withheld
sys.modules["numba"] = None
for missing in ("_multiprocessing", "_posixshmem"):
    sys.modules[missing] = None
for name in ("fork", "sched_getaffinity"):
    if hasattr(os, name):
        delattr(os, name)
os.cpu_count = lambda: 1
def refuse(*given, **named):
    raise RuntimeError("can't start new thread")
threading.Thread.start = refuse
"""

IMPORTS = """
import importlib, pkgutil
import segmap, segmap_app, segmap_course
for package in (segmap, segmap_app, segmap_course):
    for found in pkgutil.walk_packages(package.__path__, package.__name__ + "."):
        if not found.name.endswith("__main__"):
            importlib.import_module(found.name)
            print(found.name)
"""

RUNS = """
import numpy as np
import segmap, segmap_course as course
from segmap import alignment, quadtree, reduction
from segmap.matching import localize_ekf
log = segmap.load("room")[:5]
found = alignment.point_icp(log)
map = segmap.build_map(log, found)
small = reduction.fusion(map)
tree = quadtree.build_map(log, found, resolution=0.1)
state = list(localize_ekf(segmap.SegmentMap(small.segments), log, log.truth[0], np.eye(3) / 99))
png = map._repr_mimebundle_()["image/png"]
panel = course.FusionPanel(map)
panel.tolerance.value = 0.1
away = np.hypot(*(found.poses - log.truth)[:, :2].T).max()
print(len(map) > len(small) > 3, away < 0.05, len(tree.leaves().x) > 50, len(state), png[:4])
assert "numba" not in str(sys.modules["numba"]) and course.check_compose(lambda a, b: a).hint
"""


def run(code):
    done = subprocess.run(
        [sys.executable, "-c", LACKING + code],
        capture_output=True,
        text=True,
        env={**os.environ, "MPLBACKEND": "agg"},
        timeout=300,
        check=False,
    )
    assert done.returncode == 0, done.stderr[-2000:]
    return done.stdout.splitlines()


def test_everything_imports_without_numba_threads_and_processes():
    """Catches a thread that an import starts, a name of `os` or `multiprocessing` at the top of a
    file that a browser does not have, and a `termios` that ends `import segmap` on Windows."""
    imported = run(IMPORTS)
    assert {"segmap.matching._kalman", "segmap_course.panels._tape"} <= set(imported)
    assert len(imported) > 300


def test_a_map_is_made_drawn_and_played_with_without_them():
    """Catches work that only goes on in a second thread, and a loop that only numba runs."""
    assert run(RUNS) == ["True True True 5 iVBO"]
