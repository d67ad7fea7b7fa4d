"""Every compiled loop gives the same result as plain Python, with and without numba."""

from __future__ import annotations

import os
import subprocess
import sys

import numpy as np
import pytest
from conftest import slow

from segmap.compiled import PLAIN, compiled

#: Its window of search takes half a minute in plain Python: a smaller one stands in CASE.
SLOW = "alignment pose_graph"

CASE = """
import sys
if {blocked}:
    sys.modules["numba"] = None
import numpy as np
from segmap import _warm
from segmap.alignment.points._point_map import PointMap
from segmap.reduction import METHODS
from segmap.segments import SegmentMap
points = _warm._room()
search = dict(reach=0.2, turn=0.2, step=0.1)
found = [PointMap(points).search(points[::3], (0.1, 0.0, 0.1), **search)[0]]
for name, case in _warm.cases().items():
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


OTHER = """
import sys
sys.path.insert(0, {folder!r})
from outer import twice
print(twice(1.5))
"""


def test_a_kernel_is_compiled_again_when_one_in_another_file_changes(tmp_path):
    """Catches a cache that looks at a kernel's own file only, and answers as of yesterday."""
    outer = "from inner import once\nfrom segmap.compiled import compiled\n"
    outer += "@compiled\ndef twice(x):\n    return 2 * once(x)\n"
    (tmp_path / "outer.py").write_text(outer)
    said = []
    for factor in (1, 3, 3):
        inner = "from segmap.compiled import compiled\n@compiled\ndef once(x):\n"
        (tmp_path / "inner.py").write_text(inner + f"    return {factor} * x\n")
        code = OTHER.format(folder=str(tmp_path))
        environment = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path), PLAIN: "0"}
        environment["PYTHONDONTWRITEBYTECODE"] = "1"  # the file changes within a second
        run = [sys.executable, "-c", code]
        done = subprocess.run(run, capture_output=True, text=True, env=environment, check=True)
        said.append(float(done.stdout))
    assert said == [3.0, 9.0, 9.0]


@compiled
def _double(x: float) -> float:
    """Twice."""
    return 2 * x


@compiled
def _four_times(x: float) -> float:
    return _double(_double(x))


def test_kernels_call_kernels():
    assert _four_times(1.5) == _four_times.plain(1.5) == 6.0
    assert _double.__doc__ == "Twice."


def test_a_whole_number_is_no_new_signature():
    """Catches `fusion(walls, tolerance=1)` that waits eight seconds, everything warm."""
    from segmap import fusion
    from segmap.reduction._fusion_kernels import fuse_all

    for tolerance in (1, 1.0, np.float32(1)):
        fusion([[(0, 0), (1, 0)], [(0, 5), (3, 5)]], tolerance=tolerance)
    assert len(fuse_all._fast.signatures) == 1


def test_falls_back_where_no_cache_can_be_written(monkeypatch):
    """A read-only installation must still compile."""
    import numba

    kernel = compiled(lambda x: x + 1)
    original = numba.njit

    def refusing(*args, **kwargs):
        if kwargs.get("cache"):
            raise RuntimeError("no locator available")
        return original(*args, **kwargs)

    monkeypatch.setattr(numba, "njit", refusing)
    assert kernel(1) == 2
