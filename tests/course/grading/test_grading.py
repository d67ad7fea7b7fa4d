"""Grading: a row a student whatever is handed in, and nothing of the grader's comes to harm."""

import csv
import json
import os
import shutil
import socket
import subprocess
import tempfile
from pathlib import Path

import numpy as np
import pytest
import segmap_course as course
import submitted
from makefile import ROOT, make
from programs import program
from segmap_course import EXERCISES
from segmap_course.exercises import decode, encode
from segmap_course.grading import Limits, graded, plan_of, write_feedback
from segmap_course.grading.handout import Task
from submitted import solution

main = program("segmap_course")

LIMITS = Limits(seconds=30, cpu=10)
TASK = Task(
    "compose", "11_scans_and_poses.ipynb", ("my_compose",), 4, "import numpy as np", "my_compose"
)


@pytest.fixture(scope="module")
def jail():
    """There are jails; where there is none, `test_without_a_jail_nothing_runs` is the test."""
    plain = ["bwrap", "--unshare-user", "--disable-userns", "--ro-bind", "/", "/", "true"]
    if shutil.which("bwrap") is None or subprocess.run(plain, check=False).returncode:
        pytest.skip("bubblewrap does not run here")


def outcomes(folder, cells, task=TASK, seed=None):
    """What becomes of cells, by their students, each in a jail of its own."""
    for student, cell in cells.items():
        (folder / f"{student}.ipynb").write_text(notebook((f"{task.name}-answer", cell)))
    plan = plan_of("11", None)._replace(tasks=[task], seed=seed)
    rows = graded(folder, plan, limits=LIMITS)
    return {row.submission.student: row.outcomes[task.name] for row in rows}


def said(cell, seed=None, task=TASK):
    with tempfile.TemporaryDirectory() as folder:
        return outcomes(Path(folder), {"ann": cell}, task, seed)["ann"]


# ------------------------------------------------------------------ from handout to table
@pytest.fixture(scope="module")
def classroom(jail, tmp_path_factory):
    """Rows of the table by student, pages by student, and what was said."""
    root = tmp_path_factory.mktemp("course")
    victim = root / "victim"
    victim.mkdir()
    (victim / "thesis.txt").write_text("three years of work")
    assert main(["handout", str(root / "out"), "--chapters", "11,13", "--seed", "4711"]) == 0
    submitted.hand_in(root / "out", root / "in", victim)
    table = root / "grades.csv"
    options = ["--key", str(root / "out.instructor.json"), "--seconds", "30", "--cpu", "2"]
    assert main(["grade", str(root / "in"), "-o", str(table), *options]) == 0
    with table.open(newline="") as source:
        rows = {row["student"]: row for row in csv.DictReader(source)}
    pages = {path.stem: path.read_text() for path in (root / "grades_feedback").iterdir()}
    return root, rows, pages


@pytest.mark.parametrize("student", submitted.KINDS)
def test_each_submission_ends_as_it_must(classroom, student):
    """Catches a kind that is taken for another, and one answer that spoils the next."""
    root, rows, _ = classroom
    row, kind = rows[student], submitted.KINDS[student]
    tasks = json.loads((root / "out.instructor.json").read_text())["tasks"]
    assert int(row["of"]) == sum(task["points"] for task in tasks if not task["by_hand"])
    assert row["compose"] == ("4" if kind == "right" else "0")
    assert row["cast_ray"] == ("0" if student == "10_broken" else "4")
    assert kind == "right" or f"compose: {kind}" in row["reasons"]
    assert int(row["points"]) == int(row["compose"]) + int(row["cast_ray"])


def test_nothing_of_the_grader_came_to_harm(classroom):
    root, rows, _ = classroom
    assert (root / "victim" / "thesis.txt").read_text() == "three years of work"
    assert sorted(rows) == sorted(submitted.KINDS)
    assert course.check_compose(lambda a, b: a + b).hint.startswith("a step ahead")
    left = sorted(path.name for path in root.iterdir())
    ours = ["grades.csv", "grades_class.txt", "grades_feedback"]
    assert left == [*ours, "in", "out", "out.instructor.json", "victim"]
    lines = (root / "grades_class.txt").read_text().splitlines()
    assert "compose: 1 of 12 right, 1 not judged, 2 unanswered, 8 wrong" in lines
    assert "cast_ray: 11 of 12 right, 1 not judged" in lines


def test_feedback_names_the_mistake(classroom):
    _, _, pages = classroom
    assert sorted(pages) == sorted(submitted.KINDS)
    assert "turn it by the first heading" in pages["03_wrong"]
    assert "library" in pages["04_library"] and "write your own" in pages["04_library"]
    assert "&lt;script&gt;alert(1)" in pages["01_right"] and "<script" not in pages["01_right"]


def test_feedback_shows_open_cases_in_full_and_hidden_ones_not(jail, tmp_path):
    """Catches a case that is cut to three numbers, and numbers of a hidden case on a page."""
    exercise = EXERCISES["fit_line"]
    task = TASK._replace(name="fit_line", answers=("my_fit",), given="my_fit")
    cell = "def my_fit(points):\n    return 0.25  # <b>\n"
    (tmp_path / "in").mkdir()
    (tmp_path / "in" / "ann.ipynb").write_text(notebook(("fit_line-answer", cell)))
    plan = plan_of("11", None)._replace(tasks=[task], seed=4711)
    (row,) = graded(tmp_path / "in", plan, limits=LIMITS)
    found = row.outcomes["fit_line"]
    assert all(words in found.cases for words in exercise.cases)
    said = found.cases + found.reason
    hidden = [case for draw in range(5) for case in exercise.fresh((4711, draw)).values()]
    known, unseen = (
        {f"{x:.6f}".rstrip("0") for (points,) in cases for x in points.ravel()}
        for cases in (exercise.cases.values(), hidden)
    )
    assert all(number in said for number in known) and "got      0.25" in said
    assert not any(number in said for number in unseen - known if len(number) > 6)
    write_feedback(tmp_path / "pages", row, [task])
    shown = (tmp_path / "pages" / "ann.html").read_text()
    assert "&lt;b&gt;" in shown and "<b>" not in shown
    right = outcomes(tmp_path / "in", {"ann": solution("fit_line")[1]}, named("fit_line"))["ann"]
    assert right.cases == ""


def named(exercise):
    """The task of an exercise, answered by what its solution defines."""
    mine, _ = solution(exercise)
    return TASK._replace(name=exercise, answers=(mine,), given=mine)


# ------------------------------------------------------------------ one answer in its jail
def body(text):
    return f"import os, socket, sys, threading\ndef my_compose(a, b):\n    {text}\n"


FAULTS = [
    ("def my_compose(a, b: return 3", "syntax"),
    ("%timeit 3\n" + submitted.COMPOSE, "syntax"),
    ("1 / 0\n" + submitted.COMPOSE, "raised"),
    ("raise SystemExit\n" + submitted.COMPOSE, "raised"),
    (body("raise KeyboardInterrupt"), "wrong"),
    ("my_other = 3", "missing"),
    ("my_compose = 3", "missing"),
    (body("os.kill(os.getpid(), 9)"), "ended"),
    (body("return np.zeros(10**6)"), "wrong"),
    ("x = '\\ud800'\n" + submitted.COMPOSE, "right"),
    ("print('hello')\n" + submitted.COMPOSE.replace("    x,", "    print(3)\n    x,"), "right"),
    ("from segmap.plotting import draw_map\n" + submitted.COMPOSE, "right"),
    ("from segmap.poses import inverse, transform\n" + body("return inverse(a)"), "wrong"),
    ("#" * 300_000, "too much"),
]


@pytest.fixture(scope="module")
def faults(jail, tmp_path_factory):
    """What becomes of the cells of `FAULTS`, all handed in by one class."""
    cells = {f"{k:02}": cell for k, (cell, _) in enumerate(FAULTS)}
    return outcomes(tmp_path_factory.mktemp("faults"), cells)


@pytest.mark.parametrize("k", range(len(FAULTS)))
def test_faults_are_told_apart(faults, k):
    assert faults[f"{k:02}"].kind == FAULTS[k][1]


@pytest.mark.skipif(os.geteuid() != 0, reason="for root alone")
def test_the_jail_of_root_belongs_to_nobody(jail):
    """Catches bubblewrap that root starts: it keeps rights, and the limit of processes is void."""
    assert said("import os\nassert os.getuid() == 65534\n" + submitted.COMPOSE).right


def test_python_finds_its_library_without_proc(jail):
    """Catches a jail in which the interpreter of a container, or one's own, does not start."""
    cell = "import os, sys\nassert os.environ['LD_LIBRARY_PATH'] == sys.base_prefix + '/lib'\n"
    assert said(cell + submitted.COMPOSE).right


@pytest.mark.slow
@pytest.mark.parametrize("name", EXERCISES)
def test_a_solution_is_right_in_the_jail(jail, name):
    """Catches a task that cannot be answered with what it gives, and hidden cases that refuse."""
    assert said(solution(name)[1], 4711, named(name)).right


# ------------------------------------------------------------------ attacks
@pytest.fixture(scope="module")
def grader(tmp_path_factory):
    """A file that only the grader may read, and a socket on which it hears."""
    secret = tmp_path_factory.mktemp("grader") / "key.json"
    secret.write_text("the seed is 4711")
    secret.parent.chmod(0o777)
    secret.chmod(0o666)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as ear:
        ear.bind(("127.0.0.1", 0))
        ear.settimeout(0.05)
        yield secret, ear


@pytest.mark.parametrize("name", submitted.HARM)
def test_an_attack_earns_nothing_and_harms_nothing(jail, grader, name):
    """Who may leave something behind runs twice, as two students one after the other."""
    secret, ear = grader
    cell = submitted.attack(name, secret, ear.getsockname()[1])
    for _ in range(1 + ("sys.mine" in cell)):
        found = said(cell, seed=4711)
        assert not found.right and found.share == 0
        assert "found" not in found.reason or "hidden case" in name or "pipe" in name
    assert secret.read_text() == "the seed is 4711"
    with pytest.raises(TimeoutError):
        ear.recv(99)


@pytest.mark.parametrize("name", [name for name in submitted.HARM if "hidden case" in name])
def test_a_hidden_case_stays_hidden(jail, name):
    """Catches an error of a student that carries a hidden case into the feedback."""
    exercise = EXERCISES["compose"]
    harm = submitted.HARM[name].replace("    raise", "        raise")
    known = f"    if tuple(a) not in {[tuple(c[0].tolist()) for c in exercise.cases.values()]}:\n"
    head, rest = submitted.COMPOSE.replace("a_from_b", "a").replace("b_from_c", "b").split("\n", 1)
    cell = f"{head}\n{known}{harm}{rest}"
    found = said(cell, seed=4711)
    assert said(cell).right
    assert found.reason == "right on the cases shown; on a hidden one it raises an exception"


FOOLS = "my_map = [*segmap.simulation.rectangular_room().tolist(), [(10, 10), (16, 10)]]"


@pytest.mark.parametrize(
    ("task", "given", "cell", "kind", "words"),
    [
        ("predict_beams_on_wall", "my_guess", "my_guess = 15", "right", "it is 15 beams"),
        ("predict_beams_on_wall", "my_guess", "my_guess = None", "empty", "your number first"),
        ("predict_beams_on_wall", "my_guess", "my_guess = 4", "wrong", "near enough"),
        ("break_quality", "my_map", FOOLS, "right", "invented costs nothing"),
        ("break_quality", "my_map", "my_map = [[(1e300, 0), (0, 0)]]", "wrong", "within 20 m"),
        ("break_quality", "my_map", "my_map = np.zeros(10**8)", "wrong", "array of 100000000"),
        ("break_quality", "my_map", "my_map = np.ones(10**10)", "memory", "memory"),
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
    jail, task, given, cell, kind, words
):
    asked = Task(task, "x", (given,), 4, "import numpy as np\nimport segmap", given)
    found = said(cell, task=asked)
    assert found.kind == kind and words in found.reason


# ------------------------------------------------------------------ parts of the way
@pytest.mark.parametrize("name", EXERCISES)
def test_cases_arrive_as_they_were_sent(name):
    """Catches a tuple that becomes a list, a whole number that becomes a float, a lost function."""
    exercise = EXERCISES[name]
    cases = {**exercise.cases, **exercise.fresh(5)}
    arrived = {words: decode(json.loads(json.dumps(encode(case)))) for words, case in cases.items()}
    assert list(arrived) == list(cases)
    for sent, found in zip(cases.values(), arrived.values(), strict=True):
        assert [type(a) for a in sent] == [type(b) for b in found]
        arrays = [(a, b) for a, b in zip(sent, found, strict=True) if isinstance(a, np.ndarray)]
        assert all(a.dtype == b.dtype and np.array_equal(a, b, equal_nan=True) for a, b in arrays)
    assert exercise.verdict(exercise.expected(arrived), cases)


@pytest.mark.parametrize(
    "data",
    [
        {},
        {"error": None},
        {"array": [[1], "float64", []]},
        {"array": [[-2], "float64", [1.0]]},
        {"array": [[1], "object", [1.0]]},
        {"array": [[1], "float64", [None]]},
        {"number": [[], "float64", ["x"]]},
        {"tuple": 3},
        {"bytes": "xyz"},
        {"surface": [1]},
        {"a": 1, "b": 2},
        {"array": [[200_000], "float64", [0.0] * 200_000]},
    ],
)
def test_what_a_process_makes_up_is_no_value(data):
    with pytest.raises(ValueError, match="no value"):
        decode(data)


@pytest.mark.parametrize("name", EXERCISES)
@pytest.mark.parametrize("made_up", [None, {}, [], [None], {"error": None}, "", "nan", b""])
def test_two_missing_values_are_not_the_same(name, made_up):
    """Catches `None == None`, by which a list of nothing once earned full points."""
    exercise = EXERCISES[name]
    assert not exercise.verdict([made_up] * len(exercise.cases))
    assert not exercise.verdict([encode(made_up)] * len(exercise.cases))


def notebook(*cells):
    made = [
        {"cell_type": "code", "id": name, "metadata": {}, "source": text} for name, text in cells
    ]
    return json.dumps({"cells": made})


@pytest.mark.parametrize(
    "text", ["", "[]", "3", '{"cells": 3}', '{"cells": [3]}', "[" * 10**5, "\0"]
)
def test_what_is_no_notebook_is_a_problem_of_its_student_alone(tmp_path, text):
    (tmp_path / "a.ipynb").write_text(text)
    (tmp_path / "b.ipynb").write_text(notebook(("f-answer", "def my_f(): 2")))
    plan = plan_of("11", None)._replace(tasks=[TASK])
    bad, good = (row.submission.problems for row in graded(tmp_path, plan, unprotected=True))
    assert "no notebook" in bad[0] and good == []


def test_what_is_wrong_is_said_at_the_door(tmp_path, capsys):
    def refused(*arguments):
        assert main(["grade", *map(str, arguments)]) == 1
        return capsys.readouterr().err

    table, one = tmp_path / "grades.csv", ("--chapters", "11")
    assert "is no folder" in refused(tmp_path / "nowhere", "-o", table, *one)
    assert "holds no submission" in refused(tmp_path, "-o", table, *one)
    assert "no chapter has the number 98" in refused(tmp_path, "-o", table, "--chapters", "98")
    assert "must name a table" in refused(tmp_path, "-o", tmp_path / "grades.txt")
    assert "x does not exist" in refused(tmp_path, "-o", tmp_path / "x" / "grades.csv")
    assert "leave --chapters" in refused(tmp_path, "-o", table, "--key", table, "--seed", "3")
    (tmp_path / "key.json").write_text("{}")
    assert "no instructor's file" in refused(tmp_path, "-o", table, "--key", tmp_path / "key.json")
    assert not table.exists()


def test_without_a_jail_nothing_runs(tmp_path, monkeypatch, capsys):
    """Catches a grader that runs hostile code as its own user without a word."""
    which = {name: shutil.which(name) for name in ("bwrap", "prlimit")} | {"bwrap": None}
    monkeypatch.setattr(shutil, "which", which.get)
    (tmp_path / "ann.ipynb").write_text(notebook(("compose-answer", submitted.COMPOSE)))
    words = ["grade", str(tmp_path), "-o", str(tmp_path / "g.csv"), "--chapters", "11"]
    assert main(words) == 1
    assert "bubblewrap" in capsys.readouterr().err and not (tmp_path / "g.csv").exists()
    assert main([*words, "--unprotected"]) == 0
    assert "no jail" in capsys.readouterr().out
    (row,) = csv.DictReader((tmp_path / "g.csv").read_text().splitlines())
    assert (row["compose"], row["jail"]) == ("4", "none")


def test_the_container_is_made_of_what_is_there():
    """Catches a recipe that names a folder of yesterday, or that comes without bubblewrap."""
    recipe = (ROOT / "notebooks" / "Containerfile").read_text()
    copied = [line.split()[1:-1] for line in recipe.splitlines() if line.startswith("COPY")]
    assert all((ROOT / name).exists() for names in copied for name in names) and copied
    assert "bubblewrap" in recipe and "segmap_course" in recipe
    lines = "\n".join(make("-n", "grade", "CONTAINER=podman", "DIR=/lab", "ARGS=in -o g.csv"))
    assert "--network none --cap-drop all" in lines and "--userns keep-id" in lines
    assert "systempaths=unconfined" in lines, "bubblewrap writes below /proc/sys"
    assert '"/lab:/work"' in lines and lines.endswith("segmap-grade grade in -o g.csv")
