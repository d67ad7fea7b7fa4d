"""Methods against their plain versions, and what the thesis says of all of them."""

from dataclasses import replace
from inspect import unwrap

import numpy as np
import pytest
from input_samples import segment_samples
from reduction_maps import (
    MAPS,
    TWINS,
    assert_literal,
    assert_plain,
    corridor_map,
    diagonal_map,
    grid_map,
    malaga,
    random_map,
    redundant_map,
)

from segmap.metrics import quality
from segmap.poses import transform
from segmap.reduction import METHODS
from segmap.segments import SegmentMap, length
from segmap.testing import assert_segments_equal

methods = pytest.mark.parametrize("name", METHODS)
twins = pytest.mark.parametrize("name", TWINS)
#: Methods that stand once: what a chapter prints is what runs.
alone = pytest.mark.parametrize("name", [n for n in METHODS if n not in TWINS])
#: All but the one whose cells lie along the axes of the map: surveyed/test_fuzzy_clustering.py.
anyhow = pytest.mark.parametrize("name", [n for n in METHODS if n != "fuzzy_clustering"])

#: What is asked of the methods in turn, beside their defaults; a grid of 1/4 m meets much of it.
ASKED = {
    "angle": [0.1, 0.5, np.pi / 4, np.pi / 2], "turn": [0.1, np.pi / 4, np.pi / 2],
    "distance": [0.05, 0.1, 0.25, 0.5], "tolerance": [0.013, 0.05, 0.125, 0.25, 2.0],
    "gap": [0.0, 0.05, 0.25, 0.5], "min_length": [0.0, 0.1, 0.25, 0.5], "eps": [0.03, 0.125],
    "every": [1, 2, 3, 5], "origin": ["map", "pair"], "penalty": [0.01, 0.0625, 0.2, 3.0],
    "far": [0.1, 0.25, 0.5], "long": [0.11, 0.25, 0.5], "bridge": [0.0, 0.25, 1.0, np.inf],
    "sigma": [0.25, 0.4, 0.5, 0.9], "bandwidth": [0.1, 1.5, 2.0], "factor": [0.4, 1.0, 2.0, 3.0],
    "across": [0.05, 0.25, 0.5], "along": [0.05, 0.25, 0.5], "error": [0.02, 0.1, 0.25],
    "axes": [0.0, 0.3, 1.0], "cell": [0.5, 0.7, 1.0], "corner": [(0.3, -0.2), (0.25, 0.25)],
    "noise": [0.05, 0.25, 0.5], "min_points": [0, 3, 8], "spacing": [0.1, 0.25],
    "chi2": [2.0, 30.0], "sigma_range": [0.003, 0.03], "sigma_bearing": [0.002, 0.05],
    "sigma_place": [0.0, 0.1], "sigma_heading": [0.0, 0.1], "forget": [False], "rejoin": [False],
}  # fmt: skip
#: Thresholds that are lengths, or in the case of the bandwidth one over a length.
LENGTHS = {"distance", "tolerance", "sigma", "bandwidth", "gap"}
LENGTHS |= {"sigma_range", "sigma_place", "spacing", "eps", "penalty", "far", "long", "bridge"}
LENGTHS |= {"min_length", "across", "along", "error", "cell", "noise"}
#: Mean shift looks at every piece from every piece: smaller maps, nearer together; the plain least
#: cost tries thousands of lines.
SMALL = {"mean_shift": (12, 0.4), "least_cost": (24, 0.7)}
#: Segments of a real map that the plain versions of these can bear; the others take 300.
REAL = {"mean_shift": 25, "least_cost": 80, "one_per_wall": 60, "segment_similarity": 150}


def made(make, name: str, seed: int) -> SegmentMap:
    """A random map whose scans come in any order; some have no segment."""
    rng = np.random.default_rng(seed)
    n, scale = SMALL.get(name, (48, 1.0))
    segments = make(rng, n) * scale
    scans, sensors = rng.integers(0, 9, len(segments)), rng.uniform(-1, 1, (9, 2)) * scale
    return SegmentMap(segments, scans, sensors=sensors)


def drawn(make, name: str, rng: np.random.Generator) -> tuple[SegmentMap, dict[str, object]]:
    """A small map, far or near, with or without points, and what is asked of the method."""
    most, scale = SMALL.get(name, (30, 1.0))
    if name != "fuzzy_clustering":  # its iterations magnify rounding
        scale *= rng.choice([0.25, 0.4, 1.0])
    segments = scale * make(rng, 2 * int(rng.integers(0, most // 2)))
    sensors = rng.integers(-6, 7, (6, 2)) / 4 if rng.random() < 0.5 else rng.uniform(-2, 2, (6, 2))
    if name == "one_per_wall" and rng.random() < 0.2:  # which can do without
        sensors = None
    map = SegmentMap(segments, rng.integers(0, 6, len(segments)), sensors=sensors)
    if len(map) and rng.random() < 0.5:
        count = rng.integers(2, 9, len(map))
        (a, b), size = np.repeat(segments, count, axis=0).swapaxes(0, 1), (count.sum(), 1)
        points = a + rng.random(size) * (b - a) + rng.normal(0, 0.01, a.shape)
        map = replace(map, points=points, first=np.append(0, np.cumsum(count)))
    if rng.random() < (0.8 if name == "viewing_sector" else 0.2):
        map = carried(map, (-70.0, 40.0, 0.3 if name == "viewing_sector" else 0.0))
    known = unwrap(METHODS[name].function).__kwdefaults__
    asked = {k: ASKED[k][rng.integers(len(ASKED[k]))] for k in known if rng.random() < 0.6}
    if name == "fuzzy_set":  # no angle with an axis is larger
        asked["angle"] = min(asked.get("angle", 0.1), np.pi / 4)
    return map, asked


@twins
@pytest.mark.parametrize("make", [*MAPS, grid_map, diagonal_map])
def test_equals_the_plain_method(name, make):
    """Another order, tie, limit, neighbour, chain, count, filter, scan, parent or default."""
    rng = np.random.default_rng(2)
    for _ in range({"mean_shift": 4, "least_cost": 10, "one_per_wall": 10}.get(name, 20)):
        map, asked = drawn(make, name, rng)
        assert_literal(name, map, **asked)


@twins
@pytest.mark.parametrize("sample", segment_samples())
def test_equals_the_plain_method_on_the_samples(name, sample):
    """Empty, points, duplicates, crossings, a map far from the origin."""
    segments = segment_samples()[sample][: REAL.get(name, 300)]
    wide = {"sigma": max(0.3, length(segments).sum() / 60)}
    near = {"distance": 0.3, "angle": 0.3, "min_length": 0.0}
    near = {k: v for k, v in near.items() if k in unwrap(METHODS[name].function).__kwdefaults__}
    thresholds = wide if name == "mean_shift" else near
    scans, sensors = np.arange(len(segments)) // 2, np.zeros((len(segments), 2))
    assert_literal(name, SegmentMap(segments, scans, sensors=sensors), **thresholds)


@pytest.mark.parametrize("name", [n for n in TWINS if n != "mean_shift"])
@pytest.mark.parametrize("shift", [0.0, -1e4])
@pytest.mark.parametrize("seed", range(2))
def test_equals_the_plain_method_where_sizes_differ_by_thousands(name, shift, seed):
    """Catches a level of the index whose cells are too small, a column or row too few, a slot that
    two cells share, a box that is still there though it was taken out."""
    rng = np.random.default_rng(seed)
    n = 40 if name in ("least_cost", "one_per_wall") else 120
    size = 10 ** rng.uniform(-2, 1.5, (n, 1, 1))
    spread = np.array([8, 0.5])[seed] * rng.uniform(-1, 1, (n, 1, 2))
    segments = spread + size * rng.uniform(-0.5, 0.5, (n, 2, 2))
    walls = rng.uniform(-15, 15, (4, 2, 2))[rng.integers(0, 4, n // 2)]  # and pieces of these
    begin = rng.uniform(0, 1, (n // 2, 1)) + [[0.0, 1.0]] * 10 ** rng.uniform(-3, 0, (n // 2, 1))
    pieces = walls[:, :1] + begin[..., None] * (walls[:, 1:] - walls[:, :1])
    segments[: n // 2] = pieces + rng.normal(0, 0.005, pieces.shape)
    segments += shift
    sensors = rng.uniform(-8, 8, (n // 4, 2)) + shift
    assert_literal(name, SegmentMap(segments, np.arange(n) // 4, sensors=sensors))


@twins
@pytest.mark.parametrize("turn", [0.4, np.pi / 2])
def test_equals_the_plain_method_on_a_real_map(name, turn):
    """Long walls that cross many cells; rounding, where walls along the axes are slanted."""
    map, n = malaga(), REAL.get(name, 300)
    there = carried(map[:n], (0, 0, turn))
    thresholds = {"mean_shift": {"sigma": 0.4}, "hybrid_fusion": {"every": 7}}.get(name, {})
    assert_literal(name, there, **thresholds)


@alone
@pytest.mark.parametrize("make", [*MAPS, grid_map, diagonal_map])
def test_machine_code_finds_what_its_source_finds(monkeypatch, name, make):
    """A type that the compiler chooses, an index out of range, an order that it does not keep."""
    rng = np.random.default_rng(1)
    for _ in range(4):
        map, asked = drawn(make, name, rng)
        assert_plain(monkeypatch, name, map, **asked)


# ----------------------------------------------------------------------------- symmetries
def carried(map: SegmentMap, pose, scale: float = 1.0) -> SegmentMap:
    """A map, its points and the places of its sensor, scaled and then carried along by a pose."""
    given = {"segments": map.segments, "points": map.points, "sensors": map.sensors}
    kept = {k: transform(pose, scale * v) for k, v in given.items() if v is not None}
    return replace(map, **kept)


@methods
@pytest.mark.parametrize("pose", [(0, 0, np.pi / 2), (0, 0, 1.234), (-70, 40, 0), (3, -8, -2.9)])
@pytest.mark.parametrize("make", [random_map, redundant_map, corridor_map])
def test_moving_the_map_moves_the_result(name, make, pose):
    """Angles as plain numbers, a sign, negative cells, a line that depends on the origin."""
    if name.startswith("hybrid"):  # a line is known by its distance from the origin
        pose = (0, 0, pose[2])
    if name == "fuzzy_clustering":  # by whole cells
        pose = (2 * pose[0], pose[1], 0)
    map = made(make, name, 5)
    found, expected = METHODS[name](carried(map, pose)), METHODS[name](map)
    np.testing.assert_array_equal(found.parents, expected.parents)
    back = transform(pose, expected.segments)
    assert_segments_equal(found.segments, back, ordered=True, atol=1e-8)


@pytest.mark.filterwarnings("ignore:.*millimetres:UserWarning")
@pytest.mark.parametrize("name", [n for n in METHODS if n != "one_per_wall"])  # its dial is a share
@pytest.mark.parametrize("scale", [0.01, 1000.0])
@pytest.mark.parametrize("make", [random_map, redundant_map])
def test_scaling_every_length_scales_the_result(name, make, scale):
    """An absolute length hidden in the loops. Mean shift's bandwidth is an angle a metre."""
    if name in ("uncertain_parameters", "fuzzy_clustering") and scale < 1:
        scale = 100.0  # no line is known to less than a millimetre, or a point to a micrometre
    map = made(make, name, 6)
    scaled = {
        k: v / scale if k == "bandwidth" else v * scale
        for k, v in unwrap(METHODS[name].function).__kwdefaults__.items()
        if k in LENGTHS and v is not None
    }
    found = METHODS[name](carried(map, (0, 0, 0), scale), **scaled)
    expected = METHODS[name](map)
    np.testing.assert_array_equal(found.parents, expected.parents)
    assert_segments_equal(found.segments, scale * expected.segments, atol=1e-9 * max(scale, 1))


@methods
@pytest.mark.parametrize("make", MAPS)
def test_swapping_end_points_changes_nothing(name, make):
    """A segment has no direction."""
    map = made(make, name, 7)
    swapped = replace(map, segments=map.segments[:, ::-1])
    assert_segments_equal(METHODS[name](swapped).segments, METHODS[name](map).segments)


@methods
@pytest.mark.parametrize("turn", np.radians([0, 0.4, 30, 89.6, 90, 90.4, 135, 179.6, 180, -90]))
def test_walls_at_0_and_180_degrees_merge_like_walls_at_90(name, turn):
    """Angles compared, or averaged, as plain numbers: two walls, or one across."""
    seen = [[(0.0, 1.01), (2.0, 0.99)], [(0.05, 0.99), (2.05, 1.01)], [(2.0, 1.0), (0.0, 1.0)]]
    map = carried(SegmentMap(seen, [0, 1, 2], sensors=np.ones((3, 2)) * (1, 3)), (0, 0, turn))
    one_cell = {"cell": 9.0, "corner": (-4, -4)} if name == "fuzzy_clustering" else {}
    found = METHODS[name](map, **one_cell)
    assert len(found) == 1
    back = transform((0, 0, -turn), found.segments)
    np.testing.assert_allclose(back[0, :, 1], 1.0, atol=0.03)
    end = 2.0 if name == "viewing_sector" else 2.05  # what is short is not added
    np.testing.assert_allclose(np.sort(back[0, :, 0]), (0.0, end), atol=0.03)


# ------------------------------------------------------------------- what may come out
def room() -> np.ndarray:
    """Walls without redundancy: nothing lies near another but at right angles."""
    x, y = (0.0, 4.0, 9.0), (0.0, 3.0)
    across = [[(x[0], v), (x[1], v)] for v in y] + [[(x[1] + 1.0, v), (x[2], v)] for v in y]
    return np.array(across + [[(u, y[0]), (u, y[1])] for u in x])


@anyhow
@pytest.mark.parametrize("turn", [0.0, np.pi / 2, 0.3, -1.2, np.pi - 1e-9])
def test_a_map_without_redundancy_is_kept(name, turn):
    """Corners that are cut, walls that are joined through a door: quality below 1."""
    walls = transform((0, 0, turn), room())
    sensors = transform((0, 0, turn), np.tile((0.5, 1.5), (len(walls), 1)))
    options = {"forget": False} if name == "viewing_sector" else {}
    map = SegmentMap(walls, np.arange(len(walls)) // 2, sensors=sensors)
    found = METHODS[name](map, **options)
    assert quality(walls, found) == pytest.approx(1.0, abs=1e-9)
    assert sorted(found.parents) == list(range(len(walls)))
    assert_segments_equal(found.segments[found.parents], walls, ordered=True, atol=1e-9)


@pytest.mark.parametrize("name", [n for n in METHODS if METHODS[n].online])
@pytest.mark.parametrize("make", [redundant_map, grid_map])
def test_on_line_each_scan_leaves_what_all_so_far_leave(name, make):
    """Counts of another map or scan; a method that looks ahead, or does more at the end."""
    map = made(make, name, 1)
    each = {"every": 1} if name in ("hybrid_fusion", "fuzzy_clustering") else {}
    found, scans = METHODS[name](map, **each), np.unique(map.scan)
    left = [len(METHODS[name](map[map.scan <= scan], **each)) for scan in scans]
    assert found.scan_live.tolist() == left and len(found.scan_seconds) == len(scans)
