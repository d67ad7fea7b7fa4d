"""What a quadtree map is given: points, and lengths that must be powers of two of cells."""

from typing import SupportsFloat

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array

#: Levels of the root at first, 512 cells a side, and at most, 65 536: B's largest map doubled once.
SIZE, MAX_SIZE = 9, 16


def point(name: str, values: ArrayLike) -> Array:
    """One point as an array `(2,)`."""
    array = np.asarray(values, float)
    if array.shape != (2,):
        raise ValueError(f"{name} must have shape (2,), got {array.shape}")
    return array


def points(name: str, values: ArrayLike | None) -> Array:
    """Points as an array `(n, 2)`; none where nothing is given."""
    array = np.asarray(() if values is None else values, float)
    if array.ndim != 2 or array.shape[1] != 2:
        if array.size:
            raise ValueError(f"{name} must have shape (n, 2), got {array.shape}")
        return np.empty((0, 2))
    return array


def check_finite(**named: Array) -> None:
    """Name the array that holds a value which is not finite, and where."""
    for name, array in named.items():
        wrong = ~np.isfinite(np.atleast_2d(array)).all(1)
        if wrong.any():
            where = f"{name}[{wrong.argmax()}]" if array.ndim == 2 else name
            raise ValueError(
                f"{name} must be finite, in metres, got {where} = "
                f"{np.atleast_2d(array)[wrong][0].tolist()}: leave out beams without return"
            )


def check_whole(name: str, value: SupportsFloat, most: int) -> int:
    """A whole number of at least 1."""
    if not (1 <= float(value) <= most and float(value).is_integer()):
        raise ValueError(
            f"{name} must be a whole number of at least 1, got {value} (the most is {most})"
        )
    return int(float(value))


def levels_of(
    resolution: float, size: float | None, max_size: float | None, most: int
) -> tuple[int, int]:
    """Levels of the root at first and at most; no root has more than `2^most` cells a side.

    Raises
    ------
    ValueError
        For sizes that do not fit together.
    """
    if not (resolution > 0 and np.isfinite(float(resolution) * 2.0**most)):
        raise ValueError(f"resolution must be positive and finite, in metres, got {resolution}")
    level = SIZE if size is None else level_of("size", size, resolution, 2)
    largest = max(level, MAX_SIZE)
    if max_size is not None:
        largest = level_of("max_size", max_size, resolution, 2)
    if not level <= largest <= most:
        raise ValueError(
            f"max_size must not be below the size, {np.ldexp(resolution, level):.6g} m, nor "
            f"have more than 2^{most} cells a side, got {max_size}"
        )
    return level, largest


def level_of(name: str, length: SupportsFloat, resolution: float, least: int = 0) -> int:
    """The level of squares of this side: `length = 2^level resolution`.

    Raises
    ------
    ValueError
        For a length that is no power of two of cells, or below `2^least` of them.
    """
    count = float(length) / resolution
    level = round(np.log2(count)) if 0 < count < 2.0**60 else -1
    if level < least or not np.isclose(count, 2.0**level, rtol=1e-9, atol=0):
        raise ValueError(
            f"{name} must be a power of two of cells of {resolution:.6g} m, at least {1 << least}, "
            f"got {length} m: {count:.6g} cells"
        )
    return level
