"""The table of grades: what a person wrote is kept, whatever a student's folder is called."""

import csv
import hashlib
import json
import os
import tempfile
from datetime import datetime
from pathlib import Path

import pytest
from programs import program
from segmap_course.grading import Table, class_report, duplicates, write_feedback
from segmap_course.grading.handout import Task
from submitted import rows_of

main = program("segmap_course")

STUB = "def my_f(x): ..."
F = Task("f", "x", ("my_f",), 4, stub=STUB)
HAND = Task("f_by_hand", "x", (), 6, by_hand=True)
ANSWER = "def my_f(x): return x"
END = datetime.fromisoformat("2026-11-23T10:00")


def row(student, share=1.0, source=ANSWER, time=0.0):
    """A student's row, as the grader makes it of a file, with a share of the points of `f`."""
    return handed(student, {"a.ipynb": (time, [("f-answer", "code", source)])}, share)


def handed(student, files, share=1.0):
    with tempfile.TemporaryDirectory() as folder:
        (found,) = rows_of(Path(folder), {student: files})
    return told(found._replace(jail="bubblewrap"), "right" if share == 1 else "wrong", "", share)


def told(found, kind, reason="", share=0.0, task="f", **more):
    (outcome,) = list(found.outcomes.values())[:1]
    outcome = outcome._replace(kind=kind, reason=reason, share=share, **more)
    kept = {name: held for name, held in found.outcomes.items() if name in ("f", "g")}
    return found._replace(outcomes=kept | {task: outcome})


def test_the_command_takes_all_of_it(tmp_path, capsys):
    """Of a handout, without any code of a student: what is graded by a person alone."""
    assert main(["handout", str(tmp_path / "lab"), "--chapters", "11"]) == 0
    key = json.loads((tmp_path / "lab.instructor.json").read_text())
    assert key["seed"] > 2**64 and key["tasks"][0]["stub"]
    (tmp_path / "in").mkdir()
    (tmp_path / "in" / "ann\x1b[2J.ipynb").write_text('{"cells": []}')
    os.utime(tmp_path / "in" / "ann\x1b[2J.ipynb", (2e9, 2e9))
    words = ["grade", str(tmp_path / "in"), "-o", str(tmp_path / "g.csv"), "--unprotected"]
    words += ["--key", str(tmp_path / "lab.instructor.json"), "--deadline", "2026-11-23T10:00"]
    assert main([*words, "--export", "moodle", "--partial", "0.5", "--regrade"]) == 0
    assert "\x1b" not in capsys.readouterr().out and (tmp_path / "g_moodle.csv").exists()
    for wrong in ("2", "-1", "half"):
        with pytest.raises(SystemExit):
            main([*words, "--partial", wrong])


# ------------------------------------------------------------------ letter by letter


def test_the_table_is_written_whole(tmp_path):
    """Catches a column that moves, what a person wrote that is lost, and a row out of order."""
    path, open_one = tmp_path / "g.csv", Task("g", "x", ("my_g",), 0)
    stamp = END.timestamp()
    before = "student,points,f_by_hand,remark,extra_by_hand,f,"
    path.write_text(f'{before}\nbob,0,"5,5",ill,\'+1,0\nzoe,,1,,,\n')
    table = Table(path, [F, open_one, HAND], END)
    files = {
        f"{k}.ipynb": (stamp + 3600 * k, [("f-answer", "code", f"def my_f(): {k}")]) for k in (9, 1)
    }
    bob = handed("bob", files)
    held = bob.submission._replace(name="=Bob", problems=["c.ipynb cannot be\nread"])
    bob = bob._replace(submission=held, jail="none")
    bob = told(told(bob, "wrong", "why", 0.5), "ended", task="g")
    table.add(bob)
    table.add(told(row("ann"), "right", "", 1.0, task="g"), "f: bob")
    head = "student,name,points,of,f,g,f_by_hand,extra_by_hand,total,reasons,late,alike,jail,notes"
    assert path.read_text() == (
        f"{head},remark\n"
        "ann,,4,4,4,right,,,4,,,f: bob,bubblewrap,,\n"
        "bob,'=Bob,2,4,2,ended,\"5,5\",'+1,8.5,"
        "f: wrong; g: ended; c.ipynb cannot be read,9.0 h,,none,"
        '"f: 9.ipynb counts, the newest of 2 files that answer it",ill\n'
        "zoe,,,,,,1,,,,,,,,\n"
    )
    assert table.changes == ["bob points: 0 -> 2", "bob f: 0 -> 2"]
    table.add(told(bob, "right", "", 1.0), "f: ann")
    assert len(table.changes) == 2, "told of once"
    assert "bob,'=Bob,4,4,4,ended,\"5,5\",'+1,10.5," in path.read_text()
    path.write_text("student\nkim\n")
    assert Table(path, [F]).rows == {"kim": {"student": "kim"}}


@pytest.mark.parametrize("text", ["name,price\nsoap,3\n", "student,name\n"])
def test_a_table_that_is_another_s_is_not_overwritten(tmp_path, text):
    path = tmp_path / "grades.csv"
    path.write_text(text)
    with pytest.raises(ValueError, match="no table of grades"):
        Table(path, [F])
    assert path.read_text() == text


@pytest.mark.parametrize(
    ("written", "points"),
    [("5,5", 5.5), (" 3 ", 3), ("'-1", -1), ("'+2.5", 2.5), ("", 0), ("ill", 0)],
)
def test_points_that_a_person_wrote_are_added(tmp_path, written, points):
    path = tmp_path / "g.csv"
    path.write_text(f'student,f_by_hand\nann,"{written}"\n')
    Table(path, [F, HAND]).add(row("ann"))
    (found,) = csv.DictReader(path.read_text().splitlines())
    assert float(found["total"]) == 4 + points


@pytest.mark.parametrize(("hours", "said"), [(-1, ""), (0, ""), (0.5, "0.5 h"), (1000, "1000.0 h")])
def test_hours_after_the_end(tmp_path, hours, said):
    Table(tmp_path / "g.csv", [F], END).add(row("ann", time=END.timestamp() + 3600 * hours))
    (found,) = csv.DictReader((tmp_path / "g.csv").read_text().splitlines())
    assert found["late"] == said


def test_the_exports_letter_by_letter(tmp_path):
    table = Table(tmp_path / "lab.csv", [F])
    for student in ("b_77_991_x", "Ann_123_assignsubmission_file", "late_late_5_6"):
        found = row(student, 0.5)
        table.add(found._replace(submission=found.submission._replace(name=student[:1] * 2)))
    assert table.export("moodle") == tmp_path / "lab_moodle.csv"
    assert (tmp_path / "lab_moodle.csv").read_text() == (
        "Identifier,Full name,Grade\nb_77_991_x,bb,2\nParticipant 123,AA,2\nlate_late_5_6,ll,2\n"
    )
    assert table.export("canvas").read_text() == (
        "Student,ID,SIS User ID,SIS Login ID,Section,lab\n    Points Possible,,,,,4\n"
        "bb,77,,b_77_991_x,,2\nAA,,,Ann_123_assignsubmission_file,,2\nll,5,,late_late_5_6,,2\n"
    )


def test_the_class_report_line_by_line():
    """Catches a reason that is not shared, or cut, and a stub that is called wrong."""
    one = row("ann")
    rows = [
        *(told(one, "wrong", f"turn it first expected 4, got {name}") for name in "abc"),
        *2 * [told(one, "wrong", "x" * 200)],
        *4 * [told(one, "ended", "by signal 9")],
        *(told(one, "missing"), *2 * [told(one, "right", "", 1.0)]),
        *(told(one, "empty", "nothing"), told(one, "unreadable", "no notebook")),
    ]
    assert class_report(rows, [F, HAND]) == [
        "f: 2 of 14 right, 1 not judged, 2 unanswered, 9 wrong",
        "  4 x ended: by signal 9",
        "  3 x wrong: turn it first expected 4",
        f"  2 x wrong: {'x' * 200}",
        "  1 x missing",
        "  1 x empty: nothing",
        "  1 x unreadable: no notebook",
    ]


def test_nearly_equal_is_nine_of_ten_runs_of_five_marks():
    """Catches two that share an idea, short ones that must be alike, and a list without end."""

    def answer(*changed):
        lines = (f"    x{k} = y.m{k}(z, {k + 1000 * (k in changed)})" for k in range(30))
        return "\n".join(["def my_f(z):", *lines])

    pairs = {"one": answer(3), "many": answer(*range(15)), "same": answer()}
    pairs["renamed"] = answer().replace("(z", "(wall").replace("y.", "t.") + "  # far"
    for name, text in pairs.items():
        found = duplicates([row("ann", source=answer()), row("bob", source=text)], [HAND, F])
        assert found == ({} if name == "many" else {"ann": "f: bob", "bob": "f: ann"})
    assert duplicates([row("eve", source=STUB), row("fay", source=STUB)], [F]) == {}
    short = [row(n, source=f"def my_f(x): return x.{n}.b.c.d.e") for n in "ab"]
    assert duplicates(short, [F]) == {}
    many = duplicates([row(f"{k:02}" + "n" * 98, source=answer()) for k in range(14)], [F])
    assert {len(said) for said in many.values()} == {1000} and len(many) == 14


@pytest.mark.parametrize("name", ["x" * 200, "x" * 201, os.fsdecode(b"ann\xff")])
def test_a_page_has_the_name_of_its_student(name, tmp_path):
    for _ in range(2):  # into the folder that is there
        write_feedback(tmp_path / "pages", row(name), [F])
    (found,) = (path.stem for path in (tmp_path / "pages").iterdir())
    cut = f"{'x' * 40}_{hashlib.sha256(name.encode('utf-8', 'replace')).hexdigest()[:16]}"
    assert found == (cut if len(name) > 200 else name)


def page(folder, found, tasks):
    write_feedback(folder, found, tasks)
    return (folder / f"{found.submission.student}.html").read_text()


def test_the_page_of_a_student_is_written_whole(tmp_path):
    """Catches a section that is lost, points of the wrong task, and a mark of HTML that works."""
    answers = [("f-answer", "code", "def my_f(x): <1>"), ("f_by_hand", "markdown", "I")]
    found = handed("ann", {"a.ipynb": (0.0, answers)})
    held = found.submission._replace(name="Ann <Lee>", problems=["b is <odd>."])
    found = told(found._replace(submission=held), "wrong", "turn & go", 0.5, cases="case <3>")
    other = HAND._replace(name="g_by_hand", points=1, rubric="")
    shown = page(tmp_path, found, [F, HAND._replace(rubric="| 6 | <good> |"), other])
    head, _, body = shown.partition("</style></head><body>\n")
    assert "default-src 'none'" in head and "<title>ann, Ann &lt;Lee&gt;</title>" in head
    assert body == (
        "<h1>ann, Ann &lt;Lee&gt;</h1>\n"
        "<p>2 of 4 points. Up to 7 more are given by hand. b is &lt;odd&gt;.</p>\n"
        '<section class="wrong"><h2>f: 2 of 4 points</h2><p>Wrong: turn &amp; go</p>'
        "<pre>case &lt;3&gt;</pre><pre>def my_f(x): &lt;1&gt;</pre></section>\n"
        "<section><h2>f_by_hand: graded by hand, up to 6 points</h2>"
        "<pre>| 6 | &lt;good&gt; |</pre><pre>def my_f(x): &lt;1&gt;\n\nI</pre></section>\n"
        "<section><h2>g_by_hand: graded by hand, up to 1 points</h2>"
        "<p>Nothing was handed in.</p></section>\n</body></html>\n"
    )
    files = {
        "a.ipynb": (0.0, answers),
        "new.ipynb": (9.0, [("f-answer", "code", "def my_f(x): 2")]),
    }
    twice = handed("ann", files)
    held = twice.submission._replace(problems=["b is <odd>."])
    said = page(tmp_path, twice._replace(submission=held), [F])
    assert '<section class="right"><h2>f: 4 of 4 points</h2><p>Right. (f: new.ipynb counts' in said
    assert "<h1>ann</h1>\n<p>4 of 4 points. b is" in said and "by hand" not in said
