"""A student's function alone: values as plain data, and the loop that answers cases in a sandbox.

The grader stands outside. It sends a cell, then one case at a time, and gets back one value at a
time: numbers, texts, bytes, lists, tuples and arrays, as JSON. Nothing that comes back becomes
code, and no expected value goes in. The sandbox is given the text of this file, which needs only
numpy.
"""

from __future__ import annotations

import importlib
import json
import os
import sys
import warnings
from collections.abc import Callable
from dataclasses import astuple, dataclass
from importlib.machinery import ModuleSpec
from types import ModuleType
from typing import Any, NoReturn

import numpy as np

#: An answer with more numbers is no answer to an exercise: no file of a gigabyte from a student.
MOST_NUMBERS = 100_000
#: Lists in lists that are deeper are no answer: arrays have at most so many axes.
MOST_DEEP = 32
#: As many characters of the message of an exception are kept.
MOST_WORDS = 300
#: The types of numbers that arrive as what they were; all others arrive as float64.
KEPT = ("float64", "int64", "bool")
#: What an answer says that calls what is not given.
NOT_GIVEN = "is not given: write your own"


@dataclass(frozen=True)
class Raised:
    """In place of a value: the exception that was raised, by its name, and what it says."""

    name: str
    words: str


@dataclass(frozen=True)
class Other:
    """In place of a value that is none of the plain kinds: the name of its type."""

    name: str


Three = tuple[float, float, float]


@dataclass(frozen=True)
class Surface:
    """The value of a pose: so much for each metre or radian from a point, or away from it."""

    slope: Three
    point: Three = (0.0, 0.0, 0.0)
    away: tuple[bool, bool, bool] = (False, False, False)

    def __call__(self, pose: Any) -> float:
        """The score of a pose, an array or a tuple of three numbers."""
        off = np.subtract(pose, self.point)
        return float(np.where(self.away, np.abs(off), off) @ np.array(self.slope))


# --------------------------------------------------------------------------- values as data
def encode(value: Any, depth: int = 0) -> Any:
    """A value as JSON can hold it.

    Examples
    --------
    >>> encode((1, [2.0], b"x")), encode(np.eye(1))
    ({'tuple': [1, [2.0], {'bytes': '78'}]}, {'array': [[1, 1], 'float64', [1.0]]})
    """
    kind = type(value)
    if value is None or value is ... or kind in (bool, float, str):
        return None if value is ... else value
    if kind is int:
        return value if abs(value) < 2**63 else {"other": ["int"]}
    if kind is bytes:
        return {"bytes": value.hex()}
    if kind in (list, tuple) and depth >= MOST_DEEP:
        return {"other": [f"{kind.__name__} nested more than {MOST_DEEP} deep"]}
    if kind in (list, tuple) and len(value) <= MOST_NUMBERS:
        parts = [encode(part, depth + 1) for part in value]
        return parts if kind is list else {"tuple": parts}
    if kind in (Raised, Other):
        return {kind.__name__.lower(): list(astuple(value))}
    if kind is Surface:
        return {"surface": encode(list(astuple(value)))}
    try:
        array = np.asarray(value)
        array = array if array.dtype.name in KEPT else np.asarray(value, float)
    except Exception:  # an answer may be any object at all
        return {"other": [kind.__name__]}
    if array.size > MOST_NUMBERS:
        return {"other": [f"array of {array.size} numbers"]}
    name = "number" if isinstance(value, np.generic) else "array"
    return {name: [list(array.shape), array.dtype.name, array.ravel().tolist()]}


def decode(data: Any, depth: int = 0) -> Any:
    """The value that `encode` was given.

    Raises
    ------
    ValueError
        For data that it does not write.
    """
    if data is None or isinstance(data, bool | int | float | str):
        return data
    if depth > MOST_DEEP:
        raise ValueError(f"no value: nested more than {MOST_DEEP} deep")
    if isinstance(data, list):
        return [decode(part, depth + 1) for part in data]
    try:
        ((kind, held),) = data.items()
        if kind == "tuple":
            return tuple(decode(list(held), depth))
        if kind == "bytes":
            return bytes.fromhex(held)
        if kind == "raised":
            return Raised(*(str(word)[:MOST_WORDS] for word in held))
        if kind == "other":
            return Other(str(held[0])[:MOST_WORDS])
        if kind == "surface":
            slope, point, away = decode(held, depth)
            return Surface(tuple(slope), tuple(point), tuple(away))
        shape, name, numbers = held
        plain = {type(number) for number in numbers} <= {bool, int, float}
        if kind in ("array", "number") and name in KEPT and plain and len(numbers) <= MOST_NUMBERS:
            array = np.array(numbers, name).reshape([abs(size) for size in shape])
            return array[()] if kind == "number" else array
    except Exception as error:  # it may come from a process of a student
        raise ValueError(f"no value: {type(error).__name__}") from None
    raise ValueError("no value")


def raised(error: BaseException) -> Raised:
    """An exception by its name, and what it says, where that is text."""
    try:
        return Raised(type(error).__name__, str(error)[:MOST_WORDS])
    except Exception:  # its own text may fail too
        return Raised(type(error).__name__, "an error without a text")


def reply(function: Callable[..., Any], arguments: tuple[Any, ...]) -> Any:
    """What a function answers to a case, as data; the exception that it raises is an answer too."""
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore")
        try:
            return encode(function(*arguments))
        except (Exception, SystemExit) as error:
            return encode(raised(error))


# --------------------------------------------------------------------------- in the jail
class Room(ModuleType):
    """A module of segmap where the library is not: it has what is given, and all else refuses."""

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        return importlib.import_module(f"{self.__name__}.{name}")

    def __call__(self, *_: Any, **__: Any) -> NoReturn:
        """Refuse."""
        raise LookupError(f"{self.__name__} {NOT_GIVEN}")


class Rooms:
    """Finds every module of segmap, and puts into it what the task gives."""

    def __init__(self, source: str, given: dict[str, list[str]]) -> None:
        self.given, self.space = given, {"__name__": "given"}
        exec(source, self.space)

    def find_spec(self, name: str, *_: Any) -> ModuleSpec | None:
        """A place for whatever begins with the name of one of the packages."""
        ours = name.partition(".")[0] in ("segmap", "segmap_course")
        return ModuleSpec(name, self, is_package=True) if ours else None  # type: ignore[arg-type]

    def create_module(self, spec: ModuleSpec) -> ModuleType:
        """An empty room."""
        return Room(spec.name)

    def exec_module(self, module: ModuleType) -> None:
        """Put in what is given of this module."""
        names = self.given.get(module.__name__, [])
        vars(module).update({name: self.space[name] for name in names})


def cell(job: dict[str, Any], space: dict[str, Any]) -> tuple[str, str] | None:
    """Run the imports of a chapter and the cell of a student; what is wrong, by its kind, or None.

    A job has `imports` and `cell`: sources; `names`: those that the cell must define; `given`: what
    the check is called with; and `package`, the functions of the library, where that is not seen.
    """
    try:
        code = compile(job["cell"], "<your cell>", "exec")
    except SyntaxError as error:
        line = (error.text or "").strip()
        magic = "; commands of Jupyter (%, !) are not Python" if line[:1] in ("%", "!") else ""
        return "syntax", f"line {error.lineno}: {error.msg}{magic}"
    except ValueError as error:
        return "syntax", str(error)
    try:
        exec(job["imports"], space)
        exec(code, space)
    except BaseException as error:  # an interrupt, which is no Exception
        found = raised(error)
        return (
            ("memory", "")
            if isinstance(error, MemoryError)
            else ("raised", f"{found.name}: {found.words}")
        )
    if lost := ", ".join(name for name in job["names"] if name not in space):
        return "missing", f"the cell does not define {lost}"
    no_function = job["package"] and not callable(space[job["given"]])
    return ("missing", f"{job['given']} is no function") if no_function else None


def serve() -> None:
    """Answer a job, then its cases, a line of JSON each; what the cell prints goes nowhere."""
    back = os.fdopen(os.dup(1), "w")
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)

    def say(data: Any) -> None:
        back.write(json.dumps(data) + "\n")
        back.flush()

    job = json.loads(sys.stdin.readline())
    if job["package"]:
        sys.meta_path.insert(0, Rooms(*job["package"]))
    else:
        sys.path += job["paths"]
        _read_only_cache()
    space: dict[str, Any] = {"__name__": "__main__"}
    say(cell(job, space))
    # The answer to an open exercise is a value, and its one case has no arguments.
    given = job["given"]
    function: Any = space.get(given) if job["package"] else lambda: eval(given, space)
    for line in sys.stdin:
        try:
            say(reply(function, decode(json.loads(line))))
        except BaseException as error:
            say(encode(raised(error)))


def _read_only_cache() -> None:
    """Let numba read the machine code that lies beside the library, and write none."""
    try:
        from numba.core import caching
    except ImportError:
        return
    found: Any = caching
    found._CacheLocator.ensure_cache_path = found.Cache.save_overload = lambda *_: None


if __name__ == "__main__":
    serve()
