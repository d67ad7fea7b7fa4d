"""Locks around a student's code: user, files, network, other processes, memory, time.

`lock` is called in the process that is going to run it, after all imports, and cannot be undone
there. What a system does not offer is left out, and `locks` says so.
"""

from __future__ import annotations

import ctypes
import os
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import segmap

PACKAGES = (Path(segmap.__file__).parent, Path(__file__).parents[1])
#: The user of a student's code where the grader is root: nobody.
NOBODY = 65534
#: Open files, of which a student needs none; the size of a file that is written, in bytes.
MOST_OPEN, MOST_WRITTEN = 64, 0

# Linux: system calls (the same numbers on all machines that Python runs on) and their bits.
_CREATE, _ADD, _RESTRICT = 444, 445, 446
_NO_NEW_PRIVILEGES, _DUMPABLE, _KEEP_CAPABILITIES = 38, 4, 8
_EXECUTE, _READ_FILE, _READ_FOLDER = 1 << 0, 1 << 2, 1 << 3
#: Rights about files that the versions of Landlock from 1 on handle.
_FILE_RIGHTS = {1: (1 << 13) - 1, 2: (1 << 14) - 1, 3: (1 << 15) - 1, 5: (1 << 16) - 1}
#: Capability to read whatever the mode of a file says: Landlock says then what is read.
_READ_ANYTHING = 1 << 2


class Limits(NamedTuple):
    """What one answer may take: seconds of the clock and of the processor, bytes of memory.

    The memory is what comes on top of the libraries, which are loaded before.
    """

    seconds: float = 30.0
    cpu: int = 10
    memory: int = 1 << 30


class Locks(NamedTuple):
    """Which locks hold."""

    landlock: int
    user: bool
    apart: bool

    @property
    def files(self) -> bool:
        """Whether the grader's files are out of reach."""
        return self.landlock > 0 or self.user

    def __str__(self) -> str:
        """What holds and what does not, in words."""
        held = {
            "files are read-only, and none but Python's can be opened": self.landlock > 0,
            "another user (nobody)": self.user,
            "no network, no sight of other processes": self.apart,
            "limits on memory, time, files and processes": True,
        }
        missing = [words for words, holds in held.items() if not holds]
        said = "; ".join(words for words, holds in held.items() if holds)
        return said + (f". Not on this system: {'; '.join(missing)}" if missing else "")


def landlock_version() -> int:
    """The version of Landlock that the system has; 0 where it has none."""
    if not sys.platform.startswith("linux"):
        return 0
    return max(int(ctypes.CDLL(None).syscall(_CREATE, None, 0, 1)), 0)


def available(apart: bool) -> Locks:
    """The locks that this process can put on; `apart` tells whether it has namespaces already."""
    return Locks(landlock_version(), hasattr(os, "geteuid") and os.geteuid() == 0, apart)


def lock(limits: Limits, locks: Locks) -> None:
    """Put all locks on this process."""
    _limit(limits)
    if locks.user:
        _become_nobody(keep_reading=locks.landlock > 0)
    if sys.platform.startswith("linux"):
        ctypes.CDLL(None).prctl(_DUMPABLE, 0, 0, 0, 0)
        ctypes.CDLL(None).prctl(_NO_NEW_PRIVILEGES, 1, 0, 0, 0)
    if locks.landlock:
        _close_files(locks.landlock, readable())


def readable() -> list[str]:
    """What Python reads when it imports something, and nothing of the grader's own."""
    roots = {sys.prefix, sys.base_prefix, "/usr", "/lib", "/lib64", "/dev/null", "/dev/urandom"}
    packages = {path for path in sys.path if "site-packages" in path or "dist-packages" in path}
    data = {str(folder / "data") for folder in (PACKAGES[0], PACKAGES[0].parent)}
    found = {os.path.realpath(path) for path in roots | packages | data | set(map(str, PACKAGES))}
    return sorted(path for path in found if Path(path).exists())


def _limit(limits: Limits) -> None:
    """Bound what is used from now on. A process without the right to start one has no thread."""
    import resource  # which Windows does not have

    pages = Path("/proc/self/statm")
    used = int(pages.read_text().split()[0]) * resource.getpagesize() if pages.exists() else 0
    bounds = {
        "RLIMIT_AS": used + limits.memory if used else resource.RLIM_INFINITY,
        "RLIMIT_CPU": limits.cpu,
        "RLIMIT_FSIZE": MOST_WRITTEN,
        "RLIMIT_NOFILE": MOST_OPEN,
        "RLIMIT_CORE": 0,
        "RLIMIT_NPROC": 0,
    }
    for name, bound in bounds.items():
        # At the first bound on time the process gets a signal that tells it from others.
        later = bound + 1 if name == "RLIMIT_CPU" else bound
        resource.setrlimit(getattr(resource, name), (bound, later))


def _become_nobody(keep_reading: bool) -> None:
    """Another user, for good. Python may lie where only root reads; Landlock guards the rest."""
    libc = ctypes.CDLL(None, use_errno=True)
    if keep_reading:
        libc.prctl(_KEEP_CAPABILITIES, 1, 0, 0, 0)
    os.setgroups([])
    os.setresgid(NOBODY, NOBODY, NOBODY)
    os.setresuid(NOBODY, NOBODY, NOBODY)
    bits = _READ_ANYTHING if keep_reading else 0
    head = (ctypes.c_uint32 * 2)(0x20080522, 0)
    libc.capset(head, (ctypes.c_uint32 * 6)(bits, bits, 0, 0, 0, 0))


class _Ruleset(ctypes.Structure):
    _fields_ = (("files", ctypes.c_uint64), ("net", ctypes.c_uint64), ("scoped", ctypes.c_uint64))


class _Beneath(ctypes.Structure):
    _pack_ = 1
    _fields_ = (("rights", ctypes.c_uint64), ("folder", ctypes.c_int32))


def _close_files(version: int, paths: Sequence[str]) -> None:
    """Landlock: these paths may be read, no other; nothing may be written; no TCP, no signals.

    Raises
    ------
    OSError
        Where the system refuses: then nothing may run.
    """
    libc = ctypes.CDLL(None, use_errno=True)
    rights = max(bits for since, bits in _FILE_RIGHTS.items() if since <= version)
    rules = _Ruleset(rights, 3 if version >= 4 else 0, 3 if version >= 6 else 0)
    size = 24 if version >= 6 else 16 if version >= 4 else 8
    ruleset = _checked(libc.syscall(_CREATE, ctypes.byref(rules), size, 0))
    for path in paths:
        folder = os.open(path, os.O_PATH | os.O_CLOEXEC)
        allowed = _READ_FILE | (_EXECUTE | _READ_FOLDER if Path(path).is_dir() else 0)
        beneath = _Beneath(allowed, folder)
        _checked(libc.syscall(_ADD, ruleset, 1, ctypes.byref(beneath), 0))
        os.close(folder)
    _checked(libc.syscall(_RESTRICT, ruleset, 0))
    os.close(ruleset)


def _checked(result: int) -> int:
    if result < 0:
        number = ctypes.get_errno()
        raise OSError(number, f"this system refuses to close its files: {os.strerror(number)}")
    return result
