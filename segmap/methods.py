"""What the families of methods, alignment and reduction, know of each of their members."""

from collections.abc import Callable
from dataclasses import dataclass
from difflib import get_close_matches
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


class Family(dict[str, Method[R]]):
    """Methods by name: a name that none has is refused with the one that is near."""

    def __missing__(self, name: str) -> Method[R]:
        near = get_close_matches(str(name), self, 1) or [", ".join(self)]
        raise KeyError(f"no method is called {name!r}: {near[0]}?")


def bracket(
    keeps: Callable[[float], bool], value: float, doublings: int, halvings: int
) -> tuple[float, ...]:
    """Find `(low, high)`, `high = 2 low`: `keeps` holds at low and not at high; or ().

    Examples
    --------
    >>> bracket(lambda value: value < 0.3, 0.04, 5, 5), bracket(lambda value: value < 0.3, 1, 5, 5)
    ((0.16, 0.32), (0.25, 0.5))
    >>> bracket(lambda value: False, 1.0, 5, 5)
    ()
    """
    grows = keeps(value)
    for _ in range(doublings if grows else halvings):
        before, value = value, value * (2.0 if grows else 0.5)
        if keeps(value) != grows:
            return min(before, value), max(before, value)
    return ()


def halve(keeps: Callable[[float], bool], ends: tuple[float, ...]) -> tuple[float, ...]:
    """Bisect a bracket at its geometric mean, and keep the half with the change."""
    middle = (ends[0] * ends[1]) ** 0.5
    return (middle, ends[1]) if keeps(middle) else (ends[0], middle)
