"""The table of grades: what a person wrote is kept, whatever a student's folder is called."""

import csv
import json
import os
from datetime import datetime

import pytest
import submitted
from segmap_course.__main__ import main
from segmap_course.grading._report import Outcome, Row, Table, duplicates, late, write_feedback
from segmap_course.grading._submissions import Answer, Book, Submission
from segmap_course.grading.handout._tasks import Task

STUB = "def my_f(x): ..."
F = Task("f", "x", ("my_f",), 4, stub=STUB)
HAND = Task("f_by_hand", "x", (), 6, by_hand=True)


def row(student, share=1.0, source="def my_f(x): return x", time=0.0):
    book = Book("a.ipynb", time, [Answer("f-answer", "code", source)])
    outcome = Outcome("right" if share == 1 else "wrong", "", share)
    return Row(Submission(student, "", [book], []), {"f": outcome}, "bubblewrap")


def read(path):
    return {found["student"]: found for found in csv.DictReader(path.read_text().splitlines())}


def edit(path, student, **cells):
    rows = list(read(path).values())
    for found in rows:
        found |= {name: "" for name in cells if name not in found}
        found |= cells if found["student"] == student else {}
    with path.open("w", newline="") as file:
        writer = csv.DictWriter(file, rows[0])
        writer.writeheader()
        writer.writerows(rows)


def test_regrading_keeps_what_a_person_wrote_and_tells_what_changed(tmp_path):
    """Catches points by hand that are lost, with the column of remarks and who handed in before."""
    path = tmp_path / "grades.csv"
    first = Table(path, [F, HAND])
    first.add(row("ann", 0.0))
    first.add(row("bob"))
    assert read(path)["ann"]["f_by_hand"] == "" and first.changes == []
    edit(path, "ann", f_by_hand="5,5", extra_by_hand="-1", remark="came to my office")
    again = Table(path, [F, HAND])
    again.add(row("ann", 1.0))
    assert again.changes == ["ann points: 0 -> 4", "ann f: 0 -> 4"]
    found = read(path)
    kept = [found["ann"][name] for name in ("f_by_hand", "extra_by_hand", "remark", "total")]
    assert kept == ["5,5", "-1", "came to my office", "8.5"] and found["bob"]["points"] == "4"


def test_a_table_that_is_another_s_is_not_overwritten(tmp_path):
    path = tmp_path / "grades.csv"
    path.write_text("name,price\nsoap,3\n")
    with pytest.raises(ValueError, match="no table of grades"):
        Table(path, [F])
    assert path.read_text() == "name,price\nsoap,3\n"


def test_half_points_for_hidden_cases(tmp_path):
    table = Table(tmp_path / "g.csv", [F])
    table.add(row("ann", 0.5))
    assert read(tmp_path / "g.csv")["ann"]["points"] == "2"


def test_a_name_as_long_as_a_name_may_be_loses_nothing(tmp_path):
    for name in ("x" * 255, "y" * 255, "ü" * 127):
        write_feedback(tmp_path / "pages", row(name), [F])
    assert len(list((tmp_path / "pages").iterdir())) == 3


def test_files_after_the_deadline_are_late(tmp_path):
    end = datetime.fromisoformat("2026-11-23T10:00")
    handed = row("ann", time=end.timestamp() + 5400).submission
    assert late(handed, end) == "1.5 h" and not late(row("bob").submission, end)
    table = Table(tmp_path / "g.csv", [F], end)
    table.add(row("ann", time=end.timestamp() + 5400))
    assert read(tmp_path / "g.csv")["ann"]["late"] == "1.5 h"


def test_equal_and_nearly_equal_answers_are_named():
    """Names, spaces and comments hide nothing; stubs and other ideas are left alone."""
    longer = submitted.CAST.replace("my_cast_ray", "my_f")
    renamed = longer.replace("wall", "w").replace("share", "t").replace("np.inf", "np.inf  # far")
    rows = [
        *(row("ann", source=longer), row("bob", source=renamed), row("eve", source=STUB)),
        *(row("fay", source=STUB), row("kim", source=submitted.COMPOSE.replace("compose", "f"))),
    ]
    assert duplicates(rows, [F]) == {"ann": "f: bob", "bob": "f: ann"}


def test_totals_are_written_as_moodle_and_canvas_import_them(tmp_path):
    table = Table(tmp_path / "lab.csv", [F])
    for student in ("Ann Lee_123_assignsubmission_file", "leeann_77_991_11_scans", "=bob"):
        table.add(row(student))
    moodle = table.export("moodle").read_text().splitlines()
    assert moodle[0] == "Identifier,Full name,Grade" and "Participant 123,,4" in moodle
    canvas = table.export("canvas").read_text().splitlines()
    assert canvas[0] == "Student,ID,SIS User ID,SIS Login ID,Section,lab"
    assert canvas[1] == "    Points Possible,,,,,4"
    assert any(line.split(",")[1] == "77" and line.endswith(",4") for line in canvas)


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
