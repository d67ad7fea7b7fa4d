"""The wire between sensor and host, and everything that goes wrong on it."""

import threading
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

#: Faults of the wire, by name.
FAULTS = ("flip", "lose", "stale", "stop", "silence", "unplug")
#: What a buffer may hold from before: the end of a scan and a piece of an answer.
STALE = b"0AI0AI0AJ0AK\n\nGD00440\n00P\n"


class Fault(NamedTuple):
    """A fault that happens after so many more bytes; silence lasts some seconds."""

    kind: str
    after: int
    seconds: float = 0.0


class Unplugged(Exception):
    """The wire was pulled out."""


class Wire:
    """Passes bytes on, and spoils them where it was told to.

    Parameters
    ----------
    clock : callable
        Seconds.
    rng : numpy.random.Generator
        Chooses which bit flips.
    """

    def __init__(self, clock: Callable[[], float], rng: np.random.Generator) -> None:
        self.clock, self.rng = clock, rng
        self.happened: list[str] = []
        self._planned: list[Fault] = []
        self._lock = threading.Lock()
        self._mute_until = -np.inf
        self._stopped = False

    def plan(self, fault: Fault) -> None:
        """Let a fault happen."""
        with self._lock:
            self._planned = sorted([*self._planned, fault], key=lambda f: f.after)

    def passed(self, data: bytes) -> bytes:
        """What arrives of some bytes.

        Raises
        ------
        Unplugged
        """
        arrived = b""
        with self._lock:
            while self._planned and self._planned[0].after < len(data):
                fault, *rest = self._planned
                arrived += self._quiet(data[: fault.after])
                data = self._struck(fault, data[fault.after :])
                self._planned = [f._replace(after=max(f.after - fault.after, 0)) for f in rest]
            self._planned = [f._replace(after=f.after - len(data)) for f in self._planned]
            return arrived + self._quiet(data)

    def _struck(self, fault: Fault, data: bytes) -> bytes:
        """The bytes from where the fault strikes."""
        self.happened.append(fault.kind)
        if fault.kind == "unplug":
            raise Unplugged
        if fault.kind == "flip":
            return bytes([data[0] ^ 1 << int(self.rng.integers(8))]) + data[1:]
        if fault.kind == "lose":
            return data[1:]
        if fault.kind == "stale":
            return STALE + data
        if fault.kind == "silence":
            self._mute_until = self.clock() + fault.seconds
        self._stopped = self._stopped or fault.kind == "stop"
        return data

    def _quiet(self, data: bytes) -> bytes:
        """Nothing while it is silent, or up to the end of a reply that stopped."""
        if self.clock() < self._mute_until:
            return b""
        if self._stopped:
            _, end, data = data.partition(b"\n\n")
            self._stopped = not end
        return data
