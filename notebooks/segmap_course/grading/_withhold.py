"""Take the library's answer out of a process, before a student's code runs there.

A check that notices the library's answer can be changed by the code that runs beside it; an answer
that is not there cannot be called. (Its source can still be read and copied, as from a book.)
"""

from __future__ import annotations

import gc
from types import CodeType, FunctionType
from typing import Any, NoReturn

from segmap.compiled import Compiled

from ..exercises import Watch

GONE = "this is the library's; write your own"


def withhold(exercise: Any) -> None:
    """Let every function that is part of the library's answer raise; there is no way back."""
    watch = Watch(exercise.own, exercise.solution)
    for found in gc.get_objects():
        plain = found.plain if isinstance(found, Compiled) else found
        if isinstance(plain, FunctionType) and watch.covers(plain.__code__):
            if isinstance(found, Compiled):
                found._fast = found._inner = _gone
            else:
                found.__code__ = _emptied(found.__code__)


def _gone(*_: Any, **__: Any) -> NoReturn:
    raise RuntimeError(GONE)


def _emptied(code: CodeType) -> CodeType:
    """Code that raises, with the name and the place of another, so that its call is noticed."""
    held = "".join(f"    {name} = None\n" for name in code.co_freevars)
    used = ", ".join(code.co_freevars)
    space: dict[str, Any] = {}
    source = (
        f"def outer():\n{held}    def inner(*_, **__):\n        ({used})\n"
        f"        raise RuntimeError({GONE!r})\n    return inner\n"
    )
    exec(source, space)
    empty: CodeType = space["outer"]().__code__
    return empty.replace(
        co_filename=code.co_filename, co_name=code.co_name, co_qualname=code.co_qualname
    )
