"""The emulated sensor: a unit behind a pseudo-terminal."""

from __future__ import annotations

from typing import Any

from ._device import PluggedIn
from ._unit import Unit, World
from ._worlds import furnished_room


class Emulator(PluggedIn):
    """A sensor without hardware: `port` is the device to open.

    It needs Linux or macOS. A thread answers until `stop`, or the end of `with`.

    Parameters
    ----------
    world : World or None
        What it sees: `Room`, or any function from the number of a turn to the millimetres
        of all steps, `(769,)`; None for a furnished room.
    **settings
        Of the sensor itself: `protocol`, `rate`, `speed`, `clock` and `stamp`, as `Unit` says.

    Raises
    ------
    SensorError
        On Windows, which has no pseudo-terminals.

    Examples
    --------
    >>> from segmap.sensors import UrgSensor
    >>> with Emulator(speed=10) as emulator, UrgSensor(emulator.port) as sensor:
    ...     sensor.scan()  # doctest: +ELLIPSIS
    LaserScan(682 beams, ... valid, t=... s)
    """

    unit: Unit

    def __init__(self, world: World | None = None, **settings: Any) -> None:
        super().__init__(Unit(furnished_room() if world is None else world, **settings))
