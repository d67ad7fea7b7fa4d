"""One place that checks arguments: arrays of numbers, and numbers with a unit and a range.

Every public function passes its arguments through these, so that what is wrong ends as a
`ValueError` that names the argument, what was expected and what was given. Kernels check nothing.
"""

from ._declared import (
    Count,
    Declared,
    Gap,
    Metres,
    Positive,
    Quantity,
    Radians,
    RadiansPerMetre,
    Seconds,
    Settings,
    Share,
    at_least,
    at_most,
    checked,
    declared,
    described,
    upper_bound_excluded,
)
from ._scalars import (
    LIMIT,
    MOST_COUNTED,
    SMALLEST_THRESHOLD_M,
    brief,
    call_given,
    file,
    frame,
    function,
    instance,
    is_iterable,
    number,
    one_of,
    refuse_masked,
    switch,
    whole,
)
from ._tables import (
    LARGEST_COORDINATE,
    Array,
    Poses,
    Segments,
    indices,
    numbers,
    point,
    points,
    pose,
    poses,
    ranges,
    ready,
    rectangle,
    row,
    segments,
    share_of_second,
    table,
    values,
    with_axes,
)

__all__ = [
    "LARGEST_COORDINATE", "LIMIT", "MOST_COUNTED", "SMALLEST_THRESHOLD_M", "Array", "Count",
    "Declared", "Gap", "Metres", "Poses", "Positive", "Quantity", "Radians", "RadiansPerMetre",
    "Seconds", "Segments", "Settings", "Share", "at_least", "at_most", "brief", "call_given",
    "checked", "declared", "described", "file", "frame", "function", "indices", "instance",
    "is_iterable", "number", "numbers", "one_of", "point", "points", "pose", "poses", "ranges",
    "ready", "rectangle", "refuse_masked", "row", "segments", "share_of_second", "switch", "table",
    "upper_bound_excluded", "values", "whole", "with_axes",
]  # fmt: skip
