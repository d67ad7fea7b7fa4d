"""Work on all cores: the same results as on one, in the same order."""

import threading

import numpy as np
import pytest

from segmap import load, threads
from segmap.alignment import pose_graph
from segmap.threads import in_threads


@pytest.fixture
def three(monkeypatch):
    monkeypatch.setattr(threads, "cores", lambda: 3)


def test_what_is_found_comes_in_the_order_of_the_things(three):
    """The order in which threads end: here the first waits for the last."""
    last = threading.Event()

    def work(thing: int) -> int:
        assert thing > 0 or last.wait(10)
        if thing == 2:
            last.set()
        return thing * thing

    assert in_threads(work, range(3)) == [0, 1, 4]
    assert in_threads(work, []) == []


def test_one_core_or_one_thing_needs_no_thread(monkeypatch, three):
    here = threading.get_ident()
    assert in_threads(lambda _: threading.get_ident(), [1]) == [here]
    assert here not in in_threads(lambda _: threading.get_ident(), [1, 2])
    monkeypatch.setattr(threads, "cores", lambda: 1)
    assert in_threads(lambda _: threading.get_ident(), [1, 2]) == [here, here]


def test_an_error_ends_it_and_what_has_not_begun_is_left(three):
    """An interrupt that waits until all scans of a long drive are refined."""
    begun, go = [], threading.Event()

    def work(thing: int) -> None:
        begun.append(thing)
        if thing == 0:
            raise KeyboardInterrupt
        go.wait(0.2)

    with pytest.raises(KeyboardInterrupt):
        in_threads(work, range(500))
    assert len(begun) < 100


def test_threads_or_none_give_the_same_poses(monkeypatch, three):
    """Maps that two threads write to at once, a scan that gets the pose of another."""
    log, found = load("corridor"), []
    for count in (3, 1):
        monkeypatch.setattr(threads, "cores", lambda count=count: count)
        found.append(pose_graph(log, step=1.2))
    assert found[0].graph.loop.any()
    np.testing.assert_allclose(found[0].poses, found[1].poses, rtol=0, atol=1e-9)
    assert found[0].reasons == found[1].reasons
