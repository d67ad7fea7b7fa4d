"""Metres invented and missed, and walls drawn twice: what quality does not see."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from reduction_maps import MAPS

from segmap.angles import wrap
from segmap.metrics import doubled_walls, invented, missed
from segmap.poses import transform
from segmap.segments import SegmentMap, length
from segmap.simulation import rectangular_room

WALL = np.array([[(0.0, 0.0), (2.0, 0.0)], [(2.5, 0.0), (4.0, 0.0)]])


def alone(map, other, distance: float, angle: float, samples: int = 400) -> float:
    """Points of a map whose normal meets no segment of the other within the distance."""
    metres = 0.0
    for u in map:
        size = float(length(u[None])[0])
        if size < 1e-9:
            continue
        dx, dy = (u[1] - u[0]) / size
        found = np.zeros(samples, bool)
        t = (np.arange(samples) + 0.5) / samples * size
        for v in other:
            vx, vy = v[1] - v[0]
            if np.hypot(vx, vy) < 1e-9:
                continue
            if abs(dx * vy - dy * vx) > np.sin(angle) * np.hypot(vx, vy):
                continue
            p = (v - u[0]) @ np.array([(dx, -dy), (dy, dx)])  # along and across
            share = (t - p[0, 0]) / (p[1, 0] - p[0, 0])
            off = p[0, 1] + share * (p[1, 1] - p[0, 1])
            found |= (share >= 0) & (share <= 1) & (np.abs(off) <= distance)
        metres += size * np.count_nonzero(~found) / samples
    return metres


@given(st.integers(0, 10_000), st.sampled_from([(0.05, 0.1), (0.2, 0.5), (0.01, 1.5)]))
@settings(max_examples=30, deadline=None)
def test_equals_what_points_along_the_segments_see(seed, limits):
    """Another strip, an angle that wraps, spans that are not joined, a neighbour left out."""
    rng = np.random.default_rng(seed)
    before, after = (MAPS[(seed + k) % 4](rng, 20) for k in (0, seed % 2))
    distance, angle = limits
    room = 2.0 * len(before) * len(after) / 400 * 0.05 + 0.02
    for found, expected in (
        (missed(before, after, distance=distance, angle=angle), alone(before, after, *limits)),
        (invented(before, after, distance=distance, angle=angle), alone(after, before, *limits)),
    ):
        assert found == pytest.approx(expected, abs=room)


def test_beside_is_five_centimetres_and_five_degrees_where_nothing_is_said():
    """Catches other thresholds by default."""
    wall, stub = np.array([[[(0.0, 0.0), (2.0, 0.0)]], [[(0.0, 0.0), (0.0, 0.02)]]])
    for off, is_alone in ((0.049, 0), (0.051, 1)):
        for one, way, size in ((wall, (0, off), 2.0), (stub, (off, 0), 0.02)):
            assert invented(one, one + way) == missed(one, one + way) == is_alone * size
    for degrees, alone in ((4.9, 0.0), (5.1, 0.2)):
        turned = transform((1, 0, np.radians(degrees)), np.array([[(0.0, 0.0), (0.2, 0.0)]]))
        found = (invented(wall, turned), missed(turned, wall))
        assert found == pytest.approx((alone, alone), abs=1e-9)


def test_nothing_is_beside_an_empty_map():
    assert missed(WALL, []) == pytest.approx(3.5) and invented(WALL, []) == 0.0
    assert missed([], WALL) == 0.0 and invented([], WALL) == pytest.approx(3.5)


# ------------------------------------------------------------------------ walls drawn twice
SEEN_FROM = [(2.0, 1.5)] * 8


def rooms(*shifts):
    """A room of 4 m by 3 m, drawn twice as seen from two places in it; all moved each time."""
    walls = [rectangular_room(4, 3) + shift for shift in shifts for _ in range(4)]
    return SegmentMap(np.concatenate(walls), np.repeat(np.arange(4 * len(shifts)), 4))


def twice(map, sensors, nearest=0.15, farthest=0.50, angle=np.radians(10), looks=3):
    """`doubled_walls`, piece by piece."""
    cells, places = {}, []
    for (p, q), scan in zip(map.segments, map.scan.tolist(), strict=True):
        along, count = q - p, max(int(np.ceil(np.hypot(*(q - p)) / 0.1)), 1)
        facing = np.arctan2(along[0], -along[1])
        if np.dot((-along[1], along[0]), sensors[scan] - (p + q) / 2) < 0:
            facing += np.pi
        for k in range(count):
            place = p + (k + 0.5) / count * along
            way = round(wrap(facing) / angle) % round(2 * np.pi / angle)
            cell = *np.floor(place / 0.1).astype(int).tolist(), way
            cells.setdefault(cell, {}).setdefault(scan, (place, facing))
    seen = [scans[min(scans)] for scans in cells.values() if len(scans) >= looks]
    for place, facing in seen:
        for other, also in seen:
            turn, (x, y) = wrap(also - facing), other - place
            c, s = np.cos(facing + turn / 2), np.sin(facing + turn / 2)
            beside = nearest < abs(x * c + y * s) < farthest and abs(y * c - x * s) < 0.1
            if beside and abs(turn) <= angle:
                places.append(place)
                break
    return len(places) / len(seen) if seen else np.nan


@given(st.integers(0, 10_000), st.sampled_from([{}, {"looks": 1, "angle": 0.3}, {"farthest": 0.9},
                                               {"looks": 2, "nearest": 0.05}]))  # fmt: skip
@settings(max_examples=30, deadline=None)
def test_walls_drawn_twice_are_counted_piece_by_piece(seed, limits):
    """A few walls, each seen by four scans with noise, and by four more beside itself."""
    rng = np.random.default_rng(seed)
    walls = rng.uniform(-1, 1, (4, 1, 2)) + [(0, 0)] * 2
    walls[:, 1] += rng.uniform(-1, 1, (4, 2))
    shift, noise = rng.normal(0, 0.25, 2), rng.normal(0, 0.003, (8, 4, 2, 2))
    segments = walls + noise + np.repeat([(0, 0), shift], 4, axis=0)[:, None, None]
    segments[::3] = segments[::3, :, ::-1]
    map = SegmentMap(segments.reshape(-1, 2, 2), np.repeat(np.arange(8), 4))
    sensors = rng.uniform(-1, 1, (8, 2)) if seed % 2 else np.tile(rng.uniform(-1, 1, 2), (8, 1))
    expected = twice(map, sensors, **limits)
    found = doubled_walls(map, sensors, **limits)
    assert found == pytest.approx(expected, abs=1e-12, nan_ok=True)


BESIDE = [(0.1499, {}, 0), (0.1501, {}, 1), (0.25, {"nearest": 0.25}, 0), (0.4999, {}, 1)]


@pytest.mark.parametrize("seen_from", [5, -5])
@pytest.mark.parametrize(("apart", "limits", "share"), [*BESIDE, (0.5, {}, 0)])
def test_a_wall_is_drawn_twice_between_fifteen_and_fifty_centimetres(
    apart, limits, share, seen_from
):
    """Catches a bound, and looks at a wall that faces to -x which are of two directions."""
    leans = (0.0, 1e-6, -1e-6)
    walls = np.array([[(x, 0), (x + k, 2)] for x in (0.05, 0.05 + apart) for k in leans])
    found = doubled_walls(SegmentMap(walls, range(6)), [(seen_from, 1)] * 6, **limits)
    assert found == share


def test_no_wall_is_no_number_and_no_sensor_is_refused():
    assert np.isnan(doubled_walls(SegmentMap(np.empty((0, 2, 2))), np.empty((0, 2))))
    assert np.isnan(doubled_walls(rooms((0, 0))[:4], SEEN_FROM))
    with pytest.raises(ValueError, match="sensors must say where each scan"):
        doubled_walls(rooms((0, 0)))
    with pytest.raises(ValueError, match="sensors"):
        doubled_walls(rooms((0, 0)), [(0, 0)])
