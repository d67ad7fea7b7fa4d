"""Notice that a student's function calls the library's answer in place of its own code.

While the student's function runs, Python reports every function that starts (`sys.setprofile`), so
an answer is seen however it is wrapped: passed directly, by `partial`, in a lambda, in a thread,
through another function of the library that calls it. A kernel shows the call of its wrapper.
Machine code that was taken out of that wrapper shows nothing while it runs: it is looked for among
the objects that the student's function refers to.
"""

from __future__ import annotations

import functools
import inspect
import sys
import threading
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from types import CodeType, FrameType, FunctionType, ModuleType
from typing import Any

import segmap
from segmap.compiled import Compiled

_PACKAGES = (Path(segmap.__file__).parent, Path(__file__).parents[1])
#: The call of a kernel: the kernel itself stands in its first argument.
_COMPILED = Compiled.__call__.__code__
#: What all methods of a family share is no part of the answer to an exercise on one of them.
_SHARED = ("_runner", "_index")


class Watch:
    """Open it around a call: `seen` is the first function of the library's answer that ran.

    An answer is a function, with what is defined inside it, and with all that it calls of the
    private files and functions of its room; or a module: all its functions. The solution is one
    too; a file of exercises that it stands in counts whole.

    Examples
    --------
    >>> from segmap.poses import compose, inverse
    >>> watch = Watch([compose])
    >>> with watch:
    ...     found = compose((0, 0, 0), (1, 0, 0))
    >>> watch.seen
    'compose of segmap/poses/_poses.py'
    """

    def __init__(self, answers: Iterable[Any] = (), solution: object = None) -> None:
        self.seen = ""
        self._solution = getattr(solution, "__code__", None)
        self._places = _places(tuple(answers))
        if self._solution and Path(self._solution.co_filename).parent == Path(__file__).parent:
            self._places |= {(self._solution.co_filename, "")}
        self.files = {file for file, _ in self._places}
        self._before: tuple[Any, Any] = (None, None)

    def __enter__(self) -> Watch:
        self._before = sys.getprofile(), threading.getprofile()
        if self.files or self._solution:
            threading.setprofile(self._look)
            sys.setprofile(self._look)
        return self

    def __exit__(self, *_: object) -> None:
        if self.files or self._solution:
            threading.setprofile(self._before[1])
            sys.setprofile(self._before[0])

    def _look(self, frame: FrameType, event: str, called: Any) -> None:
        code = frame.f_code
        if self.seen:
            return
        if event == "call":
            self.note(frame.f_locals["self"].plain.__code__ if code is _COMPILED else code)
        elif event == "c_call" and called is sys.setprofile and code.co_filename != __file__:
            self.seen = "sys.setprofile, by which the check watches,"

    def covers(self, code: CodeType) -> bool:
        """Whether this code belongs to the answer."""
        path = code.co_filename
        if code is self._solution or path not in self.files:
            return code is self._solution
        name = code.co_qualname.partition(".")[0]
        return (path, "") in self._places or (path, name) in self._places

    def note(self, code: CodeType) -> None:
        """Remember this code if it belongs to the answer."""
        if self.covers(code):
            self.seen = f"{code.co_qualname.partition('.')[0]} of {_short(code.co_filename)}"

    def look_into(self, function: Callable[..., Any]) -> None:
        """Notice machine code of the answer among what a function refers to."""
        for found in _referred(function, set()):
            source = getattr(found, "py_func", None)
            if isinstance(source, FunctionType) and not self.seen:
                self.note(source.__code__)


def plain(found: Any) -> FunctionType | None:
    """The function behind a kernel or a decorator; None for what is no function."""
    source = found.plain if isinstance(found, Compiled) else inspect.unwrap(found)
    return source if isinstance(source, FunctionType) else None


@functools.cache
def _places(answers: tuple[Any, ...]) -> frozenset[tuple[str, str]]:
    """File and name of all functions of the answers; of a module no name: it counts whole."""
    modules = [found for found in answers if isinstance(found, ModuleType)]
    known: set[FunctionType] = set()
    todo = [function for found in answers if (function := plain(found)) is not None]
    while todo:
        function = todo.pop()
        if function not in known:
            known.add(function)
            todo += _helpers(function)
    named = {(f.__code__.co_filename, f.__code__.co_qualname.partition(".")[0]) for f in known}
    return frozenset(named | {(str(module.__file__), "") for module in modules})


def _helpers(function: FunctionType) -> Iterator[FunctionType]:
    """What a function calls of the private functions and files of its room."""
    names = set(_names(function.__code__))
    room = ".".join(function.__module__.split(".")[:2])
    scope = [function.__globals__.get(name) for name in names]
    inside = [vars(m).get(name) for m in scope if isinstance(m, ModuleType) for name in names]
    for found in [*scope, *inside]:
        helper = plain(found) if isinstance(found, FunctionType | Compiled) else None
        if helper is not None and f"{helper.__module__}.".startswith(f"{room}."):
            *_, file = helper.__module__.split(".")
            exported = getattr(sys.modules[room], helper.__name__, None) is found
            private = file.startswith("_") or helper.__name__.startswith("_")
            if private and not exported and file not in _SHARED:
                yield helper


def _names(code: CodeType) -> Iterator[str]:
    """The names that a code uses, in the functions inside it too."""
    yield from code.co_names
    for part in code.co_consts:
        if isinstance(part, CodeType):
            yield from _names(part)


def _short(path: str) -> str:
    """A file of the package as segmap/..., another one by its name."""
    found = [package for package in _PACKAGES if Path(path).is_relative_to(package)]
    return Path(path).relative_to(found[0].parent).as_posix() if found else Path(path).name


def _referred(found: Any, known: set[int]) -> Iterator[Any]:
    """An object, and what it refers to: partial arguments, wrapped functions, names, closures."""
    if id(found) in known:
        return
    known.add(id(found))
    yield found
    for part in _parts(found):
        yield from _referred(part, known)


def _parts(found: Any) -> list[Any]:
    if isinstance(found, functools.partial):
        return [found.func, *found.args, *found.keywords.values()]
    if not isinstance(found, FunctionType) or "/" in _short(found.__code__.co_filename):
        return []
    cells = [cell.cell_contents for cell in found.__closure__ or () if _filled(cell)]
    scope = found.__globals__
    named = [scope[name] for name in found.__code__.co_names if name in scope]
    return [*cells, *named, *(found.__defaults__ or ())]


def _filled(cell: Any) -> bool:
    try:
        return cell.cell_contents is not None
    except ValueError:  # a name that has no value yet
        return False
