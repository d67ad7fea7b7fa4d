"""A robot that explores an office by itself: writes `data/records/exploring.csv`."""

from collections.abc import Iterator

import numpy as np
import pandas as pd
from segmap_course import Explored, explore

from segmap.simulation import office

from .measure import RECORDS, Row

SEEDS = range(6)
#: Metres driven from row to row of the record.
EVERY = 5.0


def rows() -> Iterator[Row]:
    table, found = [], [explored(seed) for seed in SEEDS]
    for seed, run in zip(SEEDS, found, strict=True):
        for metres in np.arange(0, run.metres[-1] + EVERY, EVERY):
            at = np.searchsorted(run.metres, metres, "right") - 1
            table.append((seed, metres, round(run.known[at], 4)))
    frame = pd.DataFrame(table, columns=["seed", "metres", "known"])
    frame.to_csv(RECORDS / "exploring.csv", index=False, lineterminator="\n")
    ninety = [run.metres[np.argmax(run.known >= 0.9)] for run in found]
    least = min(run.known[-1] for run in found)
    yield Row(
        f"{len(found)} offices of 120 m², nearest frontier first",
        f"90 % of the floor after {np.median(ninety):.0f} m, in the end at least {least:.3f}",
    )


def explored(seed: int) -> Explored:
    """One run: the seed furnishes the office and is that of the sensor's noise."""
    rng = np.random.default_rng(seed)
    return explore(office(rng=rng), (1.0, 5.0), rng=rng)
