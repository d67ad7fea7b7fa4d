"""Arguments that are no arrays, checked: numbers with a range, words, objects."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterable
from os import PathLike
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

T = TypeVar("T")
R = TypeVar("R")

#: No coordinate of a map of a building is larger, metres. Compiled loops count cells in 64 bits,
#: and cells of a hundredth of a millimetre still fit.
LIMIT = 1e7
#: No threshold is a smaller length, metres: 1e7 m in such cells can still be counted.
SMALLEST_THRESHOLD_M = 1e-9
#: No count of anything is larger.
MOST_COUNTED = 10**9


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

    A length in metres is 0, or not below a nanometre and not above the limit of coordinates.
    Infinity is allowed where `most` is infinite.

    Examples
    --------
    >>> number(0.04, "tolerance", above=0, unit="metres")
    0.04
    >>> number(-1, "tolerance", above=0, unit="metres")
    Traceback (most recent call last):
    ValueError: tolerance must be a number above 0, in metres, got -1
    """
    array = _as_scalar_array(value)
    real = float(array) if array.dtype.kind in "fiu" else math.nan
    fits = math.isfinite(real) or real == most == math.inf
    fits = fits and (above is None or real > above)
    fits = fits and (least is None or real >= least)
    fits = fits and (below is None or real < below)
    fits = fits and (most is None or real <= most)
    if not fits:
        bounds = [(" above", above), (" of at least", least), (" below", below)]
        bounds.append((" of at most", most))
        range_ = " and".join(
            f"{word} {bound:.6g}" for word, bound in bounds if bound not in (None, np.inf)
        )
        suffix = f", in {unit}" if unit else ""
        kind = "a number" if range_ else "a finite number"
        upper = most if below is None else below
        degrees = unit == "radians" and upper and real > upper
        hint = f" (of degrees np.radians({brief(value)}))" if degrees else ""
        raise ValueError(f"{name} must be {kind}{range_}{suffix}{hint}, got {brief(value)}")
    most = LIMIT if most is None else most
    if unit.startswith("metres") and real and not SMALLEST_THRESHOLD_M <= abs(real) <= most:
        raise ValueError(
            f"{name} must be within {SMALLEST_THRESHOLD_M:.0e} and {LIMIT:.0e} metres, got {value}"
        )
    return real


def whole(value: object, name: str, *, least: int = 1, most: int = MOST_COUNTED) -> int:
    """One whole number.

    Examples
    --------
    >>> whole(3.0, "every")
    3
    """
    array = _as_scalar_array(value)
    fits = array.dtype.kind in "fiu" and bool(np.isfinite(array))
    fits = fits and float(array).is_integer() and least <= int(array)
    if not fits or int(array) > most:
        upper = f" and at most {most}" if fits or most != MOST_COUNTED else ""
        raise ValueError(
            f"{name} must be a whole number of at least {least}{upper}, got {brief(value)}"
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
        words = ", ".join(repr(choice) for choice in choices)
        raise ValueError(f"{name} must be one of {words}, got {brief(value)}")
    return value


def instance(value: T, name: str, kind: type) -> T:
    """One object of a class.

    Examples
    --------
    >>> instance("malaga", "log", dict)
    Traceback (most recent call last):
    ValueError: log must be a dict, got 'malaga'
    """
    if not isinstance(value, kind):
        raise ValueError(f"{name} must be a {kind.__name__}, got {brief(value)}")
    return value


def frame(
    value: Any, columns: Iterable[str] = (), numbers: Iterable[str] = (), name: str = "frame"
) -> Any:
    """A DataFrame with some columns, and with others that hold numbers.

    Examples
    --------
    >>> frame({"quality": 0.9}, numbers=["quality"])
    Traceback (most recent call last):
    ValueError: frame must be a pandas DataFrame, got {'quality': 0.9}
    """
    import pandas as pd

    if not isinstance(value, pd.DataFrame):
        raise ValueError(f"{name} must be a pandas DataFrame, got {brief(value)}")
    if missing := [each for each in [*columns, *numbers] if each not in value]:
        had = ", ".join(map(str, value.columns))
        raise ValueError(f"{name} must have columns {', '.join(missing)}, but has {had or 'none'}")
    words = [each for each in numbers if not pd.api.types.is_numeric_dtype(value[each])]
    if words and len(value):
        raise ValueError(f"{name} must hold numbers in its columns {', '.join(words)}")
    return value


def switch(value: object, name: str) -> bool:
    """True or False.

    Examples
    --------
    >>> switch("no", "closed")
    Traceback (most recent call last):
    ValueError: closed must be True or False, got 'no'
    """
    if not (isinstance(value, bool | int | np.bool_) and value in (0, 1)):
        raise ValueError(f"{name} must be True or False, got {brief(value)}")
    return bool(value)


def function(value: T, name: str, words: str) -> T:
    """Something that can be called, and is no class; words say what is expected.

    Examples
    --------
    >>> function("fast", "extract", "of points")
    Traceback (most recent call last):
    ValueError: extract must be a function of points, got 'fast'
    """
    if not callable(value) or isinstance(value, type):
        raise ValueError(f"{name} must be a function {words}, got {brief(value)}")
    return value


def call_given(function: Callable[..., R], name: str, *given: Any, **named: Any) -> R:
    """What a function of the caller's gives; a TypeError names the argument that brought it.

    Examples
    --------
    >>> call_given(lambda: 3.0, "score", "map")
    Traceback (most recent call last):
    TypeError: score: <lambda>() takes 0 positional arguments but 1 was given
    """
    try:
        return function(*given, **named)
    except TypeError as error:
        raise TypeError(f"{name}: {error}") from error


def file(value: object, name: str = "path") -> Path:
    """The path of a file or folder.

    Examples
    --------
    >>> file(3)
    Traceback (most recent call last):
    ValueError: path must be the path of a file or folder, got 3
    """
    if not isinstance(value, str | PathLike) or "\0" in str(value) or not str(value):
        raise ValueError(f"{name} must be the path of a file or folder, got {brief(value)}")
    return Path(value)


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
            f"{name} must be a generator, numpy.random.default_rng(1) say, got {brief(value)}"
        )
    return value


def _as_scalar_array(value: object) -> NDArray[Any]:
    """One number as an array; an object where it is anything else."""
    try:
        array = np.asarray(value)
    except (TypeError, ValueError):  # rows of different lengths
        return np.array(None)
    return array if array.shape == () and not is_masked(value) else np.array(None)


def is_masked(value: object) -> bool:
    """Whether part of an array, or of one in a list, is masked: numpy would lay it bare."""
    if isinstance(value, list | tuple):
        return any(isinstance(each, np.ndarray) and is_masked(each) for each in value)
    is_plain = type(value) is np.ndarray or not isinstance(value, np.ndarray)
    return not is_plain and np.ma.is_masked(value)  # numpy.ma takes long to import


def is_iterable(value: object) -> bool:
    """Whether a value gives others one by one; an array without dimension only looks like it.

    Examples
    --------
    >>> is_iterable(np.zeros(2)), is_iterable(np.array(2.0))
    (True, False)
    """
    try:
        return isinstance(value, Iterable) and iter(value) is not None
    except TypeError:
        return False


def refuse_masked(value: object, name: str) -> None:
    """Refuse an array, or a list of them, of which a part is masked.

    Examples
    --------
    >>> refuse_masked(np.ma.masked_greater([1.0, 65.0], 60.0), "angles")
    Traceback (most recent call last):
    ValueError: angles must hold no masked values: leave them out, or fill them, .filled(np.nan)
    """
    if is_masked(value):
        text = "must hold no masked values: leave them out, or fill them, .filled(np.nan)"
        raise ValueError(f"{name} {text}")


def brief(value: object) -> str:
    """A value as a message shows it, on one line."""
    try:
        text = " ".join(repr(value).split())
    except RecursionError:
        text = f"a {type(value).__name__} in a {type(value).__name__}, and so on"
    return text if len(text) <= 60 else f"{text[:57]}..."
