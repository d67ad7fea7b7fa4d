"""What was handed in, as it is read; and what is asked of each answer, without a jail."""

import json
import os
from types import SimpleNamespace

import numpy as np
import pytest
import submitted
from segmap_course import EXERCISES, OPEN_EXERCISES
from segmap_course.__main__ import main
from segmap_course.exercises import NOT_GIVEN, Raised
from segmap_course.grading import _grade, _submissions, graded, plan_of, read_key
from segmap_course.grading._grade import Plan, judged, needed
from segmap_course.grading._jail import Ended, Limits
from segmap_course.grading._report import Outcome
from segmap_course.grading._submissions import Answer, Book, Submission, submissions
from segmap_course.grading.handout import Task, package

F = Task("f", "x", ("my_f", "my_g"), 4, stub="def my_f(): ...\nmy_g = 0")


def cell(source, id="x", kind="code", **more):
    return {"cell_type": kind, "id": id, "source": source, **more}


def write(path, *cells, time=None):
    path.parent.mkdir(exist_ok=True)
    path.write_text(json.dumps({"cells": cells}))
    os.utime(path, (time or 1, time or 1))


def test_a_folder_of_submissions_is_read_whole(tmp_path):
    """Catches a name that is lost, a cell of another kind, and files of nobody."""
    named = cell(["# Lab\n", "**Name:** \t Ann Lee \n", "**Name:** Bob"], "n", "markdown")
    graded = cell("b", "y", metadata={"nbgrader": {"grade_id": "f-answer"}})
    write(tmp_path / "ann" / "b.ipynb", named, graded, time=5)
    write(tmp_path / "ann" / "a.ipynb", cell("**Name:** no", "c"), {"metadata": 3}, time=7)
    (tmp_path / "ann" / "c.ipynb").write_text("{" + "x" * 400)
    write(tmp_path / "ann" / ".ipynb_checkpoints" / "b.ipynb", cell("old"))
    (tmp_path / "ann" / "d.ipynb").symlink_to(tmp_path / "ann" / "b.ipynb")
    long = cell("**Name:**\n**Name:** " + "x" * 101, "n", "markdown")
    write(tmp_path / "bob.ipynb", long, cell(["x\n", "y"]))
    (tmp_path / "eve").mkdir()
    for name in ("notes.txt", ".hidden.ipynb"):
        (tmp_path / name).write_text("no")
    (tmp_path / "link.ipynb").symlink_to(tmp_path / "bob.ipynb")
    text = (tmp_path / "bob.ipynb").read_text()
    (tmp_path / "bob.ipynb").write_text("\ufeff" + text.replace('"x\\n"', '"\\ufeffx\\n"'))
    os.utime(tmp_path / "bob.ipynb", (1, 1))
    ann, bob, eve = submissions(tmp_path)
    said = ann.problems.pop()
    assert said.startswith("c.ipynb cannot be read: it is no notebook (JSONDecodeError: Exp")
    answers = [Answer("c", "code", "**Name:** no"), Answer("", "None", "")]
    first = Answer("n", "markdown", "".join(named["source"]))
    books = [Book("a.ipynb", 7, answers)]
    books += [Book("b.ipynb", 5, [first, Answer("f-answer", "code", "b")])]
    assert ann == Submission("ann", "Ann Lee", books, [])
    held = [Answer("n", "markdown", long["source"]), Answer("x", "code", "x\ny")]
    assert bob == Submission("bob", "x" * 100, [Book("bob.ipynb", 1, held)], [])
    assert eve == Submission("eve", "", [], ["the folder holds no notebook"])


def test_a_file_that_is_too_large_is_a_problem_of_300_letters(tmp_path, monkeypatch):
    path = tmp_path / f"{'n' * 240}.ipynb"
    write(path, cell("x"))
    monkeypatch.setattr(_submissions, "MOST_BYTES", path.stat().st_size)
    assert submissions(tmp_path)[0].problems == []
    monkeypatch.setattr(_submissions, "MOST_BYTES", path.stat().st_size - 1)
    (said,) = submissions(tmp_path)[0].problems
    assert said == f"{path.name} cannot be read: expected a file of at most 0 MB"[:300]
    path.unlink()
    path.mkdir()
    assert submissions(tmp_path)[0].problems == ["the folder holds no notebook"]
    (path / "x.ipynb").mkdir()
    assert "expected a file" in submissions(tmp_path)[0].problems[0]


def test_a_folder_without_sense_is_refused_in_words(tmp_path):
    for name in ("cid", "bob", "ann"):
        write(tmp_path / "in" / f"{name}.ipynb")
        (tmp_path / "in" / name).mkdir()
    (tmp_path / "in" / "dan").mkdir()
    with pytest.raises(ValueError, match=r"in holds a file and a folder named ann, bob, cid$"):
        submissions(tmp_path / "in")


def book(*cells, file="a.ipynb"):
    return Book(file, 0.0, [Answer(*each) for each in cells])


@pytest.mark.parametrize(
    ("cells", "found"),
    [
        ([], None),
        ([("f-answer", "code", "# nothing")], "# nothing"),
        ([("x", "code", "my_f = my_g = 1"), ("y", "code", "my_f = 2\nmy_g = 2")], 1),
        ([("x", "code", "my_f = 1\nmy_g = 1"), ("y", "code", "my_f = 2")], 0),
        ([("x", "markdown", "my_f = 1\nmy_g = 1")], None),
        ([("f-answer", "code", F.stub), ("x", "code", "my_f = 1\nmy_g = 1")], 1),
        ([("x", "code", "my_f = 1\nmy_g = 1"), ("f-answer", "code", "my_f = 2\nmy_g = 3")], 1),
        ([("x", "code", f"{F.stub}  # hm"), ("f-answer", "code", F.stub)], 1),
        ([("f-answer", "code", F.stub), ("x", "code", "my_f = 1")], 0),
        ([("g-answer", "code", "my_f = 1\nmy_g = 1")], None),
        ([("g-answer", "code", "x"), ("x", "code", "my_f, my_g = 1, (")], 1),
        ([("f-answer", "code", "my_f = 2\nmy_g = 3"), ("x", "code", "my_f = 1\nmy_g = 1")], 1),
        ([("f-answer", "code", "my_f, my_g = 3, 3"), ("x", "code", f"{F.stub}  # so?")], 0),
        ([("f-answer", "code", "my_f = my_g = 3"), ("g-answer", "code", "my_f = my_g = 1")], 0),
    ],
)
def test_the_cell_that_answers_a_task(cells, found):
    assert book(*cells).find(F) == (cells[found][2] if isinstance(found, int) else found)


def test_of_all_files_the_newest_with_something_written_counts():
    """Catches a note where all say the same, and the answer of an older file."""
    stub, one, two = (
        book(("f-answer", "code", text), file=f"{k}.ipynb")
        for k, text in enumerate([F.stub, "my_f = my_g = 1", "my_f = my_g = 2"])
    )
    written = ("f-answer", "code", "I think"), ("f_by_hand", "markdown", "so"), ("x", "code", "no")
    note = "f: 1.ipynb counts, the newest of 2 files that answer it"
    for books, found in [
        ([], (None, "")),
        ([book(("x", "code", "no"))], (None, "")),
        ([stub, stub], (F.stub, "")),
        ([stub, one], (one.cells[0].source, "")),
        ([one, one, stub], (one.cells[0].source, "")),
        ([stub, one, two], (one.cells[0].source, note)),
    ]:
        assert Submission("ann", "", books, []).find(F) == found
    both = book(("f-answer", "code", "my_f = my_g = 1"), ("x", "code", "my_f = my_g = 2"))
    note = "f: the last of 2 cells that answer it counts"
    assert Submission("ann", "", [both], []).find(F) == ("my_f = my_g = 2", note)
    assert Submission("ann", "", [both], []).beside("my_f = my_g = 2") == ["my_f = my_g = 1"]
    assert Submission("ann", "", [book(*written), one], []).written("f_by_hand") == (
        "I think\n\nso\n\nmy_f = my_g = 1"
    )
    assert Submission("ann", "", [one], []).written("g_by_hand") is None


# ------------------------------------------------------------------ from a folder to outcomes

COMPOSE, HAND = plan_of("11", None).tasks[0], Task("own_by_hand", "x", (), 6, by_hand=True)
(GUESS,) = (task for task in plan_of("13", None).tasks if task.name == "predict_beams_on_wall")


@pytest.fixture
def asked(monkeypatch):
    """Grades without a jail: cells of these tests run here; all that a jail would be asked."""
    seen = SimpleNamespace(jails=[], jobs=[])

    class Nowhere:
        def __init__(self, *given, **named):
            seen.jails.append((given, named))

        def __enter__(self):
            return self

        def __exit__(self, *_):
            pass

        __str__ = lambda self: "nowhere"  # noqa: E731

    def answers(jail, job, cases):
        seen.jobs.append((str(jail), job, cases))
        exec(f"{job['imports']}\n{job['cell']}", space := {})
        if "ends" in space:
            raise Ended("too long", space["ends"])
        if job["package"] is None:
            return [eval(job["given"], space)]
        return [space[job["names"][0]](*case) for case in cases]

    monkeypatch.setattr(_grade, "Jail", Nowhere)
    monkeypatch.setattr(_grade, "answers", answers)
    return seen


def test_what_becomes_of_each_answer(tmp_path, asked):
    """Catches a student who gets another's points, and hidden cases that nobody draws."""
    cells = {
        "ann": [cell(submitted.COMPOSE, "compose-answer"), cell("my_beams = 15")],
        "bob": [cell(submitted.WRONG, "compose-answer")],
        "cid": [cell("my_compose = 1\nends = 'slow'")],
        "eve": [cell("my_compose = ends = ''\n#" + " " * 199_976)],
        "fay": [cell("my_compose = 1\n#" + " " * 199_985)],
    }
    name = GUESS.answers[0]
    for student, made in cells.items():
        for each in made:
            each["source"] = each["source"].replace("my_beams", name)
        write(tmp_path / f"{student}.ipynb", *made)
    (tmp_path / "kim.ipynb").write_text("{")
    limits = Limits(1.0, 2, 3)
    plan = Plan([COMPOSE, HAND, GUESS], 3)
    rows = list(graded(tmp_path, plan, limits=limits, unprotected=True))
    assert [row.submission.student for row in rows] == ["ann", "bob", "cid", "eve", "fay", "kim"]
    assert {row.jail for row in rows} == {"nowhere"}
    found = {row.submission.student: row.outcomes for row in rows}
    missing = Outcome("missing", f"no cell defines {name}")
    right = Outcome("right", "", 1.0)
    assert found["ann"]["compose"] == right and found["ann"][GUESS.name].share == 1
    assert (found["bob"]["compose"].kind, found["bob"]["compose"].share) == ("wrong", 0)
    assert found["bob"][GUESS.name] == found["cid"][GUESS.name] == missing
    assert found["cid"]["compose"] == Outcome("too long", "slow")
    assert found["eve"]["compose"].kind == "too long" and len(cells["eve"][0]["source"]) == 200_000
    assert found["fay"]["compose"] == Outcome("too much", "the cell has 200001 characters")
    unread = found["kim"]["compose"]
    assert unread.kind == "unreadable" and unread.reason == "; ".join(rows[5].submission.problems)
    assert asked.jails == [((limits,), {"unprotected": True})]
    exercise = EXERCISES["compose"]
    hidden = [case for draw in range(5) for case in exercise.fresh((3, draw)).values()]
    jobs = {
        job["names"]: (jail, job, cases) for jail, job, cases in asked.jobs if "ends" not in job
    }
    jail, job, cases = next(each for each in asked.jobs if "def my_comp" in each[1]["cell"])
    wanted = [*exercise.cases.values(), *hidden]
    assert len(jobs) == 2 and jail == "nowhere" and len(cases) == len(wanted)
    for one, other in zip(cases, wanted, strict=True):
        assert all(np.array_equal(*pair) for pair in zip(one, other, strict=True))
    assert job == {
        "imports": "import numpy as np",
        "cell": job["cell"],
        "names": ("my_compose",),
        "given": "my_compose",
        "package": package(exercise),
    }
    assert jobs[GUESS.answers][1]["package"] is None and jobs[GUESS.answers][2] == [()]
    asked.jobs.clear()
    next(graded(tmp_path, Plan([COMPOSE])))
    assert len(asked.jobs[0][2]) == len(exercise.cases), "no seed, no hidden case"
    assert asked.jails[1:] == [((Limits(),), {"unprotected": False})]


def test_what_cannot_be_graded_is_said(tmp_path):
    write(tmp_path / "in" / "ann.ipynb")
    with pytest.raises(ValueError, match="ask for no answer"):
        next(graded(tmp_path / "in", Plan([])))


def test_a_plan_is_that_of_its_handout(tmp_path):
    assert main(["handout", str(tmp_path / "lab"), "--chapters", "11", "--seed", "3"]) == 0
    key = tmp_path / "lab.instructor.json"
    assert read_key(key) == plan_of("11", 3) == Plan(plan_of("11", None).tasks, 3, 0.0)
    held = json.loads(key.read_text())
    key.write_text(json.dumps(held | {"format": "segmap handout 9"}))
    with pytest.raises(ValueError, match="is written as 'segmap handout 9', this version reads"):
        read_key(key)
    key.write_text(json.dumps(held | {"tasks": [{"name": "f"}]}))
    with pytest.raises(ValueError, match="is no instructor's file of a handout"):
        read_key(key)


def test_a_verdict_tells_its_kind():
    """Catches a share for what is wrong, and an answer of the library that is called wrong."""
    exercise = EXERCISES["compose"]
    known, hidden = exercise.expected(), list(exercise.fresh(1).values())
    memory = Outcome("memory", "it asks for more memory than an answer may have")
    full = [*known, *exercise.expected(dict(enumerate(hidden)))]
    assert judged(exercise, full, hidden, 0.5) == Outcome("right", "", 1.0)
    assert judged(exercise, [*full[:-1], Raised("MemoryError", "")], hidden, 0.5) == memory
    assert judged(exercise, [*full[:-1], None], hidden).share == 0 == Outcome("ended", "x").share
    start = "right on the cases shown; on a hidden one it "
    for last, said in ((None, "gives another answer"), (Raised("KeyError", "3"), "raises an exce")):
        found = judged(exercise, [*full[:-1], last], hidden, 0.5)
        assert found[:1] + found[2:] == ("wrong", 0.5, "") and found.reason.startswith(start + said)
    given = judged(exercise, [Raised("LookupError", f"wrap {NOT_GIVEN}")] * len(full), hidden, 0.5)
    assert (given.kind, given.share) == ("library", 0.0) and NOT_GIVEN in given.reason
    guess = OPEN_EXERCISES["predict_beams_on_wall"]
    assert judged(guess, [15], [])[::2] == ("right", 1.0)
    assert judged(guess, [4], [], 0.5)[::2] == ("wrong", 0.0)


def test_of_the_imports_those_that_a_cell_uses():
    text = "import numpy as np\nimport os.path\nfrom math import cos, sin as s\nimport nothing"
    assert needed(text, "np.x; os.path; s(1); sin(2)") == (
        "import numpy as np\nimport os.path\nfrom math import sin as s"
    )
    assert needed(text, "npx = 3") == ""


@pytest.mark.parametrize("newest", ["a", "b", "c"])
def test_the_newest_file_counts_whatever_its_name(newest, tmp_path):
    """Catches files in the order of their names, or the oldest first."""
    for name in "abc":
        text = f"def my_f(): return '{name}'\nmy_g = 1"
        write(tmp_path / "ann" / f"{name}.ipynb", cell(text), time=9 if name == newest else 5)
    (ann,) = submissions(tmp_path)
    text, said = ann.find(F)
    assert f"'{newest}'" in text and said.startswith(f"f: {newest}.ipynb counts, the newest of 3")
