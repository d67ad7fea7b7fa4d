"""The files of runs, and what is chosen of them."""

import numpy as np
import pandas as pd
import pytest
from pandas.testing import assert_frame_equal
from sweep_samples import GRIDS, MAPS, NAMES

from segmap import SegmentMap
from segmap.experiments import (
    good_maps,
    load_records,
    load_walls,
    read_records,
    select,
    sweep,
    thresholds_of,
    write_records,
)
from segmap.readers import data_file


@pytest.fixture(scope="module")
def expected():
    return sweep(MAPS, NAMES, GRIDS, filters=(None, 0.10))


def run(**changed):
    """A frame of one run."""
    row = {"map": "hall", "method": "fusion", "tolerance": 0.02, "filtered": 0.0}
    row |= {"n_before": 60, "n_after": 20, "reduction": 0.5, "quality": 0.9, "seconds": 0.1}
    return pd.DataFrame([row | changed])


def test_files_give_back_what_they_got(tmp_path, expected):
    """Catches rounding, lost thresholds, whole numbers made floats, names with commas, quotes."""
    path = tmp_path / "runs.csv"
    unknown = run(quality=np.nan, reduction=np.nan, tolerance=np.inf)
    odd = run(map='a "hall", with =;', a=1, b=1e-17, angle=np.radians(10))
    odd["a"] = odd["a"].astype("Int64")
    frame = pd.concat([expected, unknown, odd], ignore_index=True)
    write_records(frame, path)
    assert_frame_equal(read_records(path), frame, check_like=True)
    assert type(thresholds_of(read_records(path).iloc[-1])["a"]) is int
    assert "np." not in path.read_text() and [p.name for p in tmp_path.iterdir()] == ["runs.csv"]


def test_a_run_on_an_empty_map_has_no_quality_and_is_kept(tmp_path):
    """Catches a filter that leaves nothing, reported as perfect."""
    walls = SegmentMap([[(0, 0), (0.05, 0)]])
    file = tmp_path / "runs.csv"
    found = sweep({"yard": walls}, ["fusion"], filters=(0.10,))
    assert np.isnan(found["quality"].item()) and found["n_before"].item() == 0
    write_records(found, file)
    assert_frame_equal(found, read_records(file))


def test_a_file_of_something_else_is_no_file_of_runs(tmp_path):
    """Catches a table of something else, read as no run at all."""
    (tmp_path / "runs.csv").write_text("a poem")
    with pytest.raises(ValueError, match=r"runs.csv: expected a CSV file of runs"):
        read_records(tmp_path / "runs.csv")


def test_select(expected):
    """Catches a filter that is taken for none, and thresholds compared digit by digit."""
    assert len(select(expected)) == 16
    assert len(select(expected, map="hall", method="fusion")) == 4
    for filtered, found in ((True, {0.1}), (False, {0}), (0.1 + 1e-12, {0.1}), (0.2, set())):
        assert set(select(expected, filtered=filtered)["filtered"]) == found
    assert set(select(expected, tolerance=0.06 + 1e-12)["method"]) == {"fusion"}
    assert len(select(expected, distance=0.3, angle=np.radians(10))) == 4
    near = pd.DataFrame({"tolerance": 0.3 * (1 + np.array([-1.1, -0.9, 0.9, 1.1]) * 1e-9)})
    assert list(select(near, tolerance=0.3).index) == [1, 2], "a part in 10^9, to both sides"


def test_records_by_name():
    """Catches a traceback of paths for a name that is not there, and other tables read as runs."""
    one, every = load_records("malaga"), load_records()
    assert len(data_file("records/malaga.csv").read_text().splitlines()) == 1 + len(one)
    assert {*one["map"]} == {"malaga"} < {"office", "intel"} | {*every["map"]} == {*every["map"]}
    assert len(every[every["map"] == "malaga"]) == len(one)
    with pytest.raises(ValueError, match=r"names must be one of 'fr079', .*, got 'attic'"):
        load_records("attic")


def test_maps_that_are_good_are_counted():
    """Catches noises taken one by one, and maps that are counted twice."""
    runs = [
        ("old", "0", "fusion", "tolerance 0.02", "0011"),
        ("old", "drift", "fusion", "tolerance 0.02", "0000"),
        ("old", "0", "fusion", "tolerance 0.04", "0001"),
        ("old", "drift", "fusion", "tolerance 0.04", "0110"),
        ("new", "0", "fusion", "tolerance 0.02", "00"),
        ("old", "0", "hybrid", "distance 0.2", "1111"),
    ]
    frame = pd.DataFrame(runs, columns=["group", "noise", "method", "thresholds", "all_four"])
    table = good_maps(frame.assign(sensor="SICK", maps=frame["all_four"].str.len()))
    assert list(table.index) == ["hybrid", "fusion"]
    assert list(table.loc["hybrid"]) == ["distance 0.2", 4, 0, 4, 4, 4]
    assert list(table.loc["fusion"]) == ["tolerance 0.04", 1, 2, 3, 4, 10]


def test_judged_maps_are_chosen_by_their_group():
    """Catches digits read as a number."""
    frame = load_walls("fresh")
    assert set(frame["group"]) == {"fresh seeds", "fresh buildings"}
    assert (frame["all_four"].str.len() == frame["maps"]).all() and {8, 10} < set(frame["maps"])
    with pytest.raises(ValueError, match=r"group must be the beginning of one of tuned.*, got 'x"):
        load_walls("x")
