"""Open exercises: an answer that passes, one that fails for each reason, and nothing yet."""

from pathlib import Path

import numpy as np
import pytest
import segmap_course as course
from segmap_course import EXERCISES, OPEN_EXERCISES, Challenge, Check, Prediction
from segmap_course.exercises.open.own_log import BUNDLED

from segmap import readers
from segmap.scans import Log
from segmap.simulation import URG_04LX, rectangular_room, simulate

#: A level wall of 2 m that passes near the origin, with 8 mm of noise, and one that does not.
NEAR = np.stack([np.linspace(2, 4, 41), 0.001 + 0.008 * (-1.0) ** np.arange(41)], axis=-1)
FAR = NEAR + (0, 1)
BENT = NEAR + [(0.0, 0.1 * (k > 20)) for k in range(41)]

#: Two walls along x, without an end in sight.
CORRIDOR = [[(-15, -1), (15, -1)], [(-15, 1), (15, 1)]]
#: Bars of 1 cm with gaps of 4 cm.
FENCE = [[(x, 1), (x + 0.01, 1)] for x in np.arange(-2, 2, 0.05)]
CHARACTERS = np.full(63, 0x40)
FLIPPED = CHARACTERS + np.where(np.arange(63) == 0, 1, 0)  # one bit, then the same bit back:
CANCELLED = np.where(np.arange(63) == 1, 0x41, 0x40), np.where(np.arange(63) == 0, 0x41, 0x40)

#: Exercise -> an answer that passes, and answers that fail, with words of the reason.
ANSWERS = {
    "predict_drift": (8.0, [(0.17, "it is 8.632 m"), (100, "within a factor of 1.3")]),
    "break_reader": (
        [8.19, 8.2, 2.0, 3.0],
        [
            ([8.19, 8.2, 20.0], "0 of 3 walls are lost, 2 are wanted"),
            ([8.19, 8.2, 1.0, 2.0, 3.0], "2 of 5 walls are lost, 3 are wanted"),
            ([60.0] * 5, "0.1 to 30 m away"),
            ([8.19], "give 3 to 361 ranges"),
        ],
    ),
    "predict_pieces": (35, [(8, "At least 2 pi"), (100, "within a factor of 1.3")]),
    "break_line": (
        NEAR,
        [
            (FAR, "it is turned by 0."),
            (NEAR * (1, 0), "has no solution"),
            (BENT, "a straight wall is wanted"),
            (NEAR * (0.1, 1), "a straight wall is wanted: 1 m long"),
            (NEAR + 30, "stay within 20 m"),
            (NEAR[:5], "give 20 to 1000 points"),
        ],
    ),
    "predict_beams_on_wall": (15, [(11, "it is 15 beams; near enough is within 1 beams")]),
    "break_quality": (
        [*rectangular_room().tolist(), [(10, 10), (16, 10)]],
        [
            (rectangular_room(), "only 0.0 m of walls are invented"),
            ([[(10, 10), (16, 10)]], "the quality sees it: 0.000"),
            ([(10, 10), (16, 10)], "got shape (2, 2)"),
            ([[(10, 10), (16, np.nan)]], "finite numbers are wanted"),
            ([[(10, 10), (1e6, 0)]], "stay within 20 m"),
        ],
    ),
    "predict_coarse_leaves": (3300, [(4244, "it is 3169 leaves"), (2000, "factor of 1.15")]),
    "break_matching": (
        CORRIDOR,
        [
            (rectangular_room() - (2, 1.5), "ends 0 cm from the truth"),
            ([*CORRIDOR, [(2, -1), (2, 1)], [(-2, -1), (-2, 1)]], "cm from the truth, 20"),
            ([[(15, -1), (16, -1)]], "only 0 of 720 beams"),
            ([[(2, -3), (2, 3)]], "the score sees it: 220 mm"),
            ([(0, 1), (1, 1)], "got shape (2, 2)"),
            ([[(0, 1), (21, 1)]], "stay within 20 m"),
        ],
    ),
    "break_cells": (
        ([*FENCE, [(-8, 4), (8, 4)]], [(0, 0), (0.5, 0)]),
        [
            ((rectangular_room(), [(2, 1.5)]), "0 of "),
            ((rectangular_room(), [(1, 1), (2, 2), (3, 1)]), "7 of 417 cells that were hit"),
            ((rectangular_room(), [2, 1.5]), "give 1 to 30 places"),
            ((rectangular_room(), [(2, 21)]), "stay within 20 m"),
            ((rectangular_room()[0], [(2, 1.5)]), "give 1 to 400 walls"),
        ],
    ),
    "break_basic_order": (
        [7, 1, 5, 2, 11, 14, 4, 19, 13, 3, 12, 8, 16, 15, 10, 0, 6, 18, 17, 9, 20],
        [
            (range(21), "Basic leaves 1 segments, 8 at least are wanted"),
            ([*range(20), 19], "each of the numbers 0 to 20 once"),
            (range(20), "each of the numbers 0 to 20 once"),
        ],
    ),
    "decide_map": (
        {"A": "keep", "B": "doubled", "C": "spread", "D": "tape"},
        [
            ({"A": "tape", "B": "tape", "C": "spread", "D": "keep"}, "D is not the one to keep"),
            ({"A": "keep", "B": "tape", "C": "tape", "D": "tape"}, "C: 'tape' does not speak"),
            ({"A": "keep", "B": "keep", "C": "spread", "D": "keep"}, "keep one, and refuse"),
            ({"D": "keep"}, "name each of A, B, C, D"),
            (["D"], "decide first"),
        ],
    ),
    "predict_bend": (5, [(71, "it is 4.455 mm; near enough is within a factor of 2")]),
    "predict_crowd": (0.63, [(0.82, "it is 0.631 parts of 1")]),
    "predict_survivors": (63, [(100, "it is 63.4 particles"), (50, "near enough is within 3")]),
    "decide_way": (
        {"K": "wall", "L": "long", "M": "keep", "N": "unknown"},
        [
            ({"K": "keep", "L": "long", "M": "long", "N": "unknown"}, "K is not the one to keep"),
            ({"K": "long", "L": "long", "M": "keep", "N": "wall"}, "K: 'long' does not speak"),
        ],
    ),
    "predict_sparse_icp": (0.1, [(2.0, "near enough is within 0.15 m")]),
    "break_icp": (
        (0.1, -0.57, -0.18),
        [
            ((0, 0, 0), "it is 0.00"),
            ((1.1, 0, 0), "stay within 1 m"),
            ((0.1, 0, 0.6), "stay within 1 m and 30 degrees"),
            ((-1, 0, 0), "it is not sure: it may be 1.00 m off"),
            ((0, 1, 0), "it says so: "),
            ((0, 0), "got (2,)"),
        ],
    ),
    "predict_scan_time": (190, [(148, "it is 185.2 ms")]),
    "break_sum": (
        CANCELLED,
        [
            ((CHARACTERS, FLIPPED), "the sum sees it"),
            ((CHARACTERS, CHARACTERS), "no distance is off by more than 0 mm"),
            ((CHARACTERS, CHARACTERS + 3), "at most two bits may be wrong, these are 126"),
            ((CHARACTERS, CHARACTERS[:60]), "received: give 63 whole numbers"),
            ((CHARACTERS - 0x20, CHARACTERS), "sent: characters lie between 0x30 and 0x6f"),
        ],
    ),
}


def test_each_open_exercise_is_in_reach_and_tested_here():
    """Catches one that no chapter can call, or that nobody has ever answered."""
    assert set(ANSWERS) | {"check_own_log"} == set(OPEN_EXERCISES) and not (
        set(OPEN_EXERCISES) & set(EXERCISES)
    )
    for name, exercise in OPEN_EXERCISES.items():
        assert getattr(course, name) is exercise and repr(exercise).startswith(f"{name}(")


#: What is no answer to any of them.
JUNK = [None, ..., "text", [], {}, object, True, [1, 2, 3], np.nan, np.inf, 10**5000, (), [[]]]


@pytest.mark.parametrize("name", ANSWERS)
def test_an_open_exercise_passes_and_fails_with_its_reason(name):
    """Catches one that raises, or that passes whatever it is given."""
    exercise, (right, wrong) = OPEN_EXERCISES[name], ANSWERS[name]
    assert exercise(right)
    for answer, words in wrong:
        found = exercise(answer)
        assert isinstance(found, Check) and not found and words in found.hint
    assert " first" in exercise(None).hint
    for junk in JUNK:
        assert not exercise(junk) and exercise(junk).hint


# ------------------------------------------------------------------------- near enough
@pytest.mark.parametrize(
    ("true", "near", "guess", "passes", "words"),
    [
        (10.0, {"factor": 2}, 5, True, "it is 10 m"),
        (10.0, {"factor": 2}, 4.9, False, "within a factor of 2"),
        (10.0, {"factor": 2}, 20, True, ""),
        (10.0, {"factor": 2}, 20.1, False, ""),
        (10.0, {"factor": 2}, -10, False, ""),
        (0.0, {"factor": 2, "within": 0.5}, 0, True, ""),
        (0.0, {"factor": 2, "within": 0.5}, -0.5, True, ""),
        (0.0, {"factor": 2, "within": 0.5}, 1, False, "within a factor of 2 or within 0.5 m"),
        (0.1 + 0.2, {}, 0.3, True, ""),
        (0.1 + 0.2, {}, 0.31, False, "the number itself"),
        (0.3, {"within": 0.1}, 0.4, True, ""),
    ],
)
def test_a_guess_is_near_enough_by_a_factor_or_a_distance(true, near, guess, passes, words):
    """Catches a division by the guess or by a true value of 0, and rounding that decides."""
    found = Prediction("predict(guess)", lambda: true, "m", **near)(guess)
    assert bool(found) is passes and words in found.hint


# ------------------------------------------------------------------------- breaking it
def test_a_judge_takes_several_parts_and_never_raises():
    both = Challenge("break_order(a, b): two numbers", lambda a, b: "" if a > b else "a is less")
    assert both((2, 1)) and both((1, 2)).hint == "a is less"
    assert "cannot be judged, TypeError" in both(3).hint
    call = Challenge("break_share(n): a number", lambda n: str(1 / int(n)))
    assert "cannot be judged, ZeroDivisionError" in call(0).hint
    assert "numbers are wanted, got function" in call(lambda: "").hint


# ------------------------------------------------------------------------ a log of one's own
@pytest.fixture(scope="module")
def own_log():
    path = np.column_stack([np.linspace(0.5, 3.0, 24), np.full(24, 1.5), np.zeros(24)])
    walls = rectangular_room()
    return simulate(walls, path, sensor=URG_04LX, rng=np.random.default_rng(1))


def test_a_log_of_ones_own_passes_with_its_facts(own_log):
    found = course.check_own_log(own_log, own_log.truth)
    assert found, found
    assert "24 scans" in found.hint and "2.5 m driven" in found.hint


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda log: (None, None), "give your log first"),
        (lambda log: ("my.log", None), "segmap.readers.read(path)"),
        (lambda log: (log, None), "give the poses too"),
        (lambda log: (log, log.truth[:5]), "poses must be (24, 3)"),
        (lambda log: (log[:10], log.truth[:10]), "at least 20 scans are wanted"),
        (lambda log: (log, log.truth * 0), "at least 1 metres are wanted"),
        (lambda log: (log, log.truth * np.nan), ""),
        (lambda log: (Log("none", []), np.zeros((0, 3))), ""),
    ],
)
@pytest.mark.filterwarnings("ignore")
def test_a_log_that_lacks_something_is_told_so(own_log, change, words):
    found = course.check_own_log(*change(own_log))
    assert not found and found.hint and words in found.hint


def test_bundled_logs_are_recognised_though_renamed_and_cut():
    """Catches the example of the chapter that is handed in as one's own."""
    folder = Path(readers.data_file("malaga")).parent
    assert sorted(path.parent.name for path in folder.glob("*/*.log.gz")) == sorted(BUNDLED)
    log = readers.load("room")
    found = course.check_own_log(Log("mine", log.scans[5:50]), log.truth[5:50])
    assert not found and "bundled log 'room'" in found.hint
