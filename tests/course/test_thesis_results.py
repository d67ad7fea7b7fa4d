"""The runs of the thesis, those of its grid that come with segmap, and published errors."""

import csv
from math import radians

import numpy as np
import pytest
from segmap_course import THESIS_GRIDS, thesis_grid, thesis_results, within_thesis

from segmap.experiments import load_records
from segmap.readers import data_file

FOUND = thesis_results()


def test_the_reduction_that_a_prints_is_the_one_of_its_counts():
    """A's percentages agree with A's numbers of segments in all rows, to their two decimals."""
    with data_file("thesis_results.csv").open(encoding="utf-8", newline="") as lines:
        printed = [float(row["reduction_pct"]) / 100 for row in csv.DictReader(lines)]
    assert len(FOUND) == 264 and abs(printed - FOUND["reduction"]).max() < 0.5001e-4


def test_thesis_results_are_in_metres_and_radians():
    """Catches degrees, millimetres, per cent and a filter that is 1 metre long."""
    assert set(FOUND["angle"].dropna()) == {radians(10), radians(20)}
    assert set(FOUND["filtered"]) == {0, 0.10}
    lengths = np.unique(FOUND[["distance", "sigma", "tolerance"]])
    assert lengths[:-1].tolist() == [0.02, 0.04, 0.06, 0.08, 0.10, 0.20, 0.30, 0.40]
    assert FOUND[["quality", "reduction"]].stack().between(0, 1, inclusive="neither").all()
    counts = FOUND.groupby(["map", "filtered"])["n_before"]
    assert (counts.nunique() == 1).all()
    wanted = {"polimi": (658, 434), "stanford": (1507, 1117), "bicocca": (2220, 1320)}
    for name, (whole, filtered) in {**wanted, "usc": (3604, 2206)}.items():  # A 6.3 to 6.6
        assert (counts.first()[name, 0], counts.first()[name, 0.1]) == (whole, filtered)


def test_the_grid_is_that_of_the_thesis():
    """Catches a threshold that is missing: 33 runs, 66 with the filter, 264 on four buildings."""
    runs = 8 * sum(np.prod([len(v) for v in grid.values()]) for grid in THESIS_GRIDS.values())
    names = ["map", "method", "filtered", "angle", "distance", "sigma", "tolerance"]
    assert runs == len(thesis_grid(FOUND)) == len(FOUND.drop_duplicates(names)) == 264


RECORDS = load_records("malaga", "office", "intel", "fr079")
#: Share of the runs on each building whose quality, and reduction, lie within A's; chapter 23 has
#: the reason for each method that lies outside.
WITHIN = {
    "basic_offline": ([0.25, 1.0, 0.25, 0.5], 0.6),
    "basic_online": ([0.5, 1.0, 0.25, 0.5], 0.6),
    "hybrid": ([1.0, 1.0, 0.5, 0.5], 0.6),
    "mean_shift": ([0.8, 0.6, 1.0, 1.0], 0.7),
    "fusion": ([0.3, 0.8, 1.0, 0.5], 0.6),
}


@pytest.mark.parametrize("method", THESIS_GRIDS)
def test_each_method_is_the_one_that_a_ran(method):
    """A filter of Hybrid that grows with the distance left its share at 12 to 50 %."""
    table = within_thesis(RECORDS).loc[method].unstack()
    least, reduces = WITHIN[method]
    assert (table["quality"][["malaga", "office", "intel", "fr079"]] >= least).all()
    assert (table["reduction"] >= reduces).all()
