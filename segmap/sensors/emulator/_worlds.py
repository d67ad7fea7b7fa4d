"""What an emulated URG-04LX says of itself, and the simulated room that it sees."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ... import arrays
from ...arrays import Array, Segments, checked
from ...scans.error_codes import (
    LOWEST_MM,
    NEIGHBOURS_BAD_CODE,
    NOT_MEASURED_CODE,
    NOTHING_MET_CODE,
)
from ...simulation import (
    URG_04LX,
    OdometryNoise,
    Sensor,
    box,
    cast_rays,
    drive,
    rectangular_room,
    simulate,
)

#: The answer to VV; see SCIP 2.0 (Hokuyo C-42-03320B), tables 2 and 3.
VERSION = {
    "VEND": "Hokuyo Automatic Co.,Ltd.",
    "PROD": "SOKUIKI Sensor URG-04LX",
    "FIRM": "3.1.04(02/Aug./2007)",
    "PROT": "SCIP 2.0",
    "SERI": "H0000000",
}
#: First and last step that are measured.
FIRST_STEP, LAST_STEP = 44, 725
#: Steps from 0 on that can be asked for.
STEPS = 769
#: Seconds that a turn takes.
TURN_S = 0.1
#: The answer to PP.
LIMITS = {
    "MODL": "URG-04LX(Hokuyo Automatic Co.,Ltd.)",
    "DMIN": "20",
    "DMAX": "5600",
    "ARES": "1024",
    "AMIN": str(FIRST_STEP),
    "AMAX": str(LAST_STEP),
    "AFRT": "384",
    "SCAN": str(round(60 / TURN_S)),
}


class Room:
    """A sensor driven through a room, one pose a turn, to the end of its path and back again.

    Parameters
    ----------
    walls : (n, 2, 2) array, metres
    path : (k, 3) array, metres and radians
    sensor : Sensor
        What it measures with.
    rng : numpy.random.Generator or None
        Of the sensor's noise.

    Examples
    --------
    >>> from segmap.simulation import URG_04LX
    >>> room = Room(rectangular_room(4, 3), [(1, 1, 0)], URG_04LX.ideal())
    >>> room(0)[[384, 0]]  # straight ahead, and behind, where it does not measure
    array([3000,   19])
    """

    @checked
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
        most = STEPS - FIRST_STEP
        if self.sensor.beams > most:
            raise ValueError(f"sensor must have at most {most} beams, got {self.sensor.beams}")
        self.rng = np.random.default_rng(1) if rng is None else rng
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
        ranges = np.where(met >= LOWEST_MM, met, NEIGHBOURS_BAD_CODE)
        steps = np.full(STEPS, NOT_MEASURED_CODE)
        measured = slice(FIRST_STEP, FIRST_STEP + len(met))
        steps[measured] = np.where(np.isposinf(met), NOTHING_MET_CODE, ranges)
        return steps


def furnished_room() -> Room:
    """A room of 6 m by 4 m with a cupboard and a pillar, driven through, 2 cm a turn: 0.2 m/s."""
    pillar, cupboard = box(0.4, 0.4, (4.2, 1.4, 0.3)), box(0.5, 1.2, (0.25, 2.6, 0))
    walls = np.concatenate([rectangular_room(6, 4), pillar, cupboard])
    way = [(1.2, 1.0), (3.2, 1.0), (3.2, 2.8), (5.0, 2.8)]
    return Room(walls, drive(way, step=0.02, turn=np.radians(3)))
