"""Exercises of the chapters on quality, reduction and Fusion."""

import numpy as np

from ..arrays import Array
from ..metrics import reduction_rate
from ._exercise import Case, Exercise, Mistake

#: Mean error at which quality falls to 37 %, metres, and the rounding that a border forgives.
SCALE, BORDER = 0.050, 1e-9


def _quality(mean_error: float, scale: float = SCALE) -> float:
    return float(np.exp(-mean_error / scale))


def _part(before: Array, after: Array) -> float:
    return len(after) / len(before) if len(before) else 0.0


_MATRIX = np.array([(0.010, 0.200, 0.350), (0.500, 0.030, 0.400)])

check_reduction_rate = Exercise(
    "reduction_rate",
    "reduction_rate(before, after) -> float: share of the segments (n, 2, 2) that are gone",
    reduction_rate,
    tuple(
        Case(f"{n} segments before and {m} after", (np.zeros((n, 2, 2)), np.zeros((m, 2, 2))))
        for n, m in ((4, 1), (10, 7), (3, 3), (0, 0))
    ),
    (
        Mistake("what is left", _part, "this is the share that is left, wanted is what is gone"),
        Mistake(
            "per cent",
            lambda before, after: 100 * reduction_rate(before, after),
            "a share lies between 0 and 1: no per cent",
        ),
        Mistake(
            "empty map",
            lambda before, after: (len(before) - len(after)) / len(before),
            "a map without segments has lost nothing: its rate is 0, and no division by zero",
        ),
        Mistake(
            "divided by what is left",
            lambda before, after: (len(before) - len(after)) / max(len(after), 1),
            "the share is one of the map before: divide by its number",
        ),
    ),
)

check_quality = Exercise(
    "quality",
    "quality(distances) -> float: exp(-mean error / 0.050 m), from distances (n, m) in metres "
    "between n segments before and m after",
    lambda distances: _quality(distances.min(axis=1).mean()),
    (
        Case("2 segments before, 3 after", (_MATRIX,)),
        Case("3 segments before, 2 after", (_MATRIX.T,)),
        Case("a perfect map", (np.array([(0.0, 1.0), (1.0, 0.0)]),)),
        Case("one segment for three", (np.array([(0.01,), (0.02,), (0.06,)]),)),
    ),
    (
        Mistake(
            "wrong axis",
            lambda distances: _quality(distances.min(axis=0).mean()),
            "every segment of the map *before* looks for its nearest: the minimum runs along a row",
        ),
        Mistake(
            "mean of all",
            lambda distances: _quality(distances.mean()),
            "only the nearest segment after counts, not the mean distance from all",
        ),
        Mistake(
            "largest",
            lambda distances: _quality(distances.min(axis=1).max()),
            "the mean of the errors counts, not the largest",
        ),
        Mistake(
            "sum",
            lambda distances: _quality(distances.min(axis=1).sum()),
            "the mean of the errors counts, not their sum: else large maps are always bad",
        ),
        Mistake(
            "per cent",
            lambda distances: 100 * _quality(distances.min(axis=1).mean()),
            "quality lies between 0 and 1: no per cent",
        ),
        Mistake(
            "millimetres",
            lambda distances: _quality(distances.min(axis=1).mean(), 50.0),
            "distances are metres: the scale is 0.050 m, not 50",
        ),
    ),
)


def _inside(offsets: Array, shift: float, tolerance: float) -> Array:
    """Which segments lie in the strip: both ends within tolerance of the shifted line."""
    return np.abs(offsets - shift).max(axis=1) <= tolerance + BORDER


def _best(offsets: Array, worth: Array, tolerance: float, shifts: Array) -> float:
    """Of these shifts the one whose strip holds most; of equals the smallest."""
    totals = np.array([worth[_inside(offsets, t, tolerance)].sum() for t in shifts])
    equal = shifts[totals >= totals.max() - BORDER]
    return float(equal[np.argmin(np.abs(equal))])


def _entering(offsets: Array, tolerance: float) -> Array:
    return np.append(0.0, offsets.max(axis=1) - tolerance)


def _shifts(offsets: Array, tolerance: float) -> Array:
    """0, and where a segment enters or leaves the strip."""
    return np.append(_entering(offsets, tolerance), offsets.min(axis=1) + tolerance)


def _within(shifts: Array, tolerance: float) -> Array:
    return shifts[np.abs(shifts) <= tolerance + BORDER]


def best_shift(offsets: Array, lengths: Array, tolerance: float) -> float:
    """Shift of the line whose strip holds the greatest total length (A 4.4), without its chains.

    Parameters
    ----------
    offsets : (n, 2) array, metres
        Of both ends of each segment from the line; those of the longest are 0.
    lengths : (n,) array, metres
    tolerance : float, metres
        Half width of the strip; the line moves by no more, so that it keeps the longest.

    Returns
    -------
    float, metres

    Examples
    --------
    >>> round(best_shift(np.array([(0, 0), (0.05, 0.06)]), np.array([3, 2]), 0.04), 9)
    0.02
    """
    return _best(offsets, lengths, tolerance, _within(_shifts(offsets, tolerance), tolerance))


_STRIP = np.array([(0.0, 0.0), (0.03, 0.05), (0.05, 0.03), (-0.05, -0.02), (-0.06, 0.06)])

check_inside_strip = Exercise(
    "inside_strip",
    "inside_strip(offsets, shift, tolerance) -> (n,) bool: which segments, with offsets (n, 2) of "
    "both ends from a line in metres, lie within tolerance of the line moved by shift",
    _inside,
    (
        Case("a line that is not moved", (_STRIP, 0.0, 0.04)),
        Case("a line moved by 0.02 m", (_STRIP, 0.02, 0.04)),
        Case("a line moved by -0.02 m", (_STRIP, -0.02, 0.04)),
        Case(
            "ends that lie right on the border",
            (np.array([(0.0, 0.0625), (-0.0625, 0.0)]), 0.0, 0.0625),
        ),
    ),
    (
        Mistake(
            "one end",
            lambda offsets, t, e: np.abs(offsets - t).min(axis=1) <= e + BORDER,
            "both ends must lie inside, not one of them",
        ),
        Mistake(
            "middle",
            lambda offsets, t, e: np.abs(offsets.mean(axis=1) - t) <= e + BORDER,
            "both ends must lie inside: the middle of a slanted segment says nothing about them",
        ),
        Mistake(
            "moved away",
            lambda offsets, t, e: _inside(offsets, -t, e),
            "the line moves by +shift, so the offsets from it become smaller by shift",
        ),
        Mistake(
            "without sign",
            lambda offsets, t, e: (offsets - t).max(axis=1) <= e + BORDER,
            "a strip has two borders: segments below the line can lie outside too",
        ),
        Mistake(
            "border left out",
            lambda offsets, t, e: np.abs(offsets - t).max(axis=1) < e - BORDER,
            "the border belongs to the strip: <=, not <",
        ),
        Mistake(
            "not moved",
            lambda offsets, t, e: _inside(offsets, 0.0, e),
            "the line has moved: measure from where it is now",
        ),
    ),
)


def _strip_case(words: str, offsets: list[tuple[int, int]], lengths: list[float]) -> Case:
    """A segment of 3 m on the line and others, offsets in 64ths of a metre: free of rounding."""
    rows = np.array([(0, 0), *offsets]) / 64
    return Case(words, (rows, np.array([3, *lengths], float), 4 / 64))


check_best_shift = Exercise(
    "best_shift",
    "best_shift(offsets, lengths, tolerance) -> metres: the shift whose strip holds the greatest "
    "total of lengths (n,), among 0 and those where a segment enters or leaves",
    best_shift,
    (
        _strip_case("a long segment above and a short one below", [(5, 6), (-5, -4)], [2, 1]),
        _strip_case(
            "a long segment above and three short ones below",
            [(5, 5), (-5, -5), (-5, -5), (-5, -5)],
            [2.5, 0.5, 0.5, 0.5],
        ),
        _strip_case("a segment below", [(-6, -5)], [2]),
        _strip_case("a longer wall far away", [(20, 20), (20, 21)], [2.9, 2]),
        _strip_case("nothing to gain", [(1, 2)], [1]),
    ),
    (
        Mistake(
            "number instead of length",
            lambda offsets, lengths, e: best_shift(offsets, np.ones(len(lengths)), e),
            "length decides, not number: noise makes many short segments",
        ),
        Mistake(
            "never moved",
            lambda offsets, lengths, e: 0.0,
            "the line may move: try the shifts at which a segment enters or leaves",
        ),
        Mistake(
            "entering only",
            lambda offsets, lengths, e: _best(
                offsets, lengths, e, _within(_entering(offsets, e), e)
            ),
            "a segment below enters as the line moves down: try the lower ends plus tolerance too",
        ),
        Mistake(
            "moved away",
            lambda offsets, lengths, e: -best_shift(offsets, lengths, e),
            "this moves the line away from what it wants to include, as row 72 of the thesis does",
        ),
        Mistake(
            "longest lost",
            lambda offsets, lengths, e: _best(offsets, lengths, e, _shifts(offsets, e)),
            "the strip must keep the longest segment: shift by no more than the tolerance",
        ),
    ),
)
