"""Right answers with a bug that a rule puts in: what passes the hidden cases is right as well."""

import inspect
from pathlib import Path

import mutants
import numpy as np
import pytest
from right_answers import RIGHT
from segmap_course import EXERCISES

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
    hidden = [case for draw in range(5) for case in exercise.fresh((4711, draw)).values()]
    graded = dict(enumerate([*exercise.cases.values(), *hidden]))
    drawn = [case for seed in range(40) for case in exercise.fresh(seed).values()]
    others = [tuple(moved(value, rng) for value in case) for case in drawn]
    many = dict(enumerate([*drawn, *others]))

    def right(function):
        return np.array([bool(exercise(function, dict([case]))) for case in many.items()])

    sound, bugs = right(RIGHT[name]), list(with_bugs(name))
    assert len(bugs) > 1 and sound[: len(drawn)].all() and sound.mean() > 0.7
    passed = [pair for pair in bugs if exercise(pair[1], graded)]
    assert [words for words, bug in passed if not right(bug)[sound].all()] == []
