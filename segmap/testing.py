"""Assertions for tests: segments are equal without direction, headings where they wrap."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from . import arrays
from .angles import wrap
from .arrays import Array, Segments
from .segments import midpoint


def assert_segments_equal(
    actual: Segments, expected: Segments, *, atol: float = 1e-9, ordered: bool = False
) -> None:
    """Assert that two maps hold the same segments, whichever end point comes first.

    Parameters
    ----------
    atol : float, metres
        Coordinates may differ by so much.
    ordered : bool
        Whether the order of the segments counts too. Without it every segment of one map must have
        a partner of its own in the other.

    Raises
    ------
    AssertionError
        Naming the first segment that has no partner, and the nearest one; or how many there are.
    ValueError
        Where either is not an array of finite segments.

    Examples
    --------
    >>> assert_segments_equal([[(0, 0), (1, 0)]], [[(1, 0), (0, 0)]])
    >>> assert_segments_equal([[(0, 0), (1, 0)]], [[(0, 0), (1, 0.5)]])
    Traceback (most recent call last):
    AssertionError: actual segment 0 [[0, 0], [1, 0]] has no partner in expected; nearest is
    segment 0 [[0, 0], [1, 0.5]], off by 0.5 m
    """
    __tracebackhide__ = True
    a, b = arrays.segments(actual, "actual"), arrays.segments(expected, "expected")
    arrays.number(atol, "atol", least=0, unit="metres")
    ordered = arrays.switch(ordered, "ordered")
    if len(a) != len(b):
        raise AssertionError(f"actual holds {len(a)} segments, expected {len(b)}")
    if ordered:
        off = _difference(a, b)
        if (off > atol).any():
            k = int(np.argmax(off > atol))
            raise AssertionError(
                f"segment {k} differs by {off[k]:.6g} m: actual {_text(a[k])}, "
                f"expected {_text(b[k])}"
            )
    elif (alone := _first_alone(a, b, atol)) < len(a):
        off = _difference(a[alone], b)
        k = int(np.argmin(off))
        raise AssertionError(
            f"actual segment {alone} {_text(a[alone])} has no partner in expected; nearest is "
            f"segment {k} {_text(b[k])}, off by {off[k]:.6g} m"
        )


def assert_poses_equal(actual: ArrayLike, expected: ArrayLike, *, atol: float = 1e-9) -> None:
    """Assert that two arrays of poses are the same, headings a whole turn apart included.

    Parameters
    ----------
    actual, expected : (..., 3) array, metres and radians
        Rows with NaN equal rows with NaN in the same columns.
    atol
        Metres and radians.

    Raises
    ------
    AssertionError
        Naming the shapes, or the first pose that differs.
    ValueError
        Where either does not hold numbers, or infinite ones.

    Examples
    --------
    >>> assert_poses_equal((1, 2, np.pi), (1, 2, -np.pi))
    >>> assert_poses_equal([(1, 2, 0), (1, 2, 0)], [(1, 2, 0), (1, 2, 0.5)])
    Traceback (most recent call last):
    AssertionError: pose 1 differs by 0 m and 0.5 rad: actual [1, 2, 0], expected [1, 2, 0.5]
    """
    __tracebackhide__ = True
    a, b = arrays.values(actual, "actual"), arrays.values(expected, "expected")
    arrays.number(atol, "atol", least=0, most=np.inf)
    if a.shape != b.shape or a.shape[-1:] != (3,):
        raise AssertionError(f"expected poses of shape {b.shape}, got {a.shape}")
    a, b = a.reshape(-1, 3), b.reshape(-1, 3)
    step = np.where(np.isnan(a) & np.isnan(b), 0.0, a - b)
    step[:, 2] = wrap(step[:, 2])
    wrong = ~(np.abs(step) <= atol).all(axis=1)
    if wrong.any():
        k = int(np.argmax(wrong))
        far, turned = np.hypot(*step[k, :2]), abs(step[k, 2])
        raise AssertionError(
            f"pose {k} differs by {far:.6g} m and {turned:.6g} rad: actual {_text(a[k])}, "
            f"expected {_text(b[k])}"
        )


def _difference(a: Array, b: Array) -> Array:
    """Largest difference of a coordinate, for the better of both directions, `(...)`."""
    straight = np.abs(a - b).max(axis=(-2, -1))
    swapped = np.abs(a - b[..., ::-1, :]).max(axis=(-2, -1))
    return np.minimum(straight, swapped)


def _first_alone(a: Array, b: Array, atol: float) -> int:
    """First segment of a that is left over when as many as possible have a partner in b."""
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import maximum_bipartite_matching
    from scipy.spatial import cKDTree

    if not len(a):
        return 0
    reach = 1.5 * atol + 1e-12 * np.abs(midpoint(a)).max()
    near = cKDTree(midpoint(a)).sparse_distance_matrix(
        cKDTree(midpoint(b)), reach, output_type="coo_matrix"
    )
    same = _difference(a[near.row], b[near.col]) <= atol
    links = (np.ones(same.sum(), np.int8), (near.row[same], near.col[same]))
    graph = csr_array(links, shape=(len(a), len(b)))
    partner = maximum_bipartite_matching(graph, perm_type="column")
    return int(np.argmax(np.append(partner, -1) < 0))


def _text(values: Array) -> str:
    if values.ndim > 1:
        return f"[{', '.join(map(_text, values))}]"
    return f"[{', '.join(f'{value:.6g}' for value in values)}]"
