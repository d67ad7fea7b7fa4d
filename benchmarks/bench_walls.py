"""Reduced maps against the true walls of simulated buildings: writes `data/records/walls.csv`.

Each building is driven through once; then the poses get a noise that is known, or drift, and the
map of the noisy poses is reduced. What could be known is the map at the true poses.
`python -m benchmarks.bench_walls --methods fusion` judges one method anew, and leaves other rows.
"""

import argparse
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from itertools import product, repeat
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
from segmap_course import known_building
from segmap_course._known_buildings import NOISES, buildings

from segmap import METHODS, SegmentMap
from segmap.experiments import good_maps, load_walls
from segmap.files import rewrite
from segmap.metrics import against_walls
from segmap.simulation import SICK_LMS200, URG_04LX

from .measure import RECORDING, ROOT, Row

PATH = ROOT / "data" / "records" / "walls.csv"
#: Metres in all.
DRIFT = 0.0206
#: The threshold of each method that trades reduction for closeness; others keep their defaults.
GRIDS: dict[str, dict[str, list[float]]] = {
    "basic_offline": {"distance": [0.02, 0.05, 0.10, 0.20]},
    "basic_online": {"distance": [0.02, 0.05, 0.10, 0.20]},
    "hybrid": {"distance": [0.02, 0.05, 0.10, 0.20, 0.40]},
    "mean_shift": {"sigma": [0.05, 0.10, 0.20]},
    "fusion": {"tolerance": [0.01, 0.02, 0.04, 0.06, 0.08, 0.10]},
    "hybrid_fusion": {"distance": [0.05, 0.10, 0.20], "tolerance": [0.02, 0.04, 0.06]},
    "polyline": {"tolerance": [0.02, 0.03, 0.05, 0.07, 0.10]},
    "segment_similarity": {"distance": [0.02, 0.03, 0.045, 0.061, 0.08, 0.10]},
    "uncertain_parameters": {"distance": [0.02, 0.03, 0.05, 0.10, 0.20]},
    "weighted_line_fitting": {"chi2": [3.0, 9.21, 30.0, 80.0, 200.0, 500.0]},
    "least_cost": {"penalty": [0.12, 0.28, 0.5, 1.0, 1.6, 2.5, 4.0]},
    "one_per_wall": {"factor": [0.7, 0.85, 1.0, 1.2, 1.5]},
    "fusion_online": {"tolerance": [0.01, 0.02, 0.04, 0.06, 0.08, 0.10]},
    "fuzzy_set": {"across": [0.02, 0.05, 0.10]},
    "fuzzy_clustering": {"noise": [0.005, 0.01, 0.02, 0.05, 0.10]},
    "viewing_sector": {"distance": [0.02, 0.05, 0.10, 0.20]},
}
#: These take 10 to 25 seconds a map: they see the first seed of each group.
SLOW = {"mean_shift"}
SENSORS = {"SICK": SICK_LMS200, "URG": URG_04LX}


class Group(NamedTuple):
    """Maps that are reported together: every building, sensor and seed of it."""

    buildings: tuple[str, ...]
    sensors: tuple[str, ...]
    seeds: range


#: The figures of the first group were seen while methods and thresholds were chosen.
GROUPS = {
    "tuned": Group(("floor", "office", "city", "corridor_loop"), ("SICK",), range(3)),
    "fresh seeds": Group(("floor", "office", "city", "corridor_loop"), ("SICK",), range(3, 5)),
    "fresh buildings": Group(("hall", "diagonal"), ("SICK", "URG"), range(5)),
}


class Drive(NamedTuple):
    """One drive through a building, in its group."""

    group: str
    sensor: str
    building: str
    seed: int


def maps(drive: Drive) -> Iterator[tuple[str, SegmentMap, SegmentMap]]:
    """Each noise, the map at the true poses, and the map to reduce."""
    for noise in (*NOISES, "drift"):
        known = known_building(drive.building, noise, drive.seed, sensor=SENSORS[drive.sensor])
        yield noise, known.true, known.map


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


def runs(drive: Drive, methods: Sequence[str]) -> list[dict[str, Any]]:
    """Methods on the maps of a drive, with all their thresholds."""
    found = []
    for noise, true, map in maps(drive):
        for method in methods:
            if method in SLOW and drive.seed > GROUPS[drive.group].seeds[0]:
                continue
            grid = GRIDS.get(method, {})
            for values in product(*grid.values()):
                chosen = dict(zip(grid, values, strict=True))
                words = ";".join(f"{name}={value:g}" for name, value in chosen.items())
                run = {"group": drive.group, "sensor": drive.sensor, "noise": noise}
                run |= {"method": method, "thresholds": words}
                reduced = METHODS[method](map, **chosen)
                found.append(run | judged(buildings()[drive.building][0], true, reduced, noise))
    return found


def summed(frame: pd.DataFrame) -> pd.DataFrame:
    """A row for all maps of a noise: building by building, seed by seed."""
    same = frame.groupby(["group", "sensor", "noise", "method", "thresholds"], sort=False)
    found = same[["per_wall", "found", "missed", "invented", "doubled"]].mean()
    found.insert(1, "largest", same["per_wall"].max())
    found["offset"] = np.sqrt(same["offset"].agg(lambda each: (each**2).mean()))
    return found.round(4).assign(all_four=same["all_four"].sum()).reset_index()


def judge(
    methods: Sequence[str] = tuple(METHODS), groups: Sequence[str] = tuple(GROUPS), workers: int = 1
) -> None:
    """Run methods on groups, and put their rows in the place of older ones of the record."""
    drives = [
        Drive(group, sensor, building, seed)
        for group in groups
        for sensor in GROUPS[group].sensors
        for building in GROUPS[group].buildings
        for seed in GROUPS[group].seeds
    ]
    with ProcessPoolExecutor(workers) as pool:
        found = [run for part in pool.map(runs, drives, repeat(methods)) for run in part]
    new, old = summed(pd.DataFrame(found)), pd.read_csv(PATH, dtype=str, keep_default_na=False)
    again = old["method"].isin(methods) & old["group"].isin(groups)
    frame = pd.concat([old[~again], new])
    order = {name: k for k, name in enumerate([*GROUPS, *SENSORS, *NOISES, "drift", *METHODS])}
    keys = ["group", "sensor", "noise", "method"]
    frame = frame.sort_values(keys, key=lambda each: each.map(order), kind="stable")
    with rewrite(PATH) as target:
        frame.to_csv(target, index=False, lineterminator="\n")


def table(group: str) -> pd.DataFrame:
    """The maps of a group that are good, also with the thresholds that are best for the first."""
    frame, chosen = load_walls(group), good_maps(load_walls("tuned"))["thresholds"]
    tuned = frame[frame["thresholds"] == frame["method"].map(chosen)]
    return good_maps(frame).assign(as_tuned=good_maps(tuned)["all"])


def rows() -> Iterator[Row]:
    if not RECORDING:
        yield Row("all methods", "skipped", "half an hour, for records only: --record")
        return
    judge()
    for group in GROUPS:
        for method, row in table(group).iterrows():
            each = f"{row['all']}, {row['each_its_own']}, {row['as_tuned']} of {row['maps']}"
            yield Row(f"{group}, {method}: one threshold, each its own, as tuned", each)


def main() -> None:
    parser = argparse.ArgumentParser("python -m benchmarks.bench_walls", description=__doc__)
    parser.add_argument("--methods", nargs="+", choices=METHODS, default=tuple(METHODS))
    parser.add_argument("--groups", nargs="+", choices=GROUPS, default=tuple(GROUPS))
    parser.add_argument("--workers", type=int, default=1)
    asked = parser.parse_args()
    judge(asked.methods, asked.groups, asked.workers)
    for group in asked.groups:
        print(f"\n{group}\n{table(group).to_string()}")


if __name__ == "__main__":
    main()
