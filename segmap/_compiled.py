"""Plain loops, compiled when first called.

Where a method is a loop by nature it is written as that loop and marked `@compiled`. numba is
imported at the first call, the machine code is kept on disk, and where numba is missing the same
source runs as plain Python: slower, with the same result.
"""

import os
import types
from collections.abc import Callable
from typing import Generic, ParamSpec, TypeVar, cast

P = ParamSpec("P")
R = TypeVar("R")

#: Set this environment variable to 1 to run every loop as plain Python.
PLAIN = "SEGMAP_PLAIN"


class Compiled(Generic[P, R]):
    """A function that becomes machine code at its first call; `.plain` is its source.

    Kernels may call other kernels. The cache on disk sees changes in the file of a kernel only: who
    changes one that another file calls deletes `__pycache__`. Never `fastmath`: it breaks
    `isfinite`.
    """

    def __init__(self, plain: Callable[P, R]) -> None:
        self.plain = plain
        self.__doc__ = plain.__doc__
        self._fast: Callable[P, R] | None = None

    def __call__(self, *args: P.args, **kwargs: P.kwargs) -> R:
        if self._fast is None:
            self._fast = self._build()
        return self._fast(*args, **kwargs)

    def _build(self) -> Callable[P, R]:
        if os.environ.get(PLAIN) == "1":
            return self.plain
        try:
            import numba
        except ImportError:
            return self.plain
        try:
            return cast(Callable[P, R], numba.njit(cache=True)(self._linked()))
        except RuntimeError:  # no folder that a cache could be written to
            return cast(Callable[P, R], numba.njit(self._linked()))

    def _linked(self) -> Callable[P, R]:
        """The source, with the kernels that it calls replaced by their compiled forms."""
        function = cast(types.FunctionType, self.plain)
        scope = dict(function.__globals__)
        for name in function.__code__.co_names:
            if isinstance(kernel := scope.get(name), Compiled):
                kernel._fast = kernel._fast or kernel._build()
                scope[name] = kernel._fast
        linked = types.FunctionType(function.__code__, scope, function.__name__)
        linked.__defaults__, linked.__qualname__ = function.__defaults__, function.__qualname__
        linked.__module__ = function.__module__
        return cast(Callable[P, R], linked)


def compiled(function: Callable[P, R]) -> Compiled[P, R]:
    """Mark a loop to be compiled at its first call."""
    return Compiled(function)
