"""Reduced maps against the true walls of four simulated buildings: writes `data/records/walls.csv`.

Each building is driven through once; then the poses get a noise that is known, or drift, and the
map of the noisy poses is reduced. What could be known is the map at the true poses.
"""

from collections.abc import Iterator
from functools import cache
from itertools import product
from typing import Any

import numpy as np
import pandas as pd

from segmap import METHODS, Log, SegmentMap, build_map
from segmap.experiments import good_maps, load_walls
from segmap.metrics import against_walls
from segmap.simulation import (
    SICK_LMS200,
    box,
    city,
    corridor_loop,
    drive,
    office,
    polyline,
    simulate,
)

from .measure import ROOT, Row

PATH = ROOT / "data" / "records" / "walls.csv"
#: Standard deviations of the poses, metres -> radians of heading. Drift is a running mean over some
#: 20 scans, with a little white noise.
NOISES = {"0": 0.0, "0.01": np.radians(0.15), "0.02": np.radians(0.3), "0.03": np.radians(0.5)}
#: Metres in all.
DRIFT = 0.0206
#: The threshold of each method that trades reduction for closeness. Mean shift, 10 to 25 seconds a
#: map for three values, is left out.
GRIDS: dict[str, dict[str, list[float]]] = {
    "basic_offline": {"distance": [0.02, 0.05, 0.10, 0.20]},
    "basic_online": {"distance": [0.02, 0.05, 0.10, 0.20]},
    "hybrid": {"distance": [0.02, 0.05, 0.10, 0.20, 0.40]},
    "fusion": {"tolerance": [0.01, 0.02, 0.04, 0.06, 0.10]},
    "hybrid_fusion": {"distance": [0.05, 0.10, 0.20], "tolerance": [0.02, 0.04, 0.06]},
    "polyline": {"tolerance": [0.02, 0.03, 0.05, 0.10]},
    "segment_similarity": {"distance": [0.02, 0.03, 0.045, 0.061, 0.08, 0.10]},
    "uncertain_parameters": {"distance": [0.02, 0.05, 0.10, 0.20]},
    "weighted_line_fitting": {"chi2": [3.0, 9.21, 30.0, 80.0, 200.0, 500.0]},
    "least_cost": {"penalty": [0.12, 0.28, 0.5, 1.0, 1.6, 2.5, 4.0]},
    "fusion_online": {"tolerance": [0.01, 0.02, 0.04, 0.06, 0.10]},
    "fuzzy_set": {"across": [0.02, 0.05, 0.10]},
    "fuzzy_clustering": {"noise": [0.02, 0.05, 0.10]},
    "viewing_sector": {"distance": [0.02, 0.05, 0.10, 0.20]},
}


@cache
def buildings() -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """The walls of each building, and the poses of a drive through it."""
    floor = [box(12, 8, (6, 4, 0)), box(1, 0.8, (6, 5.9, 0))]
    floor += [
        polyline(ends)
        for ends in (
            [(4, 0), (4, 3)],
            [(4, 4), (4, 8)],
            [(8, 8), (8, 5)],
            [(8, 4), (8, 0)],
            [(9, 2), (11, 3.2)],
        )
    ]
    way = [(2, 3.5), (6, 3.5), (10, 4.5), (10, 7), (10.5, 1), (6, 2), (6, 7), (2, 6.5), (2, 1)]
    rooms = [(1, 5), *((x, y) for x in (2, 6, 10) for y in (5, 7.6, 5, 2.4, 5)), (11, 5)]
    square = [(1.5, 1.5), (12.5, 1.5), (12.5, 12.5), (1.5, 12.5)]
    round_way = [(1, 1), (17, 1), (17, 9), (1, 9)]
    wide = np.radians(30)
    return {
        "floor": (np.concatenate(floor), drive(way, step=0.6, turn=np.radians(20))),
        "office": (
            office(rng=np.random.default_rng(66), rooms=3),
            drive([*rooms, *rooms[-2::-1]], step=0.8, turn=np.radians(45)),
        ),
        "city": (
            city(1, 1, rng=np.random.default_rng(5), block=8, street=3),
            drive([*square, *square, square[0]], step=0.6, turn=wide),
        ),
        "corridor_loop": (
            corridor_loop(18, 10),
            drive([*round_way, *round_way, round_way[0]], step=0.6, turn=wide),
        ),
    }


def noisy(truth: np.ndarray, noise: str, rng: np.random.Generator) -> np.ndarray:
    """The poses with white noise, or with drift."""
    white = rng.normal(size=(len(truth), 3))
    if noise != "drift":
        return truth + white * (float(noise), float(noise), NOISES[noise])
    keep = np.exp(-1 / 20)
    slow = rng.normal(size=(len(truth), 3))
    for k in range(1, len(slow)):
        slow[k] = keep * slow[k - 1] + np.sqrt(1 - keep**2) * slow[k]
    return truth + slow * (0.02, 0.02, np.radians(0.3)) + white * (0.005, 0.005, np.radians(0.1))


def maps(seeds: range) -> Iterator[tuple[dict[str, Any], np.ndarray, SegmentMap, SegmentMap]]:
    """Building, noise and seed; the walls; the map at the true poses; the map to reduce."""
    for seed in seeds:
        for name, (walls, path) in buildings().items():
            rng = np.random.default_rng(seed)
            log: Log = simulate(walls, path, sensor=SICK_LMS200, rng=rng)
            true = build_map(log, log.truth).filtered(0.10)
            for noise in (*NOISES, "drift"):
                poses = noisy(log.truth, noise, np.random.default_rng(1000 + seed))
                map = build_map(log, poses, keep_points=True).filtered(0.10)
                known = {"group": "tuned", "sensor": "SICK", "map": name, "seed": seed}
                yield known | {"noise": noise}, walls, true, map


def judged(walls: np.ndarray, true: SegmentMap, reduced: Any, noise: str) -> dict[str, Any]:
    """The figures as shares, and whether all four that count are good."""
    found = against_walls(walls, reduced, seen=true)
    whole, limit = found.seen.sum(), max(DRIFT if noise == "drift" else float(noise), 0.01)
    row = {
        "per_wall": found.per_wall,
        "found": found.found,
        "missed": found.missed / whole,
        "invented": found.invented / whole,
        "doubled": found.doubled.sum() / whole,
        "offset": found.offset,
    }
    good = row["per_wall"] <= 1.1 and row["missed"] <= 0.01 and row["invented"] <= 0.03
    return row | {"all_four": str(int(good and row["offset"] <= limit))}


def rows() -> Iterator[Row]:
    summed(runs(range(3))).to_csv(PATH, index=False)
    for method, row in good_maps(load_walls()).iterrows():
        each = f"{row['all']}, {row['each_its_own']} of {row['maps']}"
        yield Row(f"{method}: all four, one threshold, each its own", each)


def runs(seeds: range) -> pd.DataFrame:
    """Every method on every map with all thresholds."""
    lines = []
    for known, walls, true, map in maps(seeds):
        for method, grid in GRIDS.items():
            for values in product(*grid.values()):
                chosen = dict(zip(grid, values, strict=True))
                reduced = METHODS[method](map, **chosen)
                words = ";".join(f"{name}={value:g}" for name, value in chosen.items())
                run = {**known, "method": method, "thresholds": words}
                lines.append(run | judged(walls, true, reduced, known["noise"]))
    return pd.DataFrame(lines)


def summed(frame: pd.DataFrame) -> pd.DataFrame:
    """A row for all maps of a noise: building by building, seed by seed."""
    order = {name: k for k, name in enumerate(buildings())}
    frame = frame.sort_values(["map", "seed"], key=lambda each: each.replace(order), kind="stable")
    same = frame.groupby(["group", "sensor", "noise", "method", "thresholds"], sort=False)
    means = ["per_wall", "found", "missed", "invented", "doubled"]
    found = same[means].mean()
    found.insert(1, "largest", same["per_wall"].max())
    found["offset"] = np.sqrt(same["offset"].agg(lambda each: (each**2).mean()))
    found = found.round(4)
    found["all_four"] = same["all_four"].sum()
    return found.reset_index()
