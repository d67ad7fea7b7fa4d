"""Units and bounds of arguments, declared once: at the parameter, by its annotation.

`distance: Metres = 0.20` says all: `@checked` refuses what is no such length, a command makes an
option in metres of it, and a panel a slider. `Annotated[Radians, at_most(np.pi / 2)]` narrows it.
"""

from __future__ import annotations

import functools
import inspect
import math
import re
import sys
import typing
from collections.abc import Callable
from dataclasses import dataclass, fields, replace
from types import NoneType
from typing import Annotated, Any, Literal, ParamSpec, TypeVar, cast

import numpy as np

from ..progress import told
from . import unit_checks
from ._scalars import generator, number, one_of, switch, whole

P = ParamSpec("P")
R = TypeVar("R")


@dataclass(frozen=True)
class Quantity:
    """What a number is: its unit, its bounds, and from where on it looks like millimetres.

    That is above `usual`, and above this `share` of the map or the points that it is for. What is
    None says nothing: in `Annotated` a later one narrows those before it.
    """

    unit: str | None = None
    above: float | None = None
    least: float | None = None
    below: float | None = None
    most: float | None = None
    usual: float | None = None
    share: float | None = None

    def narrow(self, by: Quantity) -> Quantity:
        """With what another says: its lower bound in place of ours, its upper one likewise."""
        changes = {f.name: v for f in fields(by) if (v := getattr(by, f.name)) is not None}
        for pair in (("above", "least"), ("below", "most")):
            if any(bound in changes for bound in pair):
                changes = dict.fromkeys(pair) | changes
        return replace(self, **changes)


def at_least(least: float) -> Quantity:
    """A lower bound that is allowed itself."""
    return Quantity(least=least)


def at_most(most: float) -> Quantity:
    """An upper bound that is allowed itself; infinity is, where it is the bound."""
    return Quantity(most=most)


def upper_bound_excluded(bound: float) -> Quantity:
    """An upper bound that is not allowed itself."""
    return Quantity(below=bound)


Metres = Annotated[float, Quantity("metres", above=0, usual=unit_checks.MOST_MATCH_DISTANCE_M)]
Radians = Annotated[float, Quantity("radians", above=0, most=2 * math.pi)]
RadiansPerMetre = Annotated[float, Quantity("rad/m", above=0)]
Seconds = Annotated[float, Quantity("seconds", above=0)]
#: Of a whole, 0 to 1.
Share = Annotated[float, Quantity("", least=0, most=1)]
Positive = Annotated[float, Quantity("", above=0)]
#: Of things: a whole number.
Count = Annotated[int, Quantity("", least=1)]
#: Neighbours of a scan may be far apart, and infinity cuts nowhere.
Gap = Annotated[
    float, Quantity("metres", above=0, most=math.inf, usual=unit_checks.MOST_GAP_M, share=1)
]


class Declared(typing.NamedTuple):
    """What an annotation says of an argument.

    Parameters
    ----------
    kind : type
        float, int, bool, str (of `words`) or Generator; another type is left to the function.
    quantity : Quantity
    words : tuple of str
        All that may be said, for `Literal`.
    optional : bool
        Whether None may be given.
    """

    kind: Any
    quantity: Quantity
    words: tuple[str, ...]
    optional: bool

    @property
    def unit(self) -> str:
        """Its unit, nothing where it has none."""
        return self.quantity.unit or ""

    @property
    def read_unit(self) -> str:
        """The unit in which people read it: degrees for radians."""
        return self.unit.replace("radians", "degrees").replace("rad/m", "degrees/m")

    def read(self, value: float) -> float:
        """A value in the unit in which people read it."""
        return float(np.degrees(value)) if self._is_angle else value

    def meant(self, read: float) -> float:
        """The value, in the unit of the function, of one in the unit in which people read it."""
        return float(np.radians(read)) if self._is_angle else read

    def as_read(self) -> Declared:
        """The same of a value in the unit in which people read it, its bounds too."""
        q = self.quantity
        bounds = {name: getattr(q, name) for name in ("above", "least", "below", "most")}
        read = {name: None if v is None else self.read(v) for name, v in bounds.items()}
        unit = None if q.unit is None else self.read_unit
        return self._replace(quantity=replace(q, unit=unit, **read))

    @property
    def _is_angle(self) -> bool:
        return self.unit.startswith("rad")

    @property
    def is_limited(self) -> bool:
        """Whether `check` refuses anything."""
        has_check = self.words or self.kind in (bool, int, np.random.Generator)
        return bool(has_check) or (self.kind is float and self.quantity.unit is not None)

    def check(self, value: Any, name: str) -> Any:
        """The value as its kind, or a ValueError that names it."""
        if value is None and self.optional:
            return None
        if self.words:
            return one_of(value, name, self.words)
        if self.kind is bool:
            return switch(value, name)
        if self.kind is np.random.Generator:
            return generator(value, name)
        q = self.quantity
        if self.kind is int:
            bounds = {"most": int(q.most)} if q.most is not None else {}
            return whole(value, name, least=1 if q.least is None else int(q.least), **bounds)
        if self.kind is float and q.unit is not None:
            unit = f"{q.unit}, or None" if self.optional and q.unit else q.unit
            above, least, below, most = q.above, q.least, q.below, q.most
            return number(value, name, unit=unit, above=above, least=least, below=below, most=most)
        return value


def declared(of: Callable[..., Any]) -> dict[str, Declared]:
    """What the annotations of a function, or of the fields of a class, say of each by its name.

    Examples
    --------
    >>> class Fusion:
    ...     tolerance: Metres = 0.04
    >>> declared(Fusion)["tolerance"].unit
    'metres'
    """
    hints = typing.get_type_hints(inspect.unwrap(of), include_extras=True)
    return {name: _declared_by(hint) for name, hint in hints.items() if name != "return"}


def described(of: Callable[..., Any]) -> dict[str, str]:
    """What the docstring of a function says of each argument; the first line is under "".

    "As in `another`" is what that one says.

    Examples
    --------
    >>> from segmap.reduction import fusion_online
    >>> described(fusion_online)["tolerance"].partition(".")[0]
    'Half width of the strip'
    """
    text = inspect.getdoc(of) or ""
    sentences = {"": " ".join(text.partition("\n\n")[0].split())}
    section = re.search(
        r"^Parameters\n-+\n(.*?)(?:\n\n\w+\n-+\n|\Z)", text, re.DOTALL | re.MULTILINE
    )
    entries = re.findall(r"^(\S.*)((?:\n+    .*)*)", section[1] if section else "", re.MULTILINE)
    for names, words in entries:
        sentence = " ".join(words.split())
        other = re.fullmatch(r"As in `([\w.]+)`\.", sentence)
        for name in names.partition(" : ")[0].split(", "):
            sentences[name] = described(_find(of, other[1]))[name] if other else sentence
    return sentences


def _find(of: Callable[..., Any], path: str) -> Any:
    """What a docstring names, `alignment.match_values`: of its module, or of a room above."""
    home = of.__module__
    while home:
        target: Any = sys.modules[home]
        for part in path.split("."):
            target = getattr(target, part, None)
        if callable(target):
            return getattr(target, "function", target)
        home = home.rpartition(".")[0]
    raise LookupError(f"{of.__qualname__} names {path}, which is nowhere above {of.__module__}")


def _declared_by(hint: Any) -> Declared:
    """An annotation: `Metres`, `Metres | None`, `Literal["a", "b"]`, `Annotated[...]`, a class."""
    parts = [part for part in typing.get_args(hint) if part is not NoneType]
    optional = NoneType in typing.get_args(hint) and len(parts) == 1
    inner = parts[0] if optional else hint
    quantity = Quantity()
    for extra in getattr(inner, "__metadata__", ()):
        quantity = quantity.narrow(extra) if isinstance(extra, Quantity) else quantity
    kind = getattr(inner, "__origin__", inner)
    words = typing.get_args(inner) if kind is Literal else ()
    return Declared(str if words else kind, quantity, words, optional)


def checked(function: Callable[P, R]) -> Callable[P, R]:
    """Check the arguments of a function as their annotations declare them, when it is called.

    What is refused is a ValueError that names the argument, the value and what was expected; a
    length that looks like millimetres is warned of. It takes `progress=` too, a listener.

    Examples
    --------
    >>> @checked
    ... def shrunk(*, distance: Metres = 0.2) -> float:
    ...     return distance / 2
    >>> shrunk(distance=-1)
    Traceback (most recent call last):
    ValueError: distance must be a number above 0, in metres, got -1
    """
    rules: dict[str, Declared] = {}
    parameters = inspect.signature(function).parameters
    names, free = list(parameters), -1  # so many in front may be anything
    by_name = [n for n, p in parameters.items() if p.kind is p.KEYWORD_ONLY]
    ahead = names.index(by_name[0]) if by_name else len(names)

    def checked_argument(name: str, argument: Any, args: tuple[Any, ...]) -> Any:
        if name not in rules:
            return argument
        length, q = rules[name].check(argument, name), rules[name].quantity
        if q.usual and length is not None and q.usual < length < math.inf:
            unit_checks.check_length(length, name, *args[:1], share=q.share)
        return length

    @functools.wraps(function)
    def call(*args: Any, **given: Any) -> R:
        nonlocal free
        if given and (listen := given.pop("progress", None)) is not None:
            with told(listen):
                return call(*args, **given)
        if ahead < min(len(args), len(names)):
            word = f"{names[ahead]}={args[ahead]!r}"
            raise TypeError(
                f"{names[ahead]} is given by its name: {function.__name__}(..., {word})"
            )
        if free < 0:
            rules.update({n: rule for n, rule in declared(function).items() if rule.is_limited})
            free = next((k for k, name in enumerate(names) if name in rules), len(names))
        if not given and len(args) <= free:
            return cast(Callable[..., R], function)(*args)
        first = [checked_argument(*pair, args) for pair in zip(names, args, strict=False)]
        rest = {name: checked_argument(name, given[name], args) for name in given}
        return cast(Callable[..., R], function)(*first, *args[len(names) :], **rest)

    return cast(Callable[P, R], call)


class Settings:
    """A dataclass of settings: each field is checked, and kept, as its annotation declares it.

    What is a plain float is positive; a tuple holds positive numbers.
    """

    def __post_init__(self) -> None:
        for name, rule in declared(type(self)).items():
            setting, many = getattr(self, name), rule.kind is tuple
            if many or (rule.kind is float and rule.quantity.unit is None):
                listed = setting if isinstance(setting, tuple) else (setting,)
                numbers = tuple(number(value, name, above=0) for value in listed)
                object.__setattr__(self, name, numbers if many else numbers[0])
            else:
                object.__setattr__(self, name, rule.check(setting, name))
