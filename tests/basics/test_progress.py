"""What long work tells of itself, and how whoever listens stops it."""

import gzip
from functools import partial

import alignment_logs as logs
import numpy as np
import pytest
from reduction_maps import malaga

from segmap import alignment, build_map, exports, load, matching, readers, reduction
from segmap.progress import announce, each, parts, told
from segmap.threads import in_threads

LOG = load("room")[:12]


class Stop(Exception):
    """What a listener raises."""


def heard(work):
    """What work tells: pairs of shares and words."""
    said = []
    work(progress=lambda share, words: said.append((share, words)))
    return said


def lines_of(log, path, pack=open):
    """A log of many lines."""
    exports.write_carmen(path.with_suffix(".once"), log)
    with pack(path, "wb") as file:
        file.write(path.with_suffix(".once").read_bytes() * 100)
    return path


WORK = {
    "graph": partial(alignment.pose_graph, LOG),
    "merged": partial(matching.merge, LOG[:6], LOG[6:]),
    "deskewed": partial(alignment.deskew, logs.moving_log()),
    "by_scan": partial(reduction.basic_online, build_map(LOG, LOG.truth)),
    "member": partial(reduction.METHODS["fusion_online"], build_map(LOG, LOG.truth)),
    "least_cost": partial(reduction.least_cost, malaga()),
    "one_per_wall": partial(reduction.one_per_wall, malaga()),
}


@pytest.mark.parametrize("work", WORK.values(), ids=WORK)
def test_long_work_tells_each_step_and_stops_where_it_is_told_to(work):
    """Catches work in silence, a share above one, and a stop that is swallowed."""
    work()  # from now on nothing is left to compile, which would be told as well
    said = heard(work)
    shares, words = zip(*said, strict=True)
    assert min(shares) == 0.0 and max(shares) <= 1.0 and len(set(words)) > 8

    def stop(share, words):
        if share >= 0.5:
            raise Stop(words)

    with pytest.raises(Stop):
        work(progress=stop)
    assert heard(work) == said  # nobody listens any more, and nothing is left behind


@pytest.mark.parametrize("pack", [open, gzip.open])
def test_reading_tells_how_much_of_the_file_is_read(pack, tmp_path):
    """Catches a share of the unpacked bytes, and one that never comes to its end."""
    path = lines_of(LOG, tmp_path / "it.log", pack)
    shares = [share for share, _ in heard(partial(readers.read, path))]
    assert len(shares) > 3 and shares == sorted(shares) and 0.5 < shares[-1] <= 1.0


def test_a_listener_is_for_what_is_called_within():
    """Catches one that hears on, and an inner one that takes the place of the outer for ever."""
    outer, inner = [], []
    with told(lambda share, words: outer.append(words)):
        announce(0.0, "a")
        for fault in (ValueError, KeyboardInterrupt):
            with pytest.raises(fault), told(lambda share, words: inner.append(words)):
                announce(0.0, "b")
                raise fault
        announce(0.0, "c")
    announce(0.0, "d")
    assert (outer, inner) == (["a", "c"], ["b", "b"])
    with pytest.raises(ValueError, match="progress must be a function of a share and words, got 3"):
        alignment.pose_graph(LOG, progress=3)


def test_each_thing_is_told_before_it_comes():
    """Catches a count from zero, a share that is ahead, and a thing that is lost."""
    said = []
    with told(lambda *words: said.append(words)):
        for thing in each("ab", "part"):
            said.append(thing)
        for some in parts(np.arange(4, 8), "row", size=3):
            said.append(some.tolist())
    assert said[:4] == [(0.0, "part 1 of 2"), "a", (0.5, "part 2 of 2"), "b"]
    assert said[4:6] == [(0.0, "row 1 of 4"), [4, 5, 6]]
    assert said[6:] == [(0.75, "row 4 of 4"), [7], (1.0, "row 4 of 4")]


def test_threads_tell_how_many_are_done_and_begin_no_more_once_stopped():
    """Catches a stop that waits for all that was handed to the threads."""
    said, begun = [], []

    def work(k):
        begun.append(k)
        return np.linalg.norm(np.ones(k + 1))

    with told(lambda share, words: said.append(share)):
        in_threads(work, range(4), "it")
    assert said == [0.25, 0.5, 0.75, 1.0]

    def stop(share, words):
        raise Stop

    begun.clear()
    with told(stop), pytest.raises(Stop):
        in_threads(work, range(2_000), "it")
    assert len(begun) < 2_000
