"""A command of argparse: whole words alone, one line where it is not understood."""

from __future__ import annotations

import argparse
import re
from collections.abc import Callable
from typing import Any, NoReturn, TypeVar

from segmap.arrays import Declared

from .._output import Usage

Value = TypeVar("Value")


class Command(argparse.ArgumentParser):
    """A parser for whole words: a shortened option may mean another one in the next version."""

    def __init__(self, **settings: Any) -> None:
        shape, usage = argparse.RawDescriptionHelpFormatter, "%(prog)s [OPTIONS] ..."
        super().__init__(**settings, allow_abbrev=False, formatter_class=shape, usage=usage)
        self._negative_number_matcher = re.compile(r"-[\d.,*]")  # -170:-150, or columns -,angle_deg

    def error(self, message: str) -> NoReturn:
        """End with a message."""
        raise Usage(f"{message}\n`{self.prog} --help` tells what there is")


def examples(*lines: str) -> str:
    """The end of a help: commands to copy."""
    return "\n".join(["examples:", *(f"  segmap {line}" for line in lines)])


def switch(group: Any, *names: str, help: str) -> None:
    """An option that is said or not."""
    group.add_argument(*names, action="store_true", help=help)


def told(read: Callable[[str], Value]) -> Callable[[str], Value]:
    """What reads the word of an option, with its own words where it refuses one."""

    def reading(text: str) -> Value:
        """The word read."""
        try:
            return read(text)
        except ValueError as error:
            raise argparse.ArgumentTypeError(str(error)) from error

    return reading


def checked(check: Callable[[str], Any]) -> Callable[[str], str]:
    """What takes the word of an option as it is, where this does not refuse it."""

    def taking(text: str) -> str:
        """The word itself."""
        check(text)
        return text

    return told(taking)


def quantity(declared: Declared) -> Callable[[str], Any]:
    """What reads a number that is declared."""
    return told(lambda text: declared.check(declared.kind(text), "it"))
