"""Run answers in locked processes, and judge here what they answer: no student's code runs here."""

from __future__ import annotations

import base64
import contextlib
import json
import os
import pickle
import queue
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

from ..exercises import Exercise
from ._jail import PACKAGES, Limits, Locks
from .handout import Task

#: How a process without network and without sight of others is started, the first that works.
APART = (
    ("unshare", "--net", "--ipc", "--pid", "--fork", "--kill-child", "--mount-proc"),
    ("unshare", "--user", "--map-current-user", "--net", "--ipc", "--pid", "--fork", "--kill-child")
    + ("--mount-proc",),
)
#: A server that says nothing for so long, beyond the time of an answer, is started anew, seconds.
PATIENCE = 60.0
#: Libraries that start threads of their own: a locked process may have none.
SINGLE = ("OPENBLAS", "OMP", "MKL", "NUMBA")
#: What a process tells of a cell -> the words before its text.
FAULTS = {"syntax": "the cell is not Python: ", "raised": "the cell itself raises ", "missing": ""}


class Outcome(NamedTuple):
    """What became of an answer: its kind in one word, the reason, and whether it is right."""

    kind: str
    reason: str
    right: bool = False


class Server:
    """A process that runs answers; it is started anew when it dies."""

    def __init__(self, tasks: Sequence[Task], limits: Limits) -> None:
        self.limits = limits
        self._warm = {
            "warm": [task.name for task in tasks if not task.by_hand],
            "imports": sorted({task.imports for task in tasks}),
        }
        self._start()

    def _start(self) -> None:
        prefix = apart()
        words = [sys.executable, "-P", "-m", "segmap_course.grading._server"]
        self._process = subprocess.Popen(
            [*prefix, *words, *(["apart"] if prefix else [])],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            cwd="/",
            env=environment(),
            text=True,
            start_new_session=True,
        )
        self.locks = Locks(**self._say(None, PATIENCE))
        self._say(self._warm, 10 * PATIENCE)

    def _say(self, job: Mapping[str, Any] | None, seconds: float) -> Any:
        """Send a job and wait for its report.

        Raises
        ------
        OSError
            Where the process died, or did not answer in time.
        """
        assert self._process.stdin is not None and self._process.stdout is not None
        clock = threading.Timer(seconds, self._process.kill)
        clock.start()
        try:
            if job is not None:
                self._process.stdin.write(json.dumps(job) + "\n")
                self._process.stdin.flush()
            line = self._process.stdout.readline()
        finally:
            clock.cancel()
        if not line:
            raise OSError("the process for students' code ended")
        return json.loads(line)

    def run(self, job: Mapping[str, Any]) -> dict[str, Any]:
        """The report on a job; where the process itself died, it is started anew."""
        with tempfile.TemporaryDirectory(prefix="segmap-grade-") as folder:
            Path(folder).chmod(0o755)
            asked = {**job, "folder": folder, "limits": list(self.limits)}
            try:
                return dict(self._say(asked, self.limits.seconds + PATIENCE))
            except OSError:
                self.close()
                self._start()
                return {"text": "", "ended": "whole", "status": -signal.SIGKILL}

    def close(self) -> None:
        """End the process and all that it started."""
        with contextlib.suppress(OSError):
            os.killpg(self._process.pid, signal.SIGKILL)
        self._process.wait()
        for stream in (self._process.stdin, self._process.stdout):
            with contextlib.suppress(OSError):
                stream.close()  # type: ignore[union-attr]


def apart() -> tuple[str, ...]:
    """The words that start a process apart from network and other processes; none where refused."""
    if shutil.which("unshare") is None:
        return ()
    for words in APART:
        if subprocess.run([*words, "true"], capture_output=True, check=False).returncode == 0:
            return words
    return ()


def environment() -> dict[str, str]:
    """What the process finds in its environment: nothing that is the grader's business."""
    kept = ("PATH", "HOME", "LANG", "NUMBA_CACHE_DIR", "MPLCONFIGDIR", "SEGMAP_PLAIN")
    return {
        **{name: os.environ[name] for name in kept if name in os.environ},
        **{f"{name}_NUM_THREADS": "1" for name in SINGLE},
        "MPLBACKEND": "Agg",
        "PYTHONPATH": os.pathsep.join(str(package.parent) for package in PACKAGES),
        "PYTHONDONTWRITEBYTECODE": "1",
    }


class Pool:
    """Several servers, for several threads."""

    def __init__(self, tasks: Sequence[Task], limits: Limits, workers: int) -> None:
        self.limits, self.servers = limits, [Server(tasks, limits) for _ in range(workers)]
        self.locks = self.servers[0].locks
        self._free: queue.Queue[Server] = queue.Queue()
        for server in self.servers:
            self._free.put(server)

    def _run(self, task: Task, cases: Any, job: Mapping[str, Any]) -> dict[str, Any]:
        sent = base64.b64encode(pickle.dumps(cases)).decode()
        server = self._free.get()
        try:
            return server.run({"task": task.name, "cases": sent, **job})
        finally:
            self._free.put(server)

    def run(self, task: Task, cell: str, cases: Any) -> dict[str, Any]:
        """The report on a student's cell."""
        job = {"imports": task.imports, "cell": cell, "names": task.answers, "given": task.given}
        return self._run(task, cases, job)

    def judge(self, task: Task, answers: list[Any]) -> dict[str, Any]:
        """The report on numbers that should fool a method: the method runs on them, locked in too.

        No code of the student runs there, so that the verdict is the library's.
        """
        return self._run(task, {}, {"judge": answers})

    def __enter__(self) -> Pool:
        return self

    def __exit__(self, *_: object) -> None:
        for server in self.servers:
            server.close()


# ------------------------------------------------------------------------------ the verdict
def outcome(
    exercise: Any, cases: Any, report: Mapping[str, Any], limits: Limits
) -> Outcome | list[Any]:
    """Judge what a process sent: numbers are compared here, with what the library answers here.

    Answers to an open exercise come back as they are: `Pool.judge` takes them.
    """
    found = _read(report, limits)
    if isinstance(found, Outcome):
        return found
    answers = found.get("answers")
    if not isinstance(exercise, Exercise):
        return answers if isinstance(answers, list) else []
    try:
        check = exercise.verdict(answers, cases)  # type: ignore[arg-type]  # whatever it holds
    except Exception as error:  # answers of a student may be made to break this
        return Outcome("no answer", f"what came back is no answer ({type(error).__name__})")
    if check.passed:
        return Outcome("right", "passed", True)
    kind = "library" if "this is the library's" in check.hint else "wrong"
    return Outcome(kind, check.hint[:1000])


def judged(report: Mapping[str, Any], limits: Limits) -> Outcome:
    """What became of an open exercise, by a process in which no code of a student ran."""
    found = _read(report, limits)
    if isinstance(found, Outcome):
        return found._replace(reason=f"judging it: {found.reason}")
    right, hint = found.get("passed") is True, str(found.get("hint", ""))[:1000]
    return Outcome("right" if right else "wrong", hint or "passed", right)


def _read(report: Mapping[str, Any], limits: Limits) -> Outcome | dict[str, Any]:
    """What a process sent, or why there is nothing to judge."""
    if report["ended"] == "late":
        return Outcome("too long", f"stopped after {limits.seconds:g} s: a loop that does not end?")
    if report["ended"] == "much":
        return Outcome("too much", "it answered with megabytes: return what the task says")
    if report["status"] == -signal.SIGXCPU:
        return Outcome("too long", f"stopped after {limits.cpu} s of computing: an endless loop?")
    try:
        found = json.loads(report["text"])
    except (ValueError, RecursionError):
        status = report["status"]
        how = f"by signal {-status}" if status < 0 else "before it answered"
        return Outcome("ended", f"its process ended {how}: exit, kill, or too deep a recursion?")
    if not isinstance(found, dict):
        return Outcome("no answer", "what came back is no answer")
    return _fault(found) or found


def _fault(found: Mapping[str, Any]) -> Outcome | None:
    """A fault that the process tells of itself."""
    text = str(found.get("text", ""))[:500]
    answers = found.get("answers")
    listed = answers if isinstance(answers, list) else []
    errors = [answer.get("error") for answer in listed if isinstance(answer, dict)]
    if found.get("fault") == "memory" or "MemoryError" in errors:
        return Outcome("memory", "it asks for more memory than an answer may have")
    if "fault" not in found:
        return None
    kind = str(found["fault"])
    if kind not in FAULTS:
        return Outcome("no answer", f"it could not be run: {text}")
    return Outcome(kind, FAULTS[kind] + text)
