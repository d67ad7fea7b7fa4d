"""Bugs put into the package by rule, to see a test fail: `make mutants PACKAGE=reduction`.

    python -m benchmarks.mutants reduction --count 40 --seed 1

A bug is an operator, a sign, a number, an index, a default, an axis or two arguments exchanged, or
a call or a copy left out. Each goes into a copy of the project in a temporary folder, where the
fast tests of its package must fail. These run once without any bug, to know which of them reaches
which line; then a bug meets the tests that reach its statement, the quickest first. What survives
is listed: a test is missing, the code could be simpler, or the bug changes nothing.
"""

import argparse
import ast
import contextlib
import gc
import importlib
import inspect
import multiprocessing
import os
import pickle
import random
import shutil
import signal
import sys
import tempfile
import time
from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator
from concurrent.futures import ProcessPoolExecutor
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple

import coverage
import pytest

ROOT = Path(__file__).resolve().parents[1]
PACKAGES = {
    "segmap": ROOT / "segmap",
    "segmap_app": ROOT / "segmap_app",
    "segmap_course": ROOT / "notebooks" / "segmap_course",
}
#: Seconds that all tests of a package may take, and compiled code with a bug; and how many times as
#: long as without a bug the tests may take.
WHOLE_PACKAGE, COMPILING, SLOWER = 1500, 120, 5
#: What each run would import anew; pytest warns of one that it would like to rewrite.
LARGE = (
    *("scipy.spatial", "scipy.sparse.linalg", "pandas", "matplotlib.pyplot", "numba"),
    *("ipywidgets", "hypothesis"),
)
REWRITTEN = "pytest.PytestAssertRewriteWarning"
#: Files of tests under another name, and those of packages that try this one too: what is written
#: is read again.
ALSO = {
    "pipeline": (
        "app/page/test_workbench.py",
        "app/page/test_workbench_session.py",
        "app/commands/test_commands.py",
    ),
    "alignment/pose_graph": ("matching/test_merge.py",),
    "exports": ("app/files/test_graph_files.py", "exports/test_segment_files.py"),
    "grading": ("course/grading/test_handout.py", "course/grading/test_tasks.py"),
    "threads": ("basics/test_progress.py",),
}
FORK = multiprocessing.get_context("fork")
#: What teaches, or only hands on, is left alone.
NOT_CHANGED = ("literal", "__init__.py", "__main__.py", "warm.py", "testing")
SWAPPED = {
    **{"<": "<=", "<=": "<", ">": ">=", ">=": ">", "==": "!=", "!=": "=="},
    **{"+": "-", "-": "+", "*": "/", "/": "*", "//": "/", "%": "+", "**": "*"},
    **{"and": "or", "or": "and", "min": "max", "max": "min", "sin": "cos", "cos": "sin"},
    **{"&": "|", "|": "&", "is": "is not", "is not": "is", "in": "not in", "not in": "in"},
    **{"+=": "-=", "-=": "+=", "*=": "/=", "&=": "|=", "|=": "&="},
}
#: Calls whose first argument takes their place, methods that their object replaces,
#: and calls whose arguments stay in their order.
LEFT_OUT = ("abs", "wrap", "copy", "sorted", "ascontiguousarray", "unique", "inv", "radians")
DROPPED = ("copy", "resolve", "strip", "lower")
SAME_EITHER_WAY = ("isinstance", "min", "max", "maximum", "minimum", "range", "hypot")


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

    def lines(self) -> range:
        """What runs where it matters: its statement, the function of a default, or the file."""
        text = self.path.read_text()
        line = text.count("\n", 0, self.place) + 1
        nodes = [node for node in ast.walk(ast.parse(text)) if isinstance(node, ast.stmt)]
        around = [node for node in nodes if node.lineno <= line <= node.end_lineno]
        if not any(isinstance(node, ast.FunctionDef) for node in around):
            return range(1, text.count("\n") + 1)
        inner = around[-1]
        if isinstance(inner, ast.FunctionDef):
            return range(inner.body[0].lineno, inner.end_lineno + 1)
        within = getattr(inner, "body", None)  # of a loop, or what follows a condition
        return range(inner.lineno, within[0].lineno if within else inner.end_lineno + 1)


def tests_of(package: str) -> list[str]:
    """Files of tests, then the package's own files with their examples.

    Pytest collects in this order, and to collect the examples of a package sets its name in the
    package above: there `pose_graph` would be the folder for all tests that come later.
    """
    first = sources(package)[0]
    words = [part.strip("_") for part in package.split("/")]
    if first.is_relative_to(PACKAGES["segmap_course"]):
        words.insert(0, "course")
    folder = ROOT.joinpath("tests", *words)
    found = sorted(folder.rglob("test_*.py"))
    if not found:  # a package among the basics, or a part of the course
        found = sorted((ROOT / "tests").rglob(f"test_*{words[-1].removesuffix('s')}*.py"))
    found += [ROOT / "tests" / name for name in ALSO.get(package, ())]
    return [str(path.relative_to(ROOT)) for path in (*found, *sources(package))]


def sources(package: str) -> list[Path]:
    """The files of a package: a folder or file of the library, a folder of the course, `course`."""
    for base in (PACKAGES["segmap"], PACKAGES["segmap_course"]):
        for path in (base / package, base / f"{package}.py"):
            if path.exists():
                found = sorted(path.rglob("*.py")) if path.is_dir() else [path]
                return [p for p in found if not any(name in p.parts for name in NOT_CHANGED)]
    raise SystemExit(f"there is no package {package!r}")


def made(package: str, count: int, seed: int) -> list[Bug]:
    """So many changes, spread over the files of a package."""
    rng = random.Random(f"{package} {seed}")
    by_file = [list(changes(path)) for path in sources(package)]
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
            case ast.Compare():
                for pair in pairwise([node.left, *node.comparators]):
                    yield from operator(*pair)
            case ast.AugAssign():
                yield from operator(node.target, node.value)
            case ast.UnaryOp(op=ast.USub() | ast.Not() | ast.Invert()):
                word = "not " if isinstance(node.op, ast.Not) else "-"
                yield change(begin(node), begin(node) + len(word), "")
            case ast.Constant(value=bool(value)):
                yield change(begin(node), end(node), repr(not value))
            case ast.Constant(value=int(value)):
                yield change(begin(node), end(node), repr(value + 1))
            case ast.Constant(value=float(value)):
                yield change(begin(node), end(node), repr(value * 1.5 if value else 1.0))
            case ast.keyword(arg="axis", value=ast.Constant(value=(0 | 1) as value)):
                yield change(begin(node.value), end(node.value), repr(1 - value))
            case ast.Expr(value=ast.Call()):
                yield change(begin(node), end(node), "None")
            case ast.Attribute(attr="T"):
                yield change(end(node) - len(".T"), end(node), "")
            case ast.Call(keywords=[], args=[], func=ast.Attribute(attr=name)) if name in DROPPED:
                yield change(end(node.func) - len(f".{name}"), end(node), "")
            case ast.Call(keywords=[], args=[first, *rest]):
                name = getattr(node.func, "attr", getattr(node.func, "id", ""))
                if name in SWAPPED:
                    stop = end(node.func)
                    yield change(stop - len(name), stop, SWAPPED[name])
                if name in LEFT_OUT:
                    yield change(begin(node), end(node), said(first))
                if len(rest) == 1 and name not in SAME_EITHER_WAY:
                    yield change(begin(first), end(rest[0]), f"{said(rest[0])}, {said(first)}")


def _code(tree: ast.AST) -> Iterator[ast.AST]:
    """Nodes that do something: no annotations, no texts, no `strict`, nothing inside `raise`."""
    for name, value in ast.iter_fields(tree):
        if name in ("annotation", "returns", "decorator_list"):
            continue
        for child in value if isinstance(value, list) else [value]:
            quiet = ast.Raise | ast.Assert | ast.JoinedStr | ast.Import | ast.ImportFrom
            strict = getattr(child, "arg", "") == "strict"  # of zip
            if isinstance(child, ast.AST) and not isinstance(child, quiet) and not strict:
                yield child
                yield from _code(child)


class Worker:
    """A copy of the project that takes one bug after the other.

    Each test run is a fork of this process, which has the large packages in memory already.
    """

    def __init__(self, folder: str) -> None:
        self.copy = Path(folder) / str(os.getpid()) / "segmap"
        leave = shutil.ignore_patterns(".git", ".venv*", "build", ".mypy_cache", ".ruff_cache")
        shutil.copytree(ROOT, self.copy, ignore=leave)  # machine code included; times are kept

    def reached(self, package: str) -> "Reached":
        """What the tests of a package reach without any bug."""
        notes = self.copy.parent / "reached"
        if not self._pass(tests_of(package), WHOLE_PACKAGE, Notes(self.copy, package, notes)):
            raise SystemExit(
                f"{package}: its tests fail, or take {WHOLE_PACKAGE} s, without any bug"
            )
        return Reached(*pickle.loads(notes.read_bytes()))

    def survives(self, bug: Bug, tests: list[str], longest: float) -> bool:
        """Whether these tests pass with the bug; the copy, its machine code too, is as before."""
        path = self.copy / bug.path.relative_to(ROOT)
        text, stamp = bug.path.read_text(), path.stat()
        code = {p: p.read_bytes() for p in path.parent.glob(f"__pycache__/{path.stem}.*.nb?")}
        path.write_text(text[: bug.place] + bug.new + text[bug.place + len(bug.old) :])
        files = sorted({*map(file_of, tests)}, reverse=True)  # those of `tests` first
        try:
            return self._pass(files, longest, Chosen(tests))
        finally:
            path.write_text(text)
            os.utime(path, ns=(stamp.st_atime_ns, stamp.st_mtime_ns))
            for file, machine_code in code.items():
                file.write_bytes(machine_code)

    def _pass(self, tests: list[str], longest: float, plugin: object) -> bool:
        child = FORK.Process(target=_run_tests, args=(self.copy, tests, plugin))
        child.start()
        child.join(longest)
        hangs = child.exitcode is None
        with contextlib.suppress(ProcessLookupError):  # what the tests started goes too
            os.killpg(child.pid, signal.SIGKILL)
        child.join()
        if child.exitcode == pytest.ExitCode.USAGE_ERROR:
            raise SystemExit(f"pytest cannot run {tests}")
        return not hangs and child.exitcode in (0, pytest.ExitCode.NO_TESTS_COLLECTED)


def file_of(test: str) -> str:
    return test.partition("::")[0]


class Reached(NamedTuple):
    """How long each test of a package takes, and which of them reach a line of a file."""

    seconds: dict[str, float]
    by_line: defaultdict[tuple[str, int], set[str]]

    def tests(self, bug: Bug) -> list[str]:
        """Those that reach the bug, the quickest first, or those whose file reaches it.

        Where none does it is all: what a test runs in another process leaves no trace.
        """
        name = str(bug.path.relative_to(ROOT))
        near = set().union(*(self.by_line[name, line] for line in bug.lines()))
        tests = near & self.seconds.keys() or {t for t in self.seconds if file_of(t) in near}
        return sorted(tests or self.seconds, key=self.seconds.__getitem__)

    def longest(self, tests: list[str]) -> float:
        """Seconds after which they count as failed: the bug made one hang."""
        return COMPILING + SLOWER * sum(self.seconds[test] for test in tests)


class Notes:
    """A plugin of pytest that notes what is `Reached`, by a test or while its file is collected.

    A compiled loop leaves no trace: where it is called, all its lines count, and those of the loops
    that it calls.
    """

    def __init__(self, copy: Path, package: str, notes: Path) -> None:
        self.copy, self.notes = copy, notes
        self.sources = [str(copy / path.relative_to(ROOT)) for path in sources(package)]
        self.reached = Reached({}, defaultdict(set))
        self.called: defaultdict[Any, set[str]] = defaultdict(set)

    def pytest_sessionstart(self) -> None:
        from segmap.compiled import Compiled

        def noted(kernel: Any, *args: object, **kwargs: object) -> object:
            self.called[kernel].add(self.now)
            return call(kernel, *args, **kwargs)

        call, Compiled.__call__ = Compiled.__call__, noted
        self.trace = coverage.Coverage(data_file=None, config_file=False, include=self.sources)
        self.trace.start()

    def pytest_collectstart(self, collector: pytest.Collector | pytest.Item) -> None:
        self.now = collector.nodeid
        self.trace.switch_context(self.now)

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_protocol(self, item: pytest.Item) -> Iterator[None]:
        self.pytest_collectstart(item)
        begin = time.perf_counter()
        result = yield
        self.reached.seconds[self.now] = time.perf_counter() - begin
        return result

    def pytest_sessionfinish(self) -> None:
        self.trace.stop()
        for file in self.trace.get_data().measured_files():
            for line, tests in self.trace.get_data().contexts_by_lineno(file).items():
                self._note(file, line, tests)
        for kernel, tests in self.called.items():
            self._note_kernel(kernel, tests)
        self.notes.write_bytes(pickle.dumps(tuple(self.reached)))

    def _note_kernel(self, kernel: Any, tests: set[str]) -> None:
        lines, first = inspect.getsourcelines(kernel.plain)
        for line in range(first, first + len(lines)):
            self._note(inspect.getfile(kernel.plain), line, tests)
        for name in kernel.plain.__code__.co_names:
            if isinstance(other := kernel.plain.__globals__.get(name), type(kernel)):
                self._note_kernel(other, tests)

    def _note(self, file: str, line: int, tests: Iterable[str]) -> None:
        self.reached.by_line[str(Path(file).relative_to(self.copy)), line].update(tests)


class Chosen:
    """A plugin of pytest that runs these tests in this order."""

    def __init__(self, tests: list[str]) -> None:
        self.place = {test: k for k, test in reversed(list(enumerate(tests)))}

    def pytest_collection_modifyitems(self, items: list[pytest.Item]) -> None:
        items[:] = [item for item in items if item.nodeid in self.place]
        items.sort(key=lambda item: self.place[item.nodeid])


def _run_tests(copy: Path, tests: list[str], plugin: object) -> None:
    """In a process of its own: run tests of the copy in silence, stop at the first that fails."""
    os.setsid()
    multiprocessing.process._parent_process = None  # else the library takes it for a worker
    silence = os.open(os.devnull, os.O_RDWR)
    for stream in range(3):
        os.dup2(silence, stream)
    os.chdir(copy)
    os.environ["PYTHONPATH"] = f"{copy}:{copy / 'notebooks'}"
    own = {str(ROOT / part) for part in (".", "tests", "notebooks")}
    ours = [str(copy), str(copy / "notebooks")]
    sys.path[:] = [*ours, *(folder for folder in sys.path if folder not in own)]
    options = ["-x", "-q", "--tb=no", "-m", "not slow", "-W", f"ignore::{REWRITTEN}"]
    for name in ("cacheprovider", "nbval", "anyio"):
        options += ["-p", f"no:{name}"]
    os._exit(pytest.main([*options, *tests], plugins=[plugin]))


def _begin(folder: str) -> None:
    global WORKER
    WORKER = Worker(folder)


def _reached(package: str) -> Reached:
    return WORKER.reached(package)


def _survives(bug: Bug, tests: list[str], longest: float) -> bool:
    return WORKER.survives(bug, tests, longest)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("packages", nargs="+")
    parser.add_argument("--count", type=int, default=40, help="bugs a package")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1)
    given = parser.parse_args()
    bugs = [
        (package, bug)
        for package in given.packages
        for bug in made(package, given.count, given.seed)
    ]
    for name in LARGE:
        importlib.import_module(name)  # once, for all forks
    sys.modules["numba"].njit(lambda x: x)(1)
    gc.freeze()
    killed: Counter[str] = Counter()
    with (
        tempfile.TemporaryDirectory() as folder,
        ProcessPoolExecutor(given.jobs, FORK, _begin, (folder,)) as pool,
    ):
        reached = dict(zip(given.packages, pool.map(_reached, given.packages), strict=True))
        tests = [reached[package].tests(bug) for package, bug in bugs]
        longest = [reached[package].longest(t) for (package, _), t in zip(bugs, tests, strict=True)]
        lives = pool.map(_survives, [bug for _, bug in bugs], tests, longest)
        for (package, bug), survived in zip(bugs, lives, strict=True):
            killed[package] += not survived
            if survived:
                print(f"survived: {bug}", flush=True)
    for package, count in Counter(package for package, _ in bugs).items():
        print(f"{package:14} {killed[package]:4} of {count:4} killed")
    return 0


if __name__ == "__main__":
    sys.exit(main())
