"""A map against true walls: kept, missed, invented, doubled."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from reduction_maps import MAPS, grid_map
from segmap_course import literal
from segmap_course.literal.metrics import covered, joined_walls, owned_pieces

from segmap import simulation
from segmap.metrics import against_walls
from segmap.poses import transform
from segmap.segments import length, point_distance

ROOM = simulation.rectangular_room(4, 3)
FIELDS = ("missed", "invented", "doubled", "per_wall", "found", "offset", "angle")


def values(found) -> np.ndarray:
    return np.array([np.sum(getattr(found, name)) for name in FIELDS])


def plainly(whole, segments, distance=0.10, angle=np.radians(5), least=0.0):
    """What the plain loops say: pieces, their owners, and the spans on each wall."""
    pieces, owners, spans = [], [], [[] for _ in whole]
    for s in segments[length(segments) >= 1e-9]:
        for a, b, k, _ in owned_pieces(whole.tolist(), s.tolist(), distance, angle):
            pieces.append(s[0] + np.outer((a, b), s[1] - s[0]))
            owners.append(k)
            if k >= 0:
                way = (whole[k, 1] - whole[k, 0]) / length(whole[k])
                spans[k].append(tuple(sorted((pieces[-1] - whole[k, 0]) @ way)))
    return np.reshape(pieces, (-1, 2, 2)), owners, spans


LIMITS = [{}, {"distance": 0.25, "angle": 0.5}, {"distance": 0.25, "least": 0.25}, {"least": 1.0}]


@given(st.integers(0, 10_000), st.sampled_from(LIMITS), st.booleans())
@settings(max_examples=60, deadline=None)
def test_equals_the_plain_version(seed, limits, is_seen):
    """Another strip, a wall that owns by its index, a span that is not joined, a limit left out."""
    rng = np.random.default_rng(seed)
    kinds = [*MAPS, grid_map]
    walls, map, looks = (kinds[(seed + k * (seed // 5 % 2)) % 5](rng, 12) for k in range(3))
    given = {"seen": looks} if is_seen else {}
    found = against_walls(walls, map, **given, **limits)
    whole = np.reshape(joined_walls(walls.tolist()), (-1, 2, 2))
    np.testing.assert_allclose(found.walls, whole, atol=1e-9)
    pieces, owners, own = plainly(whole, map, **limits)
    np.testing.assert_allclose(found.pieces, pieces, atol=1e-6)
    np.testing.assert_array_equal(found.owner, owners)
    known = plainly(whole, looks, **limits)[2] if is_seen else [[(0.0, w)] for w in length(whole)]
    for k, (looked, spans) in enumerate(zip(known, own, strict=True)):
        both = covered(looked) + covered(spans) - covered(looked + spans)
        double = sum(high - low for low, high in spans) - covered(spans)
        here = found.seen[k], found.kept[k], found.doubled[k]
        assert here == pytest.approx((covered(looked), both, double), abs=1e-6)
        at = rng.uniform(0, 1, 9)
        points = whole[k, 0] + np.outer(at, whole[k, 1] - whole[k, 0])
        at *= length(whole[k])
        seen, times = (
            sum(((a <= at) & (at <= b) for a, b in each), np.zeros(9)) for each in (looked, spans)
        )
        for stretches, wanted in (
            (found.lost, (seen > 0) & (times == 0)),
            (found.twice, times > 1),
        ):
            away = point_distance(points[:, None], stretches).min(axis=1, initial=np.inf)
            np.testing.assert_array_equal(away < 1e-9, wanted)
    if np.isfinite(found.per_wall):
        plain = literal.against_walls(
            walls.tolist(),
            map.tolist(),
            **{name: s.tolist() for name, s in given.items()},
            **limits,
        )
        wanted = [plain[name] for name in FIELDS]
        np.testing.assert_allclose(values(found), wanted, atol=1e-6, equal_nan=True)


def test_a_line_in_the_middle_of_two_walls_belongs_to_the_first():
    """However the building lies: catches rounding that chooses."""
    walls, line = [[(0, 0), (3, 0)], [(0, 0.10), (3, 0.10)]], [[(0, 0.05), (3, 0.05)]]
    for turn in np.linspace(0, 6, 25):
        to = (7.0, -2.0, turn)
        found = against_walls(transform(to, walls), transform(to, line))
        np.testing.assert_array_equal(found.owner, [0])


def test_at_a_right_angle_every_direction_is_beside():
    """However the building lies: rounding turns none by more."""
    walls, across = [[(0, 0), (3, 0)]], [[(1, -0.05), (1, 0.04)]]
    for turn in np.linspace(0, 6, 50):
        turned = (transform((7.0, -2.0, turn), each) for each in (walls, across))
        found = against_walls(*turned, angle=np.pi / 2)
        assert found.invented == 0 and found.angle == pytest.approx(np.pi / 2)


@pytest.mark.parametrize(("rise", "beside"), [(0.02, True), (0.049, True), (0.08, False)])
def test_a_stub_may_be_turned_by_more_than_the_angle(rise, beside):
    """Five degrees of 20 cm are 17 mm: noise alone would reject each stub."""
    found = against_walls(ROOM, [[(1, 0), (1.2, rise)]])
    assert (found.invented == 0) == beside


def test_nothing_to_judge_by_is_refused():
    with pytest.raises(ValueError, match="walls must hold a segment that has a length"):
        against_walls([[(1, 1), (1, 1)]], ROOM)
    empty = against_walls(ROOM, np.empty((0, 2, 2)))
    assert empty.missed == pytest.approx(14) and empty.per_wall == 0 and np.isnan(empty.offset)
