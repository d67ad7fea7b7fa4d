"""Source notebooks of all chapters, and the command: what nbgrader is given, without nbgrader."""

import doctest
import json
import re
from itertools import permutations

import numpy as np
import pytest
import segmap_course as course
from chapter_rules import CHAPTERS
from handed_in import HEART, RIGHT
from programs import program
from segmap_course import EXERCISES, OPEN_EXERCISES
from segmap_course.grading import (
    JUDGED,
    otter_tests,
    own_case,
    read_chapter,
    solution,
    source_notebook,
    tasks_of,
)

main = program("segmap_course")
SEED = 987654321


@pytest.fixture(scope="module")
def sources():
    """Chapter -> its source notebook, in a handout of all of them."""
    books = {path.name: read_chapter(path) for path in CHAPTERS}
    return {name: source_notebook(name, book, SEED, books) for name, book in books.items()}


def all_cells(sources):
    return [cell for book in sources.values() for cell in book["cells"]]


def test_a_source_has_no_outputs_and_a_place_for_the_name(sources):
    code = [cell for cell in all_cells(sources) if cell["cell_type"] == "code"]
    assert len(code) > 300
    assert all(cell["outputs"] == [] and cell["execution_count"] is None for cell in code)
    assert all(b["cells"][1]["source"].startswith("**Name:**") for b in sources.values())


def test_the_seed_stands_in_hidden_cases_alone(sources):
    """Catches a seed that nbgrader leaves in the release."""
    marks = re.compile(r"### BEGIN HIDDEN TESTS\n.*?### END HIDDEN TESTS", re.DOTALL)
    with_seed = [c for c in all_cells(sources) if str(SEED) in json.dumps(c)]
    assert len(with_seed) > 40
    assert not any(str(SEED) in marks.sub("", cell["source"]) for cell in with_seed)
    assert all(cell["id"].endswith("-test") for cell in with_seed)


def test_every_exercise_of_the_chapters_has_an_answer_a_check_and_points(sources):
    """Catches a chapter whose exercise is written in another way, and is lost."""
    called = r"^course\.check_(\w+)\("
    text = "\n".join(cell["source"] for path in CHAPTERS for cell in read_chapter(path)["cells"])
    asked = set(re.findall(called, text, re.M)) & set(EXERCISES)
    cells = {cell["id"]: cell for cell in all_cells(sources)}
    assert len(asked) > 40
    for name in asked:
        assert "course.check" not in cells[f"{name}-answer"]["source"]
        assert f"4 * bool(course.check_{name}(" in cells[f"{name}-test"]["source"]
        assert cells[f"{name}-test"]["metadata"]["nbgrader"]["points"] == 4


def test_stubs_are_no_solutions(sources):
    """Catches a chapter that prints the answer in the cell for it."""
    answers = [c["source"] for c in all_cells(sources) if c["id"].endswith("-answer")]
    for text in answers:
        stub, _, rest = text.partition("\n\n\n### BEGIN SOLUTION\n")
        assert rest.endswith("\n### END SOLUTION")
        stub = stub.partition("  # ")[0]
        assert "def " not in stub or stub.endswith(("...", "None")), stub


#: What a student makes of a cell -> its type, its source, and the hint.
MISPLACED = {
    "text": ("markdown", RIGHT, "there is no answer: write it in a cell of code above this one"),
    "split": ("code", "def my_compose(a, b): ...", "write all of it in one cell"),
    "import below": ("code", RIGHT.replace("np.", "numpy."), "it uses numpy, which no cell"),
}


@pytest.mark.parametrize("words", MISPLACED)
def test_what_stands_in_the_wrong_cell_has_a_hint(sources, words):
    """Catches a bare NameError where students do not know what to move."""
    kind, text, hint = MISPLACED[words]
    (book,) = (book for name, book in sources.items() if name.startswith("02_"))
    cells = {cell["id"]: dict(cell) for cell in book["cells"]}
    cells["compose-answer"] |= {"cell_type": kind, "source": text}
    space = {"np": np, "course": course}
    for name in ("compose-none", "compose-answer"):
        if cells[name]["cell_type"] == "code":
            exec(cells[name]["source"], space)
    found = eval(cells["compose-check"]["source"], space)
    assert not found and hint in found.hint


# ------------------------------------------------------------------- a case of its own
#: Task of judgement -> its chapter, and what stands around the number of its case.
DECIDED = {
    "decide_map": ("13_", ["floor {} of", "unknown_building({})"]),
    "decide_way": ("61_", ["`course.four_ways({})`", "in enumerate(course.four_ways({})"]),
}


def decided(task, seed):
    """The cells of a chapter in the source of a seed, and what of them students get."""
    (path,) = (path for path in CHAPTERS if path.name.startswith(DECIDED[task][0]))
    book = source_notebook(path.name, read_chapter(path), seed)
    hidden = re.compile(r"### BEGIN (HIDDEN TESTS|SOLUTION)\n(.*?)### END \1", re.DOTALL)
    sources = {cell["id"]: cell["source"] for cell in book["cells"]}
    return sources, {name: hidden.sub("", source) for name, source in sources.items()}


@pytest.mark.parametrize("task", DECIDED)
def test_each_handout_decides_on_a_case_of_its_own(task):
    """Catches a case that all years share, and an answer or a seal in what a student gets."""
    numbers, shown = set(), JUDGED[task].shown
    for seed in (SEED, SEED + 1):
        sources, given = decided(task, seed)
        case, text = own_case(task, seed), "\n".join(given.values())
        numbers.add(case.number)
        for place in DECIDED[task][1]:
            assert place.format(case.number) in text and place.format(shown) not in text
        assert not any(word in text for word in case.seals.split())
        assert str(case.solution) in sources[f"{task}-answer"] and str(seed) not in text
        assert str(case.solution) not in text
        assert f"course.{task}.noted(my_decision)" in given[f"{task}-check"]
        assert f"course.{task}(" not in text
    assert len(numbers) == 2 and shown not in numbers


@pytest.mark.parametrize("task", DECIDED)
def test_a_handed_out_decision_is_judged_by_its_own_case(task):
    """Catches points for the answer of the chapter's case, or for any answer that is whole."""
    sources, given = decided(task, SEED)
    case, asked = own_case(task, SEED), sources[f"{task}-test"].split("\n")
    (hidden,) = (line for line in asked if "noted" in line and " and " in line)
    names, words = case.decision.names, [*case.solution.values()]
    others = [{**case.solution, name: word} for name in names for word in words]
    others += [dict(zip(names, order, strict=True)) for order in permutations(words)]
    for answer in (case.solution, None, {}, *others):
        right = answer and all(
            word in (case.against[name] or ["keep"]) for name, word in answer.items()
        )
        won = eval(hidden.split("#")[0], {"course": course, "my_decision": answer})
        assert won == (2 if right else 0), answer
        if answer and [*answer.values()].count("keep") == 1:
            assert case.decision.noted(answer) and given


# --------------------------------------------------------------------------- the command


# ----------------------------------------------------------------------------- solutions
@pytest.mark.parametrize("name", OPEN_EXERCISES)
def test_the_open_exercises_are_answered_too(name):
    """Catches an input that no longer fools the method, and a measured number that is not near."""
    if name == "check_own_log":
        pytest.skip("a log of one's own")
    exec(solution(name, "mine"), space := {})
    assert OPEN_EXERCISES[name](space["mine"])


# --------------------------------------------------------------------------------- otter
@pytest.fixture(scope="module")
def otter():
    """Task -> its test, read as otter reads its OK format: without otter."""
    tasks = [t for p in CHAPTERS if p.name.partition("_")[0] in ("02", "53", "58")
             for t in tasks_of(p.name, read_chapter(p))]  # fmt: skip
    files = otter_tests(tasks, 4711)
    assert {name.partition("/")[0] for name in files} == {t.chapter[:-6] for t in tasks}
    found = {}
    for name, text in files.items():
        exec(text, space := {})
        assert space["OK_FORMAT"]
        found[name.partition("/")[2][:-3]] = space["test"]
    assert set(found) == {task.name for task in tasks if not task.by_hand}
    return found


def points(test, source):
    """What a test gives for a cell, and of how many points."""
    exec(source, space := {"np": np})
    cases = [case for suite in test["suites"] for case in suite["cases"]]
    won = 0
    for case in cases:
        asked = doctest.DocTestParser().get_doctest(case["code"], dict(space), "case", None, 0)
        said = []
        failed = doctest.DocTestRunner(verbose=False).run(asked, out=said.append).failed
        won += 0 if failed else case["points"]
        assert not failed or "AssertionError: not yet: " in "".join(said)
    return won, sum(case["points"] for case in cases)


@pytest.mark.parametrize(
    ("name", "source", "right"),
    [
        ("compose", RIGHT, True),
        ("compose", "def my_compose(a, b):\n    return a + b", False),
        ("compose", f"my_compose = lambda a, b: {HEART}.get(repr((a, b)), [0, 0, 0])", False),
        ("predict_beams_on_wall", "my_beams = 15", True),
        ("predict_beams_on_wall", "my_beams = None", False),
    ],
)
def test_otter_gives_the_points_of_nbgrader(otter, name, source, right):
    """Catches hidden cases that are not asked, and an answer by heart that passes."""
    won, of = points(otter[name], source)
    assert won == (of if right else 0) and of > 0
