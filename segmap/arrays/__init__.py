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
    below,
    checked,
    declared,
    described,
)
from ._scalars import (
    LEAST,
    LIMIT,
    MOST,
    brief,
    called,
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
    FAR,
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
    share,
    table,
    trailing,
    values,
)

__all__ = [
    "FAR", "LEAST", "LIMIT", "MOST", "Array", "Count", "Declared", "Gap", "Metres", "Poses",
    "Positive", "Quantity", "Radians", "RadiansPerMetre", "Seconds", "Segments", "Settings",
    "Share", "at_least", "at_most", "below", "brief", "called", "checked", "declared", "described",
    "file", "frame", "function", "indices", "instance", "is_iterable", "number", "numbers",
    "one_of", "point", "points", "pose", "poses", "ranges", "ready", "rectangle", "refuse_masked",
    "row", "segments", "share", "switch", "table", "trailing", "values", "whole",
]  # fmt: skip
