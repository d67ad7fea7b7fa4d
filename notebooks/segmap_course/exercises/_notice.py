"""Notice that a student's function calls the library's answer in place of its own code.

While the student's function runs, Python reports every function that starts (`sys.setprofile`), so
an answer is seen however it is wrapped: passed directly, by `partial`, in a lambda, in a thread,
through another function of the library that calls it. A compiled loop shows the call of its
wrapper. Machine code that was taken out of that wrapper shows nothing while it runs: it is looked
for among the objects that the student's function refers to.
"""

from __future__ import annotations

import functools
import sys
import threading
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from types import CodeType, FrameType, FunctionType
from typing import Any

import segmap
from segmap.compiled import Compiled

_PACKAGES = (Path(segmap.__file__).parent, Path(__file__).parents[1])
#: The call of a compiled loop: the loop itself stands in its first argument.
_COMPILED = Compiled.__call__.__code__


class Watch:
    """Open it around a call: `seen` is the first function of the library's answer that ran.

    Parameters
    ----------
    answers : iterable of str
        "segmap/poses/_poses.py:compose", a function of a file by its qualified name (what is
        defined inside it counts too), or "segmap_course/literal/lines.py", all functions of a file.
    solution : callable, optional
        A function that is part of the answer; a file of exercises that it stands in counts whole.

    Examples
    --------
    >>> from segmap.poses import compose, inverse
    >>> watch = Watch(["segmap/poses/_poses.py:compose"])
    >>> with watch:
    ...     found = compose((0, 0, 0), (1, 0, 0))
    >>> watch.seen
    'compose of segmap/poses/_poses.py'
    """

    def __init__(self, answers: Iterable[str], solution: object = None) -> None:
        self.seen = ""
        self._solution = getattr(solution, "__code__", None)
        self._whole: set[str] = set()
        self._named: set[tuple[str, str]] = set()
        if self._solution and Path(self._solution.co_filename).parent == Path(__file__).parent:
            self._whole.add(self._solution.co_filename)
        for answer in answers:
            file, _, name = answer.partition(":")
            path = str(next(p.parent for p in _PACKAGES if p.name == file.split("/")[0]) / file)
            if name:
                self._named.add((path, name))
            else:
                self._whole.add(path)
        self._files = self._whole | {path for path, _ in self._named}
        self._needed = bool(self._files) or self._solution is not None
        self._before: tuple[Any, Any] = (None, None)

    def __enter__(self) -> Watch:
        self._before = sys.getprofile(), threading.getprofile()
        if self._needed:
            threading.setprofile(self._look)
            sys.setprofile(self._look)
        return self

    def __exit__(self, *_: object) -> None:
        if self._needed:
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

    def note(self, code: CodeType) -> None:
        """Remember this code if it belongs to the answer."""
        path = code.co_filename
        if code is not self._solution and path not in self._files:
            return
        name = code.co_qualname.partition(".")[0]
        if code is self._solution or path in self._whole or (path, name) in self._named:
            self.seen = f"{name} of {_short(path)}"

    def look_into(self, function: Callable[..., Any]) -> None:
        """Notice machine code of the answer among what a function refers to."""
        for found in _referred(function, set()):
            source = getattr(found, "py_func", None)
            if isinstance(source, FunctionType) and not self.seen:
                self.note(source.__code__)


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
    named = [
        found.__globals__[name] for name in found.__code__.co_names if name in found.__globals__
    ]
    return [*cells, *named, *(found.__defaults__ or ())]


def _filled(cell: Any) -> bool:
    try:
        return cell.cell_contents is not None
    except ValueError:  # a name that has no value yet
        return False
