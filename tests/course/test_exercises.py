"""Exercises: the library passes, so do other ways to the answer; each mistake has its own hint."""

import numpy as np
import pytest
import segmap_course as course
from hypothesis import given
from hypothesis import strategies as st
from right_answers import RIGHT
from segmap_course import EXERCISES, Check
from segmap_course.grading import solution

from segmap.angles import axial_difference
from segmap.reduction import common_directions

EACH = pytest.mark.parametrize("exercise", EXERCISES.values(), ids=EXERCISES)


# -------------------------------------------------------------- all exercises alike
def right(exercise):
    """The library's source as one's own function, and where it is the course's, another idea."""
    exec(solution(exercise.name, "mine"), space := {"np": np})
    return [space["mine"], *(RIGHT[name] for name in RIGHT if name == exercise.name)]


@EACH
def test_right_answers_pass_and_each_mistake_fails_with_its_own_hint(exercise):
    """On the cases that students see and on hidden ones. Catches cases that a wrong answer
    survives, mistakes that look alike, a check that wants the library's code, its types or its
    rounding, or takes a helper of the library for its answer, and a solution that misses what it
    calls."""
    assert getattr(course, f"check_{exercise.name}") is exercise
    assert repr(exercise) == f"check_{exercise.name}(your function): {exercise.task}"
    assert len(exercise.mistakes) >= 4, "students err in more ways"
    for cases in (exercise.cases, exercise.fresh(3)):
        for function in right(exercise):
            assert exercise(function, cases)
        for hint, mistake in exercise.mistakes.items():
            assert exercise(mistake, cases).hint == hint
    assert repr(exercise.fresh(3)) == repr(exercise.fresh(3)) != repr(exercise.cases)


#: Wrong in one step -> the exercise, and the answer; each of them passed once.
WRONG = {
    "it never turns": ("climb_diagonally", lambda f: lambda v, p, move, turn: f(v, p, move, 0.0)),
    "degrees": (
        "climb_diagonally",
        lambda f: lambda v, p, move, turn: f(v, p, move, np.degrees(turn)),
    ),
    "radians of": (
        "climb_diagonally",
        lambda f: lambda v, p, move, turn: f(v, p, move, turn / 57.3),
    ),
    "never to the left": (
        "climb_diagonally",
        lambda f: lambda v, p, *r: np.fmax(f(v, p, *r), [p[0], -9, -9]),
    ),
    "twice the angle": ("matches", lambda f: lambda a, b, d, angle: f(a, b, d, 2 * angle)),
    "half the angle": ("matches", lambda f: lambda a, b, d, angle: f(a, b, d, angle / 2)),
    "twice the distance": ("matches", lambda f: lambda a, b, d, angle: f(a, b, 2 * d, angle)),
    "without the last": ("best_run", lambda f: lambda points, q: f(points[:-1], q)),
    "without the first": (
        "best_run",
        lambda f: lambda points, q: f(points[1:], q) + (f(points[1:], q) >= 0),
    ),
    "front without its best": ("front", lambda f: lambda runs: f(runs)[:-1]),
    "far ahead only": (
        "cast_ray",
        lambda f: lambda *given: found if (found := f(*given)) > 0.5 else np.inf,
    ),
    "left of the corner by one": (
        "cell_of",
        lambda f: lambda points, corner, r: f(points, corner, r) - (points < corner),
    ),
}


@pytest.mark.parametrize("words", WRONG)
def test_an_answer_that_is_wrong_in_one_step_fails(words):
    """On the open cases, and on hidden ones of any seed."""
    name, wrong = WRONG[words]
    exercise, mine = EXERCISES[name], wrong(RIGHT[name])
    assert not exercise(mine)
    assert not any(exercise(mine, exercise.fresh(seed)) for seed in range(5))


def test_an_answer_that_is_off_by_less_than_is_shown_says_by_how_much():
    found = course.check_quality(lambda *maps: RIGHT["quality"](*maps) + 1e-7)
    assert "which is off by 1e-07" in found.hint


def broken(*_):
    raise RuntimeError("out <of> luck")


def spoil(*arguments):
    for argument in arguments:
        if isinstance(argument, np.ndarray):
            argument[...] = 0


#: What is no answer -> words that say why.
NO_ANSWERS = [
    (
        lambda *_: None,
        "returns nothing yet: write all of it in one cell, above this check; the task",
    ),
    (lambda *_: ..., "in one cell, above this check; the task is {e.task}"),
    (spoil, "returns nothing yet"),
    (3.0, "check_{e.name}(my_{e.name}), without a call"),
    (lambda: None, "raised TypeError"),
    (broken, "raised RuntimeError: out <of> luck"),
    *((lambda *_, answer=answer: answer, "") for answer in ("text", [], {}, object)),
    *((lambda *_, answer=answer: answer, "") for answer in (np.nan, np.inf, 10**5000)),
    (lambda *_: np.zeros((7, 7)), ""),
    (..., "write it in a cell of code above this one"),
]
#: One exercise for each way to compare.
COMPARED = {exercise.same: name for name, exercise in EXERCISES.items()}.values()


@EACH
def test_what_is_no_answer_fails_and_says_why(exercise):
    """Catches a check that passes whatever it is given, hands an exception on, or is spoilt."""
    every = 1 if exercise.name in COMPARED else 3
    for answer, words in NO_ANSWERS[::every]:
        found = exercise(answer)
        assert isinstance(found, Check) and not found and found.hint
        assert words.format(e=exercise) in found.hint


def test_an_unknown_mistake_is_answered_with_the_first_case_that_differs():
    """With its arguments, where they are few."""
    found = course.check_axial_mean(lambda angles: 7.0)
    (first,) = course.check_axial_mean.cases["two lines on both sides of 0 degrees"]
    mean = course.check_axial_mean.solution(first)
    assert found.hint == (
        f"for two lines on both sides of 0 degrees expected {mean:.6g}, got 7 "
        f"from axial_mean([{first[0]:.6g}, {first[1]:.6g}])"
    )
    found = course.check_beam_angles(np.arange)
    assert " expected an array (" in found.hint and " that starts [-1.5708, " in found.hint


# ---------------------------------------------------- an exercise teaches what the library does


@given(st.integers(0, 10**6))
def test_a_step_is_that_of_mean_shift(seed):
    """Catches an exercise that teaches another step than the method makes."""
    segments = np.random.default_rng(seed).uniform(0, 0.1, (6, 2, 2))
    begin, one = (
        common_directions(segments, sigma=0.2, bandwidth=5.0, steps=k).centres for k in (0, 1)
    )
    found = np.array(course.check_mean_shift_step.solution(begin, begin, np.ones(6), 0.2, 5.0))
    np.testing.assert_allclose(found[:, :2], one[:, :2], atol=1e-9)
    np.testing.assert_allclose(axial_difference(found[:, 2], one[:, 2]), 0, atol=1e-9)


def shifted(solution, off):
    return lambda *given: solution(*given) + off


def test_a_milliradian_is_a_mistake():
    """Catches tolerances that let a slip through."""
    for name, slip in (("axial_mean", 1e-3), ("compose", np.array([0, 0, 1e-6]))):
        check = EXERCISES[name]
        for part, fine in ((1e-6, True), (1.0, False)):
            assert bool(check(shifted(check.solution, part * slip))) == fine


# ------------------------------------------------------------- the library is no answer
@EACH
def test_the_library_itself_is_no_answer(exercise):
    """Catches an import that counts as an answer; a call of it is for who grades."""
    assert "this is the library's; write your own" in exercise(exercise.solution).hint


def test_a_function_of_ones_own_with_the_name_of_the_librarys_is_ones_own():
    def compose(a, b):
        return RIGHT["compose"](a, b)

    assert course.check_compose(compose)
