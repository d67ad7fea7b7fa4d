"""All commands behind one name, and how each may end."""

from __future__ import annotations

import os
import sys

from segmap.arrays import described
from segmap.files import speak

from ._output import FAULTS, Usage, plain_warnings, print_error, print_line, reason
from .log_options import FAMILIES, call_of, command, parse, thresholds


@command("methods", "methods", "methods fusion", "methods pose_graph")
def methods(method: str | None = None, /) -> None:
    """All methods, or the thresholds of one, as `--method fusion:tolerance=0.05` sets them.

    Parameters
    ----------
    method
        One of them.
    """
    functions = {name: each for family in FAMILIES.values() for name, each in family.items()}
    for name in [method] if method else functions:
        function = call_of(name, functions).function
        words = described(function)
        print_line(f"{name}: {words['']}")
        for key, threshold in thresholds(function).items() if method else ():
            print_line(f"  {key}: {words[key]} Default: {threshold.text_of()}.")


def main(arguments: list[str] | None = None) -> int:
    """Run a command and return its exit code."""
    speak()
    words = sys.argv[1:] if arguments is None else arguments
    try:
        with plain_warnings():
            return int(parse(words)() or 0)
    except KeyboardInterrupt:
        print_error("stopped")
        return 130
    except BrokenPipeError:  # `segmap info ... | head`
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 1
    except Usage as error:
        print_error(str(error))
        return 2
    except FAULTS as error:
        print_error(reason(error))
        return 1
