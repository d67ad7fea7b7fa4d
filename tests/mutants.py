"""Bugs put into the package on purpose, to see a test fail: `make mutants`.

    python tests/mutants.py                  the planted bugs of planted.py
    python tests/mutants.py --random 300     as many changes made by rule, over all rooms
    python tests/mutants.py --only reduction some rooms only

Each bug goes into a copy of the project in a temporary folder; the tests named for it, or those of
its room, must fail there. What survives is listed: a test is missing, or the bug changes nothing.
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
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path
from typing import NamedTuple

import pytest
from planted import PLANTED

ROOT = Path(__file__).resolve().parents[1]
#: Seconds after which a run counts as failed: the bug made it hang.
LONGEST = 300
#: Seconds for all tests of a room without a bug.
WHOLE_ROOM = 1500
FORK = multiprocessing.get_context("fork")
#: The tests of a room, or of the files of a room that begin so, where their names do not begin with
#: the room's own; the examples of the file come with them.
TESTS = {
    "alignment": "alignment baselines",
    "alignment/_align_parts": "align_parts",
    "alignment/_angle": "angle_correspondence",
    "alignment/_backbone": "backbone",
    "alignment/_global": "global_segments",
    "alignment/_graph": "graph pose_graph",
    "alignment/_loop_closing": "pose_graph",
    "alignment/_point": "match_points point_map",
    "alignment/_front_end": "pose_graph",
    "alignment/_key_frames": "pose_graph",
    "alignment/_pose_graph": "pose_graph",
    "alignment/_step_loops": "match_points point_map",
    "alignment/_search_loops": "match_points point_map pose_graph",
    "alignment/_ways": "ways pose_graph",
    "alignment/_solver": "solver graph",
    "alignment/_segment": "segment_icp global_segments",
    "_arguments": "units doors segments poses scans metrics extraction quadtree",
    "arrays": "doors backbone segments poses scans metrics extraction quadtree",
    "_commands": "commands",
    "experiments": "experiments records comparison",
    "exports/_graph": "graph_files",
    "exports/_segments": "segment_files",
    "emulator": "emulator sensor_tcp",
    "hokuyo": "hokuyo record sensor",
    "_extraction_loops": "extraction compiled",
    "_files": "files records exports segment_files quadtree_files",
    "_information": "graph",
    "kernels": "metrics basic hybrid fusion segment_similarity weighted angle_corr reduction",
    "matching": "matchers matching distance_field map_scans",
    "matching/_live": "live_map",
    "methods": "alignment reduction",
    "_placed": "extraction quadtree distance_field exports units",
    "plotting": "plotting drawings comparison",
    "quadtree": "quadtree distance_field",
    "readers": "readers hostile_files error_codes",
    "readers/_graph": "graph_files",
    "readers/_segments": "segment_files",
    "reduction": "reduction",
    "reduction/_basic": "basic reduction",
    "reduction/_boxes": "weighted_line_fitting fuzzy_set reduction",
    "reduction/_cells": "cells segment_similarity uncertain_parameters reduction",
    "reduction/_climb": "mean_shift reduction",
    "reduction/_fusion": "fusion reduction",
    "reduction/_fuzzy_": "fuzzy_clustering reduction",
    "reduction/_fuzzy_set": "fuzzy_set reduction",
    "reduction/_hough": "hybrid reduction",
    "reduction/_hybrid": "hybrid reduction",
    "reduction/_least_cost": "least_cost reduction",
    "reduction/_line_fits": "weighted_line_fitting reduction",
    "reduction/_mean_shift": "mean_shift reduction",
    "reduction/_points": "map_points viewing_sector reduction",
    "reduction/_polyline": "polyline reduction",
    "reduction/_rectangles": "fuzzy_set reduction",
    "reduction/_sector": "viewing_sector reduction",
    "reduction/_segment_similarity": "segment_similarity reduction",
    "reduction/_uncertain": "uncertain_parameters reduction",
    "reduction/_viewing": "viewing_sector reduction",
    "reduction/_weighted": "weighted_line_fitting reduction",
    "segments": "segments segment_files map_points returns",
    "_segment_points": "map_points segment_files",
    "simulation": "simulation simulated_data",
}


#: What teaches, helps tests or only hands on is left alone.
NOT_CHANGED = ("course", "literal", "testing", "display", "warm", "_main__", "_init__")


class Bug(NamedTuple):
    """A change of one file, and the tests that must see it."""

    room: str
    path: Path
    old: str
    new: str
    place: int
    tests: tuple[str, ...]

    def __str__(self) -> str:
        before = self.path.read_text()[: self.place]
        line, column = before.count("\n") + 1, self.place - before.rfind("\n")
        return f"{self.path.relative_to(ROOT)}:{line}:{column}: {self.old!r} -> {self.new!r}"


def room_of(path: Path) -> str:
    part = path.relative_to(ROOT / "segmap").parts[0]
    return part.removesuffix(".py").removeprefix("_").removesuffix("_loops")


def tests_of(path: Path) -> tuple[str, ...]:
    """The examples of a file, and the tests of it or its room."""
    name = path.relative_to(ROOT / "segmap").as_posix()
    words = [TESTS[key] for key in sorted(TESTS, key=len) if name.startswith(key)]
    words = (words or [room_of(path)])[-1].split()
    found = [p for word in words for p in sorted((ROOT / "tests").glob(f"test_{word}*.py"))]
    return tuple(str(p.relative_to(ROOT)) for p in dict.fromkeys([path, *found]))


# ------------------------------------------------------------------ planted by hand
def planted() -> list[Bug]:
    """The bugs of `planted.py`, found by their text wherever it stands now."""
    sources = {p: p.read_text() for p in sorted((ROOT / "segmap").rglob("*.py"))}
    found = []
    for old, new, tests in PLANTED:
        homes = [p for p, text in sources.items() if old in text]
        if len(homes) != 1 or sources[homes[0]].count(old) != 1:
            raise SystemExit(f"planted.py: {old!r} stands {len(homes)} times in segmap, expected 1")
        place = sources[homes[0]].index(old)
        named = tuple(f"tests/test_{word}.py" for word in tests.split()) or tests_of(homes[0])
        found.append(Bug(room_of(homes[0]), homes[0], old, new, place, named))
    return found


# ------------------------------------------------------------------ made by rule
SWAPPED = {
    **{"<": "<=", "<=": "<", ">": ">=", ">=": ">", "==": "!=", "!=": "=="},
    **{"+": "-", "-": "+", "*": "/", "/": "*", "//": "/", "%": "+", "**": "*"},
    **{"and": "or", "or": "and", "min": "max", "max": "min", "sin": "cos", "cos": "sin"},
}


def made(count: int, seed: int) -> list[Bug]:
    """Changes by rule: signs, comparisons, constants, wraps left out, arguments exchanged."""
    rng = random.Random(seed)
    by_room: dict[str, list[Bug]] = {}
    for path in sorted((ROOT / "segmap").rglob("*.py")):
        if room_of(path) not in NOT_CHANGED:
            by_room.setdefault(room_of(path), []).extend(changes(path))
    rooms = sorted(by_room)
    for room in rooms:
        rng.shuffle(by_room[room])
    share = [by_room[room][: max(3, count // len(rooms))] for room in rooms]
    chosen = [bug for bugs in share for bug in bugs]
    rest = [bug for room in rooms for bug in by_room[room][max(3, count // len(rooms)) :]]
    rng.shuffle(rest)
    return (chosen + rest)[:count]


def changes(path: Path) -> list[Bug]:
    """All changes of a file that a rule makes, outside of texts, annotations and errors."""
    text, found = path.read_text(), []
    starts = [0]
    for line in text.splitlines(keepends=True):
        starts.append(starts[-1] + len(line.encode()))
    data = text.encode()

    def at(node: ast.AST, end: bool = False) -> int:
        if end:
            return starts[node.end_lineno - 1] + node.end_col_offset
        return starts[node.lineno - 1] + node.col_offset

    def change(begin: int, stop: int, new: str) -> None:
        place = len(data[:begin].decode())
        old = data[begin:stop].decode()
        found.append(Bug(room_of(path), path, old, new, place, tests_of(path)))

    def between(left: ast.AST, right: ast.AST) -> None:
        """The operator between two operands."""
        begin, stop = at(left, end=True), at(right)
        word = data[begin:stop].decode().strip(" ()\n")
        if word in SWAPPED:
            offset = data[begin:stop].decode().index(word)
            change(begin + offset, begin + offset + len(word), SWAPPED[word])

    for node in _code(ast.parse(text)):
        if isinstance(node, ast.BinOp):
            between(node.left, node.right)
        elif isinstance(node, ast.Compare) and len(node.ops) == 1:
            between(node.left, node.comparators[0])
        elif isinstance(node, ast.BoolOp):
            between(node.values[0], node.values[1])
        elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub | ast.Not):
            change(at(node), at(node.operand), "")
        elif isinstance(node, ast.Constant) and type(node.value) in (int, float):
            new = node.value * 1.5 if type(node.value) is float and node.value else node.value + 1
            change(at(node), at(node, end=True), repr(new))
        elif isinstance(node, ast.Call) and not node.keywords:
            name = node.func.attr if isinstance(node.func, ast.Attribute) else None
            name = name or (node.func.id if isinstance(node.func, ast.Name) else "")
            if name in SWAPPED:
                stop = at(node.func, end=True)
                change(stop - len(name), stop, SWAPPED[name])
            if name == "wrap":
                change(at(node.func), at(node.func, end=True), "")
            if len(node.args) == 2 and name not in ("isinstance", "min", "max", "range", "hypot"):
                one, two = node.args
                texts = [data[at(n) : at(n, end=True)].decode() for n in (two, one)]
                change(at(one), at(two, end=True), ", ".join(texts))
    return found


def _code(tree: ast.AST):
    """Nodes that do something: no annotations, no texts, nothing inside `raise`."""
    for name, value in ast.iter_fields(tree):
        if name in ("annotation", "returns", "decorator_list"):
            continue
        for child in value if isinstance(value, list) else [value]:
            if isinstance(child, ast.AST) and not isinstance(
                child, ast.Raise | ast.Assert | ast.JoinedStr | ast.Import | ast.ImportFrom
            ):
                yield child
                yield from _code(child)


# ------------------------------------------------------------------ run
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
        stop = bug.place + len(bug.old)
        path.write_text(text[: bug.place] + bug.new + text[stop:])
        try:
            return self._pass(bug.tests, longest)
        finally:
            path.write_text(text)
            os.utime(path, ns=(stamp.st_atime_ns, stamp.st_mtime_ns))
            for file, data in code.items():
                file.write_bytes(data)

    def _pass(self, tests: tuple[str, ...], longest: float) -> bool:
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


def _run_tests(copy: Path, tests: tuple[str, ...]) -> None:
    """In a process of its own: run tests of the copy in silence, stop at the first that fails."""
    os.setsid()
    silence = os.open(os.devnull, os.O_RDWR)
    for stream in range(3):
        os.dup2(silence, stream)
    os.chdir(copy)
    os.environ["PYTHONPATH"] = str(copy)
    own = {str(ROOT), str(ROOT / "tests")}
    sys.path[:] = [str(copy), *(folder for folder in sys.path if folder not in own)]
    os._exit(
        pytest.main(
            ["-x", "-q", "-m", "not slow", "-p", "no:cacheprovider", "-p", "no:nbval", *tests]
        )
    )


def _load_packages() -> None:
    """What most tests import, and the compiler: once, for all forks."""
    packages = "scipy.spatial scipy.sparse.linalg pandas matplotlib.pyplot numba"
    for name in packages.split():
        importlib.import_module(name)
    sys.modules["numba"].njit(lambda x: x)(1)


def _begin(folder: str) -> None:
    global WORKER
    WORKER = Worker(folder)


def _survives(bug: Bug) -> bool:
    return WORKER.survives(bug)


def _passes_whole(bug: Bug) -> bool:
    return WORKER.survives(bug, WHOLE_ROOM)


def _check_without_bugs(bugs: list[Bug], pool: ProcessPoolExecutor) -> None:
    """Stop where the tests of a room fail without any bug: all its bugs would count as killed."""
    rooms = sorted({bug.room for bug in bugs})
    none = [_no_bug([bug for bug in bugs if bug.room == room]) for room in rooms]
    for room, passes in zip(rooms, pool.map(_passes_whole, none), strict=True):
        if not passes:
            raise SystemExit(f"{room}: its tests fail, or take {WHOLE_ROOM} s, without any bug")


def _no_bug(bugs: list[Bug]) -> Bug:
    """A change that changes nothing, and the tests of all these bugs."""
    tests = dict.fromkeys(test for bug in bugs for test in bug.tests)
    return bugs[0]._replace(new=bugs[0].old, tests=tuple(tests))


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--random", type=int, default=0, help="so many changes made by rule")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--only", nargs="*", help="rooms")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1)
    given = parser.parse_args()
    bugs = made(given.random, given.seed) if given.random else planted()
    bugs = [bug for bug in bugs if not given.only or bug.room in given.only]
    killed, left = Counter(), []
    _load_packages()
    with (
        tempfile.TemporaryDirectory() as folder,
        ProcessPoolExecutor(given.jobs, FORK, _begin, (folder,)) as pool,
    ):
        _check_without_bugs(bugs, pool)
        for bug, lives in zip(bugs, pool.map(_survives, bugs), strict=True):
            killed[bug.room] += not lives
            if lives:
                left.append(bug)
                print(f"survived: {bug}", flush=True)
    for room, count in sorted(Counter(bug.room for bug in bugs).items()):
        print(f"{room:14} {killed[room]:4} of {count:4} killed")
    print(f"{'all':14} {sum(killed.values()):4} of {len(bugs):4} killed")
    return bool(left) and not given.random


if __name__ == "__main__":
    sys.exit(main())
