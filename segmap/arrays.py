"""One place that checks arguments: arrays of numbers, and numbers with a range.

Every public function passes its arguments through these, so that what is wrong ends as a
`ValueError` that names the argument, what was expected and what was given. Loops that are compiled
check nothing.
"""

import sys
from collections.abc import Collection
from typing import Any, Protocol, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]

#: No coordinate of a map of a building is larger, metres. Compiled loops count cells in 64 bits,
#: and cells of a hundredth of a millimetre still fit.
LIMIT = 1e7


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
Poses = HasPoses | ArrayLike


def numbers(value: object, name: str, expected: str = "an array of real numbers") -> Array:
    """Real numbers of any shape as floats: no text, no complex numbers, no objects.

    An error calls the argument by its `name`, and says what was `expected`.

    Examples
    --------
    >>> numbers([1, 2], "ranges")
    array([1., 2.])
    >>> numbers("two", "ranges")
    Traceback (most recent call last):
    ValueError: ranges must be an array of real numbers, got 'two'
    """
    try:
        array = np.asarray(value)
    except (TypeError, ValueError):
        array = np.empty(0, object)  # rows of different lengths
    if array.dtype.kind not in "fiub":
        raise ValueError(f"{name} must be {expected}, got {_brief(value)}")
    return array.astype(float, copy=False)


def trailing(value: object, name: str, *axes: int) -> Array:
    """Numbers of any leading shape whose last axes are given; NaN and infinity may be among them.

    Points are `(..., 2)`, poses `(..., 3)`, segments `(..., 2, 2)`. An empty list is no row.

    Examples
    --------
    >>> trailing([[(0, 0), (1, 0)]], "segments", 2, 2).shape
    (1, 2, 2)
    >>> trailing((0, 0), "pose", 3)
    Traceback (most recent call last):
    ValueError: pose must have shape (..., 3), got (2,)
    """
    array = numbers(value, name)
    if array.shape[-len(axes) :] == axes:
        return array
    if array.shape == (0,):
        return np.empty((0, *axes))
    wanted = ", ".join(["...", *map(str, axes)])
    raise ValueError(f"{name} must have shape ({wanted}), got {array.shape}")


def table(
    value: object,
    name: str,
    columns: int,
    *,
    unit: str = "metres",
    count: int | None = None,
    missing: bool = False,
    limit: float = LIMIT,
) -> Array:
    """Rows of numbers, `(n, columns)`; nothing at all is no row.

    There must be `count` of them, if given. Values are in `unit`, at most `limit`; they may be NaN
    where `missing` allows it.
    """
    wanted = f"({'n' if count is None else count}, {columns})"
    array = numbers(value, name, f"a {wanted} array")
    if array.size == 0 and array.ndim in (1, 2) and not count:
        return np.empty((0, columns))
    if array.ndim != 2 or array.shape[1] != columns or count not in (None, len(array)):
        raise ValueError(f"{name} must have shape {wanted}, got {array.shape}")
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
    given = getattr(value, "poses", value)
    return table(given, name, 3, unit="metres and radians", count=count, missing=missing)


def pose(value: object, name: str = "pose", *, missing: bool = False) -> Array:
    """One pose, `(3,)`: x and y in metres, heading in radians; NaN where `missing` allows it."""
    array = numbers(value, name, "a pose (x, y, heading)")
    if array.shape != (3,):
        raise ValueError(f"{name} must be x, y, heading, got shape {array.shape}")
    _check_values(array, name, "metres and radians", missing, LIMIT)
    return array


def point(value: object, name: str = "point", *, limit: float = LIMIT) -> Array:
    """One point, `(2,)`, metres, no coordinate above a limit."""
    array = numbers(value, name, "a point (x, y)")
    if array.shape != (2,):
        raise ValueError(f"{name} must be x, y, got shape {array.shape}")
    _check_values(array, name, "metres", False, limit)
    return array


def segments(value: Segments, name: str = "segments") -> Array:
    """Segments of a map, a reduction or an array, `(n, 2, 2)`, metres."""
    given = getattr(value, "segments", value)
    array = numbers(given, name, "a map or an (n, 2, 2) array")
    if array.size == 0 and array.ndim in (1, 3):
        return np.empty((0, 2, 2))
    if array.ndim != 3 or array.shape[1:] != (2, 2):
        raise ValueError(
            f"{name} must have shape (n, 2, 2), segments of two end points, got {array.shape}"
        )
    _check_values(array, name, "metres", False, LIMIT)
    return array


def number(
    value: object,
    name: str,
    *,
    above: float | None = None,
    least: float | None = None,
    below: float | None = None,
    most: float | None = None,
    unit: str = "",
) -> float:
    """One finite number: above a bound, or at least at it, and below another, or at most at it.

    Infinity is allowed where `most` is infinite.

    Examples
    --------
    >>> number(0.04, "tolerance", above=0, unit="metres")
    0.04
    >>> number(-1, "tolerance", above=0, unit="metres")
    Traceback (most recent call last):
    ValueError: tolerance must be a number above 0, in metres, got -1
    """
    array = np.asarray(value)
    fits = array.shape == () and array.dtype.kind in "fiu"
    fits = fits and bool(np.isfinite(array) or array == most == np.inf)
    fits = fits and (above is None or float(array) > above)
    fits = fits and (least is None or float(array) >= least)
    fits = fits and (below is None or float(array) < below)
    fits = fits and (most is None or float(array) <= most)
    if not fits:
        bounds = [(" above", above), (" of at least", least), (" below", below)]
        bounds.append((" of at most", most))
        range_ = " and".join(
            f"{word} {bound:.6g}" for word, bound in bounds if bound not in (None, np.inf)
        )
        suffix = f", in {unit}" if unit else ""
        kind = "a number" if range_ else "a finite number"
        raise ValueError(f"{name} must be {kind}{range_}{suffix}, got {_brief(value)}")
    return float(array)


def positive(unit: str = "", **values: object) -> None:
    """Refuse each named value that is not one positive, finite number.

    Examples
    --------
    >>> positive("metres", distance=0.2, gap=0)
    Traceback (most recent call last):
    ValueError: gap must be a number above 0, in metres, got 0
    """
    for name, value in values.items():
        number(value, name, above=0, unit=unit)


def whole(value: object, name: str, *, least: int = 1, most: int | None = None) -> int:
    """One whole number.

    Examples
    --------
    >>> whole(3.0, "every")
    3
    """
    array = np.asarray(value)
    fits = array.shape == () and array.dtype.kind in "fiu" and bool(np.isfinite(array))
    fits = fits and float(array).is_integer() and least <= int(array)
    if not fits or (most is not None and int(array) > most):
        upper = "" if most is None else f" and at most {most}"
        raise ValueError(
            f"{name} must be a whole number of at least {least}{upper}, got {_brief(value)}"
        )
    return int(array)


def one_of(value: object, name: str, choices: Collection[str]) -> str:
    """One word of several.

    Examples
    --------
    >>> one_of("best", "fit", ("total", "algebraic"))
    Traceback (most recent call last):
    ValueError: fit must be one of 'total', 'algebraic', got 'best'
    """
    if not (isinstance(value, str) and value in choices):
        known = ", ".join(repr(choice) for choice in choices)
        raise ValueError(f"{name} must be one of {known}, got {_brief(value)}")
    return value


def generator(value: Any, name: str = "rng") -> np.random.Generator:
    """A source of random numbers.

    Examples
    --------
    >>> generator(7)
    Traceback (most recent call last):
    ValueError: rng must be a generator, numpy.random.default_rng(1) say, got 7
    """
    if not isinstance(value, np.random.Generator):
        raise ValueError(
            f"{name} must be a generator, numpy.random.default_rng(1) say, got {_brief(value)}"
        )
    return value


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
        raise ValueError(f"{name} must be {fault}, in {unit}, but {where} is {got}")


def _brief(value: object) -> str:
    text = repr(value)
    return text if len(text) <= 60 else f"{text[:57]}..."
