"""Every compiled loop gives the same result as plain Python, with and without numba."""

import os
import subprocess
import sys

import numpy as np
import pytest

from segmap._compiled import PLAIN, compiled

CASE = """
import sys
if {blocked}:
    sys.modules["numba"] = None
import numpy as np
from segmap import alignment, extraction, matching, metrics, quadtree, reduction, simulation
from segmap.alignment._point_map import PointMap
rng = np.random.default_rng(3)
t = np.radians(np.arange(0, 360, 6.0))
ranges = 1 / np.maximum(np.abs(np.cos(t)) / 2, np.abs(np.sin(t)) / 1.5) + rng.normal(0, 0.01, 60)
points = np.stack([ranges * np.cos(t), ranges * np.sin(t)], -1)
walls = rng.uniform(-3, 3, (12, 2, 2))
seen = np.repeat(walls, 3, axis=0) + rng.normal(0, 0.01, (36, 2, 2))
reduced = reduction.fusion(seen)
match = alignment.match_points(points, points[5:] + (0.03, -0.02))
path = np.array([(1.0, 5.0, 0.0), (1.3, 5.0, 0.05), (1.6, 5.1, 0.1)])
office = simulation.office(rng=np.random.default_rng(1), rooms=2)
log = simulation.simulate(office, path, sensor=simulation.SICK_LMS200, rng=rng)
maps = [quadtree.QuadtreeMap(resolution=0.1, size=1.6, free_resolution=f) for f in (None, 0.2)]
for map in maps:
    map.insert_scan((0.1, 0.0), points, points[:5] * 1.5)
poses = rng.normal(0, 0.2, (3, 3))
scores = [getattr(matching, name) for name in matching.__all__ if name.endswith("_score")]
found = [
    *[score(maps[0], points, poses) for score in scores],
    matching.hill_climb(maps[1], points, poses[0]),
    *maps[0].leaves(),
    *maps[1].leaves(),
    maps[0].to_grid(0.2),
    maps[1].occupancy(points),
    extraction.extract_clusters(points, closed=True),
    extraction.extract_clusters(points, fit="algebraic"),
    extraction.extract_polylines(points, gap=0.5, closed=True),
    extraction.fit_line(points[:9])[0],
    metrics.errors(seen, reduced),
    reduced.segments,
    reduced.parents,
    reduction.basic_offline(seen).segments,
    reduction.hybrid(seen).segments,
    reduction.mean_shift(seen[:9], sigma=1.0).segments,
    simulation.cast_rays(walls, (0.1, 0.2, 0.3), t, max_range=4.0),
    alignment.match_segments(walls, walls[2:8] + 0.02).pose,
    alignment.global_segments(log).poses,
    match.pose,
    match.covariance,
    PointMap(points).search(points[::3], (0.1, 0.0, 0.1), reach=0.2, turn=0.2, step=0.1)[0],
]
print("numba" in sys.modules and sys.modules["numba"] is not None)
for array in found:
    print(" ".join(f"{{x:.9e}}" for x in np.ravel(array)))
"""


def run(blocked: bool = False, plain: bool = False) -> list[str]:
    environment = {**os.environ, PLAIN: "1" if plain else "0"}
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", CASE.format(blocked=blocked)],
        capture_output=True,
        text=True,
        env=environment,
        timeout=300,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout.splitlines()


@pytest.mark.parametrize("how", [{"blocked": True}, {"plain": True}])
def test_plain_python_gives_the_same(how):
    """A loop that only numba accepts, or that wraps, divides or clips differently there."""
    used, *expected = run()
    assert used == "True"
    used, *found = run(**how)
    assert used == "False"
    for a, b in zip(found, expected, strict=True):
        np.testing.assert_allclose(
            np.array(a.split(), float), np.array(b.split(), float), 1e-6, 1e-8
        )


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
