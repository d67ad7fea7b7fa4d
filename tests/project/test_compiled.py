"""Every compiled loop gives the same result as plain Python, with and without numba."""

from __future__ import annotations

import importlib
import os
import signal
import subprocess
import sys
import tempfile
import time
from functools import partial
from types import SimpleNamespace

import numpy as np
import pytest
from conftest import slow

from segmap import warm
from segmap.compiled import (
    COMPILING,
    KEPT_NOWHERE,
    PLAIN,
    _say_once,
    compiled,
    hold_signals,
    work_time,
)
from segmap.progress import Compiling, announce, told

#: Its window of search takes half a minute in plain Python: a smaller one stands in CASE.
SLOW = "alignment pose_graph"

CASE = """
import sys
if {blocked}:
    sys.modules["numba"] = None
import numpy as np
from segmap import warm
from segmap.alignment.points._point_map import PointMap
from segmap.reduction import METHODS
from segmap.segments import SegmentMap
points = warm._room()
search = dict(reach=0.2, turn=0.2, step=0.1)
found = [PointMap(points).search(points[::3], (0.1, 0.0, 0.1), **search)[0]]
for name, case in warm.cases().items():
    found += case() if name != {slow!r} else []
for method in METHODS.values():  # what has nothing, or one thing, to look at
    for count in (0, 1):
        few = SegmentMap(np.array([[[0.0, 0.0], [1.0, 0.5]]])[:count], sensors=[(0.0, 0.0)])
        found.append(method(few).segments)
print("numba" in sys.modules and sys.modules["numba"] is not None)
for array in found:
    print(" ".join(f"{{x:.9e}}" for x in np.ravel(array)))
"""


def run(blocked: bool = False, plain: bool = False) -> list[str]:
    environment = {**os.environ, PLAIN: "1" if plain else "0"}
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", CASE.format(blocked=blocked, slow=SLOW)],
        capture_output=True,
        text=True,
        env=environment,
        timeout=300,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout.splitlines()


@pytest.mark.parametrize("how", [slow({"blocked": True}), {"plain": True}])
def test_plain_python_gives_the_same(how):
    """A loop that only numba accepts, or that wraps, divides or clips differently there, or that
    reads beyond an array: compiled loops do not look, `least_cost([])` read beside nothing."""
    used, *expected = run()
    assert used == "True"
    used, *found = run(**how)
    assert used == "False"
    for a, b in zip(found, expected, strict=True):
        np.testing.assert_allclose(
            np.array(a.split(), float), np.array(b.split(), float), 1e-6, 1e-8
        )


@compiled
def doubled(x: float) -> float:
    return 2 * x


@compiled
def doubled_twice(x: float) -> float:
    return doubled(doubled(x))


def test_a_kernel_that_python_has_called_serves_other_kernels(tmp_path, monkeypatch):
    """Catches one that is compiled again for other kernels: what a newcomer waits for."""
    event = pytest.importorskip("numba.core.event")
    monkeypatch.delenv(PLAIN, raising=False)
    monkeypatch.setattr("numba.config.CACHE_DIR", str(tmp_path))
    with event.install_recorder("numba:compile") as seen:
        assert (doubled(1.5), doubled_twice(1.5)) == (3.0, 6.0)
    names = [one.data["dispatcher"].py_func.__name__ for _, one in seen.buffer if one.is_start]
    assert sorted(names) == ["doubled", "doubled_twice"]


#: Written anew for each case below; `kernel.py`, whose date and content the cache looks at, is not.
KERNEL = """
from names import LIMIT, State, half
from segmap.compiled import compiled

@compiled
def answer(state: State) -> float:
    return half(state.first) * LIMIT
"""
ROOM = {
    "names.py": "from inner import half\nfrom {state} import State\nLIMIT = {limit}\n",
    "inner.py": "from segmap.compiled import compiled\n\n@compiled\ndef half(x):\n"
    "    return x / {by}\n",
    "{state}.py": "from typing import NamedTuple\n\n"
    "class State(NamedTuple):\n    {one}: float\n    {two}: float\n",
}
BEFORE = {"state": "state", "limit": 8, "by": 2, "one": "first", "two": "second"}
UPDATES = {
    "a module that moved": ({"state": "moved"}, 4.0),
    "another kernel": ({"by": 4}, 2.0),
    "a constant": ({"limit": 80}, 40.0),
    "the order of fields": ({"one": "second", "two": "first"}, 12.0),
}


@pytest.mark.parametrize("update", UPDATES)
def test_an_update_of_another_file_is_seen_by_the_cache(update, tmp_path, monkeypatch):
    """Catches a cache that looks at a kernel's own file only: it answers as of yesterday, or ends
    with `ModuleNotFoundError` where a module of named tuples has moved."""
    numba = pytest.importorskip("numba")
    monkeypatch.delenv(PLAIN, raising=False)
    monkeypatch.setattr(numba.config, "CACHE_DIR", str(tmp_path / "cache"))
    monkeypatch.setattr(sys, "dont_write_bytecode", True)  # files change within a second
    monkeypatch.syspath_prepend(tmp_path)
    (tmp_path / "kernel.py").write_text(KERNEL)
    changed, expected = UPDATES[update]
    compiled_anew = []
    for given, answer in ((BEFORE, 4.0), (BEFORE | changed, expected), (BEFORE, 4.0)):
        for name, text in ROOM.items():
            (tmp_path / name.format(**given)).write_text(text.format(**given))
        importlib.invalidate_caches()
        kernel, state = importlib.import_module("kernel"), importlib.import_module(given["state"])
        assert kernel.answer(state.State(1.0, 3.0)) == answer
        compiled_anew.append(sum(kernel.answer._fast.stats.cache_misses.values()))
        (tmp_path / f"{given['state']}.py").unlink()
        for name in ("kernel", "names", "inner", given["state"]):
            del sys.modules[name]
    assert compiled_anew == [1, 1, 0]


def test_a_whole_number_is_no_new_signature():
    """Catches `fusion(walls, tolerance=1)` that waits eight seconds, everything warm."""
    from segmap import fusion
    from segmap.reduction._fusion import _fuse_all

    for tolerance in (1, 1.0, np.float32(1)):
        fusion([[(0, 0), (1, 0)], [(0, 5), (3, 5)]], tolerance=tolerance)
    assert len(_fuse_all._fast.signatures) == 1


#: Interrupts at random moments of the processor's time, an alarm each; then the call must be right.
INTERRUPTED = """
import random, signal, sys, time
import numpy as np
from segmap.kernels import describe
moments, came = random.Random({seed}), 0
signal.signal(signal.SIGINT, signal.default_int_handler)
signal.signal(signal.SIGVTALRM, lambda *_: signal.raise_signal(signal.SIGINT))
walls = np.array([[[0.0, 0.0], [2.0, 0.0]]])
while came < {most}:
    signal.setitimer(signal.ITIMER_VIRTUAL, moments.uniform(0.001, {longest}))
    try:
        describe(walls)
        signal.setitimer(signal.ITIMER_VIRTUAL, 0)
        break
    except KeyboardInterrupt:
        came += 1
print(came, *describe(walls)[0].tolist(), "numba" in sys.modules)
"""


@pytest.mark.skipif(not hasattr(signal, "setitimer"), reason="Windows has no such alarm")
@pytest.mark.parametrize("seed", [4, *map(slow, [0, 1, 2, 3, *range(5, 11)])])
def test_an_interrupted_first_call_can_be_repeated(seed, tmp_path):
    """Catches numba half imported, a table of what it compiles half read, a kernel half compiled:
    all stay so until the process ends. Each child is interrupted from an empty cache on."""
    environment = os.environ | {"NUMBA_CACHE_DIR": str(tmp_path), PLAIN: "0"}
    code = INTERRUPTED.format(seed=seed, most=12, longest=0.3 if seed % 2 else 0.8)
    words = [sys.executable, "-c", code]
    done = subprocess.run(
        words, capture_output=True, text=True, env=environment, timeout=300, check=False
    )
    assert done.returncode == 0, done.stderr
    came, *found, used = done.stdout.split()
    assert int(came) >= 1 and found == ["1.0", "0.0", "1.0", "0.0", "1.0"] and used == "True"


def test_what_compiles_goes_on_behind_an_interrupt():
    """Catches an interrupt that comes within, and one that is lost."""
    steps = []

    def work(word):
        signal.raise_signal(signal.SIGINT)
        time.sleep(0.1)
        steps.append(word)

    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        with pytest.raises(KeyboardInterrupt):
            hold_signals(work)("compiled")
    finally:
        signal.signal(signal.SIGINT, before)
    assert steps == ["compiled"]
    with pytest.raises(ZeroDivisionError):
        hold_signals(lambda: 1 / 0)()


# ------------------------------------------------------------------ where machine code is kept
ONCE = """\
from segmap.arrays import Array
from segmap.compiled import compiled

@compiled
def double(a: Array) -> float:
    return 2.0 * a[0]
"""


class Installation:
    """A module with a loop; its folder, and the home of who calls it, can be closed to writing."""

    def __init__(self, root, monkeypatch, capsys):
        self.root, self.capsys, self.closed = root, capsys, []
        (root / "segmap_once.py").write_text(ONCE)
        monkeypatch.syspath_prepend(root)
        for name in ("segmap_once", "ipykernel"):  # a notebook's kernel says nothing
            monkeypatch.delitem(sys.modules, name, raising=False)
        self.module, opened = importlib.import_module("segmap_once"), tempfile.TemporaryFile

        def refused(*args, **options):  # root may write anywhere: numba tries by such a file
            if any(str(options["dir"]).startswith(str(folder)) for folder in self.closed):
                raise PermissionError(13, "closed")
            return opened(*args, **options)

        monkeypatch.setattr(tempfile, "TemporaryFile", refused)
        monkeypatch.setattr("numba.config.CACHE_DIR", "")
        for name in ("HOME", "XDG_CACHE_HOME"):
            monkeypatch.setenv(name, str(root / "home"))
        monkeypatch.delenv(PLAIN, raising=False)

    def run(self, a):
        """What a new process says; how many files each folder has then."""
        _say_once.cache_clear()
        assert compiled(self.module.double.plain)(np.array([a])) == 2 * a
        folders = (self.root / "__pycache__", self.root / "home")
        kept = [sum(1 for _ in folder.rglob("*double*.nbc")) for folder in folders]
        return self.capsys.readouterr().err, kept


@pytest.fixture
def installation(tmp_path, monkeypatch, capsys):
    pytest.importorskip("numba")
    return Installation(tmp_path, monkeypatch, capsys)


def test_a_warm_installation_is_read_though_nobody_may_write_it(installation):
    """Catches a hub on which each student compiles what the administrator has, a home that fills
    with copies, a run without a home; and one that waits without a word."""
    said = f"segmap: {COMPILING}; `segmap warm` does it for all\n"
    assert installation.run(1.5) == (said, [1, 0])
    assert installation.run(1.5) == ("", [1, 0])
    installation.closed = [installation.root / "__pycache__"]
    assert installation.run(1.5) == ("", [1, 0])
    assert installation.run(1) == (said, [1, 1])  # whole numbers: what is missing is one's own
    assert installation.run(1) == ("", [1, 1])
    installation.closed = [installation.root]
    assert installation.run(1.5) == ("", [1, 1])
    for _ in range(2):
        assert installation.run(1.5 + 1j) == (f"segmap: {KEPT_NOWHERE}\n", [1, 1])


def test_compiling_is_told_as_such_and_is_no_time_of_the_work(installation):
    """Catches seconds of a method that are those of the compiler, and a stop that breaks a loop."""
    heard = []

    def refuse(share, words):
        heard.append((share, words.partition(":")[0]))
        raise InterruptedError

    with told(refuse), pytest.raises(InterruptedError):
        installation.run(1.5)
    assert heard == [(0.0, COMPILING)]
    begun = time.perf_counter(), work_time()
    with told(lambda *said: None):
        assert installation.run(1.5) == ("", [1, 0])  # a bar says it, and no line beside
    whole, work = time.perf_counter() - begun[0], work_time() - begun[1]
    assert 0 <= work < 0.2 * whole
    begun = time.perf_counter(), work_time()
    time.sleep(0.02)
    assert abs((time.perf_counter() - begun[0]) - (work_time() - begun[1])) < 0.01


def test_what_is_needed_is_loaded_once_and_tells_of_compiling_alone(monkeypatch):
    """Catches a first map whose time left is that of the compiler."""
    ran, heard = [], []

    def case(name):
        ran.append(name)
        announce(0.7, "placing scan 3 of 4")
        announce(0.0, Compiling(f"{COMPILING}: {len(ran)} loops so far"))

    monkeypatch.setattr(warm, "cases", lambda: {n: partial(case, n) for n in ("a", "b")})
    monkeypatch.setattr(warm, "_dispatched", set())
    monkeypatch.delenv(PLAIN, raising=False)
    with told(lambda share, words: heard.append((share, words))):
        warm.dispatch(["b", "a", "b", "a method of one's own"])
        warm.dispatch(["a"])
    assert ran == ["b", "a"]
    loading = "loading compiled loops"
    assert heard[::2] == [(0.0, loading), (0.5, loading)] and len(heard) == 4
    monkeypatch.setattr(warm, "_dispatched", set())
    needed = [SimpleNamespace(_fast=None, _inner=None) for _ in range(10)]
    needed[3]._fast = needed[4]._inner = print  # of two there is machine code
    monkeypatch.setattr(warm, "loops", lambda cases: needed)
    monkeypatch.setattr(warm, "missing", ran)  # one for each case
    heard.clear()
    with told(lambda share, words: heard.append((share, words))):
        warm.dispatch(["a", "b"])
    assert heard == [(0.0, loading)] + [(0.2, "compiling loop 2 of 10")] * 2
    assert isinstance(heard[1][1], Compiling), "no time is told of it"
    ran[2:] = []
    monkeypatch.setenv(PLAIN, "1")  # as plain Python the cases take minutes
    monkeypatch.setattr(warm, "_dispatched", set())
    warm.dispatch(["a"])
    assert ran == ["b", "a"]
