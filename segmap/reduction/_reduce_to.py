"""The smallest map of a method that keeps a quality: its threshold is found by bisection."""

from __future__ import annotations

import inspect
import warnings
from dataclasses import replace
from typing import Annotated

from .. import arrays, metrics
from ..arrays import Positive, Segments, checked, upper_bound_excluded
from ..methods import bracket, halved
from ._methods import METHODS
from ._runner import Reduction

#: A threshold is doubled at most so often, as far as metres of a room go.
DOUBLINGS = 5
#: A threshold is halved at most so often: from 5 cm to 0.1 mm.
HALVINGS = 9
#: Then the bracket is cut in half so often: 0.3 % of the threshold are left open.
CUTS = 8


@checked
def reduce_to(
    map: Segments,
    *,
    quality: Annotated[Positive, upper_bound_excluded(1)] = 0.85,
    method: str = "least_cost",
) -> Reduction:
    """The smallest map of a method that keeps a quality, among those that a bisection meets.

    `METHODS[method].varies` names the threshold. It is doubled or halved, from its default, until
    one value keeps the quality and the next does not, and then the bracket is halved. Quality need
    not fall with the threshold: another value beyond the bracket may leave less.

    Parameters
    ----------
    quality
        The least `metrics.quality(map, result)`.
    method
        Its name in `METHODS`.

    Returns
    -------
    Reduction
        Where no value that was tried keeps the quality, the best of them, and `doubt` says so.

    Examples
    --------
    >>> wall = [[(0, 0), (2, 0)], [(1, 0.01), (3, 0.01)], [(0, 1), (2, 1)]]
    >>> reduce_to(wall, quality=0.9)
    Reduction(least_cost: 3 -> 2 segments)
    >>> reduce_to(wall, quality=0.9, method="fusion")
    Reduction(fusion: 3 -> 2 segments)
    """
    arrays.one_of(method, "method", METHODS)
    varies = METHODS[method].varies
    tried: list[tuple[float, Reduction]] = []

    def keeps(value: float) -> bool:
        """Whether a value of the threshold keeps the quality."""
        with warnings.catch_warnings():  # those of a value that is only tried tell nobody anything
            warnings.simplefilter("ignore")
            reduction = METHODS[method](map, **{varies: value})
        tried.append((metrics.quality(map, reduction), reduction))
        return tried[-1][0] >= quality

    usual = inspect.signature(METHODS[method].function).parameters[varies].default
    ends = bracket(keeps, float(usual), DOUBLINGS, HALVINGS)
    for _ in range(CUTS if ends else 0):
        ends = halved(keeps, ends)
    enough = [reduction for reached, reduction in tried if reached >= quality]
    if enough:
        return min(enough, key=len)
    best, reduction = max(tried, key=lambda each: each[0])
    words = f"no {varies} that was tried keeps a quality of {quality:g}: {best:.3g} is the best"
    return replace(reduction, doubt="; ".join(filter(None, (reduction.doubt, words))))
