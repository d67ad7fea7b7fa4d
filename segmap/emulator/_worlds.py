"""What an emulated sensor sees: a simulated room, driven through, or the scans of a capture."""

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .. import arrays
from ..arrays import Array, Segments
from ..error_codes import LOWEST, NEIGHBOURS_BAD, NOT_MEASURED, NOTHING_MET
from ..hokuyo import SensorError, parse_reply, parse_request, parse_scan
from ..simulation import URG_04LX, OdometryNoise, Sensor, box, drive, rectangular_room, simulate

#: From the number of a turn to the millimetres of all its steps, `(769,)`.
World = Callable[[int], NDArray[np.int64]]

#: Steps 0 to 768 can be asked for; those from 44 to 725 are measured.
STEPS, FIRST = 769, 44


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
        self.walls = arrays.segments(walls, "walls")
        self.path: Array = np.array(path, float).reshape(-1, 3)
        if not len(self.path):
            raise ValueError("path must hold at least one pose, (k, 3), got none")
        self.sensor = sensor
        self.rng = np.random.default_rng(1)
        self(0)  # loads what is compiled, before a sensor waits for it
        self.rng = np.random.default_rng(1) if rng is None else rng

    def pose(self, turn: int) -> Array:
        """Where the sensor is in a turn, `(3,)`, metres and radians."""
        last = len(self.path) - 1
        return self.path[last - abs(last - turn % (2 * last))] if last else self.path[0]

    def __call__(self, turn: int) -> NDArray[np.int64]:
        """Millimetres of all steps, `(769,)`."""
        pose, wheels = self.pose(turn)[None], OdometryNoise().ideal()
        log = simulate(self.walls, pose, sensor=self.sensor, rng=self.rng, odometry_noise=wheels)
        met = np.rint(1000 * log[0].ranges)
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
