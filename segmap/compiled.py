"""Plain loops, compiled when first called.

Where a method is a loop by nature it is written as that loop and marked `@compiled`. numba is
imported at the first call, the machine code is kept on disk, and where numba is missing the same
source runs as plain Python: slower, with the same result.
"""

from __future__ import annotations

import gc
import hashlib
import inspect
import multiprocessing
import os
import signal
import sys
import threading
import time
import types
from collections.abc import Callable
from contextlib import suppress
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from typing import Any, Generic, ParamSpec, TypeVar, cast, get_args, get_type_hints

from .progress import Compiling, announce

P = ParamSpec("P")
R = TypeVar("R")

#: Set this environment variable to 1 to run every loop as plain Python.
PLAIN = "SEGMAP_PLAIN"
#: Message where machine code is missing.
COMPILING = "compiling once on this machine, about a minute"
#: Message where machine code is missing and no folder can keep it.
KEPT_NOWHERE = "compiling, about a minute each time: no folder that could keep it may be written to"
#: What makes an array or a list in a kernel; numba refuses any other where it counts nothing.
MAKERS = frozenset({"append", "arange", "copy", "empty", "empty_like", "full", "heapq", "zeros"})
#: Loops that this process had to compile.
missing: list[str] = []


def runs_plain() -> bool:
    """Whether loops run as plain Python: so it was asked for, or there is no numba."""
    return os.environ.get(PLAIN) == "1" or find_spec("numba") is None


class Compiled(Generic[P, R]):
    """A function that becomes machine code at its first call; `.plain` is its source.

    Kernels may call other kernels, of other files too: a change there is seen. For its callers in
    Python a kernel gets a wrapper that unpacks arrays, which costs a sixth of the compiling; for
    other kernels it is compiled without. Never `fastmath`: it breaks `isfinite`. Other threads of
    Python run on beside a kernel.
    """

    def __init__(self, plain: Callable[P, R]) -> None:
        self.plain = plain
        self.__doc__ = plain.__doc__
        self._fast: Callable[P, R] | None = None
        self._inner: Callable[P, R] | None = None
        self._code = cast(types.FunctionType, plain).__code__

    def __call__(self, *args: P.args, **kwargs: P.kwargs) -> R:
        """Run the machine code."""
        if self._fast is None:
            self._fast = self.plain if runs_plain() else hold_signals(self._build)()
        return self._fast(*args, **kwargs)

    def _build(self) -> Callable[P, R]:
        try:
            import numba
        except ImportError:
            return self.plain
        njit: Callable[..., Any] = numba.njit
        linked, options = self._link(njit), self._options()
        try:
            machine = njit(cache=True, nogil=True, **options)(linked)
        except RuntimeError:  # no folder that a cache could be written to
            machine = njit(nogil=True, **options)(linked)
        machine._cache.load_overload = _cached_code(linked, machine._cache)
        machine.compile = hold_signals(machine.compile)
        return cast(Callable[P, R], machine)

    def _options(self) -> dict[str, bool]:
        return {"_nrt": self._counts(), "no_cfunc_wrapper": True}  # nobody calls it from C

    def _counts(self) -> bool:
        """Whether numba must count who holds an array: where one is made, or handed back.

        Elsewhere it would cost up to half of the time of a kernel that hands on tuples of arrays.
        """
        kernels = [one for one in self._names().values() if isinstance(one, Compiled)]
        hints = [get_type_hints(one.plain).get("return", "ndarray") for one in (self, *kernels)]
        return not MAKERS.isdisjoint(self._code.co_names) or "ndarray" in str(hints)

    def _link(self, njit: Callable[..., Any]) -> types.FunctionType:
        """The source, with the kernels that it calls replaced by their compiled forms.

        Those are not kept on disk: the machine code of what calls them holds theirs.
        """
        function = cast(types.FunctionType, self.plain)
        scope = dict(function.__globals__)
        for name, kernel in self._names().items():
            if isinstance(kernel, Compiled):
                if kernel._inner is None:  # one that Python has called already serves kernels too
                    jit = njit(no_cpython_wrapper=True, **kernel._options())
                    kernel._inner = _for_any_number(kernel._fast or jit(kernel._link(njit)))
                scope[name] = kernel._inner
        linked = types.FunctionType(function.__code__, scope, function.__name__)
        linked.__defaults__, linked.__module__ = function.__defaults__, function.__module__
        # The cache has an entry for each qualified name, and looks at this file alone.
        kind = "" if self._counts() else "-bare"
        linked.__qualname__ = function.__qualname__ + kind + self._key()
        return linked

    def _names(self) -> dict[str, Any]:
        """What the source names outside itself: other kernels, constants, classes, modules."""
        scope = cast(types.FunctionType, self.plain).__globals__
        return {name: scope[name] for name in self._code.co_names if name in scope}

    def _key(self) -> str:
        """Changes with all that the machine code rests on outside the kernel's own file.

        The cache holds named tuples by name: one that has moved could not be read.
        """
        own, parts = self._code.co_filename, self._parts()
        contents = [Path(file).read_bytes() for file in sorted({p[1] for p in parts} - {own, ""})]
        names = "\n".join(sorted(text for text, _ in parts))
        return "-" + hashlib.sha256(b"\n".join([names.encode(), *contents])).hexdigest()[:12]

    def _parts(self) -> set[tuple[str, str]]:
        """Names and files of this kernel, of those it calls and of its named tuples; constants."""
        parts = {(self.plain.__module__, self._code.co_filename)}
        for name, value in self._names().items():
            if isinstance(value, Compiled):
                parts |= value._parts()
            elif isinstance(value, (int, float, str, tuple)):
                parts.add((f"{name} = {value!r}", ""))
            else:
                parts |= _tuple_files(value)
        return parts.union(*map(_tuple_files, get_type_hints(self.plain).values()))


def _tuple_files(kind: Any) -> set[tuple[str, str]]:
    """Name and file of a class of named tuples, and of those that its fields hold."""
    inside = [_tuple_files(part) for part in get_args(kind)]
    if not hasattr(kind, "_fields"):
        return set().union(*inside)
    inside += [_tuple_files(part) for part in get_type_hints(kind).values()]
    return {(f"{kind.__module__}.{kind.__qualname__}", inspect.getfile(kind))}.union(*inside)


def _cached_code(source: types.FunctionType, own: Any) -> Callable[..., Any]:
    """How machine code is found: in the first folder, though it is read-only, else in one's own.

    numba passes by a folder that it may not write to, and compiles what an installation for all
    has. What must be compiled is told.
    """
    from numba.core import caching, config

    cache_dir = vars(config)["CACHE_DIR"]
    folder = caching.UserProvidedCacheLocator if cache_dir else caching.InTreeCacheLocator
    locator = type("First", (folder,), {"ensure_cache_path": lambda self: None})
    files = type("Files", (caching.CompileResultCacheImpl,), {"_locator_classes": [locator]})
    shared = type("Shared", (caching.FunctionCache,), {"_impl_class": files})
    load_own, words = own.load_overload, COMPILING if own.cache_path else KEPT_NOWHERE

    def load(*asked: Any) -> Any:
        code = None
        with suppress(OSError, RuntimeError):  # it may not be read; a cell has no file
            code = shared(source).load_overload(*asked)
        code = load_own(*asked) if code is None else code
        if code is None and source.__module__.startswith("segmap"):
            missing.append(source.__qualname__)
            if not announce(0.0, Compiling(f"{words}: {len(missing)} loops so far")):
                _say_once(words)
        return code

    return load


@cache
def _say_once(words: str) -> None:
    """Tell on the terminal why a run waits; workers of a pool leave it to who started them."""
    if multiprocessing.parent_process() is None and "ipykernel" not in sys.modules:
        hint = "; `segmap warm` does it for all" if words == COMPILING else ""
        print(f"segmap: {words}{hint}", file=sys.stderr)


class _WorkClock:
    """A clock that stands still while threads, one or several at once, load or compile loops."""

    def __init__(self) -> None:
        self.lock, self.busy, self.since, self.paused = threading.Lock(), 0, 0.0, 0.0

    def change(self, by: int) -> float:
        """One thread begins, or ends; answers the seconds until now."""
        with self.lock:
            now = time.perf_counter()
            if self.busy:
                self.paused += now - self.since
            self.busy, self.since = self.busy + by, now
            return now - self.paused


_clock = _WorkClock()


def work_time() -> float:
    """Seconds as `time.perf_counter` has them, without those of loading and compiling loops.

    All methods are timed by it: the first run of one takes as long as the second.

    Examples
    --------
    >>> begun = work_time()
    >>> work_time() - begun < 1
    True
    """
    return _clock.change(0)


def hold_signals(compiling: Callable[..., R]) -> Callable[..., R]:
    """Let interrupts wait: numba half imported, or a kernel half compiled, would stay broken.

    The main thread alone is interrupted. The clock of the work stands still, and Python looks for
    no garbage: that saves a tenth of the time, for objects that stay.
    """

    def run(*args: Any) -> R:
        collecting = gc.isenabled()
        _clock.change(1)
        gc.disable()
        try:
            return compiling(*args)
        finally:
            _clock.change(-1)
            if collecting:
                gc.enable()

    def call(*args: Any) -> R:
        if threading.current_thread() is not threading.main_thread():
            return run(*args)
        interrupts: list[int] = []
        handler = signal.signal(signal.SIGINT, lambda number, frame: interrupts.append(number))
        try:
            return run(*args)
        finally:
            signal.signal(signal.SIGINT, handler or signal.SIG_DFL)
            if interrupts:
                signal.raise_signal(signal.SIGINT)

    return call


def _for_any_number(inner: Any) -> Any:
    """Let a call with a constant use the code for any number: numba makes one for each constant."""
    from numba.core.types import unliteral

    number: Callable[[Any], Any] = unliteral
    chosen = inner.get_call_template
    inner.get_call_template = lambda args, kws: chosen([number(arg) for arg in args], kws)
    return inner


def compiled(function: Callable[P, R]) -> Compiled[P, R]:
    """Mark a loop to be compiled at its first call."""
    return Compiled(function)
