"""A function that a user chose, with its thresholds, as code and as words."""

from __future__ import annotations

import inspect
import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

from segmap import reduction
from segmap.arrays import Declared, declared


@dataclass(frozen=True)
class Call:
    """A function of some data by its name, with the thresholds that are not its defaults."""

    name: str
    function: Callable[..., Any]
    thresholds: Mapping[str, Any] = field(default_factory=dict)

    def run(self, data: Any) -> Any:
        """Call it."""
        return self.function(data, **self.thresholds)

    def arguments(self) -> str:
        """The thresholds as Python writes them, each behind a comma; angles by their degrees."""
        rules, written = declared(self.function), ""
        for name, value in self.thresholds.items():
            text = shortest(value) if isinstance(value, float) else repr(value)
            if isinstance(value, float) and rules[name].read_unit != rules[name].unit:
                read = as_read(rules[name], value)
                exact = rules[name].meant(read) == value
                text = f"np.radians({shortest(read)})" if exact else repr(float(value))
            written += f", {name}={text}"
        return written

    def words(self) -> str:
        """The thresholds as a person reads them."""
        return self.arguments().removeprefix(", ").replace("=", " ").replace("np.", "")


def defaults(function: Callable[..., Any]) -> dict[str, Any]:
    """What is taken of each argument where nobody says anything: of the usual reduction, its own.

    Examples
    --------
    >>> defaults(reduction.least_cost)["penalty"]
    1.0
    """
    usual = getattr(reduction, reduction.USUAL_METHOD) is function
    own = {name: each.default for name, each in inspect.signature(function).parameters.items()}
    return own | (reduction.USUAL_THRESHOLDS if usual else {})


def as_read(said: Declared, value: Any) -> Any:
    """A threshold as people read it; without the digits that a conversion adds, if it is one."""
    if not isinstance(value, float):
        return value
    read = said.read(value)
    brief = float(f"{read:.6g}")
    return brief if said.meant(brief) == value else read


def shortest(value: float) -> str:
    """A number as short as it can be written without becoming another one."""
    brief = f"{value:.6g}"
    return brief if float(brief) == value else repr(float(value))


def keywords(options: Mapping[str, Any]) -> dict[str, Any]:
    """The keywords of `alignment.prepared` for options of `segmap map`, as a session keeps them.

    Examples
    --------
    >>> keywords({"no_deskew": True, "mount": [0.2, 0.0, 180.0]})
    {'deskew': False, 'mount': (0.2, 0.0, 3.141592653589793)}
    """
    keywords: dict[str, Any] = {"deskew": False} if options.get("no_deskew") else {}
    keywords |= {name: True for name in ("keep_body", "clockwise") if options.get(name)}
    if options.get("mask"):
        keywords["mask"] = directions(options["mask"])
    if options.get("mount_auto"):
        keywords["mount"] = "auto"
    elif "mount" in options:
        x, y, degrees = options["mount"]
        keywords["mount"] = (float(x), float(y), math.radians(degrees))
    return keywords


def directions(words: Iterable[str]) -> tuple[tuple[float, float], ...]:
    """The directions FROM:TO that words like "-170:-150,150:170" name in degrees, in radians.

    Raises
    ------
    ValueError
        Where they name none.

    Examples
    --------
    >>> directions(["0:180"])
    ((0.0, 3.141592653589793),)
    """
    intervals = []
    for text in ",".join(words).split(","):
        try:
            begin, end = map(float, text.split(":"))
        except ValueError:
            begin = end = math.nan
        if not (max(abs(begin), abs(end)) <= 360 and (end - begin) % 360):
            raise ValueError(f"a mask must be FROM:TO in degrees, like -170:-150, got {text!r}")
        intervals.append((math.radians(begin), math.radians(end)))
    return tuple(intervals)


def source_of(room: Any, name: str, call: Call, data: str) -> str:
    """A call of a method, by its own name where the room exports it, else out of METHODS."""
    own = getattr(room, call.name, None) is call.function
    path = f"segmap.{name}.{call.name}" if own else f"segmap.{name}.METHODS[{call.name!r}]"
    return f"{path}({data}{call.arguments()})"


def option_words(held: tuple[str, Any]) -> str:
    """An option that a session keeps, as words."""
    name, value = held
    return name if value is True else f"{name} {value}"


def with_imports(body: str) -> str:
    """Python code behind the imports that it needs.

    Examples
    --------
    >>> print(with_imports('log = segmap.load("room")'), end="")
    import segmap
    <BLANKLINE>
    log = segmap.load("room")
    """
    numpy = "import numpy as np\n\n" if "np." in body else ""
    app = "import segmap_app.files\n" if "segmap_app." in body else ""
    return f"{numpy}import segmap\n{app}\n{body}\n"
