"""A jail for one answer: bubblewrap around a process that holds no secret, with limits by prlimit.

Inside are Python and its packages, read-only; for an open exercise the library too. There is no
network, no file of the grader's, no other process but bubblewrap's own first one, under the same
limits and out of reach; of memory, time and processes what the limits leave, and of system calls
what an answer needs. As root the jail belongs to `nobody`: bubblewrap that is started by root would
keep its rights.
"""

from __future__ import annotations

import contextlib
import inspect
import json
import os
import select
import shlex
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any, NamedTuple

import matplotlib.font_manager as fonts

import segmap

from ..exercises import decode, encode
from ._filter import seccomp

PACKAGES = (Path(segmap.__file__).resolve().parent, Path(__file__).resolve().parents[1])
#: A reply with more bytes is no answer.
MOST_BYTES = 8 << 20
#: Bytes of the files that an answer may write, all in memory.
MOST_WRITTEN = 16 << 20
BUBBLEWRAP = (
    "bwrap --unshare-all --unshare-user --disable-userns --cap-drop ALL --new-session "
    f"--clearenv --die-with-parent --dev /dev --remount-ro /dev --size {MOST_WRITTEN} --tmpfs /tmp "
    "--seccomp 9"
).split()
#: Where matplotlib has its list of fonts. To make it takes seconds, and a thread in old versions.
FONTS = f"fontlist-v{fonts.FontManager.__version__}.json"
ENVIRONMENT = {
    **{f"{name}_NUM_THREADS": "1" for name in ("OPENBLAS", "OMP", "MKL", "NUMBA")},
    **{"HOME": "/tmp", "MPLCONFIGDIR": "/tmp", "MPLBACKEND": "Agg", "LANG": "C.UTF-8"},
    "LD_LIBRARY_PATH": f"{sys.base_prefix}/lib",  # without /proc `$ORIGIN/../lib` leads nowhere
}
#: What a process tells of a cell -> the words before its text.
FAULTS = {
    "syntax": "the cell is not Python: ",
    "raised": "the cell itself raises ",
    "missing": "",
    "memory": "it asks for more memory than an answer may have",
}
REFUSED = """\
no answer was run, since this system cannot keep a student's code in: {}.
Install bubblewrap 0.8 or later (Debian, Ubuntu: apt install bubblewrap), or grade in a container by
the command in notebooks/INSTRUCTOR.md; or, if you have read all of the code: --unprotected"""


class Limits(NamedTuple):
    """What one answer may take: seconds of the clock and of the processor, bytes of memory."""

    seconds: float = 30.0
    cpu: int = 10
    memory: int = 3 << 30


class Ended(Exception):
    """An answer that came to no end of its own: the kind of the end, and the reason."""


class Jail:
    """Starts jails, each with a process for one answer.

    Raises
    ------
    ValueError
        Where none can be had on this system; but `unprotected` starts the processes without.
    """

    def __init__(self, limits: Limits = Limits(), *, unprotected: bool = False) -> None:
        self.limits, self.bare = limits, False
        self._made = tempfile.TemporaryDirectory(prefix="segmap-jail-")
        self.folder = Path(self._made.name)
        self.folder.chmod(0o755)  # nobody finds the mounts there
        fonts.json_dump(fonts.fontManager, self.folder / FONTS)
        self.filter = self.folder / "filter"
        why = "there is no bubblewrap" if shutil.which("bwrap") is None else self._fault()
        self.bare = bool(why)
        if why and not unprotected:
            self._made.cleanup()
            raise ValueError(REFUSED.format(why))

    def __enter__(self) -> Jail:
        return self

    def __exit__(self, *_: object) -> None:
        self._made.cleanup()

    def _fault(self) -> str:
        """Why no jail starts here; empty where one does."""
        try:
            self.filter.write_bytes(seccomp())
        except ValueError as unknown:
            return str(unknown)
        words = self.command(["-c", "import numpy"], whole=False)
        found = subprocess.run(words, capture_output=True, text=True, check=False)
        return (found.stderr.strip() or "it fails")[-300:] if found.returncode else ""

    def __str__(self) -> str:
        return "none" if self.bare else "bubblewrap"

    def command(self, python: list[str], *, whole: bool) -> list[str]:
        """The words that start Python in a jail; `whole` with the library."""
        limits = [
            *("prlimit", f"--cpu={self.limits.cpu}:{self.limits.cpu + 1}"),
            *(f"--as={self.limits.memory}", "--nofile=64", f"--fsize={MOST_WRITTEN}", "--core=0"),
        ]
        alone = ["prlimit", "--nproc=1", sys.executable, "-I", *python]
        if self.bare:
            return [*limits, *alone] if shutil.which("prlimit") else alone[2:]
        script, words = "", [*limits, *BUBBLEWRAP]
        for number, path in enumerate(readable(whole)):
            seen = path
            if os.geteuid() == 0:  # nobody may have no way to it: Python below /root, for instance
                seen = str(self.folder / str(number))
                Path(seen).mkdir(exist_ok=True)
                script += f"mount --bind {shlex.quote(path)} {shlex.quote(seen)} && "
            words += ["--ro-bind", seen, path]
            if not whole:
                real = Path(path).resolve()  # /lib may be a link to /usr/lib
                inside = [p.relative_to(real) for p in PACKAGES if p.is_relative_to(real)]
                words += hidden([str(Path(path) / part) for part in inside])
        # What the course keeps for who teaches is no part of the library.
        words += hidden([str(Path(__file__).parent)]) if whole else []
        words += ["--ro-bind", str(self.folder / FONTS), f"/tmp/{FONTS}"] if whole else []
        for name, value in ENVIRONMENT.items():
            words += ["--setenv", name, value]
        words += ["--chdir", "/tmp", "--remount-ro", "/", *alone]
        nobody = "setpriv --reuid=65534 --regid=65534 --clear-groups " if os.geteuid() == 0 else ""
        script += f'exec {nobody}"$@" 9< {shlex.quote(str(self.filter))}'
        return [*(["unshare", "--mount"] if nobody else []), "sh", "-c", script, "sh", *words]


def hidden(paths: list[str]) -> list[str]:
    """The words that put nothing in the place of folders."""
    return [word for path in paths for word in ("--tmpfs", path, "--remount-ro", path)]


def readable(whole: bool) -> list[str]:
    """What Python reads when it imports something; `whole` with the library and its data."""
    roots = {"/usr", "/lib", "/lib64", sys.base_prefix, sys.prefix}
    roots |= {path for path in sys.path if path.endswith(("site-packages", "dist-packages"))}
    if whole:
        roots |= {str(path) for path in PACKAGES}
        roots |= {str(folder / "data") for folder in (PACKAGES[0], PACKAGES[0].parent)}
    return sorted(path for path in roots if Path(path).is_dir())


def answers(jail: Jail, job: Mapping[str, Any], cases: Iterable[tuple[Any, ...]]) -> list[Any]:
    """What a cell answers to each case, as plain values (see `exercises`).

    Raises
    ------
    Ended
        Where it does not answer them all, or the cell itself has a fault.
    """
    found: list[Any] = []
    with Session(jail, whole=job["package"] is None) as session:
        fault = session.ask({**job, "paths": [str(path.parent) for path in PACKAGES]})
        if fault is not None:
            kind, text = map(str, fault) if isinstance(fault, list) and len(fault) == 2 else "  "
            if kind not in FAULTS:
                raise Ended("no answer", "what came back is no answer")
            raise Ended(kind, f"{FAULTS[kind]}{text[:500]}")
        os.set_blocking(session.sent.fileno(), False)  # from here on it may choose not to read
        for arguments in cases:
            try:
                found.append(decode(session.ask(encode(arguments))))
            except ValueError:
                found.append({})  # which agrees with nothing
    return found


class Session:
    """A process that has a student's cell, and answers one case at a time."""

    def __init__(self, jail: Jail, *, whole: bool) -> None:
        self.limits = jail.limits
        self.until = time.monotonic() + self.limits.seconds
        self.held = b""
        path = os.environ.get("PATH", os.defpath)
        source = Path(inspect.getfile(encode)).read_text(encoding="utf-8")
        self.process = subprocess.Popen(
            jail.command(["-c", source], whole=whole),
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            cwd=jail.folder,
            env=ENVIRONMENT | {"PATH": path, "MPLCONFIGDIR": str(jail.folder)},
            start_new_session=True,
            bufsize=0,
        )
        assert self.process.stdin is not None and self.process.stdout is not None
        self.sent, self.got = self.process.stdin, self.process.stdout

    def __enter__(self) -> Session:
        return self

    def __exit__(self, *_: object) -> None:
        """End the process and all that it started."""
        with contextlib.suppress(OSError):
            os.killpg(self.process.pid, signal.SIGKILL)
        self.process.wait()
        self.sent.close()
        self.got.close()

    def ask(self, data: Any) -> Any:
        """Send a line and get the next one back.

        Raises
        ------
        Ended
            Where none came: too late, too long, or the process ended.
        """
        with contextlib.suppress(OSError):  # it has ended: why is asked below
            self.sent.write(json.dumps(data).encode() + b"\n")
        while b"\n" not in self.held:
            left = self.until - time.monotonic()
            if left <= 0 or not select.select([self.got], [], [], left)[0]:
                said = f"stopped after {self.limits.seconds:g} s: a loop that does not end?"
                raise Ended("too long", said)
            piece = os.read(self.got.fileno(), 1 << 16)
            self.held += piece
            if not piece:
                raise self._end()
            if len(self.held) > MOST_BYTES:
                raise Ended("too much", "it answered with megabytes: return what the task says")
        line, _, self.held = self.held.partition(b"\n")
        try:
            return json.loads(line)
        except (ValueError, RecursionError):
            return {}  # which is no value

    def _end(self) -> Ended:
        """Why the process has no more to say."""
        with contextlib.suppress(subprocess.TimeoutExpired):
            self.process.wait(2)
        status = self.process.returncode or 0
        ended = -status if status < 0 else status - 128
        if ended == signal.SIGXCPU:
            said = f"stopped after {self.limits.cpu} s of computing: an endless loop?"
            return Ended("too long", said)
        how = f"by signal {ended}" if ended > 0 else "before it answered"
        return Ended("ended", f"its process ended {how}: exit, kill, or too deep a recursion?")
