"""Made-up students of chapters 11 and 13: each hands in both answers, one of them spoilt."""

from __future__ import annotations

import copy
import json
from pathlib import Path

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
    "02_stub": ("wrong", None),
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
