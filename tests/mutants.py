"""Bugs put into the package by rule, to see a test fail: `make mutants ROOM=reduction`.

    python tests/mutants.py reduction --count 40 --seed 1

A bug is an operator, a sign, a number, an index, a default or two arguments exchanged, or a call
left out. Each goes into a copy of the project in a temporary folder, and the fast tests of its room
must fail there, those named like its file first. What survives is listed: a test is missing, the
code could be simpler, or the bug changes nothing.
"""

import argparse
import ast
import contextlib
import importlib
import multiprocessing
import os
import random
import shutil
import signal
import sys
import tempfile
from collections import Counter
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import NamedTuple

import pytest

ROOT = Path(__file__).resolve().parents[1]
PACKAGES = {"segmap": ROOT / "segmap", "segmap_course": ROOT / "notebooks" / "segmap_course"}
ANSWERS = ROOT / "tests" / "right_answers.py"
#: Seconds after which a run counts as failed, since the bug made it hang; and for a whole room.
LONGEST, WHOLE_ROOM = 300, 1500
FORK = multiprocessing.get_context("fork")
#: What teaches, or only hands on, is left alone.
NOT_CHANGED = ("literal", "__init__.py", "__main__.py", "_warm.py", "testing")
SWAPPED = {
    **{"<": "<=", "<=": "<", ">": ">=", ">=": ">", "==": "!=", "!=": "=="},
    **{"+": "-", "-": "+", "*": "/", "/": "*", "//": "/", "%": "+", "**": "*"},
    **{"and": "or", "or": "and", "min": "max", "max": "min", "sin": "cos", "cos": "sin"},
}
#: Calls whose first argument takes their place.
LEFT_OUT = ("abs", "wrap", "copy", "sorted", "ascontiguousarray", "unique")


class Bug(NamedTuple):
    """A change of one file: what stands at a place, and what is put there."""

    path: Path
    place: int
    old: str
    new: str

    def __str__(self) -> str:
        before = self.path.read_text()[: self.place]
        line, column = before.count("\n") + 1, self.place - before.rfind("\n")
        return f"{self.path.relative_to(ROOT)}:{line}:{column}: {self.old!r} -> {self.new!r}"

    def tests(self) -> list[str]:
        """The tests that are named like the file, all others of its room, then its examples.

        Pytest collects in this order, and to collect the examples of a package sets its name in the
        package above: there `pose_graph` would be the folder for all tests that come later.
        """
        if self.path == ANSWERS:
            return ["tests/course/test_exercises.py"]
        base = next(p for p in PACKAGES.values() if self.path.is_relative_to(p))
        parts = self.path.relative_to(base).with_suffix("").parts
        if base.name == "segmap_course":
            parts = ("course", *parts)
        room, own = parts[0].strip("_"), parts[-1].strip("_")
        folder = ROOT / "tests" / room
        within = sorted(folder.rglob("test_*.py"))
        if not within:  # a room among the basics
            within = sorted(folder.parent.rglob(f"test_{room}*.py"))
        named = [p for p in within if p.stem.removeprefix("test_") in (own, *parts[1:])]
        rest = [p for p in within if p not in named]
        return [str(p.relative_to(ROOT)) for p in (*named, *rest, self.path)]


def sources(room: str) -> list[Path]:
    """The files of a room: a folder or file of the library, a folder of the course, or `course`.

    `answers` are right answers to the exercises: with a bug they are wrong, and must not pass.
    """
    if room == "answers":
        return [ANSWERS]
    for base in (PACKAGES["segmap"], PACKAGES["segmap_course"]):
        for path in (base / room, base / f"{room}.py"):
            if path.exists():
                found = sorted(path.rglob("*.py")) if path.is_dir() else [path]
                return [p for p in found if not any(name in p.parts for name in NOT_CHANGED)]
    raise SystemExit(f"there is no room {room!r}")


def made(room: str, count: int, seed: int) -> list[Bug]:
    """So many changes, spread over the files of a room."""
    rng = random.Random(f"{room} {seed}")
    by_file = [list(changes(path)) for path in sources(room)]
    for found in by_file:
        rng.shuffle(found)
    rng.shuffle(by_file)
    depth = max(map(len, by_file), default=0)
    return [found[k] for k in range(depth) for found in by_file if k < len(found)][:count]


def changes(path: Path) -> Iterator[Bug]:
    """All changes of a file that a rule makes, outside of texts, annotations and errors."""
    text = path.read_text()
    data, starts = text.encode(), [0]
    for line in text.splitlines(keepends=True):
        starts.append(starts[-1] + len(line.encode()))

    def begin(node: ast.AST) -> int:
        return starts[node.lineno - 1] + node.col_offset

    def end(node: ast.AST) -> int:
        return starts[node.end_lineno - 1] + node.end_col_offset

    def said(node: ast.AST) -> str:
        return data[begin(node) : end(node)].decode()

    def change(first: int, stop: int, new: str) -> Bug:
        return Bug(path, len(data[:first].decode()), data[first:stop].decode(), new)

    def operator(left: ast.AST, right: ast.AST) -> Iterator[Bug]:
        word = data[end(left) : begin(right)].decode().strip(" ()\n")
        if word in SWAPPED:
            at = end(left) + data[end(left) : begin(right)].decode().index(word)
            yield change(at, at + len(word), SWAPPED[word])

    for node in _code(ast.parse(text)):
        match node:
            case ast.BinOp():
                yield from operator(node.left, node.right)
            case ast.Compare(ops=[_]):
                yield from operator(node.left, node.comparators[0])
            case ast.BoolOp():
                yield from operator(node.values[0], node.values[1])
            case ast.UnaryOp(op=ast.USub() | ast.Not()):
                yield change(begin(node), begin(node.operand), "")
            case ast.Constant(value=bool(value)):
                yield change(begin(node), end(node), repr(not value))
            case ast.Constant(value=int(value)):
                yield change(begin(node), end(node), repr(value + 1))
            case ast.Constant(value=float(value)):
                yield change(begin(node), end(node), repr(value * 1.5 if value else 1.0))
            case ast.Call(keywords=[], args=[first, *rest]):
                name = getattr(node.func, "attr", getattr(node.func, "id", ""))
                if name in SWAPPED:
                    stop = end(node.func)
                    yield change(stop - len(name), stop, SWAPPED[name])
                if name in LEFT_OUT:
                    yield change(begin(node), end(node), said(first))
                if len(rest) == 1 and name not in ("isinstance", "min", "max", "range", "hypot"):
                    yield change(begin(first), end(rest[0]), f"{said(rest[0])}, {said(first)}")


def _code(tree: ast.AST) -> Iterator[ast.AST]:
    """Nodes that do something: no annotations, no texts, nothing inside `raise`."""
    for name, value in ast.iter_fields(tree):
        if name in ("annotation", "returns", "decorator_list"):
            continue
        for child in value if isinstance(value, list) else [value]:
            quiet = ast.Raise | ast.Assert | ast.JoinedStr | ast.Import | ast.ImportFrom
            if isinstance(child, ast.AST) and not isinstance(child, quiet):
                yield child
                yield from _code(child)


class Worker:
    """A copy of the project that takes one bug after the other.

    Each test run is a fork of this process, which has the large packages in memory already.
    """

    def __init__(self, folder: str) -> None:
        self.copy = Path(folder) / str(os.getpid()) / "segmap"
        leave = shutil.ignore_patterns(".git", ".venv", "build", ".mypy_cache", ".ruff_cache")
        shutil.copytree(ROOT, self.copy, ignore=leave)  # machine code included; times are kept

    def survives(self, bug: Bug, longest: float = LONGEST) -> bool:
        """Whether the tests pass with the bug; the copy, its machine code too, is as before."""
        path = self.copy / bug.path.relative_to(ROOT)
        text, stamp = bug.path.read_text(), path.stat()
        code = {p: p.read_bytes() for p in path.parent.glob(f"__pycache__/{path.stem}.*.nb?")}
        path.write_text(text[: bug.place] + bug.new + text[bug.place + len(bug.old) :])
        try:
            return self._pass(bug.tests(), longest)
        finally:
            path.write_text(text)
            os.utime(path, ns=(stamp.st_atime_ns, stamp.st_mtime_ns))
            for file, machine_code in code.items():
                file.write_bytes(machine_code)

    def _pass(self, tests: list[str], longest: float) -> bool:
        child = FORK.Process(target=_run_tests, args=(self.copy, tests))
        child.start()
        child.join(longest)
        hangs = child.exitcode is None
        with contextlib.suppress(ProcessLookupError):  # what the tests started goes too
            os.killpg(child.pid, signal.SIGKILL)
        child.join()
        if child.exitcode == pytest.ExitCode.USAGE_ERROR:
            raise SystemExit(f"pytest cannot run {tests}")
        return not hangs and child.exitcode in (0, pytest.ExitCode.NO_TESTS_COLLECTED)


def _run_tests(copy: Path, tests: list[str]) -> None:
    """In a process of its own: run tests of the copy in silence, stop at the first that fails."""
    os.setsid()
    silence = os.open(os.devnull, os.O_RDWR)
    for stream in range(3):
        os.dup2(silence, stream)
    os.chdir(copy)
    os.environ["PYTHONPATH"] = f"{copy}:{copy / 'notebooks'}"
    own = {str(ROOT / part) for part in (".", "tests", "notebooks")}
    ours = [str(copy), str(copy / "notebooks")]
    sys.path[:] = [*ours, *(folder for folder in sys.path if folder not in own)]
    options = ["-x", "-q", "-m", "not slow", "-p", "no:cacheprovider", "-p", "no:nbval"]
    os._exit(pytest.main([*options, *tests]))


def _begin(folder: str) -> None:
    global WORKER
    WORKER = Worker(folder)


def _survives(bug: Bug) -> bool:
    return WORKER.survives(bug)


def _passes_whole(bug: Bug) -> bool:
    return WORKER.survives(bug, WHOLE_ROOM)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("rooms", nargs="+")
    parser.add_argument("--count", type=int, default=40, help="bugs a room")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1)
    given = parser.parse_args()
    bugs = [(room, bug) for room in given.rooms for bug in made(room, given.count, given.seed)]
    for name in ("scipy.spatial", "scipy.sparse.linalg", "pandas", "matplotlib.pyplot", "numba"):
        importlib.import_module(name)  # once, for all forks
    sys.modules["numba"].njit(lambda x: x)(1)
    killed: Counter[str] = Counter()
    with (
        tempfile.TemporaryDirectory() as folder,
        ProcessPoolExecutor(given.jobs, FORK, _begin, (folder,)) as pool,
    ):
        whole = [next(bug for r, bug in bugs if r == room) for room in given.rooms]
        whole = [bug._replace(new=bug.old) for bug in whole]
        for room, passes in zip(given.rooms, pool.map(_passes_whole, whole), strict=True):
            if not passes:  # all its bugs would count as killed
                raise SystemExit(f"{room}: its tests fail, or take {WHOLE_ROOM} s, without any bug")
        lives = pool.map(_survives, [bug for _, bug in bugs])
        for (room, bug), survived in zip(bugs, lives, strict=True):
            killed[room] += not survived
            if survived:
                print(f"survived: {bug}", flush=True)
    for room, count in Counter(room for room, _ in bugs).items():
        print(f"{room:14} {killed[room]:4} of {count:4} killed")
    return 0


if __name__ == "__main__":
    sys.exit(main())
