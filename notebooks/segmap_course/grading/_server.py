"""A process that runs students' code, each answer in a child of its own; it holds no secret.

It loads the libraries once, and the compiled loops of the exercises; each answer is then a fork
that is locked in, killed when its time is over, and asked for nothing but bytes. The grader speaks
with it in lines of JSON: a job in, a report out. In a job the grader pickles the cases; what goes
back is plain answers, and never becomes code.
"""

from __future__ import annotations

import base64
import json
import os
import pickle
import select
import signal
import sys
import time
from contextlib import suppress
from typing import IO, Any, NoReturn

from ._answer import answer
from ._jail import Limits, Locks, available, lock

#: More bytes than this are no answer.
MOST_BYTES = 8 << 20
#: A child that has sent its answer may take so long to end, seconds.
LAST = 2.0


def serve(jobs: IO[str], reports: IO[str], apart: bool) -> None:
    """Answer each job until there are no more; the first line says which locks hold."""
    locks = available(apart)
    _say(reports, locks._asdict())
    for line in jobs:
        job = json.loads(line)
        if "warm" in job:
            _warm(job["warm"], job["imports"])
            _say(reports, {"warm": True})
        else:
            _say(reports, run(job, locks))


def _say(reports: IO[str], found: dict[str, Any]) -> None:
    reports.write(json.dumps(found) + "\n")
    reports.flush()


def _warm(names: list[str], imports: list[str]) -> None:
    """Import what the chapters import, and run each solution once, so that its loops are loaded.

    A locked process may start no thread, which some libraries do when they are loaded.
    """
    import scipy.linalg
    import scipy.optimize
    import scipy.spatial  # noqa: F401

    import segmap_course as course
    from segmap import simulation

    for source in imports:
        exec(source, {"__name__": "__main__"})
    simulation.cast_rays(simulation.rectangular_room(), (1, 1, 0), [0.0], max_range=9.0)
    for name in names:
        if name in course.EXERCISES:
            course.EXERCISES[name].expected()
        else:
            course.OPEN_EXERCISES[name].verdict([{"shape": [], "values": [0.0]}])
    _read_only_cache()


def _read_only_cache() -> None:
    """Let numba read the machine code on disk, and write none: its folder is not the student's."""
    with suppress(ImportError):
        from numba.core import caching as found

        caching: Any = found
        caching._CacheLocator.ensure_cache_path = _nothing
        caching.Cache.save_overload = _nothing


def _nothing(*_: Any) -> None:
    """Take the place of what would write."""


def run(job: dict[str, Any], locks: Locks) -> dict[str, Any]:
    """Run one job in a child: how it ended, and the text that it sent."""
    limits = Limits(*job["limits"])
    reader, writer = os.pipe()
    child = os.fork()
    if child == 0:
        _child(job, writer, limits, locks)
    os.close(writer)
    text, ended = _read(reader, time.monotonic() + limits.seconds)
    os.close(reader)
    status = _reap(child, ended)
    return {"text": text.decode("utf-8", "replace"), "ended": ended, "status": status}


def _child(job: dict[str, Any], writer: int, limits: Limits, locks: Locks) -> NoReturn:
    """Everything from here on happens in the child, which never returns."""
    try:
        os.setsid()
        os.chdir(job["folder"])
        _keep_only(writer)
        cases = pickle.loads(base64.b64decode(job["cases"]))
        lock(limits, locks)
        found = json.dumps(answer(job, cases))
        with open(writer, "w", encoding="utf-8") as out:
            out.write(found)
    except MemoryError:
        os.write(writer, b'{"fault": "memory", "text": ""}')
    except BaseException as error:
        said = json.dumps({"fault": "broken", "text": f"{type(error).__name__}: {error}"[:300]})
        with suppress(OSError):
            os.write(writer, said.encode())
    finally:
        os._exit(0)


def _keep_only(writer: int) -> None:
    """No input, no output and no file but the way back; of the environment, bounds on threads."""
    null = os.open(os.devnull, os.O_RDWR)
    for stream in (0, 1, 2):
        os.dup2(null, stream)
    os.closerange(3, writer)
    os.closerange(writer + 1, 1 << 16)
    for name in list(os.environ):
        if not name.endswith("_NUM_THREADS"):
            del os.environ[name]


def _read(reader: int, until: float) -> tuple[bytes, str]:
    """What a child sends, and how that ended: whole, too late or too much."""
    found, waiting = bytearray(), select.poll()
    waiting.register(reader, select.POLLIN | select.POLLHUP)
    while (left := until - time.monotonic()) > 0:
        if not waiting.poll(1000 * left):
            break
        piece = os.read(reader, 1 << 16)
        if not piece:
            return bytes(found), "whole"
        found += piece
        if len(found) > MOST_BYTES:
            return b"", "much"
    return b"", "late"


def _reap(child: int, ended: str) -> int:
    """Wait for a child, kill it and all that it started; minus the signal that ended it, or 0."""
    until = time.monotonic() + (LAST if ended == "whole" else 0.0)
    done, status = os.waitpid(child, os.WNOHANG)
    while not done and time.monotonic() < until:
        time.sleep(0.002)
        done, status = os.waitpid(child, os.WNOHANG)
    with suppress(ProcessLookupError, PermissionError):
        os.killpg(child, signal.SIGKILL)
    if not done:
        with suppress(ProcessLookupError):
            os.kill(child, signal.SIGKILL)
        _, status = os.waitpid(child, 0)
    return os.waitstatus_to_exitcode(status)


if __name__ == "__main__":
    serve(sys.stdin, sys.stdout, apart="apart" in sys.argv)
