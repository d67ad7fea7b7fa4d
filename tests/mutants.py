"""Bugs put into the package on purpose, to see a test fail: `make mutants`.

    python tests/mutants.py                  the planted bugs of planted.py
    python tests/mutants.py --random 300     as many changes made by rule, over all rooms
    python tests/mutants.py --only reduction some rooms only

Each bug goes into a copy of the project in a temporary folder; the tests named for it, or those of
its room, must fail there. What survives is listed: a test is missing, or the bug changes nothing.
"""

import argparse
import ast
import os
import random
import shutil
import subprocess
import sys
import tempfile
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from queue import Queue
from typing import NamedTuple

from planted import PLANTED

ROOT = Path(__file__).resolve().parents[1]
#: Seconds after which a run counts as failed: the bug made it hang.
LONGEST = 400
#: The tests of a room, where their names do not begin with its own; doctests come with it.
TESTS = {
    "alignment": "alignment angle_correspondence backbone global_segments graph match_points "
    "baselines point_map pose_graph segment_icp",
    "experiments": "experiments records comparison",
    "extraction": "extraction",
    "hokuyo": "hokuyo record sensor",
    "matching": "match distance_field map_scans",
    "metrics": "metrics",
    "quadtree": "quadtree distance_field",
    "readers": "readers hostile_files error_codes",
    "reduction": "basic fusion hybrid mean_shift reduction",
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
        line = self.path.read_text()[: self.place].count("\n") + 1
        return f"{self.path.relative_to(ROOT)}:{line}: {self.old!r} -> {self.new!r}"


def room_of(path: Path) -> str:
    part = path.relative_to(ROOT / "segmap").parts[0]
    return part.removesuffix(".py").removeprefix("_").removesuffix("_loops")


def tests_of(path: Path) -> tuple[str, ...]:
    """The tests of the room that a file belongs to, and its examples."""
    room = room_of(path)
    begins = tuple(f"test_{word}" for word in TESTS.get(room, room).split())
    found = [p for p in sorted((ROOT / "tests").glob("test_*.py")) if p.stem.startswith(begins)]
    return tuple(str(p.relative_to(ROOT)) for p in [*found, path])


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
def survives(bug: Bug, copy: Path) -> bool:
    """Whether the tests pass with the bug in a copy of the project."""
    path = copy / bug.path.relative_to(ROOT)
    text, stamp = bug.path.read_text(), path.stat()
    stop = bug.place + len(bug.old)
    path.write_text(text[: bug.place] + bug.new + text[stop:])
    command = [sys.executable, "-m", "pytest", "-x", "-q", "-p", "no:cacheprovider", *bug.tests]
    try:
        done = subprocess.run(
            command, cwd=copy, env={**os.environ, "PYTHONPATH": str(copy)}, timeout=LONGEST,
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        )  # fmt: skip
        return done.returncode == 0
    except subprocess.TimeoutExpired:
        return False
    finally:
        path.write_text(text)
        os.utime(path, ns=(stamp.st_atime_ns, stamp.st_mtime_ns))


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
    with tempfile.TemporaryDirectory() as folder, ThreadPoolExecutor(given.jobs) as pool:
        copies: Queue[Path] = Queue()
        for k in range(given.jobs):
            copies.put(_copy(Path(folder) / str(k) / "segmap"))

        def run(bug: Bug) -> bool:
            copy = copies.get()
            try:
                return survives(bug, copy)
            finally:
                copies.put(copy)

        for bug, lives in zip(bugs, pool.map(run, bugs), strict=True):
            killed[bug.room] += not lives
            if lives:
                left.append(bug)
                print(f"survived: {bug}", flush=True)
    for room, count in sorted(Counter(bug.room for bug in bugs).items()):
        print(f"{room:14} {killed[room]:4} of {count:4} killed")
    print(f"{'all':14} {sum(killed.values()):4} of {len(bugs):4} killed")
    return bool(left) and not given.random


def _copy(to: Path) -> Path:
    """A copy of the project without its environment, machine code included (times are kept)."""
    leave = shutil.ignore_patterns(".git", ".venv", "build", ".mypy_cache", ".ruff_cache")
    shutil.copytree(ROOT, to, ignore=leave)
    return to


if __name__ == "__main__":
    sys.exit(main())
