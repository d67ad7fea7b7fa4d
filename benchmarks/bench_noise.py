"""The noise of the poses that one per wall finds on real logs: writes `data/records/noise.csv`.

Beside it stands the spread that the pose graph claims for its own poses.
"""

from collections.abc import Iterator

import numpy as np
import pandas as pd

from segmap import SegmentMap, build_map
from segmap.alignment import pose_graph
from segmap.files import rewrite
from segmap.reduction import one_per_wall

from .bench_alignment import cases
from .measure import RECORDS, SHARED, Row, missing


def rows() -> Iterator[Row]:
    if not (SHARED / "data").exists():
        yield from missing("Intel and FR079: the stored record stays")
        return
    found = []
    for name, log in {case.name.split(",")[0]: case.log for case in cases()}.items():
        aligned = pose_graph(log)
        assert log.truth is not None and aligned.spread is not None
        maps = [build_map(log, poses, keep_points=True) for poses in (log.truth, aligned.poses)]
        of_the_file, of_the_graph = (noise(map) for map in maps)
        assert aligned.local_spread is not None
        row = {"log": name, "of_the_file": of_the_file, "of_the_graph": of_the_graph}
        row["spread"], row["local_spread"] = (
            float(np.median(each[np.isfinite(each)]))
            for each in (aligned.spread, aligned.local_spread)
        )
        found.append(row)
        yield Row(name, ", ".join(f"{word} {row[word]:.4f} m" for word in list(row)[1:]))
    with rewrite(RECORDS / "noise.csv") as target:
        pd.DataFrame(found).round(4).to_csv(target, index=False, lineterminator="\n")


def noise(map: SegmentMap) -> float:
    """Of all places in the map, metres."""
    return one_per_wall(map.filtered(0.10)).noise
