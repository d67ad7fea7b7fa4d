"""Merging one to many, and drawing again, as chapter 22 prints it (Wen et al. 2020)."""

import numpy as np
from segmap_course.literal.reduction.one_to_many import drawn_again, one_to_many

#: Two pieces of a wall with a gap of 1 m, then a look that lies along both.
PIECES = [((0, 0), (1, 0)), ((2, 0), (3, 0)), ((0.5, 0.05), (2.5, 0.05))]


def test_a_look_joins_all_walls_that_it_lies_along():
    """Catches a look that goes into the first wall only, and a wall drawn from two walls alone."""
    walls, wall_of = one_to_many(PIECES, [0, 0, 1])
    assert wall_of == [0, 0, 0]
    np.testing.assert_allclose(walls, [[(0, 0.05 / 3), (3, 0.05 / 3)]], atol=1e-12)
    assert one_to_many(PIECES[:2], [0, 1])[1] == [0, 1]


def test_faces_and_thresholds_keep_walls_apart():
    """Catches a thin wall whose two faces become one, and thresholds that are not asked."""
    one = ((0, 0), (1, 0))
    turned = ((0, 0), (np.cos(0.1), np.sin(0.1)))
    for other in (one[::-1], ((0, 0.11), (1, 0.11)), ((1.11, 0), (2, 0)), turned):
        assert one_to_many([one, other], [0, 1])[1] == [0, 1]
    assert one_to_many([one, ((1.09, 0.09), (2, 0.09))], [0, 1])[1] == [0, 0]


def test_walls_go_where_their_members_went():
    """Catches a wall that is drawn again from the old places, and one that is asked anew."""
    _, wall_of = one_to_many(PIECES, [0, 0, 1])
    shifted = [tuple((x + 5, y - 2) for x, y in piece) for piece in PIECES]
    np.testing.assert_allclose(
        drawn_again(shifted, wall_of), [[(5, -2 + 0.05 / 3), (8, -2 + 0.05 / 3)]]
    )
    apart = [PIECES[0], ((2, 9), (3, 9)), PIECES[2]]
    assert len(drawn_again(apart, wall_of)) == 1
