"""Grading: a row a student whatever is handed in, and nothing of the grader's comes to harm."""

import csv
import json
import os
import pickle
import subprocess
import sys

import numpy as np
import pytest
import segmap_course as course
import submitted
from segmap_course import EXERCISES
from segmap_course.__main__ import main
from segmap_course.grading import _grade, _jail, _run
from segmap_course.grading._grade import cases_of
from segmap_course.grading._jail import Limits, Locks
from segmap_course.grading._report import safe
from segmap_course.grading._run import Pool, outcome
from segmap_course.grading._submissions import Answer, Submission, submissions
from segmap_course.grading.handout._tasks import Task

LIMITS = Limits(seconds=30, cpu=1, memory=1 << 28)
TASK = Task(
    "compose", "11_scans_and_poses.ipynb", ("my_compose",), 4, "import numpy as np", "my_compose"
)
pytestmark = pytest.mark.skipif(
    not (_jail.landlock_version() or _run.os.geteuid() == 0),
    reason="this system keeps no files from another program",
)


# ------------------------------------------------------------------ from handout to table
@pytest.fixture(scope="module")
def graded(tmp_path_factory):
    """Rows of the table by student, pages by student, and what was said."""
    root = tmp_path_factory.mktemp("course")
    victim = root / "victim"
    victim.mkdir()
    (victim / "thesis.txt").write_text("three years of work")
    assert main(["handout", str(root / "out"), "--chapters", "11,13", "--seed", "4711"]) == 0
    submitted.hand_in(root / "out", root / "in", victim)
    table = root / "grades.csv"
    options = ["--key", str(root / "out.instructor.json"), "--seconds", "30", "--cpu", "1"]
    assert main(["grade", str(root / "in"), "-o", str(table), *options]) == 0
    with table.open(newline="") as source:
        rows = {row["student"]: row for row in csv.DictReader(source)}
    pages = {path.stem: path.read_text() for path in (root / "grades_feedback").iterdir()}
    return root, rows, pages


@pytest.mark.parametrize("student", submitted.KINDS)
def test_each_submission_ends_as_it_must(graded, student):
    """Catches a kind that is taken for another, and one answer that spoils the next."""
    root, rows, _ = graded
    row, kind = rows[student], submitted.KINDS[student]
    tasks = json.loads((root / "out.instructor.json").read_text())["tasks"]
    assert int(row["of"]) == sum(task["points"] for task in tasks if not task["by_hand"])
    assert row["compose"] == ("4" if kind == "right" else "0")
    assert row["cast_ray"] == ("0" if student == "10_broken" else "4")
    assert kind == "right" or f"compose: {kind}" in row["reasons"]
    assert int(row["points"]) == int(row["compose"]) + int(row["cast_ray"])


def test_nothing_of_the_grader_came_to_harm(graded):
    root, rows, _ = graded
    assert (root / "victim" / "thesis.txt").read_text() == "three years of work"
    assert sorted(rows) == sorted(submitted.KINDS)
    assert course.check_compose(lambda a, b: a + b).hint.startswith("a step ahead")
    left = sorted(path.name for path in root.iterdir())
    ours = ["grades.csv", "grades_class.txt", "grades_feedback"]
    assert left == [*ours, "in", "out", "out.instructor.json", "victim"]


def test_the_class_report_counts_what_was_hard(graded):
    root, _, _ = graded
    lines = (root / "grades_class.txt").read_text().splitlines()
    assert "compose: 1 of 12 right" in lines and "cast_ray: 11 of 12 right" in lines
    assert any(line.startswith("  2 x wrong: a step ahead goes where") for line in lines)


def test_feedback_names_the_mistake_and_nothing_in_it_is_active(graded):
    _, _, pages = graded
    assert sorted(pages) == sorted(submitted.KINDS)
    assert "turn it by the first heading" in pages["03_wrong"]
    assert "library" in pages["04_library"] and "write your own" in pages["04_library"]
    assert "more memory than an answer may have" in pages["08_ten_gigabytes"]
    assert "no notebook" in pages["10_broken"]
    assert all("default-src 'none'" in page and "<script" not in page for page in pages.values())
    assert "&lt;script&gt;alert(1)" in pages["01_right"]


def test_hidden_cases_catch_answers_to_the_open_ones():
    """Catches a seed that changes nothing: open cases can be written down by a student."""
    exercise = EXERCISES["compose"]
    known = dict(zip(map(str, exercise.cases.values()), exercise.expected(), strict=True))
    answers = [
        known.get(str(arguments), {"nothing": True}) for arguments in exercise.cases.values()
    ]
    assert exercise.verdict(answers)
    cases = cases_of(exercise, 4711)
    assert len(cases) == len(exercise.cases) + len(exercise.fresh(4711))
    found = [known.get(str(arguments), {"nothing": True}) for arguments in cases.values()]
    assert not exercise.verdict(found, cases)
    assert cases_of(exercise, None) == exercise.cases


# ------------------------------------------------------------------ the locks, one by one
@pytest.fixture(scope="module")
def pool():
    with Pool([TASK], LIMITS, 1) as found:
        yield found


def body(text):
    return f"import os, socket, threading\ndef my_compose(a, b):\n    {text}\n"


def said(pool, cell):
    cases = EXERCISES["compose"].cases
    return outcome(EXERCISES["compose"], cases, pool.run(TASK, cell, cases), LIMITS)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("open('mine.txt', 'w').write('x')", "Error"),
        ("os.fork()", "Error"),
        ("threading.Thread(target=print).start()", "can't start new thread"),
        ("socket.create_connection(('192.0.2.1', 80), 1)", "Error"),
        ("os.kill(os.getppid(), 9)", "Error"),
        ("os.remove(np.__file__)", "Error"),
        ("raise ValueError([k for k in os.environ if k[-8:] != '_THREADS'])", "[]"),
    ],
)
def test_what_an_answer_has_no_need_for_is_refused(pool, text, words):
    found = said(pool, body(text))
    assert found.kind == "wrong" and "but it raised" in found.reason and words in found.reason


@pytest.mark.skipif(not _jail.landlock_version(), reason="Linux before 5.13")
def test_files_of_the_grader_are_not_read(pool, tmp_path):
    """Catches an answer that reads the seed, or what others handed in."""
    secret = tmp_path / "key.json"
    secret.write_text("4711")
    tmp_path.chmod(0o755)
    assert (
        "PermissionError"
        in said(pool, body(f"raise ValueError(open({str(secret)!r}).read())")).reason
    )


#: Takes the check out of the way that notices the library's answer, and calls that answer.
BLIND = """
import segmap_course as course
type(course.EXERCISES["compose"]).answers = lambda self, f, cases: self.expected(cases)
my_compose = abs
"""


@pytest.mark.parametrize(
    ("cell", "kind"),
    [
        ("def my_compose(a, b: return 3", "syntax"),
        ("%timeit 3\n" + submitted.COMPOSE, "syntax"),
        ("1 / 0\n" + submitted.COMPOSE, "raised"),
        ("raise SystemExit\n" + submitted.COMPOSE, "raised"),
        (body("raise KeyboardInterrupt"), "raised"),
        ("my_other = 3", "missing"),
        ("my_compose = 3", "missing"),
        (body("os.kill(os.getpid(), 9)"), "ended"),
        (body("[os.write(k, b'x' * 99) for k in range(3, 60) if ok(k)]"), "wrong"),
        (
            "import contextlib, os\nfor k in range(3, 64):\n"
            "    with contextlib.suppress(OSError): os.write(k, b'[1, 2]')\nos._exit(0)",
            "no answer",
        ),
        (body("return np.zeros(10**6)"), "wrong"),
        (BLIND, "library"),
        ("x = '\\ud800'\n" + submitted.COMPOSE, "right"),
    ],
)
def test_faults_are_told_apart(pool, cell, kind):
    assert said(pool, cell).kind == kind


def test_a_right_answer_after_all_of_these_is_right(pool):
    """Catches an answer that changes the process of the next."""
    assert said(pool, submitted.COMPOSE).right
    assert "apart" in str(pool.locks) or pool.locks.apart or "Not on this system" in str(pool.locks)


FOOLS = "my_map = [*segmap.simulation.rectangular_room().tolist(), [(10, 10), (16, 10)]]"


@pytest.mark.parametrize(
    ("task", "given", "cell", "kind", "words"),
    [
        ("predict_beams_on_wall", "my_guess", "my_guess = 15", "right", "it is 15 beams"),
        ("predict_beams_on_wall", "my_guess", "my_guess = None", "wrong", "your number first"),
        ("predict_beams_on_wall", "my_guess", "my_guess = 4", "wrong", "near enough"),
        ("break_quality", "my_map", FOOLS, "right", "invented costs nothing"),
        ("break_quality", "my_map", "my_map = [[(1e300, 0), (0, 0)]]", "wrong", "within 20 m"),
        ("break_quality", "my_map", "my_map = np.zeros(10**8)", "memory", "memory"),
        (
            "break_quality",
            "my_map",
            "import segmap_course as course\nmy_map = [[(0, 0), (1, 1)]]\n"
            "course.Challenge.verdict = lambda *_: course.Check('break_quality', True)\n"
            "course.exercises.open._open.quality = lambda *_: 1.0",
            "wrong",
            "the quality sees it",
        ),
    ],
)
def test_an_open_exercise_is_judged_where_no_student_s_code_runs(
    pool, task, given, cell, kind, words
):
    exercise = course.OPEN_EXERCISES[task]
    asked = Task(task, "x", (given,), 4, "import numpy as np\nimport segmap", given)
    handed = Submission("ann", "", [Answer(f"{task}-answer", "code", cell)], [])
    found = _grade._one(handed, asked, exercise, cases_of(exercise, 5), pool)
    assert found.kind == kind and words in found.reason


@pytest.mark.slow
def test_a_process_that_died_is_started_anew(pool):
    pool.servers[0]._process.kill()
    assert said(pool, submitted.COMPOSE).kind == "ended"
    assert said(pool, submitted.COMPOSE).right


# ------------------------------------------------------------------ parts of the way
@pytest.mark.parametrize("name", EXERCISES)
def test_cases_arrive_as_they_were_sent(name):
    """Catches a tuple that becomes a list, a whole number that becomes a float, a lost function."""
    exercise = EXERCISES[name]
    cases = {**exercise.cases, **exercise.fresh(5)}
    arrived = pickle.loads(pickle.dumps(cases))
    assert list(arrived) == list(cases)
    for sent, found in zip(cases.values(), arrived.values(), strict=True):
        assert [type(a) for a in sent] == [type(b) for b in found]
        arrays = [(a, b) for a, b in zip(sent, found, strict=True) if isinstance(a, np.ndarray)]
        assert all(a.dtype == b.dtype and np.array_equal(a, b, equal_nan=True) for a, b in arrays)
    assert exercise.verdict(exercise.expected(arrived), cases)


@pytest.mark.parametrize(
    "text",
    [
        "",
        "[]",
        "null",
        '{"answers": 3}',
        '{"answers": {}}',
        '{"answers": [{"values": [1], "shape": [1e400]}]}',
        '{"answers": [' + '{"library": {"a": [1]}}' + "]}",
        "[" * 100_000,
        '{"passed": true}',
        '{"fault": ["right"], "text": 3}',
    ],
)
def test_what_a_process_makes_up_is_never_right(text):
    exercise = EXERCISES["compose"]
    report = {"text": text, "ended": "whole", "status": 0}
    assert not outcome(exercise, exercise.cases, report, LIMITS).right


def notebook(*cells):
    made = [
        {"cell_type": "code", "id": name, "metadata": {}, "source": text} for name, text in cells
    ]
    return json.dumps({"cells": made})


def test_an_answer_is_found_by_its_cell_else_by_its_name(tmp_path):
    (tmp_path / "a.ipynb").write_text(
        notebook(("x", "def my_f(): 1"), ("f-answer", "def my_f(): 2"))
    )
    (tmp_path / "b.ipynb").write_text(notebook(("f-answer", "# moved"), ("y", "def my_f(): 3")))
    (tmp_path / "c.ipynb").write_text(notebook(("f-answer", "# empty"), ("y", "my_f()")))
    (tmp_path / "e.ipynb").write_text(notebook(("g-answer", "def my_f(): 4")))  # of task g
    (tmp_path / "d").mkdir()
    (tmp_path / "d" / "work.ipynb").write_text(notebook(("z", "print()")))
    (tmp_path / ".hidden.ipynb").write_text("{")
    (tmp_path / "link.ipynb").symlink_to(tmp_path / "a.ipynb")
    found = {s.student: s.find("f", ("my_f",)) for s in submissions(tmp_path)}
    assert found == {
        "a": "def my_f(): 2",
        "b": "def my_f(): 3",
        "c": "# empty",
        "d": None,
        "e": None,
    }


@pytest.mark.parametrize(
    "text", ["", "[]", "3", '{"cells": 3}', '{"cells": [3]}', "[" * 10**5, "\0"]
)
def test_what_is_no_notebook_is_a_problem_of_its_student_alone(tmp_path, text):
    (tmp_path / "a.ipynb").write_text(text)
    (tmp_path / "b.ipynb").write_text(notebook(("f-answer", "def my_f(): 2")))
    bad, good = submissions(tmp_path)
    assert "no notebook" in bad.problems[0] and good.problems == []


def test_no_cell_of_the_table_is_a_formula():
    assert (
        safe("=HYPERLINK(1)") == "'=HYPERLINK(1)" and safe("@x")[0] == "'" and safe("a=1") == "a=1"
    )


def test_what_is_wrong_is_said_at_the_door(tmp_path, capsys):
    def refused(*arguments):
        assert main(["grade", *map(str, arguments)]) == 1
        return capsys.readouterr().err

    table, one = tmp_path / "grades.csv", ("--chapters", "11")
    assert "is no folder" in refused(tmp_path / "nowhere", "-o", table, *one)
    assert "holds no submission" in refused(tmp_path, "-o", table, *one)
    assert "no chapter has the number 98" in refused(tmp_path, "-o", table, "--chapters", "98")
    assert "must name a table" in refused(tmp_path, "-o", tmp_path / "grades.txt")
    assert "there is no folder" in refused(tmp_path, "-o", tmp_path / "x" / "grades.csv")
    assert "leave --chapters" in refused(tmp_path, "-o", table, "--key", table, "--seed", "3")
    (tmp_path / "key.json").write_text("{}")
    assert "no instructor's file" in refused(tmp_path, "-o", table, "--key", tmp_path / "key.json")
    (tmp_path / "ann.ipynb").write_text(notebook())
    (tmp_path / "ann").mkdir()
    assert "a file and a folder named ann" in refused(tmp_path, "-o", table, *one)
    assert not table.exists()


def test_without_a_lock_on_files_nothing_runs(tmp_path, monkeypatch):
    """Catches a grader that runs hostile code as its own user without a word."""
    (tmp_path / "ann.ipynb").write_text(notebook())

    class Open:
        locks = Locks(0, False, False)
        __enter__ = lambda self: self  # noqa: E731
        __exit__ = lambda *_: None  # noqa: E731

    monkeypatch.setattr("segmap_course.grading._grade.Pool", lambda *_: Open())
    assert main(["grade", str(tmp_path), "-o", str(tmp_path / "g.csv"), "--chapters", "11"]) == 1
    assert not (tmp_path / "g.csv").exists()
    assert "Not on this system: files" in str(Open.locks)


WITHHELD = """
import json, sys
import right_answers
from segmap_course import EXERCISES
from segmap_course.grading._answer import withhold
exercise = EXERCISES[sys.argv[1]]
cases = exercise.cases
withhold(exercise)
print(json.dumps(exercise.answers(right_answers.RIGHT[exercise.name], cases)))
"""


@pytest.mark.slow
@pytest.mark.parametrize("name", EXERCISES)
def test_right_answers_do_without_the_library_s(name):
    """Catches a helper that students need, taken from them together with the answer."""
    words = [sys.executable, "-c", WITHHELD, name]
    where = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    found = subprocess.run(words, capture_output=True, text=True, check=True, env=where)
    assert EXERCISES[name].verdict(json.loads(found.stdout))


EMPTIED = """
import gc
from segmap.compiled import Compiled
from segmap_course import EXERCISES
from segmap_course.exercises import Watch
from segmap_course.grading._answer import GONE, withhold
count = 0
first = {name: next(iter(exercise.cases.values())) for name, exercise in EXERCISES.items()}
for exercise in EXERCISES.values():
    watch = Watch(exercise.own, exercise.solution)
    known = [found for found in gc.get_objects() if type(found) is Compiled]
    loops = [loop for loop in known if watch.covers(loop.plain.__code__)]
    withhold(exercise)
    calls = [(exercise.solution, first[exercise.name]), *((loop._fast, ()) for loop in loops)]
    for function, arguments in calls:
        try:
            print(exercise.name, "answers", function(*arguments))
        except RuntimeError as error:
            count += str(error) == GONE
print(count > len(EXERCISES))  # there are compiled loops among them
"""


@pytest.mark.slow
def test_the_library_s_answers_are_gone():
    """Catches a kind of function, a compiled loop say, that can still be called."""
    where = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}
    words = [sys.executable, "-c", EMPTIED]
    found = subprocess.run(words, capture_output=True, text=True, check=True, env=where)
    assert found.stdout == "True\n"
