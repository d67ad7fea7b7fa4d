"""The emulated sensor, and what it sees: a simulated room, or the scans of a capture."""

from __future__ import annotations

import os
import time
import weakref
from collections.abc import Callable
from pathlib import Path
from types import TracebackType
from typing import Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import arrays
from ..arrays import Array, Segments
from ..error_codes import LOWEST, NEIGHBOURS_BAD, NOT_MEASURED, NOTHING_MET
from ..hokuyo import SensorError, parse_reply, parse_request, parse_scan
from ..simulation import (
    URG_04LX,
    OdometryNoise,
    Sensor,
    box,
    cast_rays,
    drive,
    rectangular_room,
    simulate,
)
from ._device import FAULTS, Device, Fault, Wire
from ._unit import FIRST, STEPS, Unit, World


class Emulator:
    """A URG-04LX without hardware: `port` is the device to open.

    For Linux and macOS. A thread answers until `stop`, the end of `with`, or until it is forgotten.

    Parameters
    ----------
    world : World or None
        What it sees: `Room`, `Replay`, or any function from the number of a turn to `(769,)`
        millimetres; None for a furnished room.
    protocol : "2.0", "1.1" or "1.1 only"
        What it speaks after power-up; the last has firmware that cannot switch.
    rate : int, bits a second
        That it is left at.
    usb : bool
        False makes it an RS-232 sensor: the rate must match and slows it down.
    speed : float
        Its seconds go by so much faster.
    clock : callable
        Seconds.
    stamp : int, milliseconds
        Its own clock at power-up; it wraps at 2 ** 24.
    streaming, timing : bool
        Left streaming, or in time mode, by a host that crashed.
    link : str or Path or None
        A symbolic link to make, which names the device, the same after `replug`.
    rng : numpy.random.Generator or None
        Of noise on the line.

    Raises
    ------
    SensorError
        On Windows, which has no pseudo-terminals.
    OSError
        Where the link cannot be made, or a file has its name.

    Examples
    --------
    >>> from segmap.hokuyo import UrgSensor
    >>> with Emulator(speed=10) as emulator, UrgSensor(emulator.port) as sensor:
    ...     sensor.scan()  # doctest: +ELLIPSIS
    LaserScan(682 beams, ... valid, t=... s)
    """

    def __init__(
        self,
        world: World | None = None,
        *,
        protocol: str = "2.0",
        rate: int = 19200,
        usb: bool = True,
        speed: float = 1.0,
        clock: Callable[[], float] = time.monotonic,
        stamp: int = 0,
        streaming: bool = False,
        timing: bool = False,
        link: str | Path | None = None,
        rng: np.random.Generator | None = None,
    ) -> None:
        if not hasattr(os, "openpty"):
            raise SensorError("the emulator needs pseudo-terminals: Linux, macOS, or WSL")
        self.unit = Unit(
            furnished_room() if world is None else world,
            protocol=protocol,
            rate=rate,
            usb=usb,
            speed=speed,
            clock=clock,
            stamp=stamp,
            streaming=streaming,
            timing=timing,
        )
        self.wire = Wire(
            time.monotonic, np.random.default_rng(1) if rng is None else arrays.generator(rng)
        )
        self._link = None if link is None else arrays.file(link, "link")
        self._device = Device(self.unit, self.wire, self._link)
        self._finalizer = weakref.finalize(self, self._device.stop)
        self._device.start()

    @property
    def port(self) -> str:
        """The device to open, or the link to it."""
        return str(self._link or self._device.name)

    def inject(self, kind: str, *, after: int = 0, seconds: float = 0.5) -> None:
        """Plan a fault.

        Parameters
        ----------
        kind : str
            Of the wire: "flip" a bit, "lose" a byte, "stale" bytes, "stop" in a reply, "silence",
            "unplug". Of the sensor: "status" 50 for each scan until `mend`, clock "wrap".
        after : int
            So many more bytes of the sensor pass before; faults of the sensor come at once.
        seconds : float
            Length of a silence.
        """
        arrays.whole(after, "after", least=0)
        arrays.number(seconds, "seconds", least=0)
        if kind == "status":
            self.unit.fail("Motor does not turn.")
        elif kind == "wrap":
            self.unit.wrap_clock()
        else:
            arrays.one_of(kind, "kind", (*FAULTS, "status", "wrap"))
            self.wire.plan(Fault(kind, after, seconds))

    def mend(self) -> None:
        """Repair the sensor: its scans are whole again."""
        self.unit.fail("")

    def unplug(self) -> None:
        """Pull the sensor out: the device vanishes."""
        self._device.stop()

    def replug(self) -> None:
        """Plug it in again; without `link` the device may have another name."""
        self._device.stop()
        self._device.start()

    def stop(self) -> None:
        """End the thread and free the device; nothing happens the second time."""
        self._finalizer()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        value: BaseException | None,
        traceback: TracebackType | None,
    ) -> None:
        self.stop()


class Room:
    """A sensor driven through a room, one pose a turn, to the end of its path and back again.

    Parameters
    ----------
    walls : (n, 2, 2) array, metres
    path : (k, 3) array, metres and radians
    sensor : Sensor
    rng : numpy.random.Generator
        Of the sensor's noise.

    Raises
    ------
    ValueError
        For a path without poses.

    Examples
    --------
    >>> room = Room(rectangular_room(4, 3), [(1, 1, 0)], URG_04LX.ideal())
    >>> room(0)[[384, 0]]  # straight ahead, and behind, where it does not measure
    array([3000,   19])
    """

    def __init__(
        self,
        walls: Segments,
        path: ArrayLike,
        sensor: Sensor = URG_04LX,
        rng: np.random.Generator | None = None,
    ) -> None:
        self.walls, self.path = arrays.segments(walls, "walls"), arrays.poses(path, "path")
        if not len(self.path):
            raise ValueError("path must hold at least one pose, (k, 3), got none")
        self.sensor = arrays.instance(sensor, "sensor", Sensor)
        self.rng = np.random.default_rng(1) if rng is None else arrays.generator(rng)
        cast_rays(self.walls, self.path[0], [0.0])  # compiles before a driver waits for it

    def pose(self, turn: int) -> Array:
        """Where the sensor is in a turn, `(3,)`, metres and radians."""
        turn = arrays.whole(turn, "turn", least=0)
        last = len(self.path) - 1
        return self.path[last - abs(last - turn % (2 * last))] if last else self.path[0]

    def __call__(self, turn: int) -> NDArray[np.int64]:
        """Millimetres of all steps, `(769,)`."""
        pose, still = self.pose(turn)[None], OdometryNoise().ideal()
        (scan,) = simulate(self.walls, pose, sensor=self.sensor, rng=self.rng, odometry_noise=still)
        met = np.rint(1000 * scan.ranges)
        found = np.where(met >= LOWEST, met, NEIGHBOURS_BAD)
        steps = np.full(STEPS, NOT_MEASURED)
        steps[FIRST : FIRST + len(met)] = np.where(np.isposinf(met), NOTHING_MET, found)
        return steps


class Replay:
    """The scans that a sensor sent while it was recorded, again and again.

    Parameters
    ----------
    capture : bytes
        What came from a sensor in SCIP 2.0; other replies are passed over.

    Raises
    ------
    SensorError
        Where a scan is damaged, or there is none.

    Examples
    --------
    >>> Replay(b"GD0383038401\\n00P\\nJUGnD\\n06805m`\\n\\n")(0)[383:386]
    array([392, 381,  19])
    """

    def __init__(self, capture: bytes) -> None:
        arrays.instance(capture, "capture", bytes)
        replies = (reply.strip(b"\n").split(b"\n") for reply in capture.split(b"\n\n"))
        self.turns = [_turn(lines) for lines in replies if _is_scan(lines)]
        if not self.turns:
            raise SensorError("the capture holds no scan of SCIP 2.0")

    def __call__(self, turn: int) -> NDArray[np.int64]:
        """Millimetres of all steps, `(769,)`."""
        return self.turns[turn % len(self.turns)]


def _is_scan(lines: list[bytes]) -> bool:
    return lines[0][:2] in (b"GD", b"GS", b"MD", b"MS") and len(lines) > 3


def _turn(lines: list[bytes]) -> NDArray[np.int64]:
    reply = parse_reply(lines)
    request = parse_request(reply.echo)
    met = parse_scan(reply.body, 3 if request.kind[1] == "D" else 2).millimetres
    steps = np.full(STEPS, NOT_MEASURED)
    steps[request.first : request.first + len(met)] = met
    return steps


def furnished_room() -> Room:
    """A room of 6 m by 4 m with a cupboard and a pillar, driven through at 0.2 m/s."""
    pillar, cupboard = box(0.4, 0.4, (4.2, 1.4, 0.3)), box(0.5, 1.2, (0.25, 2.6, 0))
    walls = np.concatenate([rectangular_room(6, 4), pillar, cupboard])
    way = [(1.2, 1.0), (3.2, 1.0), (3.2, 2.8), (5.0, 2.8)]
    return Room(walls, drive(way, step=0.02, turn=np.radians(3)))
