"""Methods with their thresholds as one word: `fusion:tolerance=0.05`. Degrees stand for radians."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from contextlib import suppress
from typing import Any, NamedTuple

from segmap import alignment, extraction, reduction
from segmap.arrays import Declared, declared

from ...call import Call, defaults
from ...pipeline import BEGIN

#: The methods that an option names.
FAMILIES: Mapping[str, Mapping[str, Any]] = {
    "align": alignment.METHODS,
    "extract": extraction.METHODS,
    "method": reduction.METHODS,
}
#: The methods where none is named.
USUAL = {"align": "pose_graph", "extract": "extract_polylines", "method": reduction.USUAL_METHOD}
#: What a switch is called, and how a session has it.
SWITCH = {"yes": True, "no": False, "True": True, "False": False}


class Threshold(NamedTuple):
    """A keyword of a method: what is declared of it, and its default in the method's unit."""

    said: Declared
    default: Any

    def text_of(self) -> str:
        """The default as a user reads it, with its unit."""
        if self.default is None:
            return "none"
        if isinstance(self.default, bool):
            return "yes" if self.default else "no"
        if self.said.words:
            return f"{self.default} (of {', '.join(self.said.words)})"
        return f"{self.said.read(self.default):.4g} {self.said.read_unit}".rstrip()

    def value(self, word: str, name: str) -> Any:
        """What a word means, in the method's unit."""
        value: Any = SWITCH.get(word, word) if self.said.kind is bool else word
        if not self.said.words:
            with suppress(ValueError):  # the check refuses it
                value = self.said.kind(value)
        return self.said.meant(self.said.as_read().check(value, name))


def thresholds(function: Callable[..., Any]) -> dict[str, Threshold]:
    """The keywords of a method that are one number, a word of several, or a switch."""
    declarations, usual, named = declared(function), defaults(function), {}
    for name, parameter in inspect.signature(function).parameters.items():
        own = parameter.kind is parameter.KEYWORD_ONLY and declarations[name]
        if own and (own.kind in (float, int, bool) or own.words):
            named[name] = Threshold(own, usual[name])
    return named


def function_of(method: Any) -> Callable[..., Any]:
    """The function of a method; an extraction is one itself."""
    function: Callable[..., Any] = getattr(method, "function", method)
    return function


def call_of(text: str, methods: Mapping[str, Any]) -> Call:
    """The method that is named, with the thresholds that are, and those defaults that are ours."""
    name, _, pairs = text.partition(":")
    if name not in methods:
        raise ValueError(f"{name!r} is none of {', '.join(methods)}")
    function = function_of(methods[name])
    own, parameters = thresholds(function), inspect.signature(function).parameters
    values = {k: t.default for k, t in own.items() if t.default != parameters[k].default}
    for pair in filter(None, pairs.split(",")):
        key, _, word = pair.partition("=")
        if key not in own:
            raise ValueError(f"{name} has no {key}; it has {', '.join(own) or 'no threshold'}")
        values[key] = own[key].value(word, key)
    return Call(name, function, values)


def with_calls(stored: Mapping[str, Any]) -> dict[str, Any]:
    """The options with each threshold at its method: sessions keep it for itself."""
    options = {name.replace("-", "_"): value for name, value in stored.items() if value != []}
    if options.pop("mount_auto", False):
        options["mount"] = "auto"
    for option, family in FAMILIES.items():
        if (name := str(options.get(option, USUAL[option]))) in family:
            keys = {BEGIN[option] + key: key for key in thresholds(function_of(family[name]))}
            own = [f"{keys[key]}={options.pop(key)}" for key in [*options] if key in keys]
            options |= {option: f"{name}:{','.join(own)}"} if own else {}
    return options
