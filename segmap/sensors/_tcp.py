"""A sensor on Ethernet: its address, and a port that talks to it as a serial port would."""

from __future__ import annotations

import errno
import socket
from urllib.parse import urlsplit

#: Hokuyo's sensors listen at this port.
SENSOR_PORT = 10940
#: Bits a second of the line, Fast Ethernet; there is nothing to agree on.
ETHERNET = 100_000_000
#: Bytes taken from the network at once.
NETWORK_PIECE_BYTES = 1 << 16

_EXAMPLE = "tcp://192.168.0.10, tcp://192.168.0.10:10940 or tcp://[fe80::1%eth0]"


def is_address(device: str) -> bool:
    """Whether this is meant for an address and not for a serial port."""
    return device[:4].lower() == "tcp:"


def parse_address(address: str) -> tuple[str, int]:
    """Host and port of `tcp://host[:port]`.

    Examples
    --------
    >>> parse_address("tcp://192.168.0.10"), parse_address("tcp://[::1]:4000")
    (('192.168.0.10', 10940), ('::1', 4000))
    """

    try:
        url = urlsplit(address)
        host, port = url.hostname, SENSOR_PORT if url.port is None else url.port
    except ValueError:  # a port that is no number, brackets that do not end
        host, port = None, 0
    if not host or not port > 0 or url.netloc != address[len("tcp://") :]:
        raise ValueError(f"port {address[:60]!r} is no address of a sensor: write it as {_EXAMPLE}")
    return host, port


class TcpPort:
    """A connection with what `Port` asks for."""

    #: Seconds after which a read comes back with what there is, and a write fails.
    timeout, write_timeout = 0.02, 1.0

    def __init__(self, connection: socket.socket) -> None:
        connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self.baudrate = ETHERNET
        self._connection, self._kept = connection, b""

    @property
    def in_waiting(self) -> int:
        """Bytes that can be read at once; an OSError where the sensor closed the connection."""
        self._fill(0.0)
        return len(self._kept)

    def read(self, size: int = 1, /) -> bytes:
        """At most so many bytes, perhaps none."""
        self._fill(self.timeout)
        data, self._kept = self._kept[:size], self._kept[size:]
        return data

    def write(self, data: bytes, /) -> int:
        """Send bytes, all of them or an OSError."""
        self._connection.settimeout(self.write_timeout)
        self._connection.sendall(data)
        return len(data)

    def close(self) -> None:
        """Free the connection."""
        self._connection.close()

    def _fill(self, seconds: float) -> None:
        """Take what has come, where all that came before is read; wait for it so long."""
        if self._kept:
            return
        self._connection.settimeout(seconds)
        try:
            self._kept = self._connection.recv(NETWORK_PIECE_BYTES)
        except (BlockingIOError, TimeoutError) as error:
            if error.errno == errno.ETIMEDOUT:  # what was sent has not arrived for minutes
                raise
            return
        except ConnectionError:
            self._kept = b""
        if not self._kept:
            raise ConnectionError("it closed the connection; perhaps another program uses it")
