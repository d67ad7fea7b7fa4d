"""Whatever one answer does is the outcome of that answer: all others are graded."""

import csv
import json
import os

import pytest
import segmap_course.__main__ as command
import submitted
from segmap_course._sandbox_protocol import Other, decode, encode
from segmap_course.grading import _grade
from segmap_course.grading._jail import Ended
from segmap_course.grading._report import code_of, duplicates
from segmap_course.grading._submissions import Answer, Book, Submission
from segmap_course.grading.handout import Task, defines

STUDENTS = ("ann", "bob", "cid", "zoe")


def nested(depth, wrap):
    data = 1.0
    for _ in range(depth):
        data = wrap(data)
    return data


WRAPS = {
    "lists": lambda data: [data],
    "tuples": lambda data: {"tuple": [data]},
    "surfaces": lambda data: {"surface": [data, data, data]},
    "both": lambda data: [{"tuple": [data]}],
}


@pytest.mark.parametrize("wrap", WRAPS)
@pytest.mark.parametrize("depth", [40, 700, 5000])
def test_a_reply_that_is_nested_deep_is_no_value(wrap, depth):
    """Catches `[[[...]]]`, 700 deep, which ended the grading of all by a RecursionError."""
    if wrap != "surfaces" or depth == 700:
        with pytest.raises(ValueError, match="no value"):
            decode(nested(depth, WRAPS[wrap]))
    assert decode(nested(5, WRAPS["both"])) == nested(5, lambda data: [(data,)])


def test_an_answer_that_is_nested_deep_is_told_in_the_notebook():
    for depth in (40, 700, 5000):
        for wrap in (lambda data: [data], lambda data: (data,)):
            assert isinstance(flat(decode(encode(nested(depth, wrap)))), Other)


def flat(value):
    while isinstance(value, list | tuple):
        (value,) = value
    return value


@pytest.fixture
def folder(tmp_path):
    """Four students, each of whom answers `compose` rightly."""
    (tmp_path / "in").mkdir()
    for name in STUDENTS:
        cell = {"cell_type": "code", "id": "compose-answer", "source": submitted.COMPOSE}
        text = json.dumps({"cells": [cell | {"source": f"# {name}\n{submitted.COMPOSE}"}]})
        (tmp_path / "in" / f"{name}.ipynb").write_text(text)
    return tmp_path


class Jail:
    """Answers rightly without a process, but for what is planted for a student."""

    def __init__(self, planted):
        self.planted, self.asked = planted, []

    def __call__(self, jail, job, cases):
        student = job["cell"].split()[1]
        if "my_compose" not in job["names"]:
            raise Ended("ended", "")
        self.asked.append(student)
        if student in self.planted:
            raise self.planted[student]
        return [_grade.CHECKS["check_compose"].solution(*case) for case in cases]


def grade(folder):
    words = ["grade", str(folder / "in"), "-o", str(folder / "g.csv"), "--chapters", "11"]
    code = command.main([*words, "--unprotected"])
    rows = csv.DictReader((folder / "g.csv").read_text().splitlines())
    return code, {row["student"]: row for row in rows}


def test_what_the_grader_cannot_judge_is_that_answer_s_outcome(folder, monkeypatch):
    """Catches any exception, at any step of one answer, that ends the grading of the others."""
    faults = {"ann": RecursionError("x"), "bob": OSError(7, "no process"), "cid": MemoryError()}
    monkeypatch.setattr(_grade, "answers", Jail(faults))
    code, rows = grade(folder)
    assert code == 0 and sorted(rows) == sorted(STUDENTS)
    assert rows["zoe"]["compose"] == "4"
    for name, error in faults.items():
        assert rows[name]["compose"] == "0"
        assert "compose: not graded" in rows[name]["reasons"]
        page = (folder / "g_feedback" / f"{name}.html").read_text()
        assert type(error).__name__ in page and "a person has to look" in page
    for step in ("job", "judged"):
        original = getattr(_grade, step)

        turns = {"job": [], "judged": []}

        def failing(*given, original=original, step=step, turns=turns):
            turns[step].append(given)
            bob = given[0].student == "bob" if step == "job" else len(turns[step]) == 2
            if bob:
                raise SystemError("planted")
            return original(*given)

        with monkeypatch.context() as patched:
            patched.setattr(_grade, "answers", Jail({}))
            patched.setattr(_grade, step, failing)
            found = [row["compose"] for row in grade(folder)[1].values()]
        assert found == ["4", "0", "4", "4"], step


def test_grading_goes_on_where_it_stopped(folder, monkeypatch, capsys):
    """Catches a class that is graded from the start again, or whose report lacks the first."""
    whole, written = Jail({}), []
    monkeypatch.setattr(_grade, "answers", whole)
    original = command.write_feedback

    def crashing(pages, row, tasks):
        if row.submission.student == "cid" and not written:
            written.append(row)
            raise KeyboardInterrupt
        original(pages, row, tasks)

    monkeypatch.setattr(command, "write_feedback", crashing)
    code, rows = grade(folder)
    assert code == 130 and list(rows) == ["ann", "bob", "cid"]
    with (folder / "g_unfinished.jsonl").open("a") as file:
        file.write('["cut off in the mid')
    whole.asked.clear()
    (folder / "in" / "bob.ipynb").touch()  # handed in again
    os.utime(folder / "in" / "bob.ipynb", (2e9, 2e9))
    capsys.readouterr()
    code, rows = grade(folder)
    assert code == 0 and sorted(set(whole.asked)) == ["bob", "cid", "zoe"]
    assert {name: row["compose"] for name, row in rows.items()} == dict.fromkeys(STUDENTS, "4")
    said = capsys.readouterr().out
    assert "going on where grading stopped" in said and "compose: 4 of 4 right" in said
    assert not (folder / "g_unfinished.jsonl").exists()
    whole.asked.clear()
    grade(folder)
    assert sorted(set(whole.asked)) == list(STUDENTS), "a second run begins anew"


def test_a_text_that_takes_the_parser_long_or_breaks_it_is_a_text(monkeypatch):
    """Catches a number of 5 000 hexadecimal digits, which cannot be written, and ended the search
    for equal answers; and a search for a name that takes minutes in many short lines."""
    book = Book("a.ipynb", 0, [Answer("f-answer", "code", "def my_f(): 0x" + "f" * 5000)])
    rows = [_grade.Row(Submission(name, "", [book], []), {}) for name in ("ann", "bob")]
    assert duplicates(rows, [Task("f", "x", ("my_f",), 4)]) == {"ann": "f: bob", "bob": "f: ann"}
    assert not defines("a,\n" * 60_000, "my_f") and defines("a, my_f , b = 1, 2, 3", "my_f")
    for text in ("(" * 5000, "-" * 5000 + "1", "x" + ".y" * 5000, "\0", "9" * 5000):
        assert code_of(text) == text
