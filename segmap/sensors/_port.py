"""Ports of sensors, serial or by an address: found, checked and opened."""

from __future__ import annotations

import errno
import socket
from os import PathLike, fspath
from typing import Any, NamedTuple

from ..arrays import brief
from ..display import pip_install
from ._lines import PULLED_OUT_ERRORS, Port
from ._protocol import SensorError
from ._tcp import SENSOR_PORT, TcpPort, is_address, parse_address

#: USB vendor of Hokuyo.
VENDOR = 0x15D1
#: A read comes back after this, seconds, with what there is.
READ_S = 0.02
#: A sensor that takes nothing for so long has gone, seconds.
WRITE_S = 1.0
#: A sensor in the same network answers sooner, seconds.
CONNECT_S = 3.0

_FORBIDDEN = "you may not use it: join the group that owns it, `dialout` on Debian and Ubuntu"
_BUSY = "another program uses it: close that first"
_ABSENT = (
    "nothing answers there: is the sensor powered, is its cable in, is this computer in its "
    "network (192.168.0.x where nobody changed it)?"
)
_PORT_ADVICE = {
    errno.EACCES: _FORBIDDEN,
    errno.EPERM: _FORBIDDEN,
    errno.ENOENT: "it is not there: is the sensor plugged in? `segmap live` lists the ports"
    "; one on Ethernet is named as tcp://192.168.0.10",
    errno.EBUSY: _BUSY,
    errno.EAGAIN: _BUSY,
    errno.ECONNREFUSED: "nothing listens there: is it the sensor's address and port "
    f"({SENSOR_PORT} where nobody changed it), and is no other program connected to it?",
    errno.ETIMEDOUT: _ABSENT,
    errno.EHOSTUNREACH: _ABSENT,
    errno.ENETUNREACH: _ABSENT,
}


class PortInfo(NamedTuple):
    """A serial port: its device, its description, and whether Hokuyo made what is plugged in."""

    device: str
    description: str
    is_hokuyo: bool


def ports() -> list[PortInfo]:
    """Serial ports of this computer, Hokuyo's first; a SensorError without pyserial."""
    listed = _pyserial("serial.tools.list_ports").comports()
    available = [PortInfo(p.device, str(p.description), p.vid == VENDOR) for p in listed]
    return sorted(available, key=lambda port: (not port.is_hokuyo, port.device))


def find_port() -> str:
    """The device of the one Hokuyo that is plugged in."""
    devices = [port.device for port in ports() if port.is_hokuyo]
    if len(devices) == 1:
        return devices[0]
    if devices:
        raise SensorError(f"{len(devices)} sensors are plugged in, name one of {devices}")
    raise SensorError(
        "no Hokuyo (USB vendor 15d1) is plugged in: plug it in and wait a few seconds; one on "
        "Ethernet is named, as tcp://192.168.0.10"
    )


def checked_port(port: str | PathLike[str] | Port) -> str | Port:
    """A device, or an open port that does not wait for ever: pyserial's do unless told."""
    if isinstance(port, str | PathLike):
        device = fspath(port)
        if is_address(device):
            parse_address(device)
        return device
    if not callable(getattr(port, "read", None)):
        raise ValueError(
            f"port must be a device, 'auto', an address or an open port, got {brief(port)}"
        )
    if getattr(port, "timeout", 0.0) is None:
        raise ValueError("the port must have a timeout, as serial.Serial(device, timeout=0.02) has")
    return port


def open_port(device: str, rate: int) -> Port:
    """Open a serial port that no other program uses, and keep others from it; or an address."""
    address = parse_address(device) if is_address(device) else None
    try:
        if address is not None:
            return TcpPort(socket.create_connection(address, CONNECT_S))
        limits = {"timeout": READ_S, "write_timeout": WRITE_S, "exclusive": True}
        opened: Port = _pyserial("serial").Serial(device, rate, **limits)
        return opened
    except (*PULLED_OUT_ERRORS, ValueError) as error:
        number = errno.EBUSY if "exclusively lock" in str(error) else getattr(error, "errno", None)
        number = errno.ETIMEDOUT if isinstance(error, TimeoutError) else number
        advice = _PORT_ADVICE.get(number or 0, str(error))
        if isinstance(error, socket.gaierror):
            advice = f"nobody knows the host ({error.strerror}): check how it is written"
        raise SensorError(f"cannot open {device}: {advice}") from error


def _pyserial(module: str) -> Any:
    import importlib

    try:
        return importlib.import_module(module)
    except ImportError as error:
        raise SensorError(f"the port needs pyserial: {pip_install('laser')}") from error
