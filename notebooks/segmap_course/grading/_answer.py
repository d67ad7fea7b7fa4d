"""One answer, in the child that is locked in: the imports of the chapter, the cell, the cases."""

from __future__ import annotations

from typing import Any

from ._withhold import withhold

#: As much is kept of what an exception says.
MOST_WORDS = 300


def answer(job: dict[str, Any], cases: Any) -> dict[str, Any]:
    """What a student's cell answers, as plain values: `answers`, or a `fault` with its `text`.

    Parameters
    ----------
    job : dict
        `imports`, `cell`: sources; `task`: a name in `course.EXERCISES` or `OPEN_EXERCISES`;
        `names`: those that the cell must define; `given`: what the check is called with. Or
        `task` and `judge`, the answers to an open exercise: then no code of a student runs, and
        `passed` and `hint` are found.
    cases : mapping from words to a tuple of arguments
    """
    import segmap_course as course

    # Whatever the cell does to the package afterwards, this is what was there before.
    exercise: Any = {**course.EXERCISES, **course.OPEN_EXERCISES}[job["task"]]
    if "judge" in job:
        check = exercise.verdict(job["judge"])
        return {"passed": check.passed, "hint": check.hint}
    space: dict[str, Any] = {"__name__": "__main__"}
    exec(job["imports"], space)
    if job["task"] in course.EXERCISES:
        withhold(exercise)
    if fault := defined(job["cell"], space) or missing(job["names"], space):
        return fault
    try:
        given = eval(job["given"], space)
        if job["task"] in course.EXERCISES and not callable(given):
            return {"fault": "missing", "text": f"{job['given']} is no function"}
        return {"answers": exercise.answers(given, cases)}
    except MemoryError:
        return {"fault": "memory", "text": ""}
    except BaseException as error:  # an interrupt, which is no Exception
        return {"fault": "raised", "text": f"{type(error).__name__}: {_words(error)}"}


def missing(names: list[str], space: dict[str, Any]) -> dict[str, str] | None:
    """Names that a cell should have defined, and did not."""
    lost = ", ".join(name for name in names if name not in space)
    return {"fault": "missing", "text": f"the cell does not define {lost}"} if lost else None


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
