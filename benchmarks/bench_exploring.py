"""A robot that explores an office by itself: writes `data/records/exploring.csv`."""

from collections.abc import Iterator

import numpy as np
from segmap_course import Explored, explore

from segmap.files import replacing, table_text
from segmap.simulation import office

from .measure import ROOT, Row

SEEDS, WAYS = range(6), ("nearest", "largest")
#: Metres driven from row to row of the record.
EVERY = 5.0


def rows() -> Iterator[Row]:
    table = [("choose", "seed", "metres", "known", "all")]
    for choose in WAYS:
        found = [(seed, explored(seed, choose)) for seed in SEEDS]
        for seed, run in found:
            most = run.metres[-1]
            for metres in np.arange(0, most + EVERY, EVERY):
                at = np.searchsorted(run.metres, metres, "right") - 1
                table.append((choose, seed, metres, round(run.known[at], 4), round(most, 1)))
        ninety = [run.metres[np.argmax(run.known >= 0.9)] for _, run in found]
        least = min(run.known[-1] for _, run in found)
        yield Row(
            f"{choose} frontier, {len(found)} offices of 120 m²",
            f"90 % of the floor after {np.median(ninety):.0f} m, in the end at least {least:.3f}",
        )
    with replacing(ROOT / "data" / "records" / "exploring.csv") as target:
        target.write(table_text(table).encode())


def explored(seed: int, choose: str) -> Explored:
    """One run: the seed furnishes the office and is that of the sensor's noise."""
    rng = np.random.default_rng(seed)
    return explore(office(rng=rng), (1.0, 5.0), rng=rng, choose=choose)
