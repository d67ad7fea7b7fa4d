"""Floor plans of simulated buildings of known truth: what is wrong, and is it told in `doubt`?

`python -m benchmarks.bench_plan_kinds` prints, for each kind of building, sensor and source of
poses, in how many seeds rooms, doors and areas are right, wrong and told, wrong and not told.
"""

from __future__ import annotations

import argparse
import warnings
from collections.abc import Iterator
from typing import Any

import numpy as np
import pandas as pd

from segmap import alignment
from segmap.plan import floor_plan
from tests import plan_buildings

from .measure import Row


def outcome(kind: str, sensor: str, poses: str, seed: int) -> dict[str, Any]:
    """One building: what is wrong with its plan, and what the plan says of it."""
    building = plan_buildings.KINDS[kind](np.random.default_rng(seed))
    log = plan_buildings.log_of(building, plan_buildings.SENSORS[sensor], seed)
    placed = log.truth
    if poses == "graph":
        placed = alignment.align_to_truth(alignment.pose_graph(log).poses, log.truth, best=True)
    plan = floor_plan(*plan_buildings.seen(log, placed))
    wrong = plan_buildings.wrong_in(plan, building)
    state = (
        ("doubted" if plan.doubt else "right")
        if not wrong
        else "told"
        if plan.doubt
        else "NOT TOLD"
    )
    return {"kind": kind, "sensor": sensor, "poses": poses, "seed": seed, "state": state,
            "wrong": "; ".join(wrong), "doubt": plan.doubt}  # fmt: skip


def rows() -> Iterator[Row]:
    yield Row("floor plans of known buildings", "skipped", "python -m benchmarks.bench_plan_kinds")


def main() -> None:
    parser = argparse.ArgumentParser("python -m benchmarks.bench_plan_kinds", description=__doc__)
    parser.add_argument("--kinds", nargs="+", default=[*plan_buildings.KINDS])
    parser.add_argument("--sensors", nargs="+", default=[*plan_buildings.SENSORS])
    parser.add_argument("--poses", nargs="+", default=["true", "graph"])
    parser.add_argument("--seeds", type=int, default=10)
    parser.add_argument("--all", action="store_true", help="also those that are right")
    asked, found = parser.parse_args(), list[dict[str, Any]]()
    warnings.simplefilter("ignore")
    for kind in asked.kinds:
        for poses in asked.poses:
            for sensor in asked.sensors:
                for seed in range(asked.seeds):
                    found.append(row := outcome(kind, sensor, poses, seed))
                    if asked.all or row["wrong"]:
                        print(*row.values(), sep=" | ", flush=True)
    table = pd.DataFrame(found)
    counts = pd.crosstab([table["kind"], table["poses"], table["sensor"]], table["state"])
    print(counts.to_string())


if __name__ == "__main__":
    main()
