"""What a command says, in a user's words: numbers with units, faults in one plain line."""

from __future__ import annotations

import sys
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from .._display import counted
from ..readers import LogError, UnknownFormat
from ..scans import Log

if TYPE_CHECKING:
    from tqdm import tqdm

#: What a user can mend: a damaged log, a wrong argument, a full disk, a missing package.
FAULTS = (ValueError, OSError, ImportError, MemoryError)


def percent(share: float) -> str:
    """A share to a tenth of a per cent."""
    return f"{100 * share:.1f} %"


def metres(value: float) -> str:
    """A length: millimetres below a tenth of a metre."""
    return f"{1000 * value:.1f} mm" if abs(value) < 0.1 else f"{value:.2f} m"


def seconds(value: float) -> str:
    """A time: milliseconds below a tenth of a second."""
    return f"{1000 * value:.0f} ms" if value < 0.1 else f"{value:.1f} s"


def begin(log: Log, source: str) -> None:
    """Print which log comes now."""
    where = "" if source == log.name else f", {source}"
    say(f"{log.name}: {counted(len(log), 'scan')}{where}")


def line(word: str, text: str) -> None:
    """Print one thing about a log, below its name."""
    say(f"  {word:<9} {text}")


def say(text: str = "") -> None:
    """Print a line; a bar that is shown moves below it."""
    from tqdm import tqdm

    tqdm.write(text, file=sys.stdout)
    sys.stdout.flush()


def tell(text: str) -> None:
    """Say beside the output what went wrong."""
    print(f"segmap: {text}", file=sys.stderr, flush=True)


def reason(error: BaseException) -> str:
    """Why something failed, in one line; for what is no log also what to do, as it stands."""
    if isinstance(error, UnknownFormat):
        return str(error)
    if isinstance(error, LogError) and error.line and "read_csv" not in error.reason:
        return f"{error} (--skip leaves damaged lines out)"
    if isinstance(error, OSError) and error.strerror:
        return f"{error.filename}: {error.strerror}" if error.filename else error.strerror
    if isinstance(error, MemoryError):
        return "there is not enough memory for this"
    return " ".join(str(error).split()) or type(error).__name__


@contextmanager
def plain_warnings() -> Iterator[None]:
    """Show the warnings of the library as short lines, each once for each log that deserves it."""

    def show(message: Warning | str, category: type[Warning], *where: Any, **more: Any) -> None:
        """One line for a warning of the library."""
        from tqdm import tqdm  # it draws the bar anew below the line

        if issubclass(category, UserWarning):
            tqdm.write(f"warning: {message}", file=sys.stderr)

    with warnings.catch_warnings():
        warnings.simplefilter("always", UserWarning)
        warnings.showwarning = show
        yield


def progress(total: int, unit: str, doing: str = "") -> tqdm[Any]:
    """A bar on a terminal, and nothing elsewhere, nor where there is one step only."""
    from tqdm import tqdm

    hidden = True if total == 1 else None
    return tqdm(total=total, unit=unit, desc=doing or None, disable=hidden, leave=False)
