"""What a user types by a slip is answered with the line that was meant."""

import numpy as np
import pytest

import segmap
from segmap import alignment, reduction
from segmap.reduction import Reduction
from segmap.simulation import box

FULL = np.concatenate([box(4, 3), box(4, 3) + 0.01])


@pytest.mark.parametrize(
    ("call", "kind", "words"),
    [
        (lambda: reduction.least_cost(FULL, 0.3), TypeError, r"least_cost\(..., penalty=0.3\)"),
        (lambda: reduction.METHODS["lest_cost"], KeyError, "'lest_cost': least_cost?"),
        (lambda: alignment.METHODS["posegraph"], KeyError, "'posegraph': pose_graph?"),
        (lambda: segmap.load("/my.log.gz"), ValueError, r"segmap.read\(path\) reads a file"),
    ],
)
def test_a_slip_is_answered_with_what_was_meant(call, kind, words):
    with pytest.raises(kind, match=words):
        call()


def test_a_quality_of_maps_in_the_wrong_order_is_told():
    """Catches a quality of 98 % that says how well the full map keeps the reduced one."""
    reduced = segmap.fusion(FULL, tolerance=0.04)
    assert segmap.quality(FULL, reduced) > 0.5
    with pytest.warns(UserWarning, match=r"quality\(before, after\)"):
        segmap.quality(reduced, FULL)


def test_a_reduction_of_ones_own_needs_no_stopwatch():
    own = Reduction(FULL[:4], np.tile(np.arange(4), 2))
    assert np.isnan(own.seconds) and repr(own) == "Reduction(8 -> 4 segments)"
    assert list(own.members(3)) == [3, 7]
