"""What is particular to Basic: strict thresholds, and a piece beside the middle of a wall."""

import numpy as np
import pytest

from segmap.reduction import basic_offline, hybrid


def test_end_points_exactly_a_distance_apart_do_not_match():
    """Both tests are strict (A 4.1)."""
    walls = np.array([[(0, 0), (1, 0)], [(1.25, 0), (2, 0)]])
    assert len(basic_offline(walls, distance=0.25)) == 2
    assert len(basic_offline(walls, distance=0.2500001)) == 1


def test_weakness_a_piece_in_the_middle_of_a_wall_is_never_merged():
    """The counter-example of A fig. 4.4: all end points are far."""
    assert len(basic_offline(np.array([[(0, 0), (5, 0)], [(2, 0), (3, 0)]]))) == 2


@pytest.mark.parametrize("method", [basic_offline, hybrid])
def test_two_lines_differ_by_a_quarter_turn_at_most(method):
    wall = [[(0, 0), (1, 0)]]
    assert len(method(wall, angle=np.pi / 2)) == 1
    with pytest.raises(ValueError, match=r"^angle must be"):
        method(wall, angle=1.6)
