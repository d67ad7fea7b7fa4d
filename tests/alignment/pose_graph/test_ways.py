"""Shortest ways through a pose graph."""

import numpy as np
import pytest
from scipy.sparse import csr_array
from scipy.sparse.csgraph import dijkstra

from segmap.alignment.pose_graph._ways import Ways

RNG = np.random.default_rng(3)
PATH = [0.0, *np.cumsum(RNG.uniform(0.2, 1.0, 299)).tolist()]
LOOPS = [(int(a), int(b)) for a, b in RNG.integers(0, 300, (40, 2)) if abs(a - b) > 1]


def of_scipy(start: int, loops: list) -> np.ndarray:
    graph = np.diag(np.diff(PATH), 1)
    for first, second in loops:
        graph[min(first, second), max(first, second)] = 0.5
    return dijkstra(csr_array(graph), directed=False, indices=start)


@pytest.mark.parametrize("most", [np.inf, 12.0])
def test_ways_are_those_of_scipy(most):
    """While loops come in, some are undone, and others come instead."""
    ways = Ways(0.5)
    for loops in ([], LOOPS[:10], LOOPS[:30], LOOPS[:20], LOOPS[:20] + LOOPS[32:], LOOPS[:1]):
        found = ways.between(299, np.arange(300), PATH, loops, most)
        expected = of_scipy(299, loops)
        np.testing.assert_allclose(found, np.where(expected > most, np.inf, expected))
    assert ways.between(299, np.arange(0), PATH, LOOPS).shape == (0,)


def test_a_search_stays_near_its_start():
    """Counted: how often it looks at the path to a key frame, in a graph of ten thousand."""

    class Path(list):
        looked = 0

        def __getitem__(self, k):
            Path.looked += 1
            return super().__getitem__(k)

    path = Path(np.arange(10_000) / 2)
    found = Ways(0.5).between(9_999, np.array([9_990, 0]), path, [(0, 9_980)])
    assert found.tolist() == [4.5, 10.0]
    assert Path.looked < 200
