"""Exercises: the library passes, so do other ways to the answer; each mistake has its own hint."""

import json

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial import cKDTree
from scipy.spatial.transform import Rotation

from segmap import course, plotting
from segmap.angles import axial_difference
from segmap.course import EXERCISES, Check
from segmap.course._exercise_answers import answered, same_line, same_poses
from segmap.literal.viewing_sector import views
from segmap.poses import between, transform
from segmap.reduction import common_directions
from segmap.testing import assert_poses_equal

EACH = pytest.mark.parametrize("exercise", EXERCISES.values(), ids=EXERCISES)
MISTAKES = [
    pytest.param(exercise, hint, id=f"{exercise.name}: {hint[:40]}")
    for exercise in EXERCISES.values()
    for hint in exercise.mistakes
]


# -------------------------------------------------------------- all exercises alike
@EACH
def test_every_exercise_is_in_reach_and_the_library_is_right_and_noticed(exercise):
    assert exercise.verdict(exercise.expected())
    assert "this is the library's; write your own" in exercise(exercise.solution).hint
    assert getattr(course, f"check_{exercise.name}") is exercise
    assert repr(exercise) == f"check_{exercise.name}(your function): {exercise.task}"
    assert len(exercise.mistakes) >= 4
    for arguments in exercise.cases.values():
        exercise.solution(*arguments)  # which raises nothing


@pytest.mark.parametrize(("exercise", "hint"), MISTAKES)
def test_each_mistake_fails_with_its_own_hint(exercise, hint):
    """Catches cases that a wrong answer survives, and two mistakes that look alike."""
    found = exercise.verdict(answered(exercise.mistakes[hint], exercise.cases))
    assert not found and found.hint == hint


def broken(*_):
    raise RuntimeError("out <of> luck")


def spoil(*arguments):
    for argument in arguments:
        if isinstance(argument, np.ndarray):
            argument[...] = 0


@EACH
@pytest.mark.parametrize(
    ("answer", "words"),
    [
        (lambda *_: None, "returns nothing yet; the task is {e.task}"),
        (lambda *_: ..., "returns nothing yet; the task is {e.task}"),
        (spoil, "returns nothing yet"),
        (3.0, "check_{e.name}(my_{e.name}), without a call"),
        (lambda: None, "raised TypeError"),
        (broken, "raised RuntimeError: out <of> luck"),
        *((lambda *_, answer=answer: answer, "") for answer in ("text", [], {}, object)),
        *((lambda *_, answer=answer: answer, "") for answer in (np.nan, np.inf, 10**5000)),
        (lambda *_: np.zeros((7, 7)), ""),
    ],
)
def test_what_is_no_answer_fails_and_says_why(exercise, answer, words):
    """Catches a check that passes whatever it is given, hands an exception on, or is spoilt."""
    found = exercise(answer)
    assert isinstance(found, Check) and not found and found.hint
    assert words.format(e=exercise) in found.hint


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


# ------------------------------------------- other ways to the right answer, from other ideas
def rotated_step(a, b):
    heading = np.angle(np.exp(1j * (a[2] + b[2])))
    return [*(a[:2] + Rotation.from_euler("z", a[2]).as_matrix()[:2, :2] @ b[:2]), heading]


def met_by_solving(wall, pose, turn):
    beam = [np.cos(pose[2] + turn), np.sin(pose[2] + turn)]
    try:
        r, part = np.linalg.solve(np.transpose([beam, wall[0] - wall[1]]), wall[0] - pose[:2])
    except np.linalg.LinAlgError:
        return float("inf")
    return r if r > 0 and 0 <= part <= 1 and r < 1e6 else float("inf")


def farthest_in_a_loop(points):
    (x0, y0), (x1, y1) = points[0], points[-1]
    off = [abs((x1 - x0) * (y - y0) - (y1 - y0) * (x - x0)) for x, y in points]
    return off.index(max(off))


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


def reduction_by_hand(points, quality):
    reached = [tuple(p) for p in points if not any((q > p).all() for q in points)]
    above, below = ([p for p in reached if (p[0] >= quality) == up] for up in (True, False))
    if not above or not below:
        return max((r for _, r in above), default=float("nan"))
    (q0, r0), (q1, r1) = max(below), min(above)
    return r0 + (quality - q0) / (q1 - q0) * (r1 - r0)


def moved_by_pseudo_inverse(points, feet, normals):
    rows = [[nx, ny, x * ny - y * nx] for (x, y), (nx, ny) in zip(points, normals, strict=True)]
    return np.linalg.pinv(rows) @ ((feet - points) * normals).sum(1)


def step_in_a_loop(centres, pieces, sigma, bandwidth):
    moved = []
    for c in centres:
        turns = np.array([np.angle(np.exp(2j * (p[2] - c[2]))) / 2 for p in pieces])
        away = [np.hypot(*(p - c)[:2]) for p in pieces]
        w = np.exp(-(np.square(away) + (turns / bandwidth) ** 2) / 2 / sigma**2)
        x, y = np.average(pieces[:, :2], axis=0, weights=w)
        moved.append([x, y, (c[2] + np.average(turns, weights=w)) % np.pi])
    return moved


def grown_by_arrays(root, cell):
    low = np.array(root[:2])
    return np.append(np.where(np.array(cell) < low, low - root[2], low), 2 * root[2])


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


def matrix(x, y, heading):
    c, s = np.cos(heading), np.sin(heading)
    return np.array([(c, -s, x), (s, c, y), (0, 0, 1)])


def pose_of(m):
    return [m[0, 2], m[1, 2], np.arctan2(m[1, 0], m[0, 0])]


def edge_error_by_matrices(first, second, relative):
    return pose_of(np.linalg.inv(matrix(*first) @ matrix(*relative)) @ matrix(*second))


def carried_by_matrices(before, after, pose):
    """The one motion that takes the key frame along, applied to the scan."""
    return pose_of(matrix(*after) @ np.linalg.inv(matrix(*before)) @ matrix(*pose))


def distances_bit_by_bit(lines):
    text = "".join(f"{c - 48:06b}" for line in lines for c in line[:-1])
    return [int(text[i : i + 18], 2) for i in range(0, len(text), 18)]


def unwrapped_in_a_loop(stamps):
    turns = np.cumsum([0, *(np.diff(stamps) < 0)])
    return [
        (int(s) + int(t) * 2**24 - int(stamps[0])) / 1000
        for s, t in zip(stamps, turns, strict=True)
    ]


def climb_in_a_loop(value, pose, move, turn):
    best, steps = [*pose], (move, move, turn)
    for axis in range(3):
        for sign in (-1, 1):
            tried = [p + sign * steps[axis] * (k == axis) for k, p in enumerate(pose)]
            best = tried if value(np.array(tried)) > value(np.array(best)) else best
    return best


def wall_error_along_and_aside(points, walls):
    total = 0.0
    for p in points:
        off = []
        for a, b in walls:
            length = np.linalg.norm(b - a)
            along = (p - a) @ (b - a) / length
            aside = (b - a)[0] * (p - a)[1] - (b - a)[1] * (p - a)[0]
            off.append(np.hypot(max(-along, along - length, 0.0), aside / length))
        total += min(off)
    return total / len(points)


def pose_covariance_by_moving(centre, alpha, sensor, place, heading):
    """From what the line becomes when x, y and heading of the sensor move by a little."""
    n, columns = np.array([np.cos(alpha), np.sin(alpha)]), []
    for move in (*np.eye(3) * 1e-5, *np.eye(3) * -1e-5):
        ends = [[*(centre - sensor)], [*(centre - sensor + [-n[1], n[0]])]]
        a, b = transform(move, np.array(ends)) + sensor
        turned = np.arctan2(*(b - a)[::-1]) - np.pi / 2
        normal = np.array([np.cos(turned), np.sin(turned)])
        change = axial_difference(turned, alpha)
        offset = (a - centre) @ normal  # of the new line, about the old centre
        columns.append([offset, change])
    jacobian = (np.array(columns[:3]) - columns[3:]).T / 2e-5
    return jacobian @ np.diag([place, place, heading]) ** 2 @ jacobian.T


def verdict_by_complex_numbers(wall, point, sensor, distance):
    a, b, q = (complex(*end) - complex(*sensor) for end in (*wall, point))
    middle = np.angle(b / a) / 2
    turn = np.angle(q / a / np.exp(1j * middle))
    if abs(turn) > abs(middle) + 1e-12:
        return float("nan")
    normal = 1j * (b - a) / abs(b - a)
    before = ((a - q) * normal.conjugate()).real * np.sign((a * normal.conjugate()).real)
    return 0 if abs(before) <= distance else np.sign(before)


def metres_by_small_steps(spans, whole, gap):
    """A segment in pieces of 0.1 mm: those that no member covers, in runs longer than the gap."""
    at = (np.arange(round(float(whole) * 1e4)) + 0.5) / 1e4
    alone = ~((spans[:, :1] < at) & (at < spans[:, 1:])).any(axis=0)
    runs = np.split(alone, np.flatnonzero(np.diff(alone)) + 1)
    metres = [len(run) / 1e4 for run in runs if run[0]]
    return sum(metres) if len(spans) == 0 else sum(m for m in metres if m > gap)


def match_by_sampling(u, v, distance):
    """Spans by complex division; the distances of end points from the other segment."""

    def one(a, b):
        (p, q), ends = (complex(*end) for end in a), [complex(*end) for end in b]
        along = np.sort([((end - p) / (q - p)).real for end in ends])
        feet = [p + (q - p) * min(max(((end - p) / (q - p)).real, 0), 1) for end in ends]
        off = max(abs(end - foot) for end, foot in zip(ends, feet, strict=True))
        return abs(q - p) * max(min(along[1], 1) - max(along[0], 0), 0), off

    (first, far), (second, away) = one(u, v), one(v, u)
    return (first + second) / 2 * 0.95 ** (min(far, away) / distance)


def by_pseudo_inverse(normals, offsets, weights):
    root = np.sqrt(weights)
    return -np.linalg.pinv(normals * root[:, None], rcond=1e-9) @ (offsets * root)


def matches_by_complex_numbers(a, b, distance, angle):
    p, q = ([complex(*end) for end in s] for s in (a, b))
    turn = abs(np.angle(((p[1] - p[0]) / (q[1] - q[0])) ** 2)) / 2
    return min(abs(x - y) for x in p for y in q) < distance and turn < angle


def merged_by_complex_numbers(a, b):
    """Turn the second direction so that it looks along the first, then average what is left."""
    p, q = ([complex(*end) for end in s] for s in (a, b))
    u, v = p[1] - p[0], q[1] - q[0]
    share = abs(v) / (abs(u) + abs(v))
    way = u / abs(u) * np.exp(1j * share * np.angle((v / u) ** 2) / 2)
    middle = sum(p) / 2 * (1 - share) + sum(q) / 2 * share
    along = [((end - middle) / way).real for end in (*p, *q)]
    return [((middle + t * way).real, (middle + t * way).imag) for t in (min(along), max(along))]


OTHER_WAYS = {
    "best_run": lambda points, quality: max(
        (k for k, (q, _) in enumerate(points.tolist()) if q >= quality),
        key=lambda k: points[k][1],
        default=-1,
    ),
    "compose": rotated_step,
    "heading_between": lambda a, b, t: np.angle(
        np.exp(1j * (a + t * np.angle(np.exp(1j * b) / np.exp(1j * a))))
    ),
    "beam_angles": lambda n: [np.radians(-90 + i * 180 / (n - n % 2)) for i in range(n)],
    "cast_ray": met_by_solving,
    "distances": distances_bit_by_bit,
    "unwrapped": unwrapped_in_a_loop,
    "axial_mean": lambda angles: np.angle(np.mean(np.exp(2j * angles))) / 2,
    "fit_line": lambda points: np.arctan2(*np.linalg.svd(points - points.mean(0))[2][0][::-1]),
    "farthest_point": farthest_in_a_loop,
    "match_value": match_by_sampling,
    "least_translation": by_pseudo_inverse,
    "move_onto_walls": moved_by_pseudo_inverse,
    "edge_error": edge_error_by_matrices,
    "carried": carried_by_matrices,
    "reduction_rate": lambda a, b: 1 - len(b) / len(a) if len(a) else 0,
    "quality": quality_row_by_row,
    "reduction_at": reduction_by_hand,
    "mean_wall_error": wall_error_along_and_aside,
    "hough": hough_by_complex_numbers,
    "matches": matches_by_complex_numbers,
    "merged": merged_by_complex_numbers,
    "mean_shift_step": step_in_a_loop,
    "inside_strip": inside_in_a_loop,
    "best_shift": shift_in_a_loop,
    "cell_of": lambda x, c, r: int((x - c) / r) - ((x - c) / r < int((x - c) / r)),
    "grown": grown_by_arrays,
    "occupancy": lambda vis, occ, b: occ / vis if occ else np.interp(vis, [0, b], [0.5, 0.0]),
    "ray_cells": cells_by_formula,
    "pixel": lambda x, y, o, side, n: (int((o[1] + n * side - y) / side), int((x - o[0]) / side)),
    "scan_score": lambda p, pose, c: -cKDTree(c).query(transform(pose, p))[0].sum(),
    "climb_step": climb_in_a_loop,
    "pose_covariance": pose_covariance_by_moving,
    "verdict": verdict_by_complex_numbers,
    "invented_metres": metres_by_small_steps,
    "memberships": lambda squares, noise: (
        1 / (squares[:, None] / np.append(squares, noise**2)).sum(axis=1)
    ),
}


@EACH
def test_other_ways_to_the_right_answer_pass(exercise):
    """Catches a check that wants the library's code, its types or its rounding."""
    assert exercise(OTHER_WAYS[exercise.name])


# ---------------------------------------------------- an exercise teaches what the library does
def test_the_wrong_order_of_compose_differs_from_the_right_one():
    """The hint's claim by hand: the first pose is where the robot stands."""
    first, step = next(iter(course.check_compose.cases.values()))
    found = course.check_compose.solution(first, step)
    assert_poses_equal(found, (1, 3, np.pi / 2))
    assert_poses_equal(between(first, found), step)


@given(st.integers(0, 10**6))
def test_a_step_is_that_of_mean_shift(seed):
    """Catches an exercise that teaches another step than the method makes."""
    segments = np.random.default_rng(seed).uniform(0, 0.1, (6, 2, 2))
    begin, one = (
        common_directions(segments, sigma=0.2, bandwidth=5.0, steps=k).centres for k in (0, 1)
    )
    found = np.array(course.check_mean_shift_step.solution(begin, begin, 0.2, 5.0))
    np.testing.assert_allclose(found[:, :2], one[:, :2], atol=1e-9)
    np.testing.assert_allclose(axial_difference(found[:, 2], one[:, 2]), 0, atol=1e-9)


@given(st.integers(0, 10**6))
def test_a_verdict_is_that_of_the_viewing_sector(seed):
    """Catches an exercise that teaches another rule than the method keeps."""
    rng = np.random.default_rng(seed)
    wall, point, sensor = rng.uniform(-2, 2, (2, 2)), rng.uniform(-3, 3, 2), rng.uniform(-1, 1, 2)
    tiny = [point, point + rng.uniform(-1, 1, 2) * 1e-7]
    said = {view.says for view in views(wall, tiny, sensor, 0.3)}
    answer = course.check_verdict.solution(wall, point, sensor, 0.3)
    words = {1: "hides", 0: "matches", -1: "gone"}
    assert said == (set() if np.isnan(answer) else {words[answer]})


def test_a_milliradian_is_a_mistake():
    """Catches tolerances that let a slip through."""
    assert same_line(0.5 + 1e-9, 0.5) and not same_line(0.501, 0.5)
    poses = np.array([[1.0, 2.0, 0.5]])
    assert same_poses(poses, poses)
    assert not same_poses(poses + [0, 0, 1e-6], poses)


# ------------------------------------------------------------------------- hidden cases
@EACH
@pytest.mark.parametrize("seed", [1, 20])
def test_hidden_cases_catch_every_mistake_and_let_other_ways_pass(exercise, seed):
    """Catches hidden cases that are easier than the open ones, or that only the library solves."""
    cases = exercise.fresh(seed)
    assert exercise.check(OTHER_WAYS[exercise.name], cases)
    for mistake in exercise.mistakes.values():
        assert not exercise.verdict(answered(mistake, cases), cases)


@EACH
def test_answers_travel_as_json_and_are_judged_elsewhere(exercise):
    """Catches answers that only the process of the student can read, and a seed that drifts."""
    cases = exercise.fresh(3)
    sent = json.loads(json.dumps(exercise.answers(OTHER_WAYS[exercise.name], cases)))
    assert exercise.verdict(sent, exercise.fresh(3))
    stolen = json.loads(json.dumps(exercise.answers(exercise.solution, cases)))
    assert "write your own" in exercise.verdict(stolen, cases).hint
    assert repr(cases) == repr(exercise.fresh(3)) != repr(exercise.fresh(4))


@pytest.mark.parametrize("answers", [None, [], [1, 2, 3], "abc", [{}] * 4, {"values": []}])
def test_answers_that_somebody_made_up_fail(answers):
    """Catches a verdict that trusts what it is sent."""
    assert not course.check_compose.verdict(answers)
    twisted = [{"shape": shape, "values": [1.0]} for shape in ("x", [7], [-1], [1e9])]
    assert not course.check_compose.verdict(twisted)
