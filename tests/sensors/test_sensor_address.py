"""Addresses of sensors on Ethernet, and the port that talks to one; nothing leaves this machine."""

import contextlib
import errno
import socket
import threading
from functools import partial

import pytest

from segmap.sensors import SensorError, UrgSensor
from segmap.sensors._port import open_port
from segmap.sensors._tcp import TcpPort, parse_address


@pytest.mark.parametrize(
    ("address", "host", "port"),
    [
        ("tcp://192.168.0.10", "192.168.0.10", 10940),
        ("TCP://laser-2.local:1", "laser-2.local", 1),
        ("tcp://[::1]", "::1", 10940),
        ("tcp://[fe80::1%eth0]:65535", "fe80::1%eth0", 65535),
    ],
)
def test_addresses(address, host, port):
    assert parse_address(address) == (host, port)


@pytest.mark.parametrize(
    "address",
    [
        *("tcp://", "tcp:/h", "tcp://:10940", "tcp://h/", "tcp://[::1", "tcp://h:0"),
        *("tcp://h:65536", "tcp://h:-1", "tcp://h:x", "tcp://h:" + "9" * 5000),
    ],
)
def test_what_is_no_address(address):
    """Catches a traceback, and a port that wraps around."""
    for opened in (UrgSensor, partial(open_port, rate=1)):
        with pytest.raises(ValueError, match=r"port '.* is no address .*write it as tcp://192"):
            opened(address)


@pytest.mark.parametrize(
    ("fault", "why"),
    [
        (socket.gaierror(-2, "Name unknown"), r"nobody knows the host \(Name unknown\)"),
        (ConnectionRefusedError(errno.ECONNREFUSED, "x"), "nothing listens there: .*10940"),
        (TimeoutError("timed out"), "nothing answers there: is the sensor powered"),
        (OSError(errno.EHOSTUNREACH, "No route"), "is this computer in its network"),
        (OSError(errno.ENETUNREACH, "No network"), "is this computer in its network"),
        (UnicodeError("label too long"), "label too long"),
        (OSError(errno.EMFILE, "Too many open files"), "Too many open files"),
    ],
)
def test_who_cannot_be_reached(fault, why, monkeypatch):
    """Catches an error of the system that says neither where nor what to do."""

    def fail(address, timeout):
        assert address == ("laser", 4000) and timeout == 3.0
        raise fault

    monkeypatch.setattr(socket, "create_connection", fail)
    with pytest.raises(SensorError, match=f"cannot open tcp://laser:4000: .*{why}"):
        UrgSensor("tcp://laser:4000")


def port_at(connection):
    port = TcpPort.__new__(TcpPort)
    port._connection, port._kept = connection, b""
    port.timeout = port.write_timeout = 0.01
    return port


class Dead:
    """A line that the system gave up."""

    settimeout = staticmethod(lambda seconds: None)

    def recv(self, size):
        raise TimeoutError(errno.ETIMEDOUT, "Connection timed out")


def test_a_port_by_itself():
    """Catches bytes that are lost before the end is told, an end that is silence, and a hang."""
    here, there = socket.socketpair()
    port = port_at(here)
    assert (port.in_waiting, port.read(5)) == (0, b"")
    there.sendall(b"abcdef")
    assert (port.in_waiting, port.read(4), port.read(9), port.read()) == (6, b"abcd", b"ef", b"")
    with pytest.raises(OSError, match="timed out"):
        port.write(b"x" * 10_000_000)
    there.sendall(b"last")
    there.close()
    assert (port.read(1), port.in_waiting, port.read(9)) == (b"l", 3, b"ast")
    for ask in (port.read, lambda: port.in_waiting):
        with pytest.raises(OSError, match="closed the connection"):
            ask()
    port.close()
    port.close()
    with pytest.raises(OSError, match="Connection timed out"):
        port_at(Dead()).read()


@pytest.mark.parametrize("before", ["nothing", "a look", "a read"])
def test_a_port_waits_as_long_as_each_way_may_take(before):
    """Who writes waits for a slow reader, whatever was read before; who reads then waits, too.

    Catches a time that the call before has left behind.
    """
    here, there = socket.socketpair()
    here.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, 4096)
    port, got = port_at(here), []
    port.timeout, port.write_timeout = 0.05, 5.0

    def reads_slowly():
        threading.Event().wait(0.15)
        while sum(map(len, got)) < 1_000_000 and (piece := there.recv(1 << 16)):
            got.append(piece)
        threading.Event().wait(0.1)
        with contextlib.suppress(OSError):
            there.sendall(b"late")

    if before == "a look":
        assert port.in_waiting == 0
    elif before == "a read":
        assert port.read(1) == b""
    thread = threading.Thread(target=reads_slowly)
    thread.start()
    try:
        assert port.write(b"x" * 1_000_000) == 1_000_000
        assert port.in_waiting == 0  # at once
        port.timeout = 5.0
        assert port.read(4) == b"late"
    finally:
        port.close()
        thread.join()
        there.close()
