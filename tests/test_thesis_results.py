"""The runs of the thesis, and those of its grid that come with segmap."""

import csv
from collections import Counter
from math import radians

import numpy as np
import pytest

from segmap import METHODS
from segmap.experiments import (
    THESIS_FILTERS,
    THESIS_GRIDS,
    Record,
    Records,
    load_records,
    sweep,
    thesis_grid,
    thesis_results,
)
from segmap.readers import _bundled


def thesis_rows():
    with _bundled.data_file("thesis_results.csv").open(encoding="utf-8", newline="") as lines:
        return list(csv.DictReader(lines))


def test_the_reduction_that_a_prints_is_the_one_of_its_counts():
    """A's percentages agree with A's numbers of segments in all rows, to their two decimals."""
    rows, found = thesis_rows(), thesis_results()
    printed = [float(row["reduction_pct"]) / 100 for row in rows]
    wrong = sum(abs(p - r.reduction) > 0.5001e-4 for p, r in zip(printed, found, strict=True))
    assert (len(rows), wrong) == (264, 0)


def test_thesis_results_are_in_metres_and_radians():
    """Catches degrees, millimetres, per cent and a filter that is 1 metre long."""
    found = thesis_results()
    assert {r.thresholds["angle"] for r in found if "angle" in r.thresholds} == {
        radians(10),
        radians(20),
    }
    assert {r.filtered for r in found} == {None, 0.10}
    lengths = {v for r in found for k, v in r.thresholds.items() if k != "angle"}
    assert lengths == {0.02, 0.04, 0.06, 0.08, 0.10, 0.20, 0.30, 0.40}
    assert all(0 < r.quality < 1 and 0 < r.reduction < 1 for r in found)
    wanted = {"polimi": (658, 434), "stanford": (1507, 1117), "bicocca": (2220, 1320)}
    for name, counts in {**wanted, "usc": (3604, 2206)}.items():  # A 6.3 to 6.6
        parts = [found.select(map=name, filtered=f) for f in (False, True)]
        assert tuple(part[0].n_before for part in parts) == counts
        assert all({r.n_before for r in part} == {part[0].n_before} for part in parts)


def test_what_the_text_of_a_says_of_its_runs():
    """Catches a column that is read for another, by figures of the text (A 6.3, 6.6)."""
    found = thesis_results()
    usc = found.select(map="usc", method="fusion", filtered=True, tolerance=0.04)
    assert usc[0].quality == pytest.approx(0.86, abs=0.005)
    assert usc[0].reduction == pytest.approx(0.86, abs=0.005)
    polimi = found.select(map="polimi", method="hybrid")
    assert [min(r.seconds for r in polimi), max(r.seconds for r in polimi)] == [4, 10]
    online = found.select(map="polimi", method="basic_online")
    assert min(r.seconds for r in online) == 31 and 180 <= max(r.seconds for r in online) < 200


def test_the_grid_is_that_of_the_thesis():
    """Catches a threshold that is missing: 33 runs, 66 with the filter, 264 on four buildings."""

    def runs(records):
        return Counter(
            (
                r.map,
                r.method,
                r.filtered,
                *sorted((k, round(v, 9)) for k, v in r.thresholds.items()),
            )
            for r in records
        )

    def nothing(map, **thresholds):
        return METHODS["fusion"].function(map)

    maps = {r.map: np.empty((0, 2, 2)) for r in thesis_results()}
    methods = dict.fromkeys(THESIS_GRIDS, nothing)
    found = sweep(maps, methods, THESIS_GRIDS, filters=THESIS_FILTERS)
    assert len(found) == 264 and runs(found) == runs(thesis_results())


def test_a_sweep_over_the_grid_of_the_thesis_is_in_it_and_others_are_not():
    """Catches defaults that the records name and the thesis does not, and others than A's."""
    wall = np.array([[(0, 0), (2, 0)], [(1, 0), (3, 0)]])
    grids = {**THESIS_GRIDS, "hybrid_fusion": [{}]}
    found = sweep({"wall": wall}, METHODS, grids, filters=THESIS_FILTERS)
    assert len(thesis_grid(found)) == 66
    other = {"mean_shift": [{"sigma": 0.1, "bandwidth": 0.5}], "fusion": [{"tolerance": 0.03}]}
    others = sweep({"wall": wall}, list(other), other, filters=(None, 0.05))
    assert len(thesis_grid(others)) == 0
    assert len(thesis_grid(sweep({"wall": wall}, ["fusion"], filters=(0.05,)))) == 0


def test_records_by_name(tmp_path, monkeypatch):
    """Catches a traceback of paths for a name that is not there, and other tables read as runs."""
    folder = tmp_path / "records"
    folder.mkdir()
    runs = [Record(name, "fusion", {}, None, 9, 8, 0.1, 0.9, 0.5) for name in ("hall", "room")]
    Records(runs[:1] * 3).write(folder / "hall.csv")
    Records(runs[1:]).write(folder / "room.csv")
    (folder / "alignment.csv").write_text("log,method\nhall,backbone\n", encoding="utf-8")
    monkeypatch.setattr(_bundled, "PLACES", (tmp_path / "absent", tmp_path))
    assert list(load_records("hall")) == runs[:1] * 3 and len(load_records()) == 4
    with pytest.raises(ValueError, match="name must be of alignment, hall, room, got 'attic'"):
        load_records("attic")
