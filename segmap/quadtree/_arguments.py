"""What a quadtree map is given: points, and lengths that must be powers of two of cells."""

from typing import SupportsFloat

import numpy as np
from numpy.typing import ArrayLike

from ..angles import Array


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
