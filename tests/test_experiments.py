"""Sweeps: what they run, in which order, what they keep when stopped, and the files they write."""

import sys
import types
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from dataclasses import replace
from multiprocessing import get_context

import numpy as np
import pytest
from sweep_samples import GRIDS, HALL, MAPS, NAMES, ROOM, keep_all, slow_start, without_seconds

from segmap import METHODS, metrics
from segmap.experiments import digest, sweep


@pytest.fixture(scope="module")
def expected():
    return sweep(MAPS, NAMES, GRIDS, filters=(None, 0.10))


# ------------------------------------------------------------------ what is run


def test_records_are_those_of_the_methods_run_by_hand(expected):
    """Catches thresholds that do not arrive, and measures against the wrong map."""
    assert len(expected) == 2 * 2 * 4
    for record in expected:
        before = MAPS[record.map]
        before = before if record.filtered is None else before.filtered(record.filtered)
        after = METHODS[record.method](before, **record.thresholds)
        assert (record.n_before, record.n_after) == (len(before), len(after))
        assert record.quality == pytest.approx(metrics.quality(before, after), abs=1e-9)
        assert record.reduction == pytest.approx(metrics.reduction_rate(before, after), abs=1e-9)
        assert record.seconds > 0 and record.digest == digest(MAPS[record.map])


def test_a_filtered_run_is_measured_against_the_filtered_map(expected):
    """Catches a reduction that counts what the filter has dropped (A 6.2.1)."""
    counts = {(r.map, r.filtered): r.n_before for r in expected}
    assert counts["hall", None] == 70 and counts["hall", 0.10] < 61
    assert len({record.quality for record in expected.select(map="hall", tolerance=0.02)}) == 2


def test_the_order_is_that_of_the_request(expected):
    """Catches an order by name, by method first, or by time."""
    found = [(r.map, r.filtered, r.method) for r in expected]
    wanted = [(m, f, n) for m in MAPS for f in (None, 0.10) for n in NAMES for _ in range(2)]
    assert found == wanted
    assert [r.thresholds["distance"] for r in expected.select(map="hall", method="hybrid")] == [
        *(0.1, 0.3),
        *(0.1, 0.3),
    ]


def test_a_mapping_of_lists_means_all_combinations():
    """Catches lists that are walked side by side."""
    grid = {"basic_offline": {"angle": [0.1, 0.2], "distance": [0.1, 0.2, 0.3]}}
    found = sweep({"hall": HALL}, ["basic_offline"], grid)
    pairs = [(r.thresholds["angle"], r.thresholds["distance"]) for r in found]
    assert pairs == [(a, d) for a in (0.1, 0.2) for d in (0.1, 0.2, 0.3)]


def test_defaults_are_filled_in_and_none_is_left_out():
    """Catches records that do not say with what they were made."""
    fused, mixed = sweep({"hall": HALL}, ["fusion", "hybrid"])
    assert fused.thresholds == {"tolerance": 0.04}
    assert mixed.thresholds == {"distance": 0.20, "angle": np.pi / 18}


def test_all_methods_are_the_default():
    assert [r.method for r in sweep({"room": ROOM})] == list(METHODS)


def test_a_method_of_ones_own():
    """Catches a sweep that knows only the methods of the library, or takes its own time."""
    grids = {"mine": {"share": [1.0, 0.5]}}
    found = sweep({"hall": HALL.segments}, {"mine": keep_all, "fusion": METHODS["fusion"]}, grids)
    assert [(r.method, r.n_after) for r in found[:2]] == [("mine", 70), ("mine", 35)]
    assert [r.seconds for r in found[:2]] == [1.25, 1.25] and found[2].method == "fusion"


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ((MAPS, ["fussion"]), "methods must be of basic_offline.*got 'fussion'"),
        ((MAPS, ["fusion"], {"fussion": [{}]}), "grids must be for fusion, got 'fussion'"),
        ((MAPS, ["fusion"], {"fusion": [{"tolerence": 1}]}), "of tolerance, got tolerence"),
        ((MAPS, ["fusion"], {"fusion": {"tolerance": ["a"]}}), "numbers or None, got 'a'"),
        (({"two\nlines": HALL}, ["fusion"]), "names of one line"),
        (({"bad": [[(0, np.nan), (1, 1)]]}, ["fusion"]), "segment 0 is"),
    ],
)
def test_mistakes_are_found_before_anything_runs(arguments, said, monkeypatch):
    """Catches an hour of runs that ends in a spelling mistake."""
    monkeypatch.setattr("segmap.experiments._sweep.run", lambda job: pytest.fail("it ran"))
    with pytest.raises(ValueError, match=said):
        sweep(*arguments)


@pytest.mark.parametrize("least", [0.0, -1.0, np.nan, np.inf])
def test_a_filter_must_be_a_length(least):
    with pytest.raises(ValueError, match="filters must be None or positive lengths"):
        sweep(MAPS, ["fusion"], filters=(least,))


def break_down(map, *, threshold: float = 0.5):
    raise KeyError("something inside")


def test_an_error_names_the_run():
    """Catches a traceback that leaves one guessing which of 264 runs it was."""
    said = r"fusion\(hall, tolerance=-1\), filter 0.10 m: ValueError: tolerance must be "
    with pytest.raises(ValueError, match=said):
        sweep({"hall": HALL}, ["fusion"], {"fusion": [{"tolerance": -1}]}, filters=(0.10,))
    with pytest.raises(RuntimeError, match=r"mine\(hall, threshold=0.5\), filter no: KeyError"):
        sweep({"hall": HALL}, {"mine": break_down})


def test_the_first_call_is_not_timed():
    """Catches seconds that hold the loading of compiled loops."""
    calls = []

    def method(map, *, tolerance: float = 0.1):
        calls.append(len(map))
        return keep_all(map)

    sweep({"hall": HALL, "room": ROOM}, {"mine": method}, {"mine": {"tolerance": [0.1, 0.2]}})
    assert calls == [3, 70, 70, 50, 50]


def test_seconds_are_the_median_of_the_runs():
    """Catches the last run, the mean, and a warm-up that is counted."""
    times = iter([9.0, 3.0, 1.0, 8.0])

    def method(map):
        return replace(keep_all(map), seconds=next(times))

    assert sweep({"hall": HALL}, {"mine": method}, repeat=3)[0].seconds == 3.0
    with pytest.raises(ValueError, match="repeat must be at least 1, got 0"):
        sweep({"hall": HALL}, ["fusion"], repeat=0)


# ------------------------------------------------------------------ where it is run


def test_a_process_pool_gives_the_same_records(expected):
    """Catches records in the order of finishing, and maps that are changed on the way."""
    with ProcessPoolExecutor(2, mp_context=get_context("spawn")) as pool:
        found = sweep(MAPS, NAMES, GRIDS, filters=(None, 0.10), executor=pool)
    assert without_seconds(found) == without_seconds(expected)


def test_an_error_of_another_process_names_the_run():
    """Catches errors that do not survive the way between processes."""
    with (
        ProcessPoolExecutor(1, mp_context=get_context("spawn")) as pool,
        pytest.raises(ValueError, match=r"fusion\(hall, tolerance=-1\)"),
    ):
        sweep({"hall": HALL}, ["fusion"], {"fusion": [{"tolerance": -1}]}, executor=pool)


def test_dask_gives_the_same_records(expected, tmp_path):
    """Catches what cannot be sent to a cluster."""
    distributed = pytest.importorskip("distributed")
    with (
        distributed.LocalCluster(
            n_workers=2,
            threads_per_worker=1,
            dashboard_address=None,
            local_directory=str(tmp_path),
        ) as cluster,
        distributed.Client(cluster) as client,
    ):
        pool = client.get_executor()
        found = sweep(MAPS, NAMES, GRIDS, filters=(None, 0.10), executor=pool)
    assert without_seconds(found) == without_seconds(expected)


def test_records_come_back_in_order_though_the_first_ends_last():
    grids = {"mine": {"wait": [0.2, 0.0, 0.0]}}
    seen = []
    with ThreadPoolExecutor(3) as pool:
        found = sweep(
            {"hall": HALL},
            {"mine": slow_start},
            grids,
            executor=pool,
            progress=lambda done, total, record: seen.append(record),
        )
    assert [r.thresholds["wait"] for r in found] == [0.2, 0.0, 0.0]
    assert seen[0] is None and [r.thresholds["wait"] for r in seen[1:]] == [0.0, 0.0, 0.2]


# ------------------------------------------------------------------ what is shown


def test_nothing_is_shown_unless_asked_for(capfd):
    """The library never prints; nor does a bar where nobody looks (a pipe, a test)."""
    sweep({"room": ROOM}, ["fusion"])
    sweep({"room": ROOM}, ["fusion"], progress=True)
    assert capfd.readouterr() == ("", "")


def test_a_terminal_gets_one_line_that_grows(monkeypatch, capsys):
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    sweep({"room": ROOM}, ["fusion"], GRIDS, progress=True)
    lines = capsys.readouterr().err.split("\r")[1:]
    assert [line[:32].count("#") for line in lines] == [0, 15, 30]
    assert "1 of 2: fusion on room" in lines[1] and lines[-1].endswith("\n")


def test_a_notebook_gets_a_bar_that_is_replaced(monkeypatch):
    """Catches a new output for each step, and a name of a map taken for HTML."""
    shown = []
    handle = types.SimpleNamespace(update=shown.append)
    display = types.SimpleNamespace(HTML=str, display=lambda first, display_id: handle)
    shell = types.SimpleNamespace(kernel=object())
    ipython = types.SimpleNamespace(get_ipython=lambda: shell, display=display)
    monkeypatch.setitem(sys.modules, "IPython", ipython)
    sweep({"<b>": ROOM}, ["fusion"], GRIDS, progress=True)
    assert [text.split('"')[1] for text in shown] == ["0", "1", "2"]
    assert 'max="2"' in shown[0] and shown[-1].endswith("2 of 2: fusion on &lt;b&gt;")
