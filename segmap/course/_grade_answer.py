"""One answer, in the child that is locked in: the imports of the chapter, the cell, the cases."""

from __future__ import annotations

from typing import Any

#: As much is kept of what an exception says.
MOST_WORDS = 300


def answer(job: dict[str, Any], cases: Any) -> dict[str, Any]:
    """What a student's cell answers, as plain values: `answers`, or a `fault` with its `text`.

    Parameters
    ----------
    job : dict
        `imports`, `cell`: sources; `task`: a name in `course.EXERCISES`; `names`: those that the
        cell must define.
    cases : mapping from words to a tuple of arguments
    """
    from .. import course

    # Whatever the cell does to the package afterwards, this is what was there before.
    exercise = course.EXERCISES.get(job["task"])
    space: dict[str, Any] = {"__name__": "__main__"}
    exec(job["imports"], space)
    if fault := defined(job["cell"], space):
        return fault
    missing = [name for name in job["names"] if name not in space]
    if missing:
        return {"fault": "missing", "text": f"the cell does not define {', '.join(missing)}"}
    function = space[job["names"][0]]
    if not callable(function):
        return {"fault": "missing", "text": f"{job['names'][0]} is no function"}
    assert exercise is not None
    try:
        return {"answers": exercise.answers(function, cases)}
    except MemoryError:
        return {"fault": "memory", "text": ""}
    except BaseException as error:  # an interrupt, which is no Exception
        return {"fault": "raised", "text": f"{type(error).__name__}: {_words(error)}"}


def defined(cell: str, space: dict[str, Any]) -> dict[str, str] | None:
    """Run a cell; what went wrong, or None."""
    try:
        code = compile(cell, "<your cell>", "exec")
    except (SyntaxError, ValueError) as error:
        return {"fault": "syntax", "text": _syntax(error)}
    try:
        exec(code, space)
    except MemoryError:
        return {"fault": "memory", "text": ""}
    except BaseException as error:
        return {"fault": "raised", "text": f"{type(error).__name__}: {_words(error)}"}
    return None


def _syntax(error: Exception) -> str:
    if not isinstance(error, SyntaxError):
        return str(error)
    line = (error.text or "").strip()
    magic = "; commands of Jupyter (%, !) are not Python" if line[:1] in ("%", "!") else ""
    return f"line {error.lineno}: {error.msg}{magic}"


def _words(error: BaseException) -> str:
    try:
        return str(error)[:MOST_WORDS]
    except Exception:  # its own text may fail too
        return "an error without a text"
