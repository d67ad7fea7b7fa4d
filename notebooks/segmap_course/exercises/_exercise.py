"""Exercises: a student's function is compared with the library's; each known mistake has a hint."""

from __future__ import annotations

import ast
import html
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from inspect import getsource, ismodule, unwrap
from pathlib import Path
from textwrap import dedent
from typing import Any, cast

import numpy as np

from segmap.arrays import Array
from segmap.files import write_bytes
from segmap.plotting import ERROR, TRUTH

from ._answers import (
    Cases,
    Raised,
    agree,
    answered,
    close,
    common_mistake,
    first_difference,
    numbers,
    text,
)

Rng = np.random.Generator
#: Cases are drawn again until each mistake is told by its own hint, at most so many times.
MOST_DRAWS = 100
#: Hidden cases are drawn so often: what one draw of three shows, then passes one time in seven.
DRAWS = 5
#: Arguments are shown where they take no more characters.
MOST_SHOWN = 90
#: `segmap notebooks FOLDER` puts it beside the chapters; where it is not, nothing is kept.
MY_MAPPER = "my_mapper.py"

#: What is told where the answer is not what was to be handed in.
NO_ANSWER = "there is no answer: write it in a cell of code above this one, and run that cell"
NOTHING_YET = "it returns nothing yet: write all of it in one cell, above this check"
MOVE_IMPORT = "write what defines or imports it into the cell of your function"


@dataclass(frozen=True)
class Check:
    """What a check found: true or false, with a hint, or with what is true.

    Examples
    --------
    >>> Check("compose", False, "turn before you move"), bool(Check("compose", True))
    (not yet: turn before you move, True)
    """

    exercise: str
    passed: bool
    hint: str = ""

    def __bool__(self) -> bool:
        return self.passed

    def __repr__(self) -> str:
        state = "passed" if self.passed else "not yet"
        return f"{state}: {self.hint}" if self.hint else state

    def _repr_html_(self) -> str:
        color, sign = (TRUTH, "&#10003;") if self.passed else (ERROR, "&#10007;")
        style = f"border-left: 4px solid {color}; padding: 4px 10px"
        return f'<div style="{style}">{sign} {html.escape(repr(self))}</div>'


@dataclass(frozen=True, repr=False, eq=False)
class Exercise:
    """A function to be written again. Call it with yours: it answers with a `Check`, never raises.

    Examples
    --------
    >>> double = Exercise("double(x) -> 2 x", lambda x: 2 * x, lambda rng: {"a number": (3,)},
    ...                   {"twice, not to the power of two": lambda x: x * x})
    >>> double(lambda x: x + x), double(lambda x: x**2)
    (passed, not yet: twice, not to the power of two)
    >>> double(lambda x: x), double(lambda x: x + 2.5)
    (not yet: this is half of the answer, not yet: for a number expected 6, got 5.5 from double(3))
    """

    #: The signature, which begins with the name, and what is returned, with shapes and units.
    task: str
    #: The library's function.
    solution: Callable[..., Any]
    #: One case of each kind that catches a mistake. What students see is drawn by it too, from a
    #: seed of our own.
    draw: Callable[[Rng], Cases]
    #: What to tell students -> the wrong function that they write.
    mistakes: Mapping[str, Callable[..., Any]]
    #: Whether an answer is the expected one.
    same: Callable[[Any, Any], bool] = close

    @property
    def name(self) -> str:
        """The name of the function that is to be written."""
        return self.task.partition("(")[0]

    @cached_property
    def cases(self) -> dict[str, tuple[Any, ...]]:
        """The cases that students see, words -> arguments."""
        return self._drawn(np.random.default_rng(np.random.SeedSequence(0, spawn_key=(0,))))

    def fresh(self, seed: int | tuple[int, ...]) -> dict[str, tuple[Any, ...]]:
        """Hidden cases: the same seed gives the same ones, in any process, and never those shown.

        Raises
        ------
        ValueError
            Where no draw tells each mistake by its own hint.
        """
        return self._drawn(np.random.default_rng(seed))

    def hidden(self, seed: int) -> dict[str, tuple[Any, ...]]:
        """All hidden cases of a seed; numbered, since the words of a case may tell what it is."""
        draws = [self.fresh((seed, draw)) for draw in range(DRAWS)]
        return listed([case for cases in draws for case in cases.values()])

    def _drawn(self, rng: Rng) -> dict[str, tuple[Any, ...]]:
        for _ in range(MOST_DRAWS):
            cases = dict(self.draw(rng))
            wrong = {hint: answered(f, cases) for hint, f in self._known().items()}
            first = {
                hint: next((other for other, a in wrong.items() if self._agree(answers, a)), None)
                for hint, answers in wrong.items()
            }
            alike = [hint for hint in wrong if first[hint] != hint]
            if not alike:
                return cases
        raise ValueError(f"{self.name}: no draw tells {alike} from the library and from each other")

    def __repr__(self) -> str:
        return f"check_{self.name}(your function): {self.task}"

    def __call__(self, function: Callable[..., Any], cases: Cases | None = None) -> Check:
        """Check a student's function on these cases, by default the open ones. Raises nothing.

        A handout sets the name of the answer to `...` above its cell: it stays so where that cell
        was not run, or is a text.
        """
        if not callable(function):
            advice = f"give the function itself, check_{self.name}(my_{self.name}), without a call"
            return Check(self.name, False, NO_ANSWER if function is ... else advice)
        if unwrap(function) is unwrap(self.solution):
            return Check(self.name, False, "this is the library's; write your own")
        asked = self.cases if cases is None else cases
        answers = answered(function, asked)
        hint = self._mistake(answers, asked)
        hint = self._difference(answers, asked) if hint is None else hint
        if not hint and cases is None:
            return Check(self.name, True, keep(function, self.name))
        return Check(self.name, not hint, hint)

    def _mistake(self, found: Sequence[Any], cases: Cases) -> str | None:
        """The hint of the mistake that gives these answers; empty where they are right, or None."""
        if found and all(answer is None for answer in found):
            return f"{NOTHING_YET}; the task is {self.task}"
        for hint, function in self._known().items():
            if self._agree(found, answered(function, cases)):
                return hint
        if unknown := unknown_name(found):
            return f"it uses {unknown}, which no cell above knows: {MOVE_IMPORT}"
        return common_mistake(found, cases, self.solution, self.same) or None

    def _difference(self, found: Sequence[Any], cases: Cases) -> str:
        """The first case that has another answer, in full."""
        pairs = zip(cases, found, answered(self.solution, cases), strict=True)
        words, got, right = next(pair for pair in pairs if not agree(*pair[1:], self.same))
        hint = f"but it raised {text(got)}" if isinstance(got, Raised) else f"got {text(got)}"
        if text(got) == text(right):
            hint += f", which is off by {np.abs(np.subtract(got, right, dtype=float)).max():.1g}"
        hint += first_difference(got, right, cases[words])
        return f"for {words} expected {text(right)}, {hint}{self._call(cases[words])}"

    def _call(self, given: Sequence[Any]) -> str:
        """The call with these arguments, where they are few numbers."""
        shown = f" from {self.name}({', '.join(map(text, given))})"
        whole = all(numbers(argument) is not None for argument in given)
        short = len(shown) <= MOST_SHOWN and "that starts" not in shown
        return shown if whole and short else ""

    def _known(self) -> dict[str, Callable[..., Any]]:
        """Hint -> the wrong function; the library's has none."""
        return {"": self.solution, **self.mistakes}

    def _agree(self, found: Sequence[Any], expected: Sequence[Any]) -> bool:
        return all(agree(*pair, self.same) for pair in zip(found, expected, strict=True))


def unknown_name(found: Sequence[Any]) -> str:
    """The name that a function misses in all cases; empty where it misses none.

    Examples
    --------
    >>> unknown_name([Raised("NameError", "name 'np' is not defined")])
    'np'
    """
    missed = {
        answer.words.split("'")[1]
        for answer in found
        if isinstance(answer, Raised) and answer.name == "NameError" and "'" in answer.words
    }
    raised = all(isinstance(answer, Raised) for answer in found)
    return missed.pop() if raised and len(missed) == 1 else ""


# --------------------------------------------------------------- for draws and mistakes
def changed(function: Callable[..., Any], change: Callable[[Any], Any]) -> Callable[..., Any]:
    """A function whose answer is changed: a mistake at the end."""
    return lambda *given: change(function(*given))


def edited(function: Callable[..., Any], *changes: tuple[str, str]) -> Callable[..., Any]:
    """A plain version with parts of its source changed: a mistake in the middle.

    Raises
    ------
    ValueError
        When it is called, where the source does not hold what is to be changed.
    """

    @cache
    def wrong() -> Callable[..., Any]:
        source = getsource(function)
        for part, other in changes:
            if part not in source:
                raise ValueError(f"{function.__name__} must hold {part!r}")
            source = source.replace(part, other)
        scope = dict(function.__globals__)
        exec(f"from __future__ import annotations\n{source}", scope)  # our own source
        return cast(Callable[..., Any], scope[function.__name__])

    return lambda *given: wrong()(*given)


def listed(cases: Sequence[tuple[Any, ...]]) -> dict[str, tuple[Any, ...]]:
    """Cases that say by their arguments what they are."""
    return {f"case {number}": case for number, case in enumerate(cases, 1)}


def anywhere(rng: Rng, low: float = -180.0, high: float = 180.0) -> Array:
    """A pose within 5 m, with a heading between these degrees."""
    return np.append(rng.uniform(-5, 5, 2), np.radians(rng.uniform(low, high)))


# -------------------------------------------------------------- what is kept for the last chapter
def keep(function: Callable[..., Any], name: str) -> str:
    """Add a function to `my_mapper.py` of this folder under a name; words on what was done.

    What it uses comes with it: imports, numbers and other functions of the notebook. One that is
    there already is not changed: the last one counts. The words are empty where the file is not
    there, or holds the same already.

    Examples
    --------
    >>> keep(max, "largest")
    ''
    """
    path = Path(MY_MAPPER)
    if not path.is_file():
        return ""
    try:
        source = source_with_imports(function)
    except (OSError, TypeError, ValueError) as error:
        return f"not kept in {MY_MAPPER}: {error}"
    if function.__name__ != name:
        source += f"\n{name} = {function.__name__}\n"
    before = path.read_text("utf-8")
    if before.endswith(source):
        return ""
    write_bytes(path, f"{before}\n\n{source}".encode())
    if f"\n{name} = " in before or f"\ndef {name}(" in before:
        return f"kept in {MY_MAPPER}, below the one of before, which no longer counts"
    return f"kept in {MY_MAPPER}"


def source_with_imports(function: Callable[..., Any]) -> str:
    """The source of a function behind that of what it uses, which runs alone.

    Raises
    ------
    ValueError
        Where it is a lambda, or uses a variable of the notebook that is neither a number, a text, a
        function nor a module.
    """
    if function.__name__ == "<lambda>":
        raise ValueError("a lambda has no name; write it with def")
    source = dedent(getsource(function))
    nodes = list(ast.walk(ast.parse(source)))
    own = {node.arg for node in nodes if isinstance(node, ast.arg)} | {function.__name__}
    names = [node for node in nodes if isinstance(node, ast.Name)]
    own |= {name.id for name in names if isinstance(name.ctx, ast.Store)}
    used = sorted({name.id for name in names} - own)
    scope = function.__globals__
    return "\n".join([*(_line(name, scope[name]) for name in used if name in scope), "", source])


def _line(name: str, value: Any) -> str:
    """The line, or lines, that make a name mean a value."""
    if ismodule(value):
        return f"import {value.__name__} as {name}"
    if isinstance(value, int | float | str):
        return f"{name} = {value!r}"
    module, own = getattr(value, "__module__", None), getattr(value, "__name__", None)
    if own is None or module is None:
        raise ValueError(f"it uses {name}, a variable of the notebook: give it as an argument")
    if module == "__main__":
        return source_with_imports(value)
    return f"from {module} import {own}" + f" as {name}" * (own != name)
