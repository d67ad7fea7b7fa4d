"""What was handed in, as it is read; and what is asked of each answer, without a jail."""

import json
import os
import tempfile
from pathlib import Path

import pytest
import submitted
from programs import program
from segmap_course import EXERCISES
from segmap_course.grading import graded, plan_of, read_key
from segmap_course.grading.handout import Task
from submitted import rows_of

main = program("segmap_course")

F = Task("f", "x", ("my_f", "my_g"), 4, stub="def my_f(): ...\nmy_g = 0")


def cell(source, id="x", kind="code", **more):
    return {"cell_type": kind, "id": id, "source": source, **more}


def write(path, *cells, time=None):
    path.parent.mkdir(exist_ok=True)
    path.write_text(json.dumps({"cells": cells}))
    os.utime(path, (time or 1, time or 1))


def submissions(folder):
    """What was handed in, as the grader reads it; no code of it runs."""
    return [row.submission for row in graded(folder, PLAN, unprotected=True)]


PLAN = plan_of("11", None)
PLAN = PLAN._replace(tasks=PLAN.tasks[:1])


def read(submission):
    """A submission as plain values."""
    books = [(b.file, b.time, [tuple(cell) for cell in b.cells]) for b in submission.books]
    return submission.student, submission.name, books, submission.problems


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
    first = "n", "markdown", "".join(named["source"])
    books = [("a.ipynb", 7, [("c", "code", "**Name:** no"), ("", "None", "")])]
    books += [("b.ipynb", 5, [first, ("f-answer", "code", "b")])]
    assert read(ann) == ("ann", "Ann Lee", books, [])
    held = [("n", "markdown", long["source"]), ("x", "code", "x\ny")]
    assert read(bob) == ("bob", "x" * 100, [("bob.ipynb", 1, held)], [])
    assert read(eve) == ("eve", "", [], ["the folder holds no notebook"])


def test_a_file_that_is_too_large_is_a_problem_of_300_letters(tmp_path):
    path = tmp_path / f"{'n' * 249}.ipynb"
    write(path, cell("x"))
    assert submissions(tmp_path)[0].problems == []
    os.truncate(path, 200_000_000)
    (said,) = submissions(tmp_path)[0].problems
    assert len(said) == 300 and said.startswith(
        f"{path.name} cannot be read: expected a file of at"
    )
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


def handed(*files):
    """A submission of files, each a list of cells, the newest first."""
    held = {f"{k}.ipynb": (99 - k, list(cells)) for k, cells in enumerate(files)}
    with tempfile.TemporaryDirectory() as folder:
        if not held:
            (Path(folder) / "ann").mkdir()
        (row,) = rows_of(Path(folder), {"ann": held})
    return row.submission


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
    (book,) = handed(cells).books
    assert book.find(F) == (cells[found][2] if isinstance(found, int) else found)


def test_of_all_files_the_newest_with_something_written_counts():
    """Catches a note where all say the same, and the answer of an older file."""
    stub, one, two = (
        [("f-answer", "code", text)] for text in (F.stub, "my_f = my_g = 1", "my_f = my_g = 2")
    )
    written = ("f-answer", "code", "I think"), ("f_by_hand", "markdown", "so"), ("x", "code", "no")
    note = "f: 1.ipynb counts, the newest of 2 files that answer it"
    for files, found in [
        ([], (None, "")),
        ([[("x", "code", "no")]], (None, "")),
        ([stub, stub], (F.stub, "")),
        ([stub, one], (one[0][2], "")),
        ([one, one, stub], (one[0][2], "")),
        ([stub, one, two], (one[0][2], note)),
    ]:
        assert handed(*files).find(F) == found
    both = handed([("f-answer", "code", "my_f = my_g = 1"), ("x", "code", "my_f = my_g = 2")])
    note = "f: the last of 2 cells that answer it counts"
    assert both.find(F) == ("my_f = my_g = 2", note)
    assert both.beside("my_f = my_g = 2") == ["my_f = my_g = 1"]
    assert handed(written, one).written("f_by_hand") == "I think\n\nso\n\nmy_f = my_g = 1"
    assert handed(one).written("g_by_hand") is None


# ------------------------------------------------------------------ from a folder to outcomes


def test_what_cannot_be_graded_is_said(tmp_path):
    write(tmp_path / "in" / "ann.ipynb")
    with pytest.raises(ValueError, match="ask for no answer"):
        next(graded(tmp_path / "in", PLAN._replace(tasks=[])))


def test_a_plan_is_that_of_its_handout(tmp_path):
    assert main(["handout", str(tmp_path / "lab"), "--chapters", "11", "--seed", "3"]) == 0
    key = tmp_path / "lab.instructor.json"
    assert read_key(key) == plan_of("11", 3) == plan_of("11", None)._replace(seed=3)
    held = json.loads(key.read_text())
    key.write_text(json.dumps(held | {"format": "segmap handout 9"}))
    with pytest.raises(ValueError, match="is written as 'segmap handout 9', this version reads"):
        read_key(key)
    key.write_text(json.dumps(held | {"tasks": [{"name": "f"}]}))
    with pytest.raises(ValueError, match="is no instructor's file of a handout"):
        read_key(key)


@pytest.mark.parametrize(
    ("does", "said"),
    [("return None", "gives another answer"), ("raise KeyError", "raises an exce")],
)
def test_what_is_right_on_the_open_cases_alone_has_a_share(tmp_path, does, said):
    """Catches hidden cases that nobody draws, and a share for what is wrong."""
    shown = [tuple(case[0].tolist()) for case in EXERCISES["compose"].cases.values()]
    head, rest = submitted.COMPOSE.split("\n", 1)
    right = f"{head}\n    if tuple(a_from_b) not in {shown}:\n        {does}\n{rest}"
    for student, text in (("ann", right), ("bob", submitted.WRONG)):
        write(tmp_path / f"{student}.ipynb", cell(text, "compose-answer"))
    for seed, kind in ((None, "right"), (3, "wrong")):
        plan = PLAN._replace(seed=seed, partial=0.5)
        ann, bob = (row.outcomes["compose"] for row in graded(tmp_path, plan, unprotected=True))
        assert (ann.kind, ann.share, bob.share) == (kind, 0.5 if seed else 1.0, 0)
    assert ann.reason.startswith(f"right on the cases shown; on a hidden one it {said}")


@pytest.mark.parametrize("newest", ["a", "b", "c"])
def test_the_newest_file_counts_whatever_its_name(newest, tmp_path):
    """Catches files in the order of their names, or the oldest first."""
    for name in "abc":
        text = f"def my_f(): return '{name}'\nmy_g = 1"
        write(tmp_path / "ann" / f"{name}.ipynb", cell(text), time=9 if name == newest else 5)
    (ann,) = submissions(tmp_path)
    text, said = ann.find(F)
    assert f"'{newest}'" in text and said.startswith(f"f: {newest}.ipynb counts, the newest of 3")
