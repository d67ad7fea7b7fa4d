"""Reduced maps against the true walls of simulated buildings: writes `data/records/walls.csv`.

Each building is driven through once; then the poses get a noise that is known, or drift, and the
map of the noisy poses is reduced. What could be known is the map at the true poses.
`python -m benchmarks.bench_walls --methods fusion` judges one method anew, and leaves other rows.
"""

import argparse
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from functools import cache
from itertools import product, repeat
from typing import Any, NamedTuple

import numpy as np
import pandas as pd

from segmap import METHODS, Log, SegmentMap, build_map
from segmap.experiments import good_maps, load_walls
from segmap.files import replacing
from segmap.metrics import against_walls
from segmap.simulation import (
    SICK_LMS200,
    URG_04LX,
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
        "hall": hall(),
        "diagonal": diagonal(),
    }


def hall() -> tuple[np.ndarray, np.ndarray]:
    """A hall with four pillars and six niches, 12 to 40 cm deep."""
    bottom = [(0, 0), (1.5, 0), (1.5, -0.25), (2.5, -0.25), (2.5, 0)]
    bottom += [(6, 0), (6, -0.12), (7.2, -0.12), (7.2, 0), (10, 0)]
    right = [(10, 2.5), (10.4, 2.5), (10.4, 3.7), (10, 3.7), (10, 7)]
    top = [(8, 7), (8, 7.25), (7, 7.25), (7, 7), (4, 7), (4, 7.12), (3, 7.12), (3, 7), (0, 7)]
    left = [(0, 5.5), (-0.3, 5.5), (-0.3, 4.5), (0, 4.5)]
    places = [(3, 2.2, 0), (3, 4.8, 0), (7, 2.2, np.pi / 4), (7, 4.8, 0.35)]
    pillars = [box(0.4, 0.4, place) for place in places]
    way = [(1.2, 1.2), (5, 1.1), (8.7, 1.2), (8.8, 3.5), (8.7, 5.8), (5, 5.9), (1.2, 5.8)]
    way += [(1.2, 3.5), (5, 3.5), (8.7, 3.4)]
    outline = polyline([*bottom, *right, *top, *left], closed=True)
    return np.concatenate([outline, *pillars]), drive(way, step=0.6, turn=np.radians(30))


def diagonal() -> tuple[np.ndarray, np.ndarray]:
    """Three rooms with doors of a metre; few walls are parallel, and a box stands at an angle."""
    outline = polyline([(0, 0), (7, 0), (10, 3), (10, 7.5), (7.5, 9), (3, 9), (0, 6)], closed=True)
    middle, inner = np.array([6.0, 4.5]), []
    for end, low, high in (((4, 0), 0.35, 0.55), ((10, 5.5), 0.4, 0.62), ((0, 5), 0.4, 0.56)):
        near, far = (np.round(middle + (end - middle) * share, 6) for share in (low, high))
        inner += [polyline([middle, near]), polyline([far, end])]
    way = [(1.5, 1.5), (3, 3), (5.1, 2.475), (7, 2), (8.5, 3.5), (8.05, 5.01), (8, 6.8), (5.5, 6)]
    way += [(3.1, 6.6), (3.1, 4.74), (2, 3), (1.2, 4)]
    walls = np.concatenate([outline, *inner, box(0.8, 0.5, (4.5, 7.5, 0.5))])
    return walls, drive(way, step=0.6, turn=np.radians(30))


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


def maps(drive: Drive) -> Iterator[tuple[str, SegmentMap, SegmentMap]]:
    """Each noise, the map at the true poses, and the map to reduce."""
    walls, path = buildings()[drive.building]
    rng = np.random.default_rng(drive.seed)
    log: Log = simulate(walls, path, sensor=SENSORS[drive.sensor], rng=rng)
    true = build_map(log, log.truth).filtered(0.10)
    for noise in (*NOISES, "drift"):
        poses = noisy(log.truth, noise, np.random.default_rng(1000 + drive.seed))
        yield noise, true, build_map(log, poses, keep_points=True).filtered(0.10)


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
    with replacing(PATH) as target:
        frame.to_csv(target, index=False, lineterminator="\n")


def table(group: str) -> pd.DataFrame:
    """The maps of a group that are good, also with the thresholds that are best for the first."""
    frame, chosen = load_walls(group), good_maps(load_walls("tuned"))["thresholds"]
    tuned = frame[frame["thresholds"] == frame["method"].map(chosen)]
    return good_maps(frame).assign(as_tuned=good_maps(tuned)["all"])


def rows() -> Iterator[Row]:
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
