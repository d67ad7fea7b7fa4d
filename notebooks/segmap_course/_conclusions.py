"""What A concludes of its runs (A 6.3 to 6.7), asked of any runs of its grid.

Each claim is a number for each building and what that number has to be. Claims about thresholds are
asked of unfiltered runs of A's own grid; those at equal quality of all runs of A's methods.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from segmap.experiments import equal_quality, select

from ._thesis import THESIS_GRIDS, thesis_grid

if TYPE_CHECKING:
    import pandas as pd

#: Qualities at which methods are compared.
QUALITIES = (0.90, 0.85, 0.80)
#: A's methods that see the whole map at once.
OFF_LINE = ("basic_offline", "mean_shift", "fusion")


class Answer(NamedTuple):
    """A number, in words, and whether the claim holds by it."""

    words: str
    holds: bool


class Runs(NamedTuple):
    """The runs on one building: those of A's methods, and of these the ones of A's grid.

    The grid runs from its tightest thresholds to its loosest.
    """

    all: pd.DataFrame
    grid: pd.DataFrame

    def of(self, method: str, filtered: bool = False) -> pd.DataFrame:
        """A's runs of one method, with or without the filter."""
        return select(self.grid, method=method, filtered=filtered)

    def quality(self, method: str, **thresholds: Any) -> float:
        """Quality of one unfiltered run."""
        return float(select(self.of(method), **thresholds)["quality"].iloc[0])


def conclusions(frame: pd.DataFrame) -> pd.DataFrame:
    """A's conclusions on the buildings of some runs, each answered by a number.

    Parameters
    ----------
    frame : DataFrame
        Of `experiments.sweep`: buildings on which all of A's grid was run, with the filter and
        without.

    Returns
    -------
    DataFrame
        A row for each claim, named by its letter: claim; verdict: on how many buildings it holds;
        and a column for each building, the number and "yes" where the claim holds, else "no".

    Examples
    --------
    >>> from segmap_course import thesis_results
    >>> found = conclusions(thesis_results())
    >>> found.loc[["i", "l"], ["verdict", "stanford"]]
               verdict                stanford
    i  holds on 3 of 4  0.3 times the next: no
    l  holds on 3 of 4      last in 0 of 6: no
    """
    import pandas as pd

    maps = {name: _runs(select(frame, map=name)) for name in dict.fromkeys(frame["map"])}
    found = [(k, said, [ask(runs) for runs in maps.values()]) for k, said, ask in CLAIMS]
    found += [(k, said, _by_density(maps, ask, least)) for k, said, ask, least in DENSE_CLAIMS]
    found.sort(key=lambda row: row[0])
    rows = [(said, _verdict(answers), *map(_words, answers)) for _, said, answers in found]
    return pd.DataFrame(rows, [k for k, *_ in found], ["claim", "verdict", *maps])


def density(frame: pd.DataFrame) -> float:
    """Segments of a building for each that Fusion leaves at 20 mm: A calls it noise (A 6.2)."""
    run = select(frame, method="fusion", tolerance=0.02, filtered=False)
    return float(1 / (1 - run["reduction"].iloc[0]))


def filter_change(frame: pd.DataFrame, method: str) -> tuple[float, float]:
    """What the filter adds to the mean quality and reduction of a method on one building."""
    runs = thesis_grid(select(frame, method=method))
    without, filtered = (select(runs, filtered=least) for least in (False, True))
    change = filtered[["quality", "reduction"]].mean() - without[["quality", "reduction"]].mean()
    return float(change["quality"]), float(change["reduction"])


def _runs(frame: pd.DataFrame) -> Runs:
    five = frame[frame["method"].isin(list(THESIS_GRIDS))]
    order = [name for name in ("angle", "distance", "sigma", "tolerance") if name in five]
    return Runs(five, thesis_grid(five).sort_values(order, kind="stable"))


def _words(answer: Answer) -> str:
    return f"{answer.words}: {'yes' if answer.holds else 'no'}"


def _verdict(answers: list[Answer]) -> str:
    holds, of = sum(answer.holds for answer in answers), len(answers)
    return {0: "does not hold", of: "holds"}.get(holds, f"holds on {holds} of {of}")


def _by_density(
    maps: dict[str, Runs], quality: Callable[[Runs], float], least: float
) -> list[Answer]:
    """The sparser half has at least that quality, and the others less than all of that half."""
    copies = {name: density(runs.grid) for name, runs in maps.items()}
    found = {name: quality(runs) for name, runs in maps.items()}
    sparse = sorted(maps, key=copies.__getitem__)[: (len(maps) + 1) // 2]
    worst = min(found[name] for name in sparse)
    return [
        Answer(
            f"{value:.0%} at {copies[name]:.1f} copies",
            value >= least if name in sparse else value < worst,
        )
        for name, value in found.items()
    ]


def _alike(runs: Runs) -> Answer:
    rates = ["reduction", "quality"]
    off, on = (runs.of(name)[rates].to_numpy() for name in ("basic_offline", "basic_online"))
    gap = np.abs(on - off).mean(axis=0).max()
    return Answer(f"{100 * gap:.1f} points apart", bool(gap <= 0.03))


def _online_cost(runs: Runs) -> Answer:
    off, on = (runs.of(name)["seconds"].to_numpy() for name in ("basic_offline", "basic_online"))
    ratio = float(np.median(on / off))
    return Answer(_times(ratio), ratio >= 3)


def _filter_matters(runs: Runs) -> Answer:
    change = {name: filter_change(runs.grid, name) for name in THESIS_GRIDS}
    better, less = change.pop("hybrid")
    rest = np.abs(list(change.values())).max(axis=0)
    words = f"{100 * better:+.0f} and {100 * less:+.0f} points"
    return Answer(words, bool(better > rest[0] and -less > rest[1]))


def _fusion_first(runs: Runs) -> Answer:
    places = [ranking[0] == "fusion" for ranking in _rankings(runs)]
    return Answer(f"first in {sum(places)} of {len(places)}", sum(places) > len(places) / 2)


def _fusion_fast(runs: Runs) -> Answer:
    times = _off_line_times(runs)
    ratio = times.pop("fusion") / min(times.values())
    return Answer(f"{_times(ratio)} the next", ratio <= 3)


def _small_tolerance(runs: Runs) -> Answer:
    good, bad = (runs.quality("fusion", tolerance=t) for t in (0.04, 0.10))
    return Answer(f"{good:.0%} to {bad:.0%}", good - bad >= 0.10 and bad < 0.80)


def _collapses(runs: Runs) -> Answer:
    good, bad = (runs.quality("mean_shift", sigma=s) for s in (0.10, 0.40))
    return Answer(f"{good:.0%} to {bad:.0%}", good - bad >= 0.20)


def _mean_shift_slow(runs: Runs) -> Answer:
    times = _off_line_times(runs)
    ratio = times.pop("mean_shift") / max(times.values())
    return Answer(f"{_times(ratio)} the next", ratio > 1)


def _loose_fast(runs: Runs) -> Answer:
    times = [runs.of(name)["seconds"] for name in THESIS_GRIDS]
    faster = sum(bool(part.iloc[-1] < part.iloc[0]) for part in times)
    return Answer(f"{faster} of {len(times)} methods", faster == len(times))


def _unfiltered_slow(runs: Runs) -> Answer:
    without, filtered = (
        np.concatenate([runs.of(name, least)["seconds"] for name in THESIS_GRIDS])
        for least in (False, True)
    )
    share = float(np.mean(without > filtered))
    return Answer(f"{share:.0%} of runs", share >= 0.90)


def _mean_shift_last(runs: Runs) -> Answer:
    """Of those that reach a quality; not to reach what another one reaches is to be last too."""
    places = ["mean_shift" not in ranking[:-1] for ranking in _rankings(runs)]
    return Answer(f"last in {sum(places)} of {len(places)}", all(places))


#: Letter, claim, and how it is answered on one building.
CLAIMS: list[tuple[str, str, Callable[[Runs], Answer]]] = [
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
DENSE_CLAIMS: list[tuple[str, str, Callable[[Runs], float], float]] = [
    (
        "a",
        "loose Basic is good on sparse maps, less so on dense ones",
        lambda runs: runs.quality("basic_offline", distance=0.40, angle=np.pi / 9),
        0.70,
    ),
    (
        "g",
        "mean shift is good on sparse maps only",
        lambda runs: runs.quality("mean_shift", sigma=0.10),
        0.80,
    ),
]


def _off_line_times(runs: Runs) -> dict[str, float]:
    """Median seconds of the off-line methods, unfiltered, on A's grid."""
    return {name: float(runs.of(name)["seconds"].median()) for name in OFF_LINE}


def _times(ratio: float) -> str:
    return f"{ratio:.0f} times" if ratio >= 10 else f"{ratio:.1f} times"


def _rankings(runs: Runs) -> list[list[str]]:
    """A's methods that reach a quality, best first; at each that any reaches, each filter."""
    found = [equal_quality(runs.all, quality)[list(THESIS_GRIDS)] for quality in QUALITIES]
    orders = [
        list(row.dropna().sort_values(ascending=False, kind="stable").index)
        for table in found
        for _, row in table.iterrows()
    ]
    return [order for order in orders if order]
