"""Right answers with a bug that a rule puts in: what the grader lets pass is right all the same."""

import inspect
from pathlib import Path

import mutants
import numpy as np
import pytest
from right_answers import RIGHT
from segmap_course import EXERCISES
from segmap_course.exercises._answers import agree, answered
from segmap_course.grading._grade import _hidden

PATH = Path(inspect.getfile(RIGHT["compose"]))


def with_bugs(name):
    """The answers that a bug in the lines of the right one makes, each with the bug's words."""
    lines, first = inspect.getsourcelines(RIGHT[name])
    text = PATH.read_text()
    for bug in mutants.changes(PATH):
        if first <= text.count("\n", 0, bug.place) + 1 < first + len(lines):
            changed = text[: bug.place] + bug.new + text[bug.place + len(bug.old) :]
            exec(changed, space := {"__name__": "changed"})
            yield str(bug), space["RIGHT"][name]


def moved(value, rng):
    """An argument with other numbers, where it has some that are not whole."""
    if isinstance(value, float | np.ndarray) and np.asarray(value).dtype.kind == "f":
        return value + rng.normal(0, 0.05, np.shape(value))
    return value


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore")  # of numbers that no bug should have met
@pytest.mark.parametrize("name", EXERCISES)
def test_a_bug_that_passes_is_none(name):
    """On many hidden cases, and on these with other numbers, as far as they are cases still.

    What differs at a tie alone is no mistake: none of these is one.
    """
    exercise, rng = EXERCISES[name], np.random.default_rng(1)
    graded = dict(enumerate([*exercise.cases.values(), *_hidden(exercise, 4711)]))
    drawn = [case for seed in range(40) for case in exercise.fresh(seed).values()]
    others = [tuple(moved(value, rng) for value in case) for case in drawn]
    many = dict(enumerate([*drawn, *others]))
    expected = exercise.expected(many)

    def right(function):
        pairs = zip(answered(function, many), expected, strict=True)
        return np.array([agree(*pair, exercise.same) for pair in pairs])

    sound, bugs = right(RIGHT[name]), list(with_bugs(name))
    assert len(bugs) > 1 and sound[: len(drawn)].all() and sound.mean() > 0.7
    passed = [pair for pair in bugs if exercise.verdict(answered(pair[1], graded), graded)]
    assert [words for words, bug in passed if not right(bug)[sound].all()] == []
