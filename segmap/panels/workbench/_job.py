"""Long work in a process of its own, which can be stopped at any time.

A compiled loop cannot be interrupted. So the work runs in a second Python that stays warm for the
next run; stopping kills it, and so does the end of this one. Functions travel by their names: one
that is defined in a notebook is not known there, and `Workbench.run` calls it here instead.
"""

from __future__ import annotations

import contextlib
import os
import pickle
import queue
import subprocess
import sys
import threading
from collections.abc import Callable
from typing import Any, BinaryIO

#: What the worker begins with: it finds the package that this Python has imported.
START = (
    "import sys; sys.path[:] = sys.argv[1:]; from segmap.panels.workbench import _job; _job.serve()"
)
#: What to do with a function that cannot be sent.
HERE = "what only this notebook defines runs with workbench.run()"


class Stopped(Exception):
    """The work was stopped before it was done."""


class Failed(Exception):
    """The work raised: what it said."""


class Worker:
    """One more Python that does one thing after another."""

    def __init__(self) -> None:
        self._process: subprocess.Popen[bytes] | None = None
        self._lock = threading.Lock()

    def do(self, function: Callable[..., Any], *given: Any, tell: Callable[[str], None]) -> Any:
        """Call `function(*given, tell)` there, and hand on what it tells.

        Raises
        ------
        Stopped
            Where `stop` was called meanwhile.
        Failed
            With what the function raised, or where the process ended by itself.
        """
        try:
            work = pickle.dumps((function, given))
        except Exception as fault:
            raise Failed(f"{fault}; {HERE}") from fault
        process = self.start()
        assert process.stdin is not None and process.stdout is not None
        try:
            pickle.dump(work, process.stdin)
            process.stdin.flush()
            while True:
                kind, value = pickle.load(process.stdout)
                if kind == "done":
                    return value
                if kind == "failed":
                    raise Failed(value)
                tell(value)
        except (EOFError, OSError, ValueError, pickle.UnpicklingError):  # a pipe that was closed
            if self._process is process:
                raise Failed("the work ended by itself: is there memory enough?") from None
            raise Stopped from None

    def start(self) -> subprocess.Popen[bytes]:
        """The process; a new one where there is none, or where it has ended."""
        with self._lock:
            if self._process is None or self._process.poll() is not None:
                _end(self._process)
                command = [sys.executable, "-c", START, *sys.path]
                pipes: Any = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE}
                self._process = subprocess.Popen(command, **pipes)
            return self._process

    def stop(self) -> None:
        """End it, whatever it does; nothing happens where it does not run."""
        with self._lock:
            process, self._process = self._process, None
        _end(process)

    def __del__(self) -> None:
        self.stop()


def _end(process: subprocess.Popen[bytes] | None) -> None:
    """Kill a process if it still runs, and close what led to it."""
    if process is not None:
        process.kill()
        process.wait()
        for pipe in (process.stdin, process.stdout):
            with contextlib.suppress(OSError):
                pipe.close()  # type: ignore[union-attr]


def serve() -> None:
    """What the worker does: calls that come in by standard input, until that is closed.

    A thread waits there, and ends the process in the middle of its work where the kernel is gone.
    """
    calls: queue.SimpleQueue[bytes] = queue.SimpleQueue()
    threading.Thread(target=_listen, args=[calls], daemon=True).start()
    answers = os.fdopen(os.dup(sys.stdout.fileno()), "wb")
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())  # what a method prints is no answer
    while True:
        work = calls.get()
        try:
            try:
                function, given = pickle.loads(work)
            except Exception as fault:
                raise ValueError(f"{fault}; {HERE}") from fault
            _send(answers, "done", function(*given, lambda text: _send(answers, "told", text)))
        except Exception as fault:
            _send(answers, "failed", said(fault))


def _listen(calls: queue.SimpleQueue[bytes]) -> None:
    """Hand on what comes in; compiled loops let this thread run beside them."""
    try:
        while True:
            calls.put(pickle.load(sys.stdin.buffer))
    finally:  # closed, or cut off
        os._exit(0)


def _send(answers: BinaryIO, kind: str, value: Any) -> None:
    pickle.dump((kind, value), answers)
    answers.flush()


def said(fault: Exception) -> str:
    """What an error says; errors that are not of the arguments by their kind too.

    Examples
    --------
    >>> said(ValueError("map is empty")), said(KeyError("a"))
    ('map is empty', "KeyError: 'a'")
    """
    return str(fault) if isinstance(fault, ValueError) else f"{type(fault).__name__}: {fault}"
