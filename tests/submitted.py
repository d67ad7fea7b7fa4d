"""Made-up students of chapters 11 and 13: each hands in both answers, one of them spoilt."""

from __future__ import annotations

import copy
import json
import os
import tempfile
from functools import cache
from pathlib import Path
from typing import Any

import pytest
from segmap_course.grading import graded, plan_of
from segmap_course.grading.handout import write_solutions

COMPOSE = """\
def my_compose(a_from_b, b_from_c):
    x, y, h = a_from_b
    u, v, k = b_from_c
    turned = np.cos(h) * u - np.sin(h) * v, np.sin(h) * u + np.cos(h) * v
    return np.array([x + turned[0], y + turned[1], (h + k + np.pi) % (2 * np.pi) - np.pi])
"""
CAST = """\
def my_cast_ray(wall, pose, angle):
    (ax, ay), (bx, by) = wall
    dx, dy = np.cos(pose[2] + angle), np.sin(pose[2] + angle)
    ex, ey = bx - ax, by - ay
    det = ex * dy - ey * dx
    if det == 0:
        return np.inf
    along = ((ax - pose[0]) * -ey + ex * (ay - pose[1])) / det
    share = (dx * (ay - pose[1]) - dy * (ax - pose[0])) / det
    return along if along >= 0 and 0 <= share <= 1 else np.inf
"""
WRONG = "def my_compose(a_from_b, b_from_c):\n    return a_from_b + b_from_c\n"
LIBRARY = "from segmap.poses import compose as my_compose\n"


def spoilt(line: str) -> str:
    """An answer to `compose` that does something else first."""
    head, rest = COMPOSE.split("\n", 1)
    return f"import os, shutil, sys, time\n{head}\n    {line}\n{rest}"


FORGED = '[os.write(k, b\'{{"answers": [], "passed": true}}\') for k in (1, 2)]; return [0, 0, 0]'
OVERWRITES = """\
import segmap_course as course
course.check_compose = lambda f: True
course.Exercise.__call__ = course.Exercise.verdict = lambda *_: True
"""
#: Student -> what becomes of the answer to `compose`, and the answer; that to `cast_ray` is right.
ANSWERS = {
    "01_right": ("right", COMPOSE),
    "02_stub": ("empty", None),
    "03_wrong": ("wrong", WRONG),
    "04_library": ("library", LIBRARY),
    "05_deletes": ("wrong", spoilt("shutil.rmtree({folder!r})")),
    "06_exits": ("ended", spoilt("os._exit(0)")),
    "07_endless": ("too long", spoilt("while True: pass")),
    "08_ten_gigabytes": ("memory", spoilt("np.ones(1_250_000_000)")),
    "09_overwrites": ("wrong", OVERWRITES + WRONG),
    "12_forged": ("wrong", spoilt(FORGED)),
}
KINDS = {student: kind for student, (kind, _) in ANSWERS.items()}
KINDS |= {"10_broken": "unreadable", "11_no_cell": "missing"}


def hand_in(handed: Path, folder: Path, victim: Path) -> None:
    """Write the submissions of all students, made from the student copies of a handout."""
    copies = {path.name: json.loads(path.read_text()) for path in sorted(handed.iterdir())}
    for student, (_, answer) in ANSWERS.items():
        books = copy.deepcopy(copies)
        put(books, "cast_ray-answer", CAST)
        if answer is not None:
            put(books, "compose-answer", answer.format(folder=str(victim)))
        _write(folder / student, books)
    _write(folder / "10_broken", {name: "{" for name in copies})
    books = copy.deepcopy(copies)
    put(books, "cast_ray-answer", CAST)
    for book in books.values():
        book["cells"] = [cell for cell in book["cells"] if not cell["id"].startswith("compose")]
    _write(folder / "11_no_cell", books)


def put(books: dict, name: str, source: str) -> None:
    """Write an answer into its cell, and a name that is no good HTML into the name cell."""
    for book in books.values():
        for cell in book["cells"]:
            if cell["id"] == name:
                cell["source"] = source.splitlines(keepends=True)
            if cell["id"] == "name":
                cell["source"] = "**Name:** <script>alert(1)</script>\n\n"


def _write(folder: Path, books: dict) -> None:
    folder.mkdir(parents=True)
    for name, book in books.items():
        text = book if isinstance(book, str) else json.dumps(book)
        (folder / name).write_text(text)


#: Attack -> the cell of a student who wants points for `compose`, or harm; each is wrong by itself.
#: `{secret}` is a file of the grader's, `{port}` one that it listens on.
GET = """\
    import glob, gc, importlib, json, os, socket, subprocess, sys
    from pathlib import Path
"""
LOOKS = """\
    if hasattr(sys, "looked"): return [0, 0, 0]
    sys.looked = True
    found = [folder + "/" + name for folder, _, names in os.walk("/") for name in names]
    found = [p for p in found if {wanted}]
    if found: raise ValueError("found " + found[0])
"""
HARM = {
    "an answer that is nothing": "    return None\n",
    "nothing by the pipe": """\
    for k in range(64):
        try: os.write(k, b'{"error": null}\\n[{"error": null}]\\nnull\\n' * 30)
        except OSError: pass
    os._exit(0)
""",
    "the verdict by the pipe": """\
    for k in range(64):
        try: os.write(k, b'{"passed": true, "kind": "right", "share": 1.0}\\n' * 30)
        except OSError: pass
""",
    "the check overwritten": """\
    import segmap_course as course
    course.Exercise.answers = lambda *_: [{"error": None}] * 8
    course.check_compose = lambda f: True
    json.dumps = lambda *_: "null"
""",
    "the library called": "    from segmap.poses import compose\n    return compose(a, b)\n",
    "another function that calls it": (
        "    from segmap.poses import between, inverse\n    return between(inverse(a), b)\n"
    ),
    "the library's source": LOOKS.format(wanted="p.endswith('/motions.py')"),
    "the library's machine code": LOOKS.format(
        wanted="p[-4:] in ('.nbi', '.nbc', '.pyc') and ('/motions.' in p or '/_poses.' in p)"
    ),
    "the solution among the objects": """\
    known = [f for f in gc.get_objects() if getattr(f, "__name__", "") in ("compose", "_composed")]
    if [f for f in known if callable(f)]: raise ValueError("found")
""",
    "the seed and what others wrote": """\
    raise ValueError("found " + open("{secret}").read())
""",
    "shared memory": """\
    import ctypes
    libc = ctypes.CDLL(None)
    libc.shmat.restype = ctypes.c_void_p
    at = libc.shmget(4711, 64, 0o1666)
    if at < 0: return [0, 0, 0]
    there = libc.shmat(at, None, 0)
    held = ctypes.string_at(there, 5)
    if held == b"found" and not hasattr(sys, "mine"): raise ValueError("found")
    ctypes.memmove(there, b"found", 5)
    sys.mine = True
""",
    "a file for the next": """\
    for folder in ("/tmp", "/dev/shm", "/var/tmp"):
        if os.path.exists(folder + "/left") and not hasattr(sys, "mine"): raise ValueError("found")
        try: open(folder + "/left", "w").write("x")
        except OSError: pass
    sys.mine = True
""",
    "all processes killed": "    os.kill(-1, 9)\n",
    "the grader killed": "    os.kill(os.getppid(), 9)\n",
    "a fork bomb": "    while True: os.fork()\n",
    "ten gigabytes": "    np.ones(1_250_000_000)\n",
    "a disk that is filled": """\
    with open("/tmp/full", "wb") as file:
        for _ in range(10_000): file.write(bytes(1 << 20))
""",
    "a loop without end": "    while True: pass\n",
    "a word by the network": """\
    socket.socket(socket.AF_INET, socket.SOCK_DGRAM).sendto(b"found", ("127.0.0.1", {port}))
    socket.create_connection(("127.0.0.1", {port}), 1)
""",
    "a file that is removed": """\
    os.remove("{secret}")
""",
    "another user": "    os.setuid(0)\n    os.remove('{secret}')\n",
    "a jail inside the jail": """\
    import ctypes
    if ctypes.CDLL(None).unshare(0x10000000) == 0: raise ValueError("found")
""",
    "the first process led": """\
    import ctypes
    libc = ctypes.CDLL(None)
    if libc.ptrace(0x4206, 1, 0, 0) == 0: raise ValueError("found")
    if libc.process_vm_writev(1, None, 0, None, 0, 0) == 0: raise ValueError("found")
    import resource
    for limit in (resource.RLIMIT_AS, resource.RLIMIT_CPU, resource.RLIMIT_FSIZE):
        if resource.prlimit(1, limit) != resource.prlimit(0, limit): raise ValueError("found")
""",
    "files in memory": """\
    try: files = [os.memfd_create("x") for _ in range(20)]
    except OSError: return [0, 0, 0]
    if sum(os.write(file, bytes(1 << 20)) for file in files) > 16 << 20: raise ValueError("found")
""",
    "a key for the next": """\
    import ctypes
    keyctl = 250 if os.uname().machine == "x86_64" else 219
    if ctypes.CDLL(None).syscall(keyctl, 0, -3, 1) >= 0: raise ValueError("found")
""",
    "a hidden case in an error": "    raise ValueError('found ' + repr(a))\n",
    "a hidden case in the name of an error": (
        "    raise type('found' + repr(a), (Exception,), {})('x')\n"
    ),
    "megabytes": "    return ['x' * 1000] * 99_000\n",
    "a number without end": "    return [10**5000, float('nan')]\n",
}


def attack(name: str, secret: Path, port: int) -> str:
    """The cell of an attack on `compose`, with a wrong answer behind it.

    Those on hidden cases answer the open ones as they should, or there were nothing to tell.
    """
    text = HARM[name].replace("{secret}", str(secret)).replace("{port}", str(port))
    head = "import gc\ndef my_compose(a, b):\n" + GET
    return f"{head}{text}    return [0, 0, 0]\n"


#: Cells of a notebook: the name of each, its kind and its text.
Cells = list[tuple[str, str, str]]


def rows_of(folder: Path, students: dict[str, dict[str, tuple[float, Cells]]]) -> list[Any]:
    """Rows of the grader for students, each with files by name, their times and their cells.

    None answers the one task that is asked: no code of theirs runs.
    """
    for student, files in students.items():
        for name, (time, cells) in files.items():
            alone = list(files) == ["a.ipynb"]
            path = folder / f"{student}.ipynb" if alone else folder / student / name
            path.parent.mkdir(parents=True, exist_ok=True)
            made = [{"id": id, "cell_type": kind, "source": text} for id, kind, text in cells]
            path.write_text(json.dumps({"cells": made}))
            os.utime(path, (time, time))
    plan = plan_of("11", None)
    return list(graded(folder, plan._replace(tasks=plan.tasks[:1]), unprotected=True))


@cache
def solved() -> dict[str, str]:
    """The solution of each exercise of the chapters, a cell that runs by itself."""
    with tempfile.TemporaryDirectory() as folder:
        write_solutions(Path(folder) / "all")
        books = [json.loads(path.read_text()) for path in Path(folder).glob("all/*/*.ipynb")]
    cells = {cell["id"]: "".join(cell["source"]) for book in books for cell in book["cells"]}
    found = {}
    for name, text in cells.items():
        _, begins, rest = text.partition("### BEGIN SOLUTION\n")
        if name.endswith("-answer") and begins:
            found[name.removesuffix("-answer")] = rest.removesuffix("\n### END SOLUTION")
    return found


def solution(name: str) -> tuple[str, str]:
    """What the solution of an exercise defines, and its source."""
    if name not in solved():
        pytest.skip("no chapter asks for it")
    source = solved()[name]
    return source.rpartition("\n")[2].partition(" = ")[0], source
