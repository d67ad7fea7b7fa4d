"""Arrays of numbers, checked: any shape, rows, points, poses, segments."""

import sys
from typing import Protocol, TypeGuard, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ._scalars import LIMIT, brief, refuse_masked

#: Squares of numbers up to here are still numbers: enough for arithmetic that counts no cells.
LARGEST_COORDINATE = 1e100

Array = NDArray[np.float64]


@runtime_checkable
class HasSegments(Protocol):
    """Anything with `.segments`, `(n, 2, 2)`: a map or a reduction."""

    @property
    def segments(self) -> Array:
        """Segments, `(n, 2, 2)` array, metres."""
        ...


@runtime_checkable
class HasPoses(Protocol):
    """Anything with `.poses`, `(k, 3)`: an alignment."""

    @property
    def poses(self) -> Array:
        """Poses, `(k, 3)` array, metres and radians."""
        ...


Segments = HasSegments | ArrayLike
Poses = HasPoses | ArrayLike | None  # None, as of a log without truth, is refused in words


def numbers(value: object, name: str, expected: str = "an array of real numbers") -> Array:
    """Real numbers of any shape as floats: no text, no complex numbers, no objects, none masked.

    An error calls the argument by its `name`, and says what was `expected`.

    Examples
    --------
    >>> numbers([1, 2], "ranges")
    array([1., 2.])
    >>> numbers("two", "ranges")
    Traceback (most recent call last):
    ValueError: ranges must be an array of real numbers, got 'two'
    """
    if type(value) is not np.ndarray:  # which masks nothing
        refuse_masked(value, name)
    try:
        array = np.asarray(value)
    except (TypeError, ValueError):
        array = np.empty(0, object)  # rows of different lengths
    if array.dtype.kind not in "fiub":
        raise ValueError(f"{name} must be {expected}, got {brief(value)}")
    return array.astype(float, copy=False)


def ready(value: object) -> TypeGuard[Array]:
    """Whether a loop takes it as it is: it is compiled for whole arrays that it may write into.

    Examples
    --------
    >>> ready(np.zeros((4, 2))), ready(np.zeros((4, 4))[:, :2]), ready([[0.0, 0.0]])
    (True, False, False)
    """
    return type(value) is np.ndarray and value.dtype == float and value.flags.carray


def ranges(value: object, name: str = "ranges") -> Array:
    """Ranges of beams, of any shape, metres: a masked one is no measurement, NaN.

    Examples
    --------
    >>> ranges(np.ma.masked_greater([1.0, 65.0], 60.0))
    array([ 1., nan])
    """
    if isinstance(value, np.ma.MaskedArray) and value.dtype.kind in "fiu":
        value = np.ma.filled(value.astype(float), np.nan)
    return numbers(value, name)


def values(value: object, name: str) -> Array:
    """Real numbers of any shape that arithmetic stands: NaN may be among them, infinity may not.

    Examples
    --------
    >>> values([1.0, np.inf], "angles")
    Traceback (most recent call last):
    ValueError: angles must be finite and within 1e+100, got [1.0, inf]
    """
    array = numbers(value, name)
    if np.fmax.reduce(np.abs(array), axis=None, initial=0.0) > LARGEST_COORDINATE:
        raise ValueError(
            f"{name} must be finite and within {LARGEST_COORDINATE:.0e}, got {brief(value)}"
        )
    return array


def indices(value: object, name: str) -> NDArray[np.int64]:
    """Whole numbers of any shape, a copy.

    Examples
    --------
    >>> indices([0, 0.5], "scan")
    Traceback (most recent call last):
    ValueError: scan must be whole numbers, got [0, 0.5]
    """
    array = numbers(value, name)
    if not (np.abs(array) < 2**53).all() or (array % 1 != 0).any():
        raise ValueError(f"{name} must be whole numbers, got {brief(value)}")
    return array.astype(np.int64)


def row(value: object, name: str, count: int | None = None) -> Array:
    """Finite numbers in a row, `(n,)`: `count` of them, if given.

    Examples
    --------
    >>> row([1, 2], "weights", 3)
    Traceback (most recent call last):
    ValueError: weights must have shape (3,), got (2,)
    """
    return table(value, name, unit="", count=count, limit=LARGEST_COORDINATE)


def share_of_second(first: object, second: object, names: tuple[str, str]) -> Array:
    """Share of the second of two weights in their sum, 0 to 1.

    Examples
    --------
    >>> share_of_second(1, 0.25, ("weight_a", "weight_b"))
    array(0.2)
    """
    a, b = values(first, names[0]), values(second, names[1])
    if not (np.all(a >= 0) and np.all(b >= 0) and np.all(a + b > 0)):
        raise ValueError(f"{' and '.join(names)} must not be negative, and not both zero")
    return np.asarray(b / (a + b))


def with_axes(value: object, name: str, *axes: int) -> Array:
    """Numbers of any leading shape whose last axes are given; NaN may be among them.

    Points are `(..., 2)`, poses `(..., 3)`, segments `(..., 2, 2)`. An empty list is no row.

    Examples
    --------
    >>> with_axes([[(0, 0), (1, 0)]], "segments", 2, 2).shape
    (1, 2, 2)
    >>> with_axes((0, 0), "pose", 3)
    Traceback (most recent call last):
    ValueError: pose must have shape (..., 3), got (2,)
    """
    array = values(value, name)
    if array.shape[-len(axes) :] == axes:
        return array
    if array.shape == (0,):
        return np.empty((0, *axes))
    wanted = ", ".join(["...", *map(str, axes)])
    raise ValueError(f"{name} must have shape ({wanted}), got {array.shape}")


def table(
    value: object,
    name: str,
    *axes: int,
    unit: str = "metres",
    count: int | None = None,
    missing: bool = False,
    limit: float = LIMIT,
    expected: str = "an array of real numbers",
) -> Array:
    """Numbers `(n, *axes)`, of any count if none is given: nothing at all is no row then.

    They are in `unit`, at most `limit`; they may be NaN where `missing` allows it.
    """
    array = numbers(value, name, expected)
    if not array.size and not count and array.ndim in (1, 1 + len(axes)):
        return np.empty((0, *axes))
    shape = array.shape
    if not shape or shape[1:] != axes or count not in (None, shape[0]):
        wanted = str(("n" if count is None else count, *axes)).replace("'", "")
        raise ValueError(f"{name} must have shape {wanted}, got {shape}")
    _check_values(array, name, unit, missing, limit)
    return array


def points(value: object, name: str = "points") -> Array:
    """Points, `(n, 2)`, metres: finite, and no building away.

    Examples
    --------
    >>> points([(0, 0), (1, np.inf)])
    Traceback (most recent call last):
    ValueError: points must be finite, in metres, but points[1] is [1.0, inf]
    """
    return table(value, name, 2)


def poses(
    value: Poses, name: str = "poses", *, count: int | None = None, missing: bool = False
) -> Array:
    """Poses of an alignment or an array, `(k, 3)`, metres and radians.

    Rows of NaN may be among them where `missing` allows it.

    Examples
    --------
    >>> poses([(0, 0, 0)], count=2)
    Traceback (most recent call last):
    ValueError: poses must have shape (2, 3), got (1, 3)
    """
    rows = getattr(value, "poses", value)
    return table(rows, name, 3, unit="metres and radians", count=count, missing=missing)


def pose(value: object, name: str = "pose", *, missing: bool = False) -> Array:
    """One pose, `(3,)`: x and y in metres, heading in radians; NaN where `missing` allows it."""
    return table(value, name, unit="metres and radians", count=3, missing=missing)


def point(value: object, name: str = "point", *, limit: float = LIMIT) -> Array:
    """One point, `(2,)`, metres, no coordinate above a limit."""
    return table(value, name, count=2, limit=limit)


def rectangle(left: float, low: float, right: float, high: float) -> Array:
    """Lower left and upper right corner, `(2, 2)`, metres, of a rectangle that holds something."""
    corners = np.stack([point((left, low), "left, low"), point((right, high), "right, high")])
    if not (corners[0] < corners[1]).all():
        raise ValueError(
            f"wanted left < right and low < high, got {left}, {low}, {right} and {high}"
        )
    return corners


def segments(value: Segments, name: str = "segments") -> Array:
    """Segments of a map, a reduction or an array, `(n, 2, 2)`, metres."""
    rows = getattr(value, "segments", value)
    return table(rows, name, 2, 2, expected="a map or an (n, 2, 2) array")


def _check_values(array: Array, name: str, unit: str, missing: bool, limit: float) -> None:
    """Refuse what is not finite, unless it may be missing, and what is beyond the limit."""
    if np.abs(array).max(initial=0.0) <= min(limit, sys.float_info.max):  # False for NaN
        return
    rows = array.reshape(len(array), -1) if array.ndim > 1 else array[None]
    infinite = (np.isinf(rows) if missing else ~np.isfinite(rows)).any(1)
    wrong = infinite if infinite.any() else (np.abs(rows) > limit).any(1)
    if wrong.any():
        fault = "finite" if infinite.any() else f"within {limit:.0e}"
        where = f"{name}[{wrong.argmax()}]" if array.ndim > 1 else name
        got = (array[wrong.argmax()] if array.ndim > 1 else array).tolist()
        words = f"{fault}, in {unit}" if unit else fault
        raise ValueError(f"{name} must be {words}, but {where} is {got}")
