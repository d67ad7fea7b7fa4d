"""The grid of the thesis on buildings that it never saw: writes `data/records/*.csv`.

Maps hold every piece of two points or more, whatever its length, as A's extraction does: with the
defaults (five points, 0.10 m) the filter of 0.10 m would find nothing to do. Those are run too,
unfiltered, as `malaga_default` and `intel_default`. Logs are thinned to the sizes of A's maps. The
maps keep the points and the places of the sensor, for the methods that need them.
"""

from collections.abc import Iterator
from dataclasses import replace
from functools import cache

import numpy as np
import pandas as pd
from segmap_course import THESIS_FILTERS

from segmap import METHODS, Log, SegmentMap, build_map, load, read
from segmap.experiments import growth, sweep, write_records
from segmap.simulation import SICK_LMS200, drive, office, simulate

from .measure import RECORDS, SHARED, Row, missing

#: Every piece of a scan is a segment.
PIECES = {"min_points": 2, "min_length": 0.0}

_ANGLES = np.radians([2.5, 5, 10, 20])
_DISTANCES = [0.02, 0.05, 0.10, 0.20, 0.30, 0.40]
#: A's thresholds, others that reach higher qualities, and a grid for what A only names.
GRIDS = {
    "basic_offline": {"angle": _ANGLES, "distance": _DISTANCES},
    "basic_online": {"angle": _ANGLES, "distance": _DISTANCES},
    "hybrid": {"angle": _ANGLES, "distance": _DISTANCES, "min_length": [0.0, 0.10]},
    "mean_shift": {"sigma": [0.05, 0.10, 0.20, 0.30, 0.40]},
    "fusion": {"tolerance": [0.005, 0.01, 0.02, 0.04, 0.06, 0.08, 0.10]},
    "hybrid_fusion": {
        "angle": np.radians([5, 10]),
        "distance": [0.02, 0.05, 0.10, 0.20],
        "tolerance": [0.01, 0.02, 0.04],
        "min_length": [0.0, 0.10],
    },
    "polyline": {"tolerance": [0.015, 0.02, 0.03, 0.05, 0.10, 0.20]},
    "segment_similarity": {"distance": [0.005, 0.01, 0.02, 0.03, 0.05, 0.10]},
    "uncertain_parameters": {
        "angle": np.radians([2.5, 5, 10]),
        "distance": [0.005, 0.01, 0.02, 0.05, 0.10, 0.20],
    },
    "weighted_line_fitting": {"chi2": [0.25, 0.5, 1.0, 3.0, 9.21, 30.0]},
    "least_cost": {"penalty": [0.02, 0.035, 0.05, 0.08, 0.12, 0.20, 0.30, 0.50, 1.0, 2.0]},
    "one_per_wall": {"factor": [0.1, 0.2, 0.3, 0.5, 0.7, 1.0, 1.5]},
    "fusion_online": {"tolerance": [0.005, 0.01, 0.02, 0.04, 0.06, 0.10]},
    "fuzzy_set": {"across": [0.005, 0.01, 0.02, 0.05, 0.10, 0.20]},
    "fuzzy_clustering": {"noise": [0.02, 0.05, 0.10], "distance": [0.01, 0.03, 0.10]},
    "viewing_sector": {"distance": [0.005, 0.01, 0.02, 0.05, 0.10, 0.20]},
}
#: Methods whose time against scans is kept.
TIMED = ("basic_online", "hybrid", "hybrid_fusion")
#: A's figures of time against scans show these two settings (A 6.3).
ONLINE = [
    {"distance": 0.10, "angle": np.radians(10)},
    {"distance": 0.40, "angle": np.radians(20)},
]
EVERY = 32


def rows() -> Iterator[Row]:
    for name, map in maps().items():
        filters = (None,) if name.endswith("_default") else THESIS_FILTERS
        # method by method: filtered and unfiltered runs are measured close to each other
        found = pd.concat(
            [
                sweep({name: map}, [method], GRIDS, filters=filters, repeat=repeat(method))
                for method in GRIDS
            ]
        )
        write_records(found.sort_values("filtered", kind="stable"), RECORDS / f"{name}.csv")
        total = f"{found['seconds'].sum():.1f} s in all"
        yield Row(f"{name}, {len(map)} segments", f"{len(found)} runs of {total}")
    if intel() is None:
        yield from missing("Intel and FR079: their stored records stay")
        return
    yield online()


def repeat(method: str) -> int:
    """Methods of milliseconds run five times, mean shift and those that A only surveys once."""
    return 5 if method in TIMED or method in ("basic_offline", "fusion") else 1


def maps() -> dict[str, SegmentMap]:
    """The buildings whose logs are here."""
    found = {"malaga": load("malaga"), "office": simulated()}
    if (log := intel()) is not None:
        found |= {"intel": log[::8], "fr079": read(SHARED / "data" / "fr079.log.gz")[::32]}
    made = {
        name: build_map(log, log.truth, keep_points=True, **PIECES) for name, log in found.items()
    }
    for name in {"malaga", "intel"} & set(found):
        made[f"{name}_default"] = build_map(found[name], found[name].truth, keep_points=True)
    return made


@cache
def intel() -> Log | None:
    path = SHARED / "data" / "intel.log.gz"
    return read(path) if path.exists() else None


def simulated() -> Log:
    """A SICK through eight furnished rooms along a corridor, there and back; true poses."""
    rng = np.random.default_rng(66)
    walls = office(rng=rng, rooms=4)
    rooms = [(x, y) for x in (2, 6, 10, 14) for y in (5, 7.6, 5, 2.4, 5)]
    there = [(1, 5), *rooms, (15, 5)]
    path = drive([*there, *there[-2::-1]], step=0.8, turn=np.radians(45))
    sensor = replace(SICK_LMS200, period=1.2)
    return simulate(walls, path, sensor=sensor, rng=rng, name="office")


def online() -> Row:
    """Time against scans on all of Intel: the median of three runs at every scan."""
    log = intel()
    map = build_map(log, log.truth, **PIECES)
    runs = [times(name, map, thresholds) for name in TIMED for thresholds in ONLINE]
    (RECORDS / "online").mkdir(exist_ok=True)
    path = RECORDS / "online" / "intel.csv"
    pd.concat(runs).round({"seconds": 6}).to_csv(path, index=False, lineterminator="\n")
    powers = ", ".join(f"{run['method'].iloc[0]} {growth(run):.2f}" for run in runs)
    return Row(f"on-line on {len(log)} scans", f"time ~ scans ^ ({powers})")


def times(name: str, map: SegmentMap, thresholds: dict[str, float]) -> pd.DataFrame:
    runs = [METHODS[name](map, **thresholds) for _ in range(3)]
    took = np.median([found.scan_seconds for found in runs], axis=0)
    scans = np.arange(1, len(took) + 1)
    rows = {"scans": scans, "seconds": np.cumsum(took), "live": runs[0].scan_live}
    frame = pd.DataFrame({"method": name, **thresholds, **rows})
    return frame[(scans % EVERY == 0) | (scans == len(scans))]
