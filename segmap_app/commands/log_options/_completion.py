"""What a shell offers after Tab: commands, options, methods, names of logs and of files."""

from __future__ import annotations

import argparse
import re
from collections.abc import Iterable, Iterator

from ._command import Command

#: Logs that come with segmap.
BUNDLED = ("malaga", "clinic", "corridor", "room")
#: For bash, and for zsh, which can read what is for bash. The case asks for the command, the word
#: before, the word that is begun, and its number; the first pattern that fits wins.
SCRIPT = """\
if [ -n "$ZSH_VERSION" ]; then
  autoload -Uz compinit bashcompinit && compinit -u && bashcompinit
fi
_segmap() {{
  local IFS=$'\\n' word=${{COMP_WORDS[COMP_CWORD]}} words= files=
  case "${{COMP_WORDS[1]}} ${{COMP_WORDS[COMP_CWORD-1]}} $word $COMP_CWORD" in
    *' 1') words='{commands}' ;;
{cases}
  esac
  COMPREPLY=($(IFS=' '; compgen -W "$words" $files -- "$word"))
}}
complete -o filenames -F _segmap segmap
"""


class Completion(argparse.Action):
    """Print the script, and end."""

    def __call__(self, parser: argparse.ArgumentParser, *given: object) -> None:
        (commands,) = (a.choices for a in parser._actions if isinstance(a.choices, dict))
        cases = "\n".join(
            f"    {pattern}) words='{' '.join(words)}'{' files=-f' * files} ;;"
            for name, command in commands.items()
            for pattern, words, files in _cases(name, command)
        )
        words = " ".join([*commands, *_long(parser)])
        print(SCRIPT.format(commands=words, cases=cases), end="")
        parser.exit()


def _long(parser: argparse.ArgumentParser) -> Iterator[str]:
    return (option for option in parser._option_string_actions if option.startswith("--"))


def _cases(name: str, command: Command) -> Iterator[tuple[str, Iterable[str], bool]]:
    """What is typed, the words that may follow, and whether a file may."""
    for option in _long(command):
        words = command._option_string_actions[option].choices
        if words := command.methods if option == "--help" else words:
            yield f"'{name} {option} '*", words, False
    yield f"'{name} '*' -'*", _long(command), False
    first = command._get_positional_actions()[:1]
    logs = any(action.dest == "logs" for action in command._actions)
    if any(action.nargs == argparse.REMAINDER for action in first):
        yield f"'{name} {name} '*", re.findall(r"\w+", str(first[0].metavar)), False
    yield f"'{name} '*", BUNDLED * logs, True
