"""How far a sweep is: a bar where somebody looks, nothing elsewhere."""

import html
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from ._records import Record

#: `progress(done, total, record)`: the record that was finished, None at the start.
Progress = Callable[[int, int, Record | None], None]


@contextmanager
def shown(progress: Progress | bool) -> Iterator[Progress]:
    """The function to report to: the one given, a bar, or one that does nothing."""
    if callable(progress):
        yield progress
    elif progress and (display := _notebook()):
        yield _notebook_bar(display)
    elif progress and sys.stderr.isatty():
        yield _terminal_bar
        sys.stderr.write("\n")
    else:
        yield lambda done, total, record: None


def _notebook() -> Any:
    """IPython's display where a kernel runs this, else None; nothing is imported for it."""
    ipython = sys.modules.get("IPython")
    shell = ipython.get_ipython() if ipython else None
    return ipython.display if ipython and getattr(shell, "kernel", None) else None


def _notebook_bar(display: Any) -> Progress:
    handle = display.display(display.HTML(""), display_id=True)

    def report(done: int, total: int, record: Record | None) -> None:
        """Put the bar in the place of the last one."""
        words = html.escape(_words(done, total, record))
        bar = f'<progress value="{done}" max="{max(total, 1)}"></progress>'
        handle.update(display.HTML(f"{bar} {words}"))

    return report


def _terminal_bar(done: int, total: int, record: Record | None) -> None:
    filled = 30 * done // max(total, 1)
    bar = "#" * filled + "." * (30 - filled)
    sys.stderr.write(f"\r[{bar}] {_words(done, total, record)}\x1b[K")
    sys.stderr.flush()


def _words(done: int, total: int, record: Record | None) -> str:
    last = f": {record.method} on {record.map}" if record else ""
    return f"{done} of {total}{last}"
