"""One answer, in the child that is locked in: the imports of the chapter, the cell, the cases.

The library's answer is taken out of the process first.
"""

from __future__ import annotations

import gc
from types import CodeType, FunctionType
from typing import Any, NoReturn

from segmap.compiled import Compiled

from .. import EXERCISES, OPEN_EXERCISES
from ..exercises import Watch, words


def answer(job: dict[str, Any], cases: Any) -> dict[str, Any]:
    """What a student's cell answers, as plain values: `answers`, or a `fault` with its `text`.

    A job has `imports` and `cell`: sources; `task`: a name in `course.EXERCISES` or
    `OPEN_EXERCISES`; `names`: those that the cell must define; `given`: what the check is called
    with. Or `task` and `judge`, the answers to an open exercise: then no code of a student runs,
    and `passed` and `hint` are found.
    """
    # Whatever the cell does to the package afterwards, this is what was there before.
    exercise: Any = {**EXERCISES, **OPEN_EXERCISES}[job["task"]]
    wants_function = job["task"] in EXERCISES
    if "judge" in job:
        check = exercise.verdict(job["judge"])
        return {"passed": check.passed, "hint": check.hint}
    space: dict[str, Any] = {"__name__": "__main__"}
    exec(job["imports"], space)
    if wants_function:
        withhold(exercise)
    if fault := defined(job["cell"], space):
        return fault
    if lost := ", ".join(name for name in job["names"] if name not in space):
        return {"fault": "missing", "text": f"the cell does not define {lost}"}
    try:
        given = eval(job["given"], space)
        if wants_function and not callable(given):
            return {"fault": "missing", "text": f"{job['given']} is no function"}
        return {"answers": exercise.answers(given, cases)}
    except BaseException as error:  # an interrupt, which is no Exception
        return _raised(error)


def defined(cell: str, space: dict[str, Any]) -> dict[str, str] | None:
    """Run a cell; what went wrong, or None."""
    try:
        code = compile(cell, "<your cell>", "exec")
    except (SyntaxError, ValueError) as error:
        return {"fault": "syntax", "text": _syntax(error)}
    try:
        exec(code, space)
    except BaseException as error:
        return _raised(error)
    return None


def _raised(error: BaseException) -> dict[str, str]:
    """The fault of a cell that raises this."""
    if isinstance(error, MemoryError):
        return {"fault": "memory", "text": ""}
    return {"fault": "raised", "text": f"{type(error).__name__}: {words(error)}"}


def _syntax(error: Exception) -> str:
    if not isinstance(error, SyntaxError):
        return str(error)
    line = (error.text or "").strip()
    magic = "; commands of Jupyter (%, !) are not Python" if line[:1] in ("%", "!") else ""
    return f"line {error.lineno}: {error.msg}{magic}"


# ------------------------------------------------------------------ the library's answer
GONE = "this is the library's; write your own"


def withhold(exercise: Any) -> None:
    """Let every function that is part of the library's answer raise; there is no way back.

    A check that notices the library's answer can be changed by the code that runs beside it; an
    answer that is not there cannot be called. (Its source can still be read, as from a book.)
    """
    watch = Watch(exercise.own, exercise.solution)
    for found in gc.get_objects():
        # Its type, not isinstance: a weak reference to what is gone answers to no question.
        plain = found.plain if type(found) is Compiled else found
        if type(plain) is FunctionType and watch.covers(plain.__code__):
            if type(found) is Compiled:
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
