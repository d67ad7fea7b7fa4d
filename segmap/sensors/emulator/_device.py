"""The lines that programs open, a pseudo-terminal or TCP, and all that goes wrong on them."""

from __future__ import annotations

import contextlib
import os
import re
import select
import socket
import threading
from collections.abc import Callable
from typing import NamedTuple, Protocol

import numpy as np

from .._protocol import SensorError

#: Faults of the wire, by name.
WIRE_FAULTS = ("flip", "lose", "stale", "stop", "silence", "unplug")
#: What a buffer may hold from before: the end of a scan and a piece of an answer.
STALE_BYTES = b"0AI0AI0AJ0AK\n\nGD00440\n00P\n"
#: Bytes read at once.
READ_PIECE_BYTES = 4096

_LISTEN_ADDRESS = re.compile(r"(?:(?:\[(?P<six>[^]]+)]|(?P<host>[^:]*)):)?(?P<port>[0-9]{1,5})")


class Speaker(Protocol):
    """A sensor without its wire: bytes in, bytes out."""

    def receive(self, data: bytes) -> None:
        """Take bytes of the host."""

    def transmit(self) -> bytes:
        """What it has to send by now."""


class Fault(NamedTuple):
    """A fault that happens after so many more bytes; silence lasts some seconds."""

    kind: str
    after: int
    seconds: float = 0.0


class Unplugged(Exception):
    """The wire was pulled out."""


class Wire:
    """Passes bytes on, and spoils them where it was told to; `rng` chooses which bit flips."""

    def __init__(self, clock: Callable[[], float], rng: np.random.Generator) -> None:
        self.clock, self.rng = clock, rng
        self.happened: list[str] = []
        self._planned: list[Fault] = []
        self._lock = threading.Lock()
        self._mute_until = -np.inf
        self._stopped = False

    def plan(self, fault: Fault) -> None:
        """Add a fault to those that will happen."""
        with self._lock:
            self._planned = sorted([*self._planned, fault], key=lambda f: f.after)

    def passed(self, data: bytes) -> bytes:
        """The bytes that arrive of those that are sent; or Unplugged."""
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
        """The bytes after a fault at the first of them."""
        self.happened.append(fault.kind)
        if fault.kind == "unplug":
            raise Unplugged
        if fault.kind == "flip":
            return bytes([data[0] ^ 1 << int(self.rng.integers(8))]) + data[1:]
        if fault.kind == "lose":
            return data[1:]
        if fault.kind == "stale":
            return STALE_BYTES + data
        if fault.kind == "silence":
            self._mute_until = self.clock() + fault.seconds
        self._stopped = self._stopped or fault.kind == "stop"
        return data

    def _quiet(self, data: bytes) -> bytes:
        """Nothing while the wire is silent, and nothing of the rest of a reply that stopped."""
        if self.clock() < self._mute_until:
            return b""
        if self._stopped:
            _, end, data = data.partition(b"\n\n")
            self._stopped = not end
        return data


class Terminal:
    """A pseudo-terminal that programs open as a serial port."""

    def __init__(self) -> None:
        if not hasattr(os, "openpty"):
            raise SensorError(
                "the emulator needs pseudo-terminals: Linux, macOS, or WSL; or tcp='0'"
            )
        #: What a program opens.
        self.name = ""
        self._ends: tuple[int, ...] = ()  # the emulator's, and the one that programs open

    def open(self) -> None:
        """Make the line."""
        import tty

        master, slave = os.openpty()
        tty.setraw(slave)
        os.set_blocking(master, False)
        self.name, self._ends = os.ttyname(slave), (master, slave)

    def close(self) -> None:
        """Cut it; a second call does nothing."""
        ends, self._ends = self._ends, ()
        for end in ends:
            os.close(end)

    def wait(self, seconds: float, *, writing: bool) -> None:
        """Until something comes, or can be written, at most so long."""
        select.select(self._ends[:1], self._ends[:1] if writing else (), (), seconds)

    def read(self) -> bytes:
        """What has come."""
        try:
            return os.read(self._ends[0], READ_PIECE_BYTES)
        except BlockingIOError:
            return b""

    def write(self, data: bytes) -> int:
        """How many of these bytes went."""
        try:
            return os.write(self._ends[0], data) if data else 0
        except BlockingIOError:
            return 0


class Listener:
    """A TCP port, used as a Terminal is, for one client at a time: others are turned away.

    What the sensor says while nobody is there is lost.
    """

    def __init__(self, address: str) -> None:
        match = _LISTEN_ADDRESS.fullmatch(address)
        if match is None or int(match["port"]) > 65535:
            raise ValueError(f"tcp must be [host:]port, such as '10940' or '0', got {address!r}")
        self._host, self._port = match["six"] or match["host"] or "127.0.0.1", int(match["port"])
        self._server: socket.socket | None = None
        self._client: socket.socket | None = None

    @property
    def name(self) -> str:
        host = f"[{self._host}]" if ":" in self._host else self._host
        return f"tcp://{host}:{self._port}"

    def open(self) -> None:
        family = socket.AF_INET6 if ":" in self._host else socket.AF_INET
        self._server = socket.create_server((self._host, self._port), family=family)
        self._server.setblocking(False)
        self._port = self._server.getsockname()[1]  # the same one when it is plugged in again

    def close(self) -> None:
        """Cut it; a second call does nothing."""
        self._drop()
        if self._server is not None:
            self._server.close()
            self._server = None

    def wait(self, seconds: float, *, writing: bool) -> None:
        ends = [end for end in (self._server, self._client) if end is not None]
        select.select(ends, ends[1:] if writing else [], [], seconds)

    def read(self) -> bytes:
        heard = b""
        if self._client is not None:
            try:
                heard = self._client.recv(READ_PIECE_BYTES)
                is_gone = not heard
            except BlockingIOError:
                is_gone = False
            except OSError:
                is_gone = True
            if is_gone:
                self._drop()
        if not heard:  # the last word of one who leaves is heard before the next one comes
            self._accept()
        return heard

    def write(self, data: bytes) -> int:
        if self._client is None:
            return len(data)
        try:
            return self._client.send(data) if data else 0
        except BlockingIOError:
            return 0
        except OSError:
            self._drop()
            return len(data)

    def _accept(self) -> None:
        if self._server is None:
            return
        with contextlib.suppress(OSError):  # none is there, or left again
            client, _ = self._server.accept()
            if self._client is not None:
                client.close()
                return
            client.setblocking(False)
            client.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            self._client = client

    def _drop(self) -> None:
        client, self._client = self._client, None
        if client is not None:
            client.close()
