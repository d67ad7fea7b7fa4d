"""Serial ports of this computer: which hold a Hokuyo, and how to open one."""

import errno
from typing import Any, NamedTuple

from ._coding import SensorError
from ._line import LOST, Port

#: USB vendor of Hokuyo.
VENDOR = 0x15D1
#: A read comes back after this, seconds, with what there is.
READ = 0.02
#: A sensor that takes nothing for so long has gone, seconds.
WRITE = 1.0

_ADVICE = {
    errno.EACCES: "you may not use it: join the group that owns it, `dialout` on Debian and Ubuntu",
    errno.EPERM: "you may not use it: join the group that owns it, `dialout` on Debian and Ubuntu",
    errno.ENOENT: "it is not there: is the sensor plugged in? `python -m segmap.hokuyo list` tells",
    errno.EBUSY: "another program uses it: close that first",
    errno.EAGAIN: "another program uses it: close that first",
}


class Found(NamedTuple):
    """A serial port: its device, what it says of itself, and whether Hokuyo made it."""

    device: str
    description: str
    is_hokuyo: bool


def ports() -> list[Found]:
    """Serial ports of this computer, Hokuyo's first.

    Raises
    ------
    SensorError
        Without pyserial.
    """
    listed = _pyserial("serial.tools.list_ports").comports()
    found = [Found(p.device, str(p.description), p.vid == VENDOR) for p in listed]
    return sorted(found, key=lambda port: (not port.is_hokuyo, port.device))


def find_port() -> str:
    """The device of the one Hokuyo that is plugged in.

    Raises
    ------
    SensorError
        Where there is none, or more than one.
    """
    devices = [port.device for port in ports() if port.is_hokuyo]
    if len(devices) == 1:
        return devices[0]
    if devices:
        raise SensorError(f"{len(devices)} sensors are plugged in, name one of {devices}")
    raise SensorError(
        "no Hokuyo (USB vendor 15d1) is plugged in: plug it in and wait a few seconds; one on an "
        "RS-232 adapter must be named, as /dev/ttyUSB0 is"
    )


def open_port(device: str, rate: int) -> Port:
    """Open a serial port for oneself alone.

    Raises
    ------
    SensorError
    """
    serial = _pyserial("serial")
    settings = {"timeout": READ, "write_timeout": WRITE, "exclusive": True}
    try:
        opened: Port = serial.Serial(device, rate, **settings)
    except (*LOST, ValueError) as error:
        raise SensorError(f"cannot open {device}: {_advice(error)}") from error
    return opened


def _advice(error: BaseException) -> str:
    number = getattr(error, "errno", None)
    if "exclusively lock" in str(error):
        number = errno.EBUSY
    return _ADVICE.get(number, str(error)) if number is not None else str(error)


def _pyserial(module: str) -> Any:
    import importlib

    try:
        return importlib.import_module(module)
    except ImportError as error:
        raise SensorError("the port needs pyserial: pip install 'segmap[laser]'") from error
