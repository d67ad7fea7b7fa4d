"""Long work in a process of its own, which can be stopped at any time.

Work that says how far it is stops at its next step. A compiled loop cannot be interrupted: so the
work runs in a second Python that stays warm for the next run, and where no step comes soon stopping
kills it; so does the end of this one. Functions travel by their names: one that is defined in a
notebook is not known there, and `Workbench.run` calls it here instead.
"""

from __future__ import annotations

import contextlib
import io
import os
import pickle
import queue
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Sequence
from typing import IO, Any

from segmap.progress import Stopped, announce, told
from segmap.scans import Log

from ..drives import Driving, record
from ..pipeline import Pipeline, Placing
from ._files import sketch

#: What the worker begins with: Control-C is for the kernel, and it finds the package that this
#: Python has imported.
START = (
    "import signal, sys; signal.signal(signal.SIGINT, signal.SIG_IGN); sys.path[:] = sys.argv[1:]; "
    "from segmap_app.page import _job; _job.serve()"
)
#: What to do with a function that cannot be sent.
RUNS_HERE = "what only this notebook defines runs with workbench.run()"
#: What both sides have, by the name of its type.
Kept = dict[str, Any]
#: The work reads files of strangers: it may have the machine's memory, or so much, bytes.
LEAST_MEMORY_BYTES = 4 << 30
#: And one call so much time, seconds, but for a drive.
MOST_TIME_S = 3600
#: A step may take so long before it is told, seconds.
STEP_PATIENCE_S = 0.2
#: And longer in a function that waits for a laser.
PATIENCE_S: dict[Callable[..., Any], float] = {record: 5.0}
#: It is told at most every so often, seconds.
STEP_NEWS_S = 0.1
#: What is placed so far is shown so often, seconds, ...
SKETCH_NEWS_S = 0.09
#: ... and for at most this share of the time.
SKETCH_TIME_SHARE = 0.05


class Failed(Exception):
    """The work raised: what it said."""


class Worker:
    """One more Python that does one thing after another."""

    def __init__(self) -> None:
        self._process: subprocess.Popen[bytes] | None = None
        self._kept: Kept = {}
        self._lock, self._idle, self._stopped = threading.Lock(), threading.Event(), False
        self._idle.set()
        self._heard = threading.Event()
        self.grown: Callable[..., object] = lambda *seen: None
        self._patience = STEP_PATIENCE_S

    def do(self, function: Callable[..., Any], *given: Any) -> Any:
        """Call `function(*given)` there, and tell here how far it says it is.

        Raises
        ------
        Stopped
            Where `stop` was called meanwhile, and the work has not kept what it had.
        Failed
            With what the function raised, or where the process ended by itself.
        """
        self._stopped, self._patience = False, PATIENCE_S.get(function, STEP_PATIENCE_S)
        self._idle.clear()
        try:
            process, work = self.start(), io.BytesIO()
            try:
                _Writer(work, self._kept).dump((function, given))
            except Exception as fault:
                raise Failed(f"{fault}; {RUNS_HERE}") from fault
            self._kept |= _kept(given)
            result = self._done(process, work.getvalue())
            self._kept |= _kept([result])
            return result
        finally:
            self._idle.set()
            self._heard.set()

    def _done(self, process: subprocess.Popen[bytes], work: bytes) -> Any:
        assert process.stdin is not None and process.stdout is not None
        try:
            with self._lock:
                if self._stopped:
                    raise Stopped
                _send(process.stdin, work)
            while True:
                kind, value = _Reader(process.stdout, self._kept).load()
                if kind == "done":
                    return value
                if kind == "failed":
                    raise Failed(value)
                if kind == "stopped":
                    raise Stopped
                if kind == "heard":
                    self._heard.set()
                else:
                    (self.grown if kind == "grown" else announce)(*value)
        except (EOFError, OSError, ValueError, pickle.UnpicklingError):  # a pipe that was closed
            if self._process is process:
                with contextlib.suppress(subprocess.TimeoutExpired):
                    process.wait(1)
                late = process.returncode == -getattr(signal, "SIGALRM", 0)
                why = f"it took {MOST_TIME_S // 60} minutes" if late else "is there memory enough?"
                raise Failed(f"the work ended by itself: {why}") from None
            raise Stopped from None

    def start(self) -> subprocess.Popen[bytes]:
        """The process; a new one where there is none, or where it has ended."""
        with self._lock:
            if self._process is None or self._process.poll() is not None:
                _end(self._process)
                self._kept = {}
                command = [sys.executable, "-c", START, *sys.path]
                pipes: Any = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE}
                self._process = subprocess.Popen(command, **pipes)
            return self._process

    def stop(self) -> None:
        """End what it does, at its next step or with its process; nothing where it does nothing."""
        self._stopped = True
        process = self._process
        if process is None or self._idle.is_set():
            return
        self._heard.clear()
        if self._lock.acquire(timeout=STEP_PATIENCE_S):  # else a long log is on its way
            with contextlib.suppress(OSError, ValueError):
                _send(process.stdin, None)  # type: ignore[arg-type]
            self._lock.release()
        if not (self._heard.wait(self._patience) or self._idle.is_set()):
            self.end()

    def end(self) -> None:
        """Kill the process, whatever it does."""
        process, self._process = self._process, None
        _end(process)

    def __del__(self) -> None:
        self.end()


def _kept(values: Sequence[Any]) -> Kept:
    """The log and the outcome that both sides have: they go only once, for that takes seconds."""
    return {type(value).__name__: value for value in values if isinstance(value, Log | Pipeline)}


class _Writer(pickle.Pickler):
    """Sends a word in the place of what the other side has."""

    def __init__(self, pipe: IO[bytes], kept: Kept) -> None:
        super().__init__(pipe)
        self._known = kept

    def persistent_id(self, value: Any) -> str | None:
        """The word."""
        word = type(value).__name__
        return word if value is not None and value is self._known.get(word) else None


class _Reader(pickle.Unpickler):
    """Puts what is kept in the place of the word."""

    def __init__(self, pipe: IO[bytes], kept: Kept) -> None:
        super().__init__(pipe)
        self._known = kept

    def persistent_load(self, word: str) -> Any:
        """What is kept."""
        return self._known[word]


def _end(process: subprocess.Popen[bytes] | None) -> None:
    """Kill a process if it still runs, and close what led to it."""
    if process is not None:
        process.kill()
        process.wait()
        for pipe in (process.stdin, process.stdout):
            with contextlib.suppress(OSError):
                pipe.close()  # type: ignore[union-attr]


def most_time_s(function: Callable[..., Any]) -> int:
    """Seconds that a call may take; 0 for a drive, which has no end that is known."""
    return 0 if function in PATIENCE_S else MOST_TIME_S


def serve() -> None:
    """What the worker does: calls that come in by standard input, until that is closed.

    A thread waits there, and ends the process in the middle of its work where the kernel is gone.
    """
    calls: queue.SimpleQueue[bytes] = queue.SimpleQueue()
    stop, told_at, seen_at = threading.Event(), 0.0, 0.0
    threading.Thread(target=_listen, args=[calls, stop], daemon=True).start()
    answers = os.fdopen(os.dup(sys.stdout.fileno()), "wb")
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())  # what a method prints is no answer

    def hand_on(share: float, words: str) -> None:
        nonlocal told_at, seen_at
        if stop.is_set():
            stop.clear()  # who keeps what there is may be stopped once more
            _send(answers, ("heard", None))
            raise Stopped
        now = time.monotonic()
        if share == 0 or now - told_at > STEP_NEWS_S:
            told_at = now
            _send(answers, ("told", (share, str(words))))
        if isinstance(words, Placing | Driving) and share > 0 and now > seen_at:
            _send(answers, ("grown", sketch(words)))
            seen_at = time.monotonic() + max(
                SKETCH_NEWS_S, (time.monotonic() - now) / SKETCH_TIME_SHARE
            )

    with contextlib.suppress(ImportError):
        import numba  # noqa: F401 -- while the user still reads the page
    with contextlib.suppress(ImportError, OSError, ValueError):  # Windows; a lower limit that holds
        import resource

        memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
        resource.setrlimit(resource.RLIMIT_AS, (max(memory, LEAST_MEMORY_BYTES),) * 2)
    alarm = getattr(signal, "alarm", lambda seconds: None)  # it kills: no handler is waited for
    cache: Kept = {}
    while True:
        work = calls.get()
        stop.clear()
        try:
            try:
                function, arguments = _Reader(io.BytesIO(work), cache).load()
            except Exception as fault:
                raise ValueError(f"{fault}; {RUNS_HERE}") from fault
            cache |= _kept(arguments)
            alarm(most_time_s(function))
            with told(hand_on):
                result = function(*arguments)
            _send(answers, ("done", result), cache)
            cache |= _kept([result])
        except Stopped:
            _send(answers, ("stopped", None))
        except BaseException as fault:  # a method that calls sys.exit ends itself only
            _send(answers, ("failed", said(fault)))
        finally:
            alarm(0)


def _listen(calls: queue.SimpleQueue[bytes], stop: threading.Event) -> None:
    """Hand on what comes in, None to stop; compiled loops let this thread run beside them."""
    try:
        while True:
            if (work := pickle.load(sys.stdin.buffer)) is None:
                stop.set()
            else:
                calls.put(work)
    finally:  # closed, or cut off
        os._exit(0)


def _send(pipe: IO[bytes], value: object, kept: Kept | None = None) -> None:
    _Writer(pipe, kept or {}).dump(value)
    pipe.flush()


def said(fault: BaseException) -> str:
    """What an error says; errors that are not of the arguments by their kind too.

    Examples
    --------
    >>> said(ValueError("map is empty")), said(KeyError("a"))
    ('map is empty', "KeyError: 'a'")
    """
    if isinstance(fault, Stopped):
        return "stopped"
    own = isinstance(fault, ValueError | Failed)
    return str(fault) if own else f"{type(fault).__name__}: {fault}"
