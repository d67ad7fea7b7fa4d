"""Error codes of Hokuyo's sensors: a value that says why there is no distance.

One table for all who meet those of the URG-04LX: the driver, the emulator, and the readers of logs;
another for the sensors of longer reach, which the driver and the emulator meet.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import arrays
from ..arrays import Array

#: Values below this, in millimetres, are codes.
LOWEST_MM = 20
#: Codes that mean nothing met, or something out of reach; all others are errors. Code 6 is none: in
#: logs of SCIP 1.1 and 2.0, beams with it stay without range while the sensor stands.
OUT_OF_REACH_CODES = (0, 6)
#: The code that an emulated sensor gives, and a recorder fills in, where nothing was met.
NOTHING_MET_CODE = 0
#: The code where neighbouring beams contradict each other.
NEIGHBOURS_BAD_CODE = 7
#: The code where nothing was measured.
NOT_MEASURED_CODE = 19

_RANGES = np.where(np.isin(np.arange(LOWEST_MM), OUT_OF_REACH_CODES), np.inf, np.nan)


def as_ranges(millimetres: ArrayLike) -> tuple[Array, NDArray[np.int64]]:
    """Ranges in metres, and the codes of those that are none.

    Parameters
    ----------
    millimetres : (n,) array
        As the sensor gives them, or as a log has them after some arithmetic.

    Returns
    -------
    ranges : (n,) array, metres
        `inf` where nothing was met, NaN for errors and for what is negative or no number.
    codes : (n,) int array
        0 where there is a range.

    Examples
    --------
    >>> as_ranges([392, 0, 7])
    (array([0.392,   inf,   nan]), array([0, 0, 7]))
    """
    readings = arrays.numbers(millimetres, "millimetres")
    whole = np.rint(readings)
    coded = (readings >= 0) & (whole < LOWEST_MM)
    codes = np.where(coded, whole, 0).astype(np.int64)
    return np.where(coded, _RANGES[codes], np.where(readings > 0, readings / 1000, np.nan)), codes


# ------------------------------------------------------------------------- of longer reach
#: Code of the UTM-30LX (SCIP 2.0, Hokuyo C-42-03320B, table 4) where nothing was met; 3 to 5 are
#: other errors.
UTM_NOTHING_MET_CODE = 1
#: What the successors UST-10LX and UTM-30LX-EW are reported to send where nothing is met; values
#: above are errors.
NOTHING_FAR = 65533


def as_far_ranges(
    millimetres: ArrayLike, *, least: int, most: int
) -> tuple[Array, NDArray[np.int64]]:
    """Ranges in metres, and the codes of those that are none, of a UTM-30LX or its successors.

    Parameters
    ----------
    millimetres : (n,) array
        As the sensor gives them.
    least, most : int, millimetres
        What it measures, by its own word: values below are codes or too near, values above are out
        of reach.

    Returns
    -------
    ranges : (n,) array, metres
        `inf` where nothing was met within reach, NaN for errors.
    codes : (n,) int array
        The value itself where it is no range, else 0.

    Examples
    --------
    >>> as_far_ranges([9392, 1, 3, 65533], least=23, most=30000)
    (array([9.392,   inf,   nan,   inf]), array([    0,     1,     3, 65533]))
    """
    readings = np.rint(arrays.numbers(millimetres, "millimetres")).astype(np.int64)
    is_range = (readings >= least) & (readings <= most)
    nothing = (readings == UTM_NOTHING_MET_CODE) | ((readings > most) & (readings <= NOTHING_FAR))
    ranges = np.where(is_range, readings / 1000, np.where(nothing, np.inf, np.nan))
    return ranges, np.where(is_range, 0, readings)
