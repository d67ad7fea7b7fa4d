"""Sweeps: what they run, in which order, where they run it, and what they show meanwhile."""

from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from contextlib import nullcontext
from dataclasses import replace
from itertools import cycle
from multiprocessing import get_context

import numpy as np
import pytest
from conftest import dask, slow
from pandas.testing import assert_frame_equal
from sweep_samples import GRIDS, HALL, MAPS, NAMES, ROOM, keep_all, slow_start, without_seconds

from segmap import METHODS, metrics
from segmap.experiments import read_records, select, sweep, thresholds_of, write_records
from segmap.progress import told


@pytest.fixture(scope="module")
def expected():
    return sweep(MAPS, NAMES, GRIDS, filters=(None, 0.10))


@pytest.fixture(scope="module")
def spawned():
    """Two processes that know nothing of this one."""
    with ProcessPoolExecutor(2, mp_context=get_context("spawn")) as pool:
        yield pool


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
        wasted, lost = metrics.invented(before, after), metrics.missed(before, after)
        assert (run["invented"], run["missed"]) == pytest.approx((wasted, lost), abs=1e-4)
        assert run["seconds"] > 0


def test_the_order_is_that_of_the_request(expected):
    """Catches an order by name or by method first, and lists of a grid walked side by side."""
    found = list(zip(expected["map"], expected["filtered"], expected["method"], strict=True))
    assert found == [(m, f, n) for m in MAPS for f in (0, 0.10) for n in NAMES for _ in range(2)]
    assert list(select(expected, map="hall", method="hybrid")["distance"]) == [0.1, 0.3, 0.1, 0.3]
    grid = {"basic_offline": {"angle": [0.1, 0.2], "distance": [0.1, 0.2, 0.3]}}
    found = sweep({"hall": HALL}, ["basic_offline"], grid)[["angle", "distance"]].to_numpy()
    assert found.tolist() == [[a, d] for a in (0.1, 0.2) for d in (0.1, 0.2, 0.3)]


def test_all_methods_run_with_their_defaults_and_those_that_are_none_are_left_out(tmp_path):
    """Catches runs that do not say with what they were made, whole numbers made floats, and
    `np.float64(0.1)` or places, which nobody can read back, among the defaults."""
    placed, path = replace(ROOM, sensors=np.ones((ROOM.scan.max() + 1, 2))), tmp_path / "runs.csv"
    found = sweep({"room": placed})
    assert list(found["method"]) == list(METHODS)
    write_records(found, path)
    assert_frame_equal(read_records(path), found)
    runs = {run["method"]: (thresholds_of(run), run["n_after"]) for _, run in found.iterrows()}
    for method, (thresholds, left) in runs.items():
        assert len(METHODS[method](placed, **thresholds)) == left
    assert runs["fusion"][0] == {"tolerance": 0.04}
    wanted = {"distance": 0.20, "angle": np.pi / 18, "min_length": 0.10}
    assert runs["hybrid"][0] == wanted
    assert type(runs["hybrid_fusion"][0]["every"]) is int
    some = {name: METHODS[name] for name in ("fusion", "viewing_sector")}
    assert list(sweep({"room": ROOM}, some)["method"]) == ["fusion"]
    with pytest.raises(ValueError, match=r"map must tell where its sensor was"):
        sweep({"room": ROOM}, ["viewing_sector"])


MISTAKES = [
    ((MAPS, ["fussion"]), {}, "methods must be one of 'basic_offline'.*got 'fussion'"),
    ((MAPS, ["fusion"], {"fussion": [{}]}), {}, "grids must be one of 'fusion', got 'fussion'"),
    ((MAPS, ["fusion"], {"fusion": [{"tolerence": 1}]}), {}, "of tolerance, got tolerence"),
    ((MAPS, ["fusion"], {"fusion": {"tolerance": ["a"]}}), {}, "numbers or None, got 'a'"),
    ((MAPS, {"mine": lambda map, **all: 0}, {"mine": [{"seconds": 1}]}), {}, "threshold 'seconds'"),
    (({"bad": [[(0, np.nan), (1, 1)]]}, ["fusion"]), {}, r"maps\['bad'\]\[0\] is"),
    ((MAPS, ["fusion"]), {"repeat": 0}, "repeat must be .* at least 1 .*, got 0"),
    *(
        ((MAPS, ["fusion"]), {"filters": (None, least)}, "filters must be .* in metres, or None")
        for least in (0.0, -1.0, np.nan, np.inf)
    ),
]


@pytest.mark.parametrize(("arguments", "options", "said"), MISTAKES)
def test_mistakes_are_found_before_anything_runs(arguments, options, said):
    """Catches an hour of runs that ends in a spelling mistake."""
    pool = ThreadPoolExecutor(1, initializer=pytest.fail, initargs=("it ran",))
    with pool, pytest.raises(ValueError, match=said):
        sweep(*arguments, **options, executor=pool)


def break_down(map, *, threshold: float = 0.5):
    raise KeyError("something inside")


def test_an_error_names_the_run_here_and_in_another_process(spawned):
    """Catches a traceback that leaves one guessing which of 264 runs it was."""
    said = r"fusion\(hall, tolerance=-1\), filter 0.10 m: ValueError: .*tolerance must be"
    grids = {"fusion": [{"tolerance": -1}]}
    for pool in (None, spawned):
        with pytest.raises(ValueError, match=said):
            sweep({"hall": HALL}, ["fusion"], grids, filters=(0.10,), executor=pool)
        with pytest.raises(RuntimeError, match=r"mine\(hall, threshold=0.5\), filter no: KeyError"):
            sweep({"hall": HALL}, {"mine": break_down}, executor=pool)


def test_seconds_are_the_median_of_the_runs_after_one_call():
    """Catches the last run, the mean, and seconds in which loops are loaded."""
    times = cycle([3.0, 1.0, 8.0])

    def method(map, *, tolerance: float = 0.1):
        return replace(keep_all(map), seconds=99.0 if len(map) == 3 else next(times))

    grid = {"tolerance": [0.1, 0.2, 1]}  # loops are compiled for whole numbers anew
    found = sweep({"hall": HALL, "room": ROOM}, {"mine": method}, {"mine": grid}, repeat=3)
    assert list(found["seconds"]) == [3.0] * 6


# ------------------------------------------------------------------ where it is run


@pytest.mark.parametrize("kind", ["processes", slow("dask")])
def test_a_pool_gives_the_same_runs(kind, expected, tmp_path, spawned):
    """Catches runs in the order of finishing, and what cannot be sent to a process or cluster."""
    with dask(tmp_path) if kind == "dask" else nullcontext(spawned) as pool:
        found = sweep(MAPS, NAMES, GRIDS, filters=(None, 0.10), executor=pool)
    assert_frame_equal(without_seconds(found), without_seconds(expected))


# ------------------------------------------------------------------ what is shown


def test_methods_of_ones_own_come_back_in_order_though_the_first_ends_last():
    """Catches a sweep that knows only the methods of the library, or takes its own time."""
    seen, grids = [], {"mine": {"wait": [0.2, 0.0, 0.0]}, "half": {"share": [1.0, 0.5]}}
    methods = {"mine": slow_start, "half": keep_all, "fusion": METHODS["fusion"]}
    with ThreadPoolExecutor(3) as pool, told(lambda *news: seen.append(news)):
        found = sweep({"<hall>": HALL.segments}, methods, grids, executor=pool)
    assert list(found["method"]) == ["mine"] * 3 + ["half"] * 2 + ["fusion"]
    assert list(found["wait"])[:3] == [0.2, 0.0, 0.0] and [share for share, _ in seen] == [
        k / 6 for k in range(1, 7)
    ]
    assert list(found["n_after"])[:5] == [70, 70, 70, 70, 35] and set(found["seconds"][:5]) == {
        1.25
    }
