"""The building of the story: a clinic, a robot with cheap wheels, and a person with a wardrobe."""

from __future__ import annotations

from segmap.arrays import Array
from segmap.readers import data_file, read_segments


def clinic_walls() -> Array:
    """The true walls of the building in which the bundled log `clinic` was driven, `(n, 2, 2)`, m.

    Examples
    --------
    >>> clinic_walls().max(axis=(0, 1))
    array([9. , 8.8])
    """
    return read_segments(data_file("clinic/walls.csv")).segments
