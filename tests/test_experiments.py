"""Sweeps: what they run, in which order, where they run it, and what they show meanwhile."""

import sys
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from dataclasses import replace
from multiprocessing import get_context

import numpy as np
import pytest
import tqdm
from pandas.testing import assert_frame_equal
from sweep_samples import GRIDS, HALL, MAPS, NAMES, ROOM, keep_all, slow_start, without_seconds

from segmap import METHODS, metrics
from segmap.experiments import digest, select, sweep, thresholds_of


@pytest.fixture(scope="module")
def expected():
    return sweep(MAPS, NAMES, GRIDS, filters=(None, 0.10))


# ------------------------------------------------------------------ what is run


def test_runs_are_those_of_the_methods_run_by_hand(expected):
    """Catches thresholds that do not arrive, and measures against the wrong map."""
    assert len(expected) == 2 * 2 * 4
    for _, run in expected.iterrows():
        before = MAPS[run["map"]]
        before = before.filtered(run["filtered"]) if run["filtered"] else before
        after = METHODS[run["method"]](before, **thresholds_of(run))
        assert (run["n_before"], run["n_after"]) == (len(before), len(after))
        assert run["quality"] == pytest.approx(metrics.quality(before, after), abs=1e-9)
        assert run["reduction"] == pytest.approx(metrics.reduction_rate(before, after), abs=1e-9)
        assert run["seconds"] > 0 and run["digest"] == digest(MAPS[run["map"]])


def test_a_filtered_run_is_measured_against_the_filtered_map(expected):
    """Catches a reduction that counts what the filter has dropped (A 6.2.1)."""
    counts = expected.drop_duplicates(["map", "filtered"]).set_index(["map", "filtered"])
    assert counts["n_before"]["hall", 0] == 70 and counts["n_before"]["hall", 0.1] < 61
    assert select(expected, map="hall", tolerance=0.02)["quality"].nunique() == 2


def test_the_order_is_that_of_the_request(expected):
    """Catches an order by name, by method first, or by time."""
    found = list(zip(expected["map"], expected["filtered"], expected["method"], strict=True))
    assert found == [(m, f, n) for m in MAPS for f in (0, 0.10) for n in NAMES for _ in range(2)]
    hybrid = select(expected, map="hall", method="hybrid")
    assert list(hybrid["distance"]) == [0.1, 0.3, 0.1, 0.3]


def test_a_mapping_of_lists_means_all_combinations():
    """Catches lists that are walked side by side."""
    grid = {"basic_offline": {"angle": [0.1, 0.2], "distance": [0.1, 0.2, 0.3]}}
    found = sweep({"hall": HALL}, ["basic_offline"], grid)[["angle", "distance"]].to_numpy()
    assert found.tolist() == [[a, d] for a in (0.1, 0.2) for d in (0.1, 0.2, 0.3)]


def test_all_methods_run_with_their_defaults_and_those_that_are_none_are_left_out():
    """Catches runs that do not say with what they were made, and whole numbers made floats."""
    found = sweep({"room": ROOM})
    assert list(found["method"]) == list(METHODS)
    runs = {run["method"]: thresholds_of(run) for _, run in found.iterrows()}
    assert runs["fusion"] == {"tolerance": 0.04}
    assert runs["hybrid"] == {"distance": 0.20, "angle": np.pi / 18}
    assert type(runs["hybrid_fusion"]["every"]) is int


def test_a_method_of_ones_own():
    """Catches a sweep that knows only the methods of the library, or takes its own time."""
    grids = {"mine": {"share": [1.0, 0.5]}}
    found = sweep({"hall": HALL.segments}, {"mine": keep_all, "fusion": METHODS["fusion"]}, grids)
    assert list(found["method"]) == ["mine", "mine", "fusion"]
    assert list(found["n_after"])[:2] == [70, 35] and list(found["seconds"])[:2] == [1.25, 1.25]


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ((MAPS, ["fussion"]), "methods must be one of 'basic_offline'.*got 'fussion'"),
        ((MAPS, ["fusion"], {"fussion": [{}]}), "grids must be one of 'fusion', got 'fussion'"),
        ((MAPS, ["fusion"], {"fusion": [{"tolerence": 1}]}), "of tolerance, got tolerence"),
        ((MAPS, ["fusion"], {"fusion": {"tolerance": ["a"]}}), "numbers or None, got 'a'"),
        ((MAPS, {"mine": lambda map, **all: 0}, {"mine": [{"seconds": 1}]}), "threshold 'seconds'"),
        (({"two\nlines": HALL}, ["fusion"]), "names of one line"),
        (({"bad": [[(0, np.nan), (1, 1)]]}, ["fusion"]), r"segments\[0\] is"),
    ],
)
def test_mistakes_are_found_before_anything_runs(arguments, said, monkeypatch):
    """Catches an hour of runs that ends in a spelling mistake."""
    monkeypatch.setattr("segmap.experiments._sweep.run", lambda job: pytest.fail("it ran"))
    with pytest.raises(ValueError, match=said):
        sweep(*arguments)


@pytest.mark.parametrize("least", [0.0, -1.0, np.nan, np.inf])
def test_a_filter_must_be_a_length(least):
    with pytest.raises(ValueError, match=r"filters must be .* in metres, or None"):
        sweep(MAPS, ["fusion"], filters=(least,))


def break_down(map, *, threshold: float = 0.5):
    raise KeyError("something inside")


@pytest.mark.parametrize("where", ["here", "in another process"])
def test_an_error_names_the_run(where):
    """Catches a traceback that leaves one guessing which of 264 runs it was."""
    other = where != "here"
    pool = ProcessPoolExecutor(1, mp_context=get_context("spawn")) if other else None
    said = r"fusion\(hall, tolerance=-1\), filter 0.10 m: ValueError: .*tolerance must be"
    grids, options = {"fusion": [{"tolerance": -1}]}, {"filters": (0.10,), "executor": pool}
    with pytest.raises(ValueError, match=said):
        sweep({"hall": HALL}, ["fusion"], grids, **options)
    with pytest.raises(RuntimeError, match=r"mine\(hall, threshold=0.5\), filter no: KeyError"):
        sweep({"hall": HALL}, {"mine": break_down}, executor=pool)
    if pool:
        pool.shutdown()


def test_seconds_are_the_median_of_the_runs_after_a_first_call():
    """Catches the last run, the mean, and seconds in which compiled loops are loaded."""
    calls, times = [], iter([9.0, 3.0, 1.0, 8.0, 9.0, 5.0, 7.0, 6.0])

    def method(map, *, tolerance: float = 0.1):
        calls.append((len(map), tolerance))
        return replace(keep_all(map), seconds=next(times))

    grids = {"mine": {"tolerance": [0.1, 1]}}  # loops are compiled for whole numbers anew
    found = sweep({"hall": HALL}, {"mine": method}, grids, repeat=3)
    assert calls == [(3, 0.1), *[(70, 0.1)] * 3, (3, 1), *[(70, 1)] * 3]
    assert list(found["seconds"]) == [3.0, 6.0]
    with pytest.raises(ValueError, match=r"repeat must be .* at least 1, got 0"):
        sweep({"hall": HALL}, ["fusion"], repeat=0)


def test_a_method_is_loaded_once_for_all_maps_and_thresholds():
    """Catches a call before each run: a method may be slow on any map."""
    calls = []

    def method(map, *, tolerance: float = 0.1):
        calls.append(len(map))
        return keep_all(map)

    sweep({"hall": HALL, "room": ROOM}, {"mine": method}, {"mine": {"tolerance": [0.1, 0.2]}})
    assert calls == [3, 70, 70, 50, 50]


# ------------------------------------------------------------------ where it is run


def test_a_process_pool_gives_the_same_runs(expected):
    """Catches runs in the order of finishing, and maps that are changed on the way."""
    with ProcessPoolExecutor(2, mp_context=get_context("spawn")) as pool:
        found = sweep(MAPS, NAMES, GRIDS, filters=(None, 0.10), executor=pool)
    assert_frame_equal(without_seconds(found), without_seconds(expected))


def test_dask_gives_the_same_runs(expected, tmp_path):
    """Catches what cannot be sent to a cluster."""
    distributed = pytest.importorskip("distributed")
    options = {"dashboard_address": None, "local_directory": str(tmp_path)}
    with (
        distributed.LocalCluster(n_workers=2, threads_per_worker=1, **options) as cluster,
        distributed.Client(cluster) as client,
    ):
        pool = client.get_executor()
        found = sweep(MAPS, NAMES, GRIDS, filters=(None, 0.10), executor=pool)
    assert_frame_equal(without_seconds(found), without_seconds(expected))


# ------------------------------------------------------------------ what is shown


class Notes(tqdm.tqdm):
    """A bar that takes notes."""

    seen: list

    def update(self, n=1):
        super().update(n)
        self.seen.append((self.n, self.total, self.postfix))


def test_runs_come_back_in_order_though_the_first_ends_last():
    bar = type("Bar", (Notes,), {"seen": []})
    with ThreadPoolExecutor(3) as pool:
        maps, grids = {"<hall>": HALL}, {"mine": {"wait": [0.2, 0.0, 0.0]}}
        found = sweep(maps, {"mine": slow_start}, grids, executor=pool, progress=bar)
    assert list(found["wait"]) == [0.2, 0.0, 0.0]
    assert bar.seen == [(n, 3, "mine on <hall>") for n in (1, 2, 3)]


@pytest.mark.parametrize("where", ["a pipe", "a terminal", "a notebook"])
def test_a_bar_is_shown_only_where_somebody_looks(where, monkeypatch, capsys):
    """The library never prints; a notebook's output is no terminal either."""
    monkeypatch.setattr(sys.stderr, "isatty", lambda: where == "a terminal")
    if where == "a notebook":
        monkeypatch.setattr("tqdm.auto.tqdm", type("tqdm_notebook", (tqdm.tqdm,), {}))
    sweep({"room": ROOM}, ["fusion"], GRIDS)
    assert capsys.readouterr() == ("", "")
    sweep({"room": ROOM}, ["fusion"], GRIDS, progress=True)
    shown = capsys.readouterr().err
    assert ("2/2" in shown and "fusion on room" in shown) == (where != "a pipe")
