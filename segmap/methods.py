"""What the families of methods, alignment and reduction, know of each of their members."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

R = TypeVar("R")


@dataclass(frozen=True)
class Method(Generic[R]):
    """A method and what there is to know before it is called.

    Parameters
    ----------
    function : callable
        `function(map, *, thresholds) -> Reduction`, or `function(log, *, thresholds) -> Alignment`.
    source : str
        Section of the thesis, A or B.
    paper : str
        Authors and year of the publication, where there is one.
    works : str
        Alignment: "alone", on "pairs" of scans, against a "map" that grows, or on "all" scans.
    merges : str
        Reduction: how many segments one step turns into how many, "2 -> 1", "m -> 1" or "m -> n".
    keeps : str
        Reduction: what a map holds of each segment while the method runs.
    varies : str
        Reduction: the threshold that trades quality for fewer segments, which a sweep varies.
    online : bool
        Whether it takes the scans one by one.
    needs_points : bool
        Whether it needs the points behind the segments.
    needs_sensors : bool
        Whether it needs the places of the sensor.
    needs_odometry : bool
        Whether it needs odometry that is right to within its thresholds.
    """

    function: Callable[..., R]
    source: str
    paper: str = ""
    works: str = ""
    merges: str = ""
    keeps: str = ""
    varies: str = ""
    online: bool = False
    needs_points: bool = False
    needs_sensors: bool = False
    needs_odometry: bool = False

    def __call__(self, data: object, **thresholds: Any) -> R:
        """Run it: `METHODS[name](map, ...)` is `reduction.<name>(map, ...)`."""
        return self.function(data, **thresholds)
