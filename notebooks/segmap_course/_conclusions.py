"""What A concludes of its runs (A 6.3 to 6.7), asked of any runs of its grid.

Each claim is a number for each building and what that number has to be. Claims about thresholds are
asked of unfiltered runs of A's own grid; those at equal quality of all runs of A's methods.
"""

from __future__ import annotations

from collections.abc import Iterator
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

    The runs are of `experiments.sweep`: buildings on which all of A's grid was run, with the filter
    and without. A row of the table is a claim, named by its letter: claim; verdict: on how many
    buildings it holds; and a column for each building, the number and "yes" where the claim holds.

    Examples
    --------
    >>> from segmap_course import thesis_results
    >>> table = conclusions(thesis_results())
    >>> table.loc[["i", "l"], ["verdict", "stanford"]]
               verdict                stanford
    i  holds on 3 of 4  0.3 times the next: no
    l  holds on 3 of 4      last in 0 of 6: no
    """
    import pandas as pd

    maps = {name: _runs(select(frame, map=name)) for name in dict.fromkeys(frame["map"])}
    each = [list(_answers(runs)) for runs in maps.values()]
    claims = [(row[0][0], row[0][1], [a for _, _, a in row]) for row in zip(*each, strict=True)]
    claims = sorted([*claims, *_by_density(maps)], key=lambda row: row[0])
    rows = []
    for _, claim, answers in claims:
        holds, of = sum(answer.holds for answer in answers), len(answers)
        verdict = {0: "does not hold", of: "holds"}.get(holds, f"holds on {holds} of {of}")
        words = [f"{answer.words}: {'yes' if answer.holds else 'no'}" for answer in answers]
        rows.append((claim, verdict, *words))
    return pd.DataFrame(rows, [letter for letter, *_ in claims], ["claim", "verdict", *maps])


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


def _answers(runs: Runs) -> Iterator[tuple[str, str, Answer]]:
    """Letter and claim, and how it is answered on one building."""
    rates = ["reduction", "quality"]
    off, on = runs.of("basic_offline"), runs.of("basic_online")
    gap = np.abs(on[rates].to_numpy() - off[rates].to_numpy()).mean(axis=0).max()
    claim = "Basic on-line and off-line give nearly the same maps"
    yield "b", claim, Answer(f"{100 * gap:.1f} points apart", bool(gap <= 0.03))

    ratio = float(np.median(on["seconds"].to_numpy() / off["seconds"].to_numpy()))
    yield "c", "Basic on-line costs far more than off-line", Answer(_times(ratio), ratio >= 3)

    change = {name: filter_change(runs.grid, name) for name in THESIS_GRIDS}
    better, less = change.pop("hybrid")
    rest = np.abs(list(change.values())).max(axis=0)
    words = f"{100 * better:+.0f} and {100 * less:+.0f} points"
    claim = "the filter changes Hybrid most: better quality, less reduction"
    yield "d", claim, Answer(words, bool(better > rest[0] and -less > rest[1]))

    rankings = _rankings(runs)
    first = sum(ranking[0] == "fusion" for ranking in rankings)
    words = f"first in {first} of {len(rankings)}"
    yield "e", "Fusion reduces most at equal quality", Answer(words, first > len(rankings) / 2)

    seconds = {name: float(runs.of(name)["seconds"].median()) for name in OFF_LINE}
    ratio = seconds["fusion"] / min(seconds["basic_offline"], seconds["mean_shift"])
    claim = "Fusion is fast among the off-line methods"
    yield "e", claim, Answer(f"{_times(ratio)} the next", ratio <= 3)

    good, bad = (runs.quality("fusion", tolerance=t) for t in (0.04, 0.10))
    claim = "Fusion loses quality quickly from 40 to 100 mm"
    yield "f", claim, Answer(f"{good:.0%} to {bad:.0%}", good - bad >= 0.10 and bad < 0.80)

    good, bad = (runs.quality("mean_shift", sigma=s) for s in (0.10, 0.40))
    claim = "mean shift's quality collapses as sigma grows"
    yield "h", claim, Answer(f"{good:.0%} to {bad:.0%}", good - bad >= 0.20)

    ratio = seconds["mean_shift"] / max(seconds["basic_offline"], seconds["fusion"])
    claim = "mean shift is the slowest off-line method"
    yield "i", claim, Answer(f"{_times(ratio)} the next", ratio > 1)

    times = [runs.of(name)["seconds"] for name in THESIS_GRIDS]
    faster = sum(bool(part.iloc[-1] < part.iloc[0]) for part in times)
    words = f"{faster} of {len(times)} methods"
    yield "j", "looser thresholds take less time", Answer(words, faster == len(times))

    without, filtered = (
        np.concatenate([runs.of(name, least)["seconds"] for name in THESIS_GRIDS])
        for least in (False, True)
    )
    share = float(np.mean(without > filtered))
    yield "k", "unfiltered maps take longer", Answer(f"{share:.0%} of runs", share >= 0.90)

    # of those that reach a quality; not to reach what another one reaches is to be last too
    last = sum("mean_shift" not in ranking[:-1] for ranking in rankings)
    words = f"last in {last} of {len(rankings)}"
    yield "l", "at equal quality mean shift is last", Answer(words, last == len(rankings))


def _by_density(maps: dict[str, Runs]) -> Iterator[tuple[str, str, list[Answer]]]:
    """Claims about sparse maps and dense ones: letter and claim, and an answer for each building.

    The sparser half has at least a quality, and the others less than all of that half.
    """
    copies = {name: density(runs.grid) for name, runs in maps.items()}
    sparse = sorted(maps, key=copies.__getitem__)[: (len(maps) + 1) // 2]
    loose = {"distance": 0.40, "angle": np.pi / 9}
    claim = "loose Basic is good on sparse maps, less so on dense ones"
    asked: list[tuple[str, str, str, dict[str, float], float]] = [
        ("a", claim, "basic_offline", loose, 0.70),
        ("g", "mean shift is good on sparse maps only", "mean_shift", {"sigma": 0.10}, 0.80),
    ]
    for letter, claim, method, thresholds, least in asked:
        qualities = {name: runs.quality(method, **thresholds) for name, runs in maps.items()}
        worst = min(qualities[name] for name in sparse)
        answers = []
        for name, value in qualities.items():
            holds = value >= least if name in sparse else value < worst
            answers.append(Answer(f"{value:.0%} at {copies[name]:.1f} copies", holds))
        yield letter, claim, answers


def _times(ratio: float) -> str:
    return f"{ratio:.0f} times" if ratio >= 10 else f"{ratio:.1f} times"


def _rankings(runs: Runs) -> list[list[str]]:
    """A's methods that reach a quality, best first; at each that any reaches, each filter."""
    tables = [equal_quality(runs.all, quality)[list(THESIS_GRIDS)] for quality in QUALITIES]
    orders = [
        list(row.dropna().sort_values(ascending=False, kind="stable").index)
        for table in tables
        for _, row in table.iterrows()
    ]
    return [order for order in orders if order]
