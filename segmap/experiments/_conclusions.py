"""What A concludes of its runs (A 6.3 to 6.7), asked of any runs of its grid.

Each claim is a number for each building and what that number has to be. Claims about thresholds are
asked of unfiltered runs of A's own grid; those at equal quality of all runs that there are.
"""

from collections.abc import Callable, Iterable, Iterator
from typing import NamedTuple

import numpy as np

from .._display import Table
from ..arrays import Array
from ._bundled import THESIS_GRIDS, thesis_grid
from ._compare import equal_quality
from ._records import Record, Records

#: Qualities at which methods are compared.
QUALITIES = (0.90, 0.85, 0.80)


class Answer(NamedTuple):
    """A number, in words, and whether the claim holds by it."""

    words: str
    holds: bool


class Conclusion(NamedTuple):
    """A claim of A, and its answer on each building.

    Parameters
    ----------
    letter, claim : str
    answers : dict
        Name of a building -> what was measured there.
    """

    letter: str
    claim: str
    answers: dict[str, Answer]

    @property
    def verdict(self) -> str:
        """Whether the claim holds, over all buildings."""
        holds, of = sum(answer.holds for answer in self.answers.values()), len(self.answers)
        return {0: "does not hold", of: "holds"}.get(holds, f"holds on {holds} of {of}")


def conclusions(records: Iterable[Record]) -> list[Conclusion]:
    """A's conclusions on the buildings of some records, each answered by a number.

    Parameters
    ----------
    records : iterable of Record
        Of buildings on which all of A's grid was run, with and without the filter.

    Examples
    --------
    >>> from segmap.experiments import thesis_results
    >>> found = conclusions(thesis_results())
    >>> [(c.letter, c.verdict) for c in found if c.letter in "hil"]
    [('h', 'holds'), ('i', 'holds on 3 of 4'), ('l', 'holds on 3 of 4')]
    """
    whole = Records(records)
    buildings = {name: whole.select(map=name) for name in dict.fromkeys(r.map for r in whole)}
    found = [Conclusion(k, said, _each(buildings, ask)) for k, said, ask in CLAIMS]
    for k, said, ask, least in DENSE_CLAIMS:
        found.append(Conclusion(k, said, _by_density(buildings, ask, least)))
    return sorted(found, key=lambda conclusion: conclusion.letter)


def conclusion_table(found: Iterable[Conclusion]) -> Table:
    """A row for each claim: its verdict, and number and answer on each building."""
    rows = list(found)
    head = ["", "claim", "verdict", *rows[0].answers]
    return Table(
        head,
        (
            [c.letter, c.claim, c.verdict]
            + [f"{a.words}: {'yes' if a.holds else 'no'}" for a in c.answers.values()]
            for c in rows
        ),
    )


def density(records: Records) -> float:
    """Segments for each that Fusion leaves at 20 mm: what A calls the noise of a map (A 6.2)."""
    return 1 / (1 - _one(records, "fusion", tolerance=0.02).reduction)


def filter_change(records: Records, method: str) -> tuple[float, float]:
    """What the filter adds to the mean quality and reduction of a method on one building."""
    without, filtered = (_runs(records, method, least) for least in (False, True))
    quality, reduction = (
        float((_column(filtered, name) - _column(without, name)).mean())
        for name in ("quality", "reduction")
    )
    return quality, reduction


def _each(buildings: dict[str, Records], ask: Callable[[Records], Answer]) -> dict[str, Answer]:
    return {name: ask(records) for name, records in buildings.items()}


def _by_density(
    buildings: dict[str, Records], quality: Callable[[Records], float], least: float
) -> dict[str, Answer]:
    """The sparser half has at least that quality, and the others less than all of that half."""
    order = sorted(buildings, key=lambda name: density(buildings[name]))
    found = {name: quality(buildings[name]) for name in buildings}
    sparse = order[: (len(order) + 1) // 2]
    worst = min(found[name] for name in sparse)
    return {
        name: Answer(
            f"{value:.0%} at {density(buildings[name]):.1f} copies",
            value >= least if name in sparse else value < worst,
        )
        for name, value in found.items()
    }


def _alike(records: Records) -> Answer:
    off, on = (_runs(records, name) for name in ("basic_offline", "basic_online"))
    gap = max(np.abs(_column(on, x) - _column(off, x)).mean() for x in ("reduction", "quality"))
    return Answer(f"{100 * gap:.1f} points apart", gap <= 0.03)


def _online_cost(records: Records) -> Answer:
    off, on = (_runs(records, name) for name in ("basic_offline", "basic_online"))
    ratio = float(np.median(_column(on, "seconds") / _column(off, "seconds")))
    return Answer(_times(ratio), ratio >= 3)


def _filter_matters(records: Records) -> Answer:
    change = {name: filter_change(records, name) for name in THESIS_GRIDS}
    better, less = change.pop("hybrid")
    rest = np.abs(list(change.values())).max(axis=0)
    words = f"{100 * better:+.0f} and {100 * less:+.0f} points"
    return Answer(words, bool(better > rest[0] and -less > rest[1]))


def _fusion_first(records: Records) -> Answer:
    places = [ranking[0] == "fusion" for ranking in _rankings(records)]
    return Answer(f"first in {sum(places)} of {len(places)}", sum(places) > len(places) / 2)


def _fusion_fast(records: Records) -> Answer:
    times = _offline_times(records)
    ratio = times.pop("fusion") / min(times.values())
    return Answer(f"{_times(ratio)} the next", ratio <= 3)


def _small_tolerance(records: Records) -> Answer:
    good, bad = (_one(records, "fusion", tolerance=t).quality for t in (0.04, 0.10))
    return Answer(f"{good:.0%} to {bad:.0%}", good - bad >= 0.10 and bad < 0.80)


def _collapses(records: Records) -> Answer:
    good, bad = (_one(records, "mean_shift", sigma=s).quality for s in (0.10, 0.40))
    return Answer(f"{good:.0%} to {bad:.0%}", good - bad >= 0.20)


def _mean_shift_slow(records: Records) -> Answer:
    times = _offline_times(records)
    ratio = times.pop("mean_shift") / max(times.values())
    return Answer(f"{_times(ratio)} the next", ratio > 1)


def _loose_fast(records: Records) -> Answer:
    runs = {name: _runs(records, name) for name in THESIS_GRIDS}
    faster = [part[-1].seconds < part[0].seconds for part in runs.values()]
    return Answer(f"{sum(faster)} of {len(faster)} methods", all(faster))


def _unfiltered_slow(records: Records) -> Answer:
    pairs = [
        (a.seconds, b.seconds)
        for name in THESIS_GRIDS
        for a, b in zip(_runs(records, name), _runs(records, name, True), strict=True)
    ]
    share = float(np.mean([a > b for a, b in pairs]))
    return Answer(f"{share:.0%} of runs", share >= 0.90)


def _mean_shift_last(records: Records) -> Answer:
    """Of those that reach a quality; not to reach what another one reaches is to be last too."""
    places = ["mean_shift" not in ranking[:-1] for ranking in _rankings(records)]
    return Answer(f"last in {sum(places)} of {len(places)}", all(places))


#: Letter, claim, and how it is answered on one building.
CLAIMS: list[tuple[str, str, Callable[[Records], Answer]]] = [
    ("b", "Basic on-line and off-line give nearly the same maps", _alike),
    ("c", "Basic on-line costs far more than off-line", _online_cost),
    ("d", "the filter changes Hybrid most: better quality, less reduction", _filter_matters),
    ("e", "Fusion reduces most at equal quality", _fusion_first),
    ("e", "Fusion is fast among the off-line methods", _fusion_fast),
    ("f", "Fusion loses quality quickly from 40 to 100 mm", _small_tolerance),
    ("h", "mean shift's quality collapses as sigma grows", _collapses),
    ("i", "mean shift is the slowest off-line method", _mean_shift_slow),
    ("j", "looser thresholds take less time", _loose_fast),
    ("k", "unfiltered maps take longer", _unfiltered_slow),
    ("l", "at equal quality mean shift is last", _mean_shift_last),
]
#: Letter, claim, quality on one building, and least quality on a sparse map.
DENSE_CLAIMS: list[tuple[str, str, Callable[[Records], float], float]] = [
    (
        "a",
        "loose Basic is good on sparse maps, less so on dense ones",
        lambda records: _one(records, "basic_offline", distance=0.40, angle=np.pi / 9).quality,
        0.70,
    ),
    (
        "g",
        "mean shift is good on sparse maps only",
        lambda records: _one(records, "mean_shift", sigma=0.10).quality,
        0.80,
    ),
]


def _runs(records: Records, method: str, filtered: bool = False) -> Records:
    """Runs of A's grid, from its tightest thresholds to its loosest."""
    chosen = thesis_grid(records.select(method=method, filtered=filtered))
    return Records(sorted(chosen, key=lambda r: sorted(r.thresholds.items())))


def _one(records: Records, method: str, **thresholds: float) -> Record:
    chosen = records.select(method=method, filtered=False)
    return next(r for r in chosen if all(_near(r, k, v) for k, v in thresholds.items()))


def _near(record: Record, name: str, value: float) -> bool:
    return abs((record.thresholds[name] or 0) - value) < 1e-9


def _column(records: Records, name: str) -> Array:
    return np.array([getattr(record, name) for record in records], float)


def _offline_times(records: Records) -> dict[str, float]:
    """Median seconds of the off-line methods, unfiltered, on A's grid."""
    names = ("basic_offline", "mean_shift", "fusion")
    return {name: float(np.median(_column(_runs(records, name), "seconds"))) for name in names}


def _times(ratio: float) -> str:
    return f"{ratio:.0f} times" if ratio >= 10 else f"{ratio:.1f} times"


def _rankings(records: Records) -> Iterator[list[str]]:
    """A's five methods that reach a quality, best first; at each that any reaches, each filter."""
    five = [record for record in records if record.method in THESIS_GRIDS]
    for quality in QUALITIES:
        found = equal_quality(five, quality)
        for name, least in dict.fromkeys((s.map, s.filtered) for s in found):
            if ranking := found.ranking(name, filtered=least):
                yield ranking
