"""From a folder of submissions to a table of points, and a page of feedback for each student.

No code of a student runs in this process: it runs in a jail, which sends back values, and here they
are compared with what the library answers here.
"""

from __future__ import annotations

import ast
import hashlib
import json
import re
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import suppress
from pathlib import Path
from typing import Any, NamedTuple, TypeVar

from .._cells import apart, bound_names, free_names, imports_of
from ..exercises import NOT_GIVEN, Exercise, Raised
from ._jail import Ended, Jail, Limits, answers
from ._report import Outcome, Row
from ._submissions import Submission, is_stub, submission, submissions
from .handout import CHECKS, KIND, Task, chapters, package, read_chapter, tasks_of

#: Answers that run at the same time.
WORKERS = 2
#: A cell with more characters is no answer.
MOST_CHARACTERS = 200_000
#: What is said of an answer that may lack what another cell has.
LOST = re.compile(r"\bNameError: name '\w+' is not defined|it raises an exception")
#: What a jail has to know of an answer; or what became of it without.
Job = dict[str, Any] | Outcome
Found = TypeVar("Found")


class Plan(NamedTuple):
    """What is graded: the tasks, the seed of the hidden cases where there is one, and how.

    `partial` is the share of the points for an answer that is right on all cases that students see,
    and wrong on a hidden one.
    """

    tasks: list[Task]
    seed: int | None = None
    partial: float = 0.0


def read_key(path: Path) -> Plan:
    """The plan of a handout, from the instructor's file.

    Raises
    ------
    ValueError
        For a file that `handout` did not write.
    """
    try:
        held = json.loads(path.read_text(encoding="utf-8"))
        tasks = [Task(**task) for task in held["tasks"]]
        kind, seed = held["format"], held["seed"]
    except (ValueError, KeyError, TypeError) as error:
        raise ValueError(f"{path} is no instructor's file of a handout ({error})") from None
    if kind != KIND:
        raise ValueError(f"{path} is written as {kind!r}, this version reads {KIND!r}")
    return Plan([task._replace(answers=tuple(task.answers)) for task in tasks], seed)


def plan_of(wanted: str, seed: int | None) -> Plan:
    """The plan of chapters by their numbers; of all of them by default."""
    found = [
        task
        for path in chapters(wanted).values()
        for task in tasks_of(path.name, read_chapter(path))
    ]
    return Plan(found, seed)


def graded(
    folder: Path,
    plan: Plan,
    *,
    limits: Limits = Limits(),
    unprotected: bool = False,
    journal: Path | None = None,
    alone: bool = False,
) -> Iterator[Row]:
    """Grade the submissions of a folder, one student after the other.

    The limits are those of each answer. `unprotected` runs them where this system has no jail. What
    fails at one answer is the outcome of that answer. The journal, a file, holds what was found for
    each student until all are graded: where grading stopped before, it goes on from there. `alone`
    says that the folder is that of one student.

    Raises
    ------
    ValueError
        Without submissions, tasks or, unless `unprotected`, a jail.
    """
    handed = [submission(folder)] if alone else submissions(folder)
    if not plan.tasks:
        raise ValueError("the chapters that are graded ask for no answer")
    with Jail(limits, unprotected=unprotected) as jail, ThreadPoolExecutor(WORKERS) as workers:
        asked = [task for task in plan.tasks if not task.by_hand]
        known = {name.removeprefix("check_"): exercise for name, exercise in CHECKS.items()}
        exercises = {task.name: known[task.name] for task in asked}
        hidden = {name: _hidden(exercise, plan.seed) for name, exercise in exercises.items()}
        # Here, since the parser of Python 3.11 now and then ends in a SystemError in a thread.
        done, keys = _journal(journal), [_key(each, plan, limits, str(jail)) for each in handed]
        jobs = [
            {task.name: kept(job, each, task, exercises[task.name]) for task in asked}
            if key not in done
            else {}
            for each, key in zip(handed, keys, strict=True)
        ]

        def ran(jobs: dict[str, Job]) -> dict[str, Outcome | list[Any]]:
            return {
                name: kept(run, job, exercises[name], hidden[name], jail)
                for name, job in jobs.items()
            }

        for each, key, found in zip(handed, keys, workers.map(ran, jobs), strict=True):
            outcomes = done.get(key) or {
                name: got
                if isinstance(got, Outcome)
                else kept(judged, exercises[name], got, hidden[name], plan.partial)
                for name, got in found.items()
            }
            outcomes |= {t.name: kept(named, each, t, outcomes[t.name]) for t in asked}
            yield Row(each, outcomes, str(jail))
            if journal and key not in done:
                with journal.open("a", encoding="utf-8") as file:
                    file.write(json.dumps([key, outcomes]) + "\n")
    if journal:
        journal.unlink(missing_ok=True)


def kept(step: Callable[..., Found], *given: Any) -> Found | Outcome:
    """What a step finds for one answer; whatever fails there is the outcome of this answer."""
    try:
        return step(*given)
    except Exception as error:  # not its text, which may hold a hidden case
        said = f"the grader failed at it ({type(error).__name__}): a person has to look at it"
        return Outcome("not graded", said)


def _key(handed: Submission, plan: Plan, limits: Limits, jail: str) -> str:
    """Another for whatever may change the outcomes of a student."""
    return hashlib.sha256(repr((handed, plan, limits, jail)).encode("utf-8", "replace")).hexdigest()


def _journal(path: Path | None) -> dict[str, dict[str, Outcome]]:
    """The outcomes of a grading that stopped, by the keys of the students; the last may be cut."""
    found = {}
    if path and path.exists():
        for line in path.read_text(encoding="utf-8", errors="replace").splitlines():
            with suppress(ValueError, TypeError, AttributeError):
                key, outcomes = json.loads(line)
                found[key] = {name: Outcome(*outcome) for name, outcome in outcomes.items()}
    return found


def _hidden(exercise: Any, seed: int | None) -> list[tuple[Any, ...]]:
    return [] if seed is None else list(exercise.hidden(seed).values())


def job(handed: Submission, task: Task, exercise: Any) -> Job:
    """What a jail has to know of a student's answer to a task; or why there is none."""
    cell, _ = handed.find(task)
    if cell is None and handed.problems:
        return Outcome("unreadable", "; ".join(handed.problems))
    if cell is None:
        return Outcome("missing", f"no cell defines {' and '.join(task.answers)}")
    if len(cell) > MOST_CHARACTERS:
        return Outcome("too much", f"the cell has {len(cell)} characters")
    if is_stub(cell, task):
        return Outcome("empty", "nothing is written into its cell")
    given = package(exercise) if isinstance(exercise, Exercise) else None
    own = [ast.unparse(node) for text in handed.beside(cell) for node in imports_of(text)]
    imports = needed("\n".join([task.imports, *own]), cell)
    return {
        **{"imports": imports, "cell": cell, "names": task.answers},
        **{"given": task.given, "package": given},
    }


def run(
    job: Job, exercise: Any, hidden: Sequence[tuple[Any, ...]], jail: Jail
) -> Outcome | list[Any]:
    """What a student answers to a task, case by case, the open ones first; or why there is none."""
    if isinstance(job, Outcome):
        return job
    cases = [*exercise.cases.values(), *hidden] if isinstance(exercise, Exercise) else [()]
    try:
        return answers(jail, job, cases)
    except Ended as error:
        return Outcome(*error.args)


def needed(imports: str, cell: str) -> str:
    """Of the imports of a chapter those whose names a cell uses: matplotlib alone takes a second.

    Examples
    --------
    >>> needed("import numpy as np\\nfrom math import cos, sin", "np.cos(0) + cos(0)")
    'import numpy as np\\nfrom math import cos'
    """
    kept = []
    for node in ast.parse(imports).body:
        assert isinstance(node, ast.Import | ast.ImportFrom)
        bound = [(alias, (alias.asname or alias.name).partition(".")[0]) for alias in node.names]
        node.names = [
            alias
            for alias, name in bound
            if name == "*" or re.search(rf"\b{re.escape(name)}\b", cell)
        ]
        kept += [ast.unparse(node)] if node.names else []
    return "\n".join(kept)


# ------------------------------------------------------------------------------ the verdict
def judged(
    exercise: Any, found: list[Any], hidden: Sequence[tuple[Any, ...]], partial: float = 0.0
) -> Outcome:
    """Judge what came back. Of a hidden case no more is told than the kind of the mistake."""
    nothing = all(value is None for value in found)
    if not isinstance(exercise, Exercise):
        check = exercise.verdict(exercise.answers(*found))
        kind = "right" if check else "empty" if nothing else "wrong"
        return Outcome(kind, check.hint, float(check.passed))
    if any(isinstance(value, Raised) and value.name == "MemoryError" for value in found):
        return Outcome("memory", "it asks for more memory than an answer may have")
    # Numbers, since the words of a case may tell what it is.
    numbered = enumerate([*exercise.cases.values(), *hidden])
    hint = exercise.mistake(found, {str(number): case for number, case in numbered})
    if hint == "":
        return Outcome("right", "", 1.0)
    shown = exercise.verdict(found[: len(exercise.cases)])  # answered before a hidden one came in
    if not shown:
        kind = "library" if NOT_GIVEN in shown.hint else "empty" if nothing else "wrong"
        return Outcome(kind, hint or shown.hint, cases=exercise.told(found[: len(exercise.cases)]))
    fails = any(isinstance(value, Raised) for value in found)
    said = "it raises an exception" if fails else "it gives another answer"
    return Outcome("wrong", hint or f"right on the cases shown; on a hidden one {said}", partial)


def named(handed: Submission, task: Task, found: Outcome) -> Outcome:
    """An outcome; where an answer lacks what another cell has, that is its reason."""
    if found.right or not LOST.search(found.reason):
        return found
    cell, _ = handed.find(task)
    others = [bound_names(text) for text in handed.beside(cell or "")]
    needed = {name for name in free_names(cell or "") if any(name in names for names in others)}
    return found._replace(kind="other cell", reason=apart(needed)) if needed else found
