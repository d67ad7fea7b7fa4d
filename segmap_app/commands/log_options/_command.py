"""A command that explains itself: what most people need, all of it, or one method."""

from __future__ import annotations

import argparse
import re
from collections.abc import Iterable
from difflib import get_close_matches
from typing import Any, NoReturn

from .._output import Usage, print_line


class Command(argparse.ArgumentParser):
    """A parser for whole words: a shortened option may mean another one in the next version.

    Its help leaves out groups of options that few need, and thresholds: `--help METHOD` tells those
    of one method, `--help-all` everything.
    """

    def __init__(self, **settings: Any) -> None:
        super().__init__(**settings, allow_abbrev=False, add_help=False)
        self._negative_number_matcher = re.compile(r"-[\d.,*]")  # -170:-150, or columns -,angle_deg
        self._few: list[argparse._ArgumentGroup] = []
        #: The thresholds of each method, as options of a parser of their own.
        self.methods: dict[str, argparse._ArgumentGroup] = {}
        self._help = self.add_argument("-h", "--help", nargs=0, action=_Help, help="tell this")

    def finish(self, said: str) -> None:
        """What it does, and the help of its methods, once all is named."""
        self.description = self.description or f"{said[:1].upper()}{said[1:]}."
        self.set_defaults(refuse=self.error, command=self)
        if self.methods:
            self._help.nargs, self._help.metavar = "?", "METHOD"
            self._help.help = "tell this, or the thresholds of METHOD; --help-all tells everything"
            self.add_argument("--help-all", action=_Help, nargs=0, help=argparse.SUPPRESS)

    def few_need(self, title: str) -> argparse._ArgumentGroup:
        """A group of options that `--help` only names."""
        self._few.append(self.add_argument_group(title))
        return self._few[-1]

    def shown_groups(self) -> list[argparse._ArgumentGroup]:
        """All groups with options that have help, those of the methods last."""
        groups = [group for group in self._action_groups if _names(group)]
        return [*groups, *self.methods.values()]

    def usage_line(self) -> str:
        """How it is called: what must be named, and that there are options."""
        form = argparse.HelpFormatter(self.prog)
        form.add_usage(None, self._get_positional_actions(), [], "")
        return f"{' '.join(form.format_help().split())} [OPTIONS]"

    def format_help(self) -> str:
        """What most people need; where there are no methods, all."""
        few = self._few if self.methods else []
        more = "".join(f"  {group.title}: {', '.join(_names(group))}\n" for group in few)
        words = f"more options, which --help-all explains:\n{more}\n" if few else ""
        return self._page([group for group in self._action_groups if group not in few], words)

    def format_all(self) -> str:
        """All options and the thresholds of all methods."""
        return self._page(self.shown_groups())

    def format_method(self, name: str) -> str:
        """What a method does, and its thresholds."""
        group = self.methods[name]
        page = _with_groups([group], usage=argparse.SUPPRESS)
        return page if _names(group) else f"{page}  It has no threshold.\n"

    def _page(self, groups: list[argparse._ArgumentGroup], more: str = "") -> str:
        words = {"usage": self.usage_line(), "description": self.description}
        return _with_groups(groups, **words, epilog=f"{more}{self.epilog or ''}")

    def error(self, message: str) -> NoReturn:
        """End with a message."""
        raise Usage(f"{message}\n`{self.prog} --help` tells what there is")

    def refuse_unknown(self, words: list[str]) -> NoReturn:
        """End where words are left that mean nothing."""
        known = list(self._option_string_actions)
        self.error(f"unrecognized arguments: {' '.join(words)}{meant(words[0], known)}")

    def _check_value(self, action: argparse.Action, value: Any) -> None:
        """As argparse does, with the word that was meant."""
        if action.choices is not None and value not in action.choices:
            known = list(map(str, action.choices))
            said = f"invalid choice: {value!r}{one_of_known(str(value), known)}"
            raise argparse.ArgumentError(action, said)


class _Help(argparse.Action):
    """Tell what there is, and end."""

    def __call__(
        self, parser: argparse.ArgumentParser, given: Any, values: Any, option: str | None = None
    ) -> None:
        assert isinstance(parser, Command)
        if not values:
            text = parser.format_all() if option == "--help-all" else parser.format_help()
        elif values in parser.methods:
            text = parser.format_method(values)
        else:
            known = list(parser.methods)
            parser.error(f"--help {values}: there is no such method{one_of_known(values, known)}")
        for line in text.rstrip().split("\n"):
            print_line(line)
        parser.exit()


def examples(*lines: str) -> str:
    """The end of a help: commands to copy."""
    return "\n".join(["examples:", *(f"  segmap {line}" for line in lines)])


def meant(word: str, known: Iterable[str]) -> str:
    """The word among those known that one may have meant.

    Examples
    --------
    >>> meant("--toler", ["--filter", "--tolerance"]), meant("magic", ["fusion"])
    (' (did you mean --tolerance?)', '')
    >>> meant("--aling", ["--along", "--align"])  # two letters in the wrong order
    ' (did you mean --align?)'
    """
    word = word.partition("=")[0]
    near = get_close_matches(word, list(known))
    near.sort(key=lambda other: sorted(other) != sorted(word))
    return f" (did you mean {near[0]}?)" if near else ""


def one_of_known(word: str, known: list[str]) -> str:
    """The word that one may have meant, or all that are known."""
    return meant(word, known) or f"; one of {', '.join(known)}"


def _with_groups(groups: list[argparse._ArgumentGroup], **words: Any) -> str:
    """The help of a parser that has these groups of options and no others."""
    shape = argparse.RawDescriptionHelpFormatter
    page = argparse.ArgumentParser(**words, add_help=False, formatter_class=shape)
    page._action_groups = groups
    return page.format_help()


def _names(group: argparse._ArgumentGroup) -> list[str]:
    """The arguments of a group that have help."""
    shown = (action for action in group._group_actions if action.help != argparse.SUPPRESS)
    return [action.option_strings[0] if action.option_strings else action.dest for action in shown]
