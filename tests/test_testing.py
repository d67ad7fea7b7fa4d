"""The public assertions, the zoo of inputs, and the checks of exercises."""

import inspect

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import segmap
from segmap import arrays, course, plotting
from segmap.alignment import _points_loops
from segmap.angles import axial_difference
from segmap.course import EXERCISES, Check
from segmap.poses import between, interpolate
from segmap.segments import angle, length, midpoint
from segmap.testing import (
    assert_poses_equal,
    assert_segments_equal,
    point_zoo,
    scan_zoo,
    segment_zoo,
)

SEGMENTS, POINTS, SCANS = segment_zoo(), point_zoo(), scan_zoo()
THREE = np.array([[(0, 0), (1, 0)], [(1, 1), (1, 2)], [(0, 5), (2, 5)]], float)
NUMBER = st.floats(-20, 20)
MAP = st.lists(st.tuples(st.tuples(NUMBER, NUMBER), st.tuples(NUMBER, NUMBER)), max_size=6)


def refused(actual, expected, **options):
    with pytest.raises(AssertionError) as caught:
        assert_segments_equal(actual, expected, **options)
    return str(caught.value)


# -------------------------------------------------------------- segment assertion
@given(MAP, st.randoms())
def test_segments_are_equal_whichever_end_and_segment_comes_first(segments, random):
    """Catches an assertion that knows a direction, or an order."""
    other = [s[::-1] if random.random() < 0.5 else s for s in segments]
    random.shuffle(other)
    assert_segments_equal(segments, other)
    assert_segments_equal(np.reshape(segments, (-1, 2, 2)), other)


@given(MAP.filter(len), st.data(), st.sampled_from([-1e-3, 1e-3]))
def test_a_coordinate_that_is_off_is_seen(segments, data, step):
    """Catches an assertion that cannot fail."""
    moved = np.array(segments, float)
    place = tuple(data.draw(st.integers(0, n - 1)) for n in moved.shape)
    moved[place] += step
    ours, theirs = sorted(map(str, arrays.segments(segments))), sorted(map(str, moved))
    if ours != theirs:
        refused(moved, segments, ordered=True, atol=1e-6)
    assert_segments_equal(moved, segments, atol=1e-2)


def test_the_first_segment_without_a_partner_is_named_with_the_nearest():
    moved = THREE[[2, 1, 0]] + 0.0
    moved[1, 1, 1] = 2.25
    assert refused(moved, THREE) == (
        "actual segment 1 [[1, 1], [1, 2.25]] has no partner in expected; "
        "nearest is segment 1 [[1, 1], [1, 2]], off by 0.25 m"
    )


def test_order_counts_where_it_is_asked_for_and_direction_never():
    assert_segments_equal(THREE[:, ::-1], THREE, ordered=True)
    message = refused(THREE[[0, 2, 1]], THREE, ordered=True)
    assert message.startswith("segment 1 differs by 4 m: actual [[0, 5], [2, 5]], expected [[1, 1]")


def test_repeated_segments_are_counted():
    """Catches a comparison of sets."""
    a, b = THREE[0], THREE[1]
    assert "actual segment 1" in refused([a, a, b], [a, b, b])
    assert_segments_equal([a, b, a], [a, a, b])


def test_a_missing_or_extra_segment_is_named():
    assert refused(THREE[:2], THREE) == (
        "actual holds 2 segments, expected 3; expected segment 2 [[0, 5], [2, 5]] has no partner "
        "in actual; nearest is segment 1 [[1, 1], [1, 2]], off by 4 m"
    )
    assert "actual segment 2 [[0, 5], [2, 5]] has no partner in expected" in refused(
        THREE, THREE[:2]
    )
    assert refused([], THREE[:1]).endswith("[[0, 0], [1, 0]] has no partner in actual")


def test_rounding_of_one_coordinate_does_not_exchange_end_points():
    """Catches end points sorted by x: in an upright wall rounding decides which comes first."""
    upright = np.array([[(1, 0), (1, 2)]])
    for tilt in (1e-12, -1e-12):
        assert_segments_equal(upright + [[(tilt, 0), (-tilt, 0)]], upright)


def test_partners_are_shared_out_so_that_all_get_one():
    """Catches a greedy choice of the nearest, which leaves another one alone."""
    places = [np.array([[(x, 0), (x, 1)] for x in xs]) for xs in ((0.5, 0.0), (0.3, 1.0))]
    assert_segments_equal(*places, atol=0.55)
    refused(*places, atol=0.45)


def test_the_tolerance_holds_far_from_the_origin_too():
    assert_segments_equal(THREE + 1e6, THREE[::-1] + 1e6)
    refused(THREE + 1e6, THREE + 1e6 + 1e-3)


def test_maps_and_reductions_are_accepted_and_what_is_no_map_is_named():
    assert_segments_equal(segmap.SegmentMap(THREE), THREE)
    with pytest.raises(ValueError, match="actual must have shape"):
        assert_segments_equal(THREE.reshape(3, 4), THREE)
    with pytest.raises(ValueError, match="expected must be finite"):
        assert_segments_equal(THREE, THREE * np.nan)


def test_thousands_of_segments_are_compared_without_a_matrix_of_all_pairs():
    many = np.random.default_rng(1).uniform(0, 100, (20_000, 2, 2))
    assert_segments_equal(many[::-1], many)


# ----------------------------------------------------------------- pose assertion
def test_headings_a_turn_apart_are_the_same_and_others_are_not():
    """Catches pi compared with -pi as numbers, and headings that are not compared."""
    assert_poses_equal([(1, 2, np.pi), (0, 0, 7)], [(1, 2, -np.pi), (0, 0, 7 - 2 * np.pi)])
    with pytest.raises(AssertionError, match=r"pose 1 differs by 0 m and 0\.5 rad"):
        assert_poses_equal([(1, 2, 0), (0, 0, 0.5)], [(1, 2, 0), (0, 0, 0)])
    with pytest.raises(AssertionError, match="pose 0 differs by 5 m and 0 rad"):
        assert_poses_equal([(3, 4, 0)], [(0, 0, 0)])


def test_unknown_poses_equal_unknown_ones_only():
    nan = (np.nan,) * 3
    assert_poses_equal([nan, (0, 0, 0)], [nan, (0, 0, 0)])
    with pytest.raises(AssertionError, match="pose 0"):
        assert_poses_equal([nan], [(0, 0, 0)])
    with pytest.raises(AssertionError, match="pose 0"):
        assert_poses_equal([(0, 0, 0)], [nan])


@pytest.mark.parametrize("actual", [np.zeros((2, 3)), np.zeros(3), np.zeros((3, 2))])
def test_poses_of_another_shape_are_refused(actual):
    """Catches a pose that broadcasts against many."""
    with pytest.raises(AssertionError, match=r"expected poses of shape \(3, 3\)"):
        assert_poses_equal(actual, np.zeros((3, 3)))


# --------------------------------------------------------------------------- zoos
def test_the_zoos_hold_what_their_names_say():
    """Catches an animal that has lost its stripes."""
    assert all(np.isfinite(s).all() and s.shape[1:] == (2, 2) for s in SEGMENTS.values())
    assert all(np.isfinite(p).all() and p.shape[1:] == (2,) for p in POINTS.values())
    assert len(SEGMENTS["empty"]) == len(POINTS["empty"]) == len(SCANS["empty"]) == 0
    assert length(SEGMENTS["without length"]).max() == 0
    assert 0 < length(SEGMENTS["tiny"]).max() < 1e-6
    assert SEGMENTS["far away"].min() > 9e5
    np.testing.assert_allclose(np.degrees(angle(SEGMENTS["one and 179 degrees"])), [1, 179])
    assert len(np.unique(length(SEGMENTS["lattice"]))) == 1
    assert np.ptp(POINTS["vertical"][:, 0]) == 0 and np.ptp(POINTS["coincident"]) == 0
    steps = {name: np.hypot(*np.diff(p, axis=0).T) for name, p in POINTS.items() if len(p) > 1}
    assert steps["gap"].max() > 0.9 and steps["all round"].max() < 0.2
    assert not SCANS["all invalid"].valid.any()
    assert np.isnan(SCANS["with NaN"].ranges).any() and SCANS["with NaN"].valid.any()
    assert 0 < SCANS["with maximum range"].valid.sum() < len(SCANS["with maximum range"])
    assert np.ptp(SCANS["whole turn"].angles) > np.radians(358)


def test_each_call_gives_new_arrays():
    """Catches one test that spoils the input of the next."""
    segment_zoo()["single"][:] = 9
    assert_segments_equal(segment_zoo()["single"], SEGMENTS["single"])


@pytest.mark.parametrize("name", SEGMENTS)
def test_every_map_of_the_zoo_is_measured_reduced_and_drawn(name):
    """Catches NaN, and divisions by a length of zero."""
    segments = SEGMENTS[name]
    assert segmap.quality(segments, segments) == pytest.approx(1, abs=1e-12)
    assert np.isfinite(midpoint(segments)).all() and np.isfinite(angle(segments)).all()
    found = segmap.fusion(segments)
    assert np.isfinite(found.segments).all() and found.parents.shape == (len(segments),)
    assert ((found.parents < 0) == (length(segments) < 1e-9)).all()
    assert 0 <= segmap.quality(segments, found) <= 1
    if len(segments) > 1:
        pairs = segmap.segment_distance(segments[:, None], segments)
        assert np.isfinite(pairs).all() and np.allclose(pairs, pairs.T, atol=1e-9)
    ax = plotting.draw_provenance(segments, found)
    assert len(ax.collections[-1].get_segments()) == len(segments)
    plotting_closed(ax)


def plotting_closed(ax):
    import matplotlib.pyplot as plt

    plt.close(ax.figure)


@pytest.mark.parametrize("name", POINTS)
@pytest.mark.parametrize("closed", [False, True])
def test_every_cloud_of_the_zoo_is_extracted(name, closed):
    for extract in (segmap.extract_clusters, segmap.extract_polylines):
        found = extract(POINTS[name], closed=closed)
        assert found.shape[1:] == (2, 2) and np.isfinite(found).all()
        assert (length(found) > 0).all()


#: The seam of the whole turn lies in the middle of a wall, which counts twice unless it is closed.
WALLS = {
    **dict.fromkeys(("empty", "one beam", "two beams", "all invalid"), lambda closed: 0),
    **dict.fromkeys(("single wall", "with NaN", "with maximum range"), lambda closed: 1),
    "whole turn": lambda closed: 4 if closed else 5,
    "sensor off the middle": lambda closed: 1,
}


@pytest.mark.parametrize("name", SCANS)
def test_every_scan_of_the_zoo_becomes_a_map(name):
    scan = SCANS[name]
    log, pose = segmap.Log("zoo", [scan]), [(1, 2, 3)]
    for closed in (False, True):
        map = segmap.build_map(log, pose, closed=closed)
        assert len(map) == WALLS[name](closed) and np.isfinite(map.segments).all()
    assert len(plotting.thumbnail(scan)) > 100


# ------------------------------------------------------------------------ exercises
MISTAKES = [
    pytest.param(e, m, id=f"{e.name}: {m.name}") for e in EXERCISES.values() for m in e.mistakes
]
EACH = pytest.mark.parametrize("exercise", EXERCISES.values(), ids=EXERCISES)


@EACH
def test_the_library_passes(exercise):
    found = exercise(exercise.solution)
    assert found and repr(found) == "passed"


@EACH
@pytest.mark.parametrize("stub", [lambda *_: None, lambda *_: ...], ids=["None", "..."])
def test_the_stub_fails_and_is_told_its_task(exercise, stub):
    """Catches a check that passes whatever it is given."""
    found = exercise(stub)
    assert not found and "returns nothing yet" in found.hint and exercise.task in found.hint


@pytest.mark.parametrize(("exercise", "mistake"), MISTAKES)
def test_each_mistake_fails_with_its_own_hint(exercise, mistake):
    """Catches cases that a wrong answer survives, and two mistakes that look alike."""
    found = exercise(mistake.function)
    assert not found and found.hint == mistake.hint
    assert sum(other.hint == mistake.hint for other in exercise.mistakes) == 1


@EACH
def test_every_exercise_is_in_reach_under_its_name(exercise):
    assert getattr(course, f"check_{exercise.name}") is exercise
    assert repr(exercise).startswith(f"check_{exercise.name}(your function): {exercise.name}(")
    assert len(exercise.mistakes) >= 4


def rotated_step(a, b):
    rotation = np.array([(np.cos(a[2]), -np.sin(a[2])), (np.sin(a[2]), np.cos(a[2]))])
    heading = np.arctan2(np.sin(a[2] + b[2]), np.cos(a[2] + b[2]))
    return [*(np.array(a[:2]) + rotation @ b[:2]), heading]


def beams_in_steps(n):
    return [np.radians(-90 + i * 180 / (n - n % 2)) for i in range(n)]


def met_by_solving(wall, pose, turn):
    beam = [np.cos(pose[2] + turn), np.sin(pose[2] + turn)]
    try:
        r, part = np.linalg.solve(np.transpose([beam, wall[0] - wall[1]]), wall[0] - pose[:2])
    except np.linalg.LinAlgError:
        return float("inf")
    return r if r > 0 and 0 <= part <= 1 and r < 1e6 else float("inf")


def mean_of_doubled(angles):
    return np.angle(np.mean(np.exp(2j * angles))) / 2  # in (-90, 90] degrees


def direction_by_svd(points):
    return np.arctan2(*np.linalg.svd(points - points.mean(axis=0))[2][0][::-1])


def farthest_in_a_loop(points):
    (x0, y0), (x1, y1) = points[0], points[-1]
    off = [abs((x1 - x0) * (y - y0) - (y1 - y0) * (x - x0)) for x, y in points]
    return off.index(max(off))


def rate_by_counting(before, after):
    return 1 - len(after) / len(before) if len(before) else 0


def quality_row_by_row(distances):
    return np.exp(-sum(min(row) for row in distances.tolist()) / len(distances) / 0.05)


def inside_in_a_loop(offsets, shift, tolerance):
    return [all(abs(x - shift) <= tolerance for x in pair) for pair in offsets]


def shift_in_a_loop(offsets, lengths, tolerance):
    shifts = [0.0, *(max(p) - tolerance for p in offsets), *(min(p) + tolerance for p in offsets)]
    shifts = sorted((t for t in shifts if abs(t) <= tolerance), key=abs)
    return max(shifts, key=lambda t: lengths[inside_in_a_loop(offsets, t, tolerance)].sum())


def hough_by_complex_numbers(segment, near):
    a, b = (complex(*end) for end in segment)
    theta = np.angle((b - a) * 1j)
    theta += np.pi * round((near - theta) / np.pi)
    return [(a * np.exp(-1j * theta)).real, theta]


def matches_in_a_loop(a, b, distance, angle):
    slopes = [np.arctan2(*(s[1] - s[0])[::-1]) for s in (a, b)]
    near = any(np.linalg.norm(p - q) < distance for p in a for q in b)
    return near and abs(np.arcsin(np.sin(slopes[0] - slopes[1]))) < angle


def merged_by_vectors(a, b):
    """Weights and the shorter turn by hand, ends in the other order."""
    (la, lb), (ta, tb) = zip(
        *((np.hypot(*v), np.arctan2(v[1], v[0])) for v in (a[1] - a[0], b[0] - b[1])), strict=True
    )
    tb -= np.pi * round((tb - ta) / np.pi)
    way = np.array(
        [np.cos((la * ta + lb * tb) / (la + lb)), np.sin((la * ta + lb * tb) / (la + lb))]
    )
    centre = (la * a.mean(0) + lb * b.mean(0)) / (la + lb)
    along = [(p - centre) @ way for p in (*a, *b)]
    return [centre + max(along) * way, centre + min(along) * way]


def reduction_by_hand(points, quality):
    reached = [tuple(p) for p in points if not any((q > p).all() for q in points)]
    above = [p for p in reached if p[0] >= quality]
    below = [p for p in reached if p[0] < quality]
    if not above:
        return float("nan")
    if not below:
        return max(r for _, r in above)
    (q0, r0), (q1, r1) = max(below), min(above)
    return r0 + (quality - q0) / (q1 - q0) * (r1 - r0)


def heading_by_complex_numbers(before, after, share):
    turn = np.angle(np.exp(1j * after) / np.exp(1j * before))
    return np.angle(np.exp(1j * (before + share * turn)))


def moved_by_pseudo_inverse(points, feet, normals):
    rows = [[nx, ny, x * ny - y * nx] for (x, y), (nx, ny) in zip(points, normals, strict=True)]
    return np.linalg.pinv(rows) @ [
        n @ (f - p) for p, f, n in zip(points, feet, normals, strict=True)
    ]


def match_value_by_complex_numbers(u, v, distance):
    """The real part runs along a segment, the imaginary part off it."""
    u, v = ([complex(*end) for end in s] for s in (u, v))

    def seen_along(a, b):
        way = (a[1] - a[0]) / abs(a[1] - a[0])
        return [(end - a[0]) / way for end in b], abs(a[1] - a[0])

    lengths, apart = [], []
    for a, b in ((u, v), (v, u)):
        ends, size = seen_along(a, b)
        inside = [min(max(end.real, 0), size) for end in ends]
        lengths.append(abs(inside[1] - inside[0]))
        apart.append(max(abs(e - i) for e, i in zip(ends, inside, strict=True)))
    return sum(lengths) / 2 * 0.95 ** (min(apart) / distance)


def step_in_a_loop(centres, pieces, sigma, bandwidth):
    moved = []
    for c in centres:
        w, turns = [], []
        for p in pieces:
            turns.append(np.angle(np.exp(2j * (p[2] - c[2]))) / 2)
            w.append(
                np.exp(-(np.hypot(*(p - c)[:2]) ** 2 + (turns[-1] / bandwidth) ** 2) / 2 / sigma**2)
            )
        x, y = np.average(pieces[:, :2], axis=0, weights=w)
        moved.append([x, y, (c[2] + np.average(turns, weights=w)) % np.pi])
    return moved


def moved_along_what_is_held(normals, offsets, weights):
    """Only along the directions that the lines hold."""
    root = np.sqrt(weights)[:, None] * normals
    values, axes = np.linalg.eigh(root.T @ root)
    held = axes[:, values > 1e-9 * values.max()]
    return held @ np.linalg.solve(
        held.T @ root.T @ root @ held, -held.T @ root.T @ (np.sqrt(weights) * offsets)
    )


def cell_by_cutting(x, corner, resolution):
    column = (x - corner) / resolution
    return int(column) - (column < int(column))


def grown_by_arrays(root, cell):
    low, cell = np.array(root[:2]), np.array(cell)
    return np.append(np.where(cell < low, low - root[2], low), 2 * root[2])


def occupancy_by_interpolation(vis, occ, bias):
    return occ / vis if occ else np.interp(vis, [0, bias], [0.5, 0.0])


def cells_by_formula(start, end):
    """After k steps along the longer axis, rounded from the end with the smaller coordinate."""
    start, end = np.array(start), np.array(end)
    axis = int(abs(end - start)[1] > abs(end - start)[0])
    first, last = (end, start) if end[axis] < start[axis] else (start, end)
    length, aside = (last - first)[axis], (last - first)[1 - axis]
    k = np.arange(length + 1)
    across = (k * abs(aside) + (length - 1) // 2) // max(length, 1) if length else k
    cells = np.empty((length + 1, 2), int)
    cells[:, axis], cells[:, 1 - axis] = first[axis] + k, first[1 - axis] + np.sign(aside) * across
    return cells


def pixel_from_the_top(x, y, origin, side, rows):
    return int((origin[1] + rows * side - y) / side), int((x - origin[0]) / side)


def edge_error_by_matrices(first, second, relative):
    def matrix(x, y, heading):
        c, s = np.cos(heading), np.sin(heading)
        return np.array([(c, -s, x), (s, c, y), (0, 0, 1)])

    m = np.linalg.inv(matrix(*first) @ matrix(*relative)) @ matrix(*second)
    return [m[0, 2], m[1, 2], np.arctan2(m[1, 0], m[0, 0])]


def distances_bit_by_bit(lines):
    text = "".join(f"{c - 48:06b}" for line in lines for c in line[:-1])
    return [int(text[i : i + 18], 2) for i in range(0, len(text), 18)]


def unwrapped_in_a_loop(stamps):
    turns, found = 0, []
    for k, stamp in enumerate(stamps):
        turns += bool(k) and stamp < stamps[k - 1]
        found.append((int(stamp) + turns * 2**24 - int(stamps[0])) / 1000)
    return found


def score_by_tree(points, pose, centres):
    from scipy.spatial import cKDTree

    return -cKDTree(centres).query(segmap.poses.transform(pose, points))[0].sum()


def climb_in_a_loop(value, pose, move, turn):
    best, steps = [*pose], (move, move, turn)
    for axis in range(3):
        for sign in (-1, 1):
            tried = [p + sign * steps[axis] * (k == axis) for k, p in enumerate(pose)]
            if value(np.array(tried)) > value(np.array(best)):
                best = tried
    return best


def wall_error_along_and_aside(points, walls):
    total = 0.0
    for p in points:
        best = np.inf
        for a, b in walls:
            length = np.linalg.norm(b - a)
            along = (p - a) @ (b - a) / length
            beyond = max(-along, along - length, 0.0)
            aside = (b - a)[0] * (p - a)[1] - (b - a)[1] * (p - a)[0]
            best = min(best, np.hypot(beyond, aside / length))
        total += best
    return total / len(points)


OTHER_WAYS = {
    "scan_score": score_by_tree,
    "climb_step": climb_in_a_loop,
    "mean_wall_error": wall_error_along_and_aside,
    "distances": distances_bit_by_bit,
    "unwrapped": unwrapped_in_a_loop,
    "edge_error": edge_error_by_matrices,
    "compose": rotated_step,
    "beam_angles": beams_in_steps,
    "cast_ray": met_by_solving,
    "axial_mean": mean_of_doubled,
    "fit_line": direction_by_svd,
    "farthest_point": farthest_in_a_loop,
    "reduction_rate": rate_by_counting,
    "quality": quality_row_by_row,
    "heading_between": heading_by_complex_numbers,
    "move_onto_walls": moved_by_pseudo_inverse,
    "least_translation": moved_along_what_is_held,
    "match_value": match_value_by_complex_numbers,
    "hough": hough_by_complex_numbers,
    "matches": matches_in_a_loop,
    "merged": merged_by_vectors,
    "mean_shift_step": step_in_a_loop,
    "inside_strip": inside_in_a_loop,
    "best_shift": shift_in_a_loop,
    "reduction_at": reduction_by_hand,
    "cell_of": cell_by_cutting,
    "grown": grown_by_arrays,
    "occupancy": occupancy_by_interpolation,
    "ray_cells": cells_by_formula,
    "pixel": pixel_from_the_top,
}


@EACH
def test_other_ways_to_the_right_answer_pass(exercise):
    """Catches a check that wants the library's code, its types or its rounding."""
    assert exercise(OTHER_WAYS[exercise.name])


@EACH
def test_a_function_that_raises_fails_with_its_message(exercise):
    """Catches a check that hands the student's exception on."""

    def broken(*_):
        raise RuntimeError("out <of> luck")

    found = exercise(broken)
    assert not found and "raised RuntimeError: out <of> luck" in found.hint
    assert "out &lt;of&gt; luck" in found._repr_html_()


def type_name(answer):
    return type(answer).__name__


@EACH
@pytest.mark.parametrize(
    "answer", ["text", [], {}, object, np.zeros((7, 7)), np.nan, np.inf, 10**5000], ids=type_name
)
def test_no_answer_breaks_a_check(exercise, answer):
    found = exercise(lambda *_: answer)
    assert isinstance(found, Check) and not found and found.hint


@EACH
def test_a_result_instead_of_a_function_is_explained(exercise):
    """Catches check_compose(my_compose(a, b))."""
    found = exercise(3.0)
    assert not found and f"check_{exercise.name}(my_{exercise.name})" in found.hint


@EACH
def test_a_function_with_too_few_arguments_is_told_so(exercise):
    found = exercise(lambda: None)
    assert not found and "raised TypeError" in found.hint


@EACH
def test_a_function_that_changes_its_arguments_spoils_nothing(exercise):
    """Catches cases that are shared with the student."""

    def spoil(*arguments):
        for argument in arguments:
            if isinstance(argument, np.ndarray):
                argument[...] = 0

    assert not exercise(spoil) and exercise(exercise.solution)


def test_an_unknown_mistake_is_answered_with_the_first_case_that_differs():
    found = course.check_quality(lambda distances: 0.5)
    assert found.hint == "for 2 segments before, 3 after expected 0.67032, got 0.5"
    found = course.check_beam_angles(np.arange)
    assert "an array (181,) that starts [-1.5708, -1.55334, -1.53589]" in found.hint


def test_a_check_shows_itself_as_text_and_in_colour():
    """Catches a default repr, which holds an address, and a verdict in colour alone."""
    passed, failed = Check("quality", True), Check("quality", False, "a < b")
    assert (repr(passed), repr(failed)) == ("passed", "not yet: a < b")
    assert plotting.TRUTH in passed._repr_html_() and "passed" in passed._repr_html_()
    assert plotting.ERROR in failed._repr_html_() and "not yet: a &lt; b" in failed._repr_html_()


def test_the_wrong_order_of_compose_differs_from_the_right_one():
    """The hint's claim by hand: the first pose is where the robot stands."""
    case = course.check_compose.cases[0]
    found = course.check_compose.solution(*case.arguments)
    assert_poses_equal(found, (1, 3, np.pi / 2))
    assert_poses_equal(between(case.arguments[0], found), case.arguments[1])


@given(st.integers(0, 10**6))
def test_match_and_merge_are_those_of_basic(seed):
    """Catches an exercise that teaches another method than the library has."""
    a, b = np.random.default_rng(seed).uniform(0, 1, (2, 2, 2))
    found = segmap.reduction.basic_offline(np.array([a, b]), distance=0.5, angle=0.8)
    assert (len(found) == 1) == course.matches(a, b, 0.5, 0.8)
    if len(found) == 1:
        assert_segments_equal(found, course.merged(a, b)[None])


@given(st.integers(0, 10**6))
def test_a_step_is_that_of_mean_shift(seed):
    """Catches an exercise that teaches another step than the method makes."""
    rng = np.random.default_rng(seed)
    segments = rng.uniform(0, 0.1, (6, 2, 2))
    begin, one = (
        segmap.reduction.common_directions(segments, sigma=0.2, bandwidth=5.0, steps=k).centres
        for k in (0, 1)
    )
    found = course.mean_shift_step(begin, begin, 0.2, 5.0)
    found[:, 2] = axial_difference(found[:, 2], one[:, 2])
    np.testing.assert_allclose(found[:, :2], one[:, :2], atol=1e-9)
    np.testing.assert_allclose(found[:, 2], 0, atol=1e-9)


@given(st.integers(0, 10**6))
def test_a_move_onto_walls_is_a_step_of_point_icp(seed):
    """Catches an exercise that teaches another step than the matcher makes."""
    rng = np.random.default_rng(seed)
    points, angle = rng.normal(0, 2, (20, 2)), rng.uniform(-3, 3, 20)
    normals = np.stack([np.cos(angle), np.sin(angle)], 1)
    feet = points + rng.normal(0, 0.1, (20, 2))
    lever = points[:, 0] * normals[:, 1] - points[:, 1] * normals[:, 0]
    offsets = ((points - feet) * normals).sum(1)
    equations = _points_loops.equations(
        np.column_stack([normals, lever, offsets]), np.ones(len(points))
    )
    move = _points_loops.least_move(*equations, 1.0)
    np.testing.assert_allclose(course.move_onto_walls(points, feet, normals), move, atol=1e-9)


@given(st.floats(-3, 3), st.floats(-3, 3), st.floats(0, 1))
def test_a_heading_between_is_that_of_interpolate(before, after, share):
    """Catches an exercise that teaches another heading than ground truth has."""
    poses = [(0, 0, before), (0, 0, after)]
    found = course.heading_between(before, after, share)
    assert_poses_equal([(0, 0, found)], interpolate([0, 1], poses, [share]))


def test_no_mistake_takes_a_case_as_its_own():
    """Catches an exercise whose mistake needs other arguments than its cases have."""
    for exercise in EXERCISES.values():
        count = len(exercise.cases[0].arguments)
        for mistake in exercise.mistakes:
            if mistake.function is not np.mean:
                assert len(inspect.signature(mistake.function).parameters) == count
