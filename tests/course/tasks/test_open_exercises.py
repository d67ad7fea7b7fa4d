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

#: Bars of 1 cm with gaps of 4 cm.
FENCE = [[(x, 1), (x + 0.01, 1)] for x in np.arange(-2, 2, 0.05)]

#: Exercise -> an answer that passes, and answers that fail, with words of the reason.
ANSWERS = {
    "predict_drift": (8.0, (0.17, "it is 8.632 m"), (100, "within a factor of 1.3")),
    "break_reader": ([8.19, 8.2, 2.0, 3.0],
        ([8.19, 8.2, 20.0], "0 of 3 walls are lost, 2 are wanted"),
        ([8.19, 8.2, 1.0, 2.0, 3.0], "2 of 5 walls are lost, 3 are wanted"),
        ([60.0] * 5, "0.1 to 30 m away"), ([8.19], "give 3 to 361 ranges")),
    "predict_beams_on_wall": (15, (11, "it is 15 beams; near enough is within 1 beams")),
    "break_cells": (([*FENCE, [(-8, 4), (8, 4)]], [(0, 0), (0.5, 0)]),
        ((rectangular_room(), [(2, 1.5)]), "0 of "),
        ((rectangular_room(), [(1, 1), (2, 2), (3, 1)]), "7 of 417 cells that were hit"),
        ((rectangular_room(), [2, 1.5]), "give 1 to 30 places"),
        ((rectangular_room(), [(2, 21)]), "stay within 20 m"),
        ((rectangular_room()[0], [(2, 1.5)]), "give 1 to 400 walls")),
    "decide_map": ({"A": "keep", "B": "doubled", "C": "verdict", "D": "tape"},
        ({"A": "tape", "B": "tape", "C": "verdict", "D": "keep"}, "D is not the one to keep"),
        ({"A": "keep", "B": "tape", "C": "tape", "D": "tape"}, "C: 'tape' does not speak"),
        ({"A": "keep", "B": "keep", "C": "verdict", "D": "keep"}, "keep one, and refuse"),
        ({"D": "keep"}, "name each of A, B, C, D"), (["D"], "decide first")),
    "predict_crowd": (0.63, (0.82, "it is 0.631 parts of 1")),
    "predict_survivors": (63, (100, "it is 63.4 particles"), (50, "near enough is within 3")),
    "decide_way": ({"K": "long", "L": "unknown", "M": "keep", "N": "wall"},
        ({"K": "keep", "L": "long", "M": "long", "N": "wall"}, "K is not the one to keep"),
        ({"K": "wall", "L": "unknown", "M": "keep", "N": "wall"}, "K: 'wall' does not speak")),
    "predict_sparse_icp": (0.1, (2.0, "near enough is within 0.15 m")),
    "break_icp": ((0.1, -0.57, -0.18), ((0, 0, 0), "it is 0.00"), ((0, 0), "got (2,)"),
        ((1.1, 0, 0), "stay within 1 m"), ((0.1, 0, 0.6), "stay within 1 m and 30 degrees"),
        ((-1, 0, 0), "it is not sure: it may be 1.00 m off"), ((0, 1, 0), "it says so: ")),
}  # fmt: skip


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
    exercise, (right, *wrong) = OPEN_EXERCISES[name], ANSWERS[name]
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


def test_bundled_logs_are_recognised_though_renamed_and_cut():
    """Catches the example of the chapter that is handed in as one's own."""
    folder = Path(readers.data_file("malaga")).parent
    assert sorted(path.parent.name for path in folder.glob("*/*.log.gz")) == sorted(BUNDLED)
    log = readers.load("room")
    found = course.check_own_log(Log("mine", log.scans[5:50]), log.truth[5:50])
    assert not found and "bundled log 'room'" in found.hint
