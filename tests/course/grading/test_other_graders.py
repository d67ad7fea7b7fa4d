"""The same checks for other graders: results.json for Gradescope, tests for otter-grader."""

import doctest
import json

import pytest
from programs import program
from segmap_course import EXERCISES
from segmap_course.grading import read_key
from submitted import COMPOSE, WRONG, solution

main = program("segmap_course")


@pytest.fixture(scope="module")
def handed(tmp_path_factory):
    """Chapters 11, 13 and 66 handed out with the tests for otter."""
    folder = tmp_path_factory.mktemp("course") / "lab"
    options = ["--chapters", "11,13,66", "--seed", "4711", "--otter"]
    assert main(["handout", str(folder), *options]) == 0
    return folder


def passes_shown_only():
    """An answer that knows the open cases by heart."""
    known = [(repr(case), case) for case in EXERCISES["compose"].cases.values()]
    right = {key: EXERCISES["compose"].solution(*case).tolist() for key, case in known}
    return (
        f"def my_compose(a, b):\n    known = {right!r}\n"
        "    return known.get(repr((a, b)), [0, 0, 0])\n"
    )


# ------------------------------------------------------------------------------- Gradescope
def results(handed, folder, *answers):
    """The tests in results.json of a student who hands in these cells for `compose`."""
    folder.mkdir()
    cells = [{"cell_type": "code", "id": "compose-answer", "source": text} for text in answers]
    (folder / "11_scans_and_poses.ipynb").write_text(json.dumps({"cells": cells}))
    written, key = folder.with_name("results.json"), handed.with_name("lab.instructor.json")
    options = ["--key", str(key), "--unprotected"]
    assert main(["grade", str(folder), "-o", str(written), *options]) == 0
    return {test["name"]: test for test in json.loads(written.read_text())["tests"]}


def test_gradescope_reads_a_test_for_each_task(handed, tmp_path):
    """Catches a task that is lost, points by hand that count as lost, and a hidden case told."""
    found = results(handed, tmp_path / "ann", COMPOSE)
    asked = [t for t in read_key(handed.with_name("lab.instructor.json")).tasks if not t.by_hand]
    assert {name: test["max_score"] for name, test in found.items()} == {
        task.name: task.points for task in asked
    }
    right = {"name": "compose", "score": 4.0, "max_score": 4, "status": "passed"}
    assert found["compose"] == right | {"output": "Right.", "visibility": "visible"}
    assert found["cast_ray"]["score"] == 0 and found["cast_ray"]["status"] == "failed"
    assert found["cast_ray"]["output"].startswith("Missing: no cell defines my_cast_ray")


def test_gradescope_shows_the_hint_and_no_hidden_case(handed, tmp_path):
    """Catches an answer without a hint, and one that tells the cases of the seed."""
    wrong = results(handed, tmp_path / "ann", WRONG)["compose"]
    assert (wrong["score"], wrong["status"]) == (0, "failed")
    assert "turn it by the first heading" in wrong["output"] and "expected [" in wrong["output"]
    heart = results(handed, tmp_path / "bob", passes_shown_only())["compose"]
    assert heart["score"] == 0
    assert (
        heart["output"]
        == "Wrong: right on the cases shown; on a hidden one it gives another answer"
    )


# ------------------------------------------------------------------------------------ otter
def points(path, source):
    """What a test file gives for a cell, read as otter reads its OK format: without otter."""
    scope, space = {}, {}
    exec(path.read_text(), scope)
    exec(source, space)
    assert scope["OK_FORMAT"]
    cases = [case for suite in scope["test"]["suites"] for case in suite["cases"]]
    won = 0
    for case in cases:
        test = doctest.DocTestParser().get_doctest(case["code"], dict(space), "case", None, 0)
        said = []
        failed = doctest.DocTestRunner(verbose=False).run(test, out=said.append).failed
        won += 0 if failed else case["points"]
        assert not failed or "AssertionError: not yet: " in "".join(said)
    return won, sum(case["points"] for case in cases)


def test_otter_finds_a_file_for_each_task(handed):
    """Catches a task without a test, and the seed in what students get."""
    tests = handed.with_name("lab.otter")
    held = {f"{path.parent.name}.ipynb {path.stem}" for path in tests.rglob("*.py")}
    tasks = read_key(handed.with_name("lab.instructor.json")).tasks
    assert held == {f"{t.chapter} {t.name}" for t in tasks if not t.by_hand}
    assert all("4711" in path.read_text() for path in tests.rglob("compose.py"))
    assert not any("4711" in path.read_text() for path in handed.iterdir())


def test_otter_gives_the_points_of_the_grader(handed):
    """Catches hidden cases that are not asked, and an answer by heart that passes."""
    (path,) = handed.with_name("lab.otter").rglob("compose.py")
    sources = [COMPOSE, WRONG, passes_shown_only()]
    head = "import numpy as np\n"
    assert [points(path, head + source) for source in sources] == [(4, 4), (0, 4), (0, 4)]


@pytest.mark.parametrize("name", ["cast_ray", "predict_beams_on_wall", "break_cells"])
def test_otter_takes_each_kind_of_task(handed, name):
    """Catches a check that is called by another name, or with a tuple of values torn apart."""
    (path,) = handed.with_name("lab.otter").rglob(f"{name}.py")
    wanted, source = solution(name)
    won, of = points(path, source)
    assert won == of > 0
    nothing = f"{wanted.replace(', ', ' = ')} = None"
    assert points(path, f"def {wanted}(*_): 1" if name in EXERCISES else nothing)[0] == 0
