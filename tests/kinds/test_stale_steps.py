"""What is kept of the run before, where choices change: the outcome is as if nothing had been."""

from dataclasses import replace

import numpy as np
import pytest

from segmap import alignment, extraction, load, reduction
from segmap._call import Call
from segmap._map_pipeline import MapChoices, follow

LOG = load("room")[:8]
FUSION = Call("fusion", reduction.METHODS["fusion"].function)
FIRST = MapChoices(Call("odometry", alignment.METHODS["odometry"].function), methods=[FUSION])
#: A recipe that differs in one choice; the second of a pair may be the first again.
CHANGED = {
    "prepare": {"prepare": {"clockwise": True}},
    "as it is": {"prepare": None},
    "align": {"align": Call("segment_icp", alignment.METHODS["segment_icp"].function)},
    "extract": {"extract": Call("extract_clusters", extraction.METHODS["extract_clusters"])},
    "passers": {"seen_through": 0.9},
    "points": {"methods": [Call("mean_shift", reduction.METHODS["mean_shift"].function),
                           Call("viewing_sector", reduction.METHODS["viewing_sector"].function)]},
    "turned": {"edits": {"square": True}},
    "crop": {"edits": {"crop": [0.0, 0.0, 3.0, 9.0]}},
    "filter": {"least": 0.5},
}  # fmt: skip


def told(outcome):
    """All that is made, step by step."""
    yield "log", np.concatenate([scan.points() for scan in outcome.log])
    yield "poses", outcome.alignment.poses
    yield "map", outcome.map.segments
    for reduced in outcome.reductions:
        yield "reduced", reduced.segments
    yield "quality", np.array(outcome.qualities)


@pytest.mark.parametrize("change", CHANGED.values(), ids=CHANGED)
def test_each_choice_changes_what_hangs_on_it_and_comes_back(change):
    """Catches a step of the run before that is kept though what it hangs on has changed."""
    first, fresh = follow(FIRST, LOG), follow(replace(FIRST, **change), LOG)
    then = follow(replace(FIRST, **change), LOG, first)
    back = follow(FIRST, LOG, then)
    for found, wanted in ((then, fresh), (back, first)):
        for (step, one), (_, other) in zip(told(found), told(wanted), strict=True):
            np.testing.assert_array_equal(one, other, step)
