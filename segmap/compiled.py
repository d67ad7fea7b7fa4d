"""Plain loops, compiled when first called.

Where a method is a loop by nature it is written as that loop and marked `@compiled`. numba is
imported at the first call, the machine code is kept on disk, and where numba is missing the same
source runs as plain Python: slower, with the same result.
"""

from __future__ import annotations

import os
import types
import zlib
from collections.abc import Callable
from pathlib import Path
from typing import Any, Generic, ParamSpec, TypeVar, cast

P = ParamSpec("P")
R = TypeVar("R")

#: Set this environment variable to 1 to run every loop as plain Python.
PLAIN = "SEGMAP_PLAIN"


class Compiled(Generic[P, R]):
    """A function that becomes machine code at its first call; `.plain` is its source.

    Kernels may call other kernels, of other files too: a change there is seen. For its callers in
    Python a kernel gets a wrapper that unpacks arrays, which costs a sixth of the compiling; for
    other kernels it is compiled without. Never `fastmath`: it breaks `isfinite`. What is annotated
    `float` is handed over as one: numba would compile everything once more for `tolerance=1`.
    Other threads of Python run on beside a kernel.
    """

    def __init__(self, plain: Callable[P, R]) -> None:
        self.plain = plain
        self.__doc__ = plain.__doc__
        self._fast: Callable[P, R] | None = None
        self._inner: Callable[P, R] | None = None
        self._code = cast(types.FunctionType, plain).__code__
        names = self._code.co_varnames[: self._code.co_argcount]
        self._floats = [k for k, n in enumerate(names) if plain.__annotations__.get(n) == "float"]

    def __call__(self, *args: P.args, **kwargs: P.kwargs) -> R:
        """Run the machine code."""
        if self._fast is None:
            self._fast = self._build()
        given: list[Any] = list(args)
        for k in self._floats:
            given[k] = float(given[k])
        return self._fast(*given, **kwargs)

    def _build(self) -> Callable[P, R]:
        if os.environ.get(PLAIN) == "1":
            return self.plain
        try:
            import numba
        except ImportError:
            return self.plain
        return self._jit(numba.njit, nogil=True)

    def _jit(self, njit: Callable[..., Any], **options: bool) -> Callable[P, R]:
        inner = "no_cpython_wrapper" in options
        linked = self._linked(njit, "-inner" if inner else "")
        try:
            return cast(Callable[P, R], njit(cache=True, **options)(linked))
        except RuntimeError:  # no folder that a cache could be written to
            return cast(Callable[P, R], njit(**options)(linked))

    def _linked(self, njit: Callable[..., Any], suffix: str) -> types.FunctionType:
        """The source, with the kernels that it calls replaced by their compiled forms."""
        function = cast(types.FunctionType, self.plain)
        scope = dict(function.__globals__)
        for name, kernel in self._called():
            if kernel._inner is None:
                inner = kernel._jit(njit, no_cpython_wrapper=True, no_cfunc_wrapper=True)
                kernel._inner = _for_any_number(inner)
            scope[name] = kernel._inner
        linked = types.FunctionType(function.__code__, scope, function.__name__)
        linked.__defaults__, linked.__module__ = function.__defaults__, function.__module__
        # The cache has an entry for each qualified name, and looks at this file's date alone.
        linked.__qualname__ = function.__qualname__ + suffix + self._state_of_other_files()
        return linked

    def _called(self) -> list[tuple[str, Compiled[..., Any]]]:
        """Names and kernels that this one calls."""
        scope = cast(types.FunctionType, self.plain).__globals__
        found = [(name, scope.get(name)) for name in self._code.co_names]
        return [(name, kernel) for name, kernel in found if isinstance(kernel, Compiled)]

    def _files(self) -> set[str]:
        """Files of this kernel and of all that it calls, directly or not."""
        called = [kernel._files() for _, kernel in self._called()]
        return {self._code.co_filename}.union(*called)

    def _state_of_other_files(self) -> str:
        """Changes with every file but its own that this kernel is compiled from."""
        others = sorted(self._files() - {self._code.co_filename})
        sources = b"".join(Path(file).read_bytes() for file in others)
        return f"-{zlib.crc32(sources):08x}" if others else ""


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
