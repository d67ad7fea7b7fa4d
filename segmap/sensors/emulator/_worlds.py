"""The sensors that can be emulated, and the simulated room that they see."""

from __future__ import annotations

from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ... import arrays
from ...arrays import Array, Segments, checked
from ...scans.error_codes import (
    LOWEST,
    NEIGHBOURS_BAD_CODE,
    NOT_MEASURED_CODE,
    NOTHING_FAR,
    NOTHING_MET_CODE,
    UTM_TOO_NEAR_CODE,
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

ModelName = Literal["URG-04LX", "UST-10LX"]


class Model(NamedTuple):
    """A model of sensor.

    `version` and `limits` are its answers to VV and PP, `line` what II says of its line, empty for
    the bit rate; `steps` from 0 on can be asked for. It sends `nothing` where nothing is met,
    `near` where something is too near, and `unmeasured` for a step that it does not measure.
    """

    version: dict[str, str]
    limits: dict[str, str]
    line: str
    sensor: Sensor
    steps: int
    nothing: int
    near: int
    unmeasured: int

    @property
    def first(self) -> int:
        return int(self.limits["AMIN"])

    @property
    def last(self) -> int:
        return int(self.limits["AMAX"])

    @property
    def turn(self) -> float:
        """Seconds that it takes."""
        return 60.0 / int(self.limits["SCAN"])


def _version(product: str, firmware: str, protocol: str) -> dict[str, str]:
    first = {"VEND": "Hokuyo Automatic Co.,Ltd.", "PROD": f"SOKUIKI Sensor {product}"}
    return first | {"FIRM": firmware, "PROT": protocol, "SERI": "H0000000"}


def _limits(model: str, limits: str) -> dict[str, str]:
    return {"MODL": model, **dict(item.split(":") for item in limits.split())}


#: Steps 44 to 725 are measured; see SCIP 2.0 (Hokuyo C-42-03320B), tables 2 and 3.
_URG_MODEL = Model(
    _version("URG-04LX", "3.1.04(02/Aug./2007)", "SCIP 2.0"),
    _limits(
        "URG-04LX(Hokuyo Automatic Co.,Ltd.)",
        "DMIN:20 DMAX:5600 ARES:1024 AMIN:44 AMAX:725 AFRT:384 SCAN:600",
    ),
    "",
    URG_04LX,
    769,
    NOTHING_MET_CODE,
    NEIGHBOURS_BAD_CODE,
    NOT_MEASURED_CODE,
)
#: 1081 beams over 270 degrees, forty turns a second. Its data sheet promises 0.06 to 10 m on white
#: paper, to 30 m at best, and repeats to 30 mm; lost beams as for the URG-04LX.
_UST = Model(
    _version("UST-10LX", "1.0.0(01/Jan./2015)", "SCIP 2.2"),
    _limits("UST-10LX", "DMIN:20 DMAX:30000 ARES:1440 AMIN:0 AMAX:1080 AFRT:540 SCAN:2400"),
    "Ethernet 100 [Mbps]",
    Sensor(
        "Hokuyo UST-10LX",
        beams=1081,
        first=-540 * 2 * np.pi / 1440,
        step=2 * np.pi / 1440,
        max_range=30.0,
        min_range=0.060,
        sigma=0.010,
        resolution=0.001,
        dropout=0.01,
        grazing=float(np.radians(5)),
        period=0.025,
    ),
    1081,
    NOTHING_FAR,
    UTM_TOO_NEAR_CODE,
    NOTHING_FAR,
)
MODELS = {"URG-04LX": _URG_MODEL, "UST-10LX": _UST}


class Room:
    """A sensor driven through a room, one pose a turn, to the end of its path and back again.

    Parameters
    ----------
    walls : (n, 2, 2) array, metres
    path : (k, 3) array, metres and radians
    sensor : Sensor or None
        What it measures with; None for what the model does.
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
        sensor: Sensor | None = None,
        rng: np.random.Generator | None = None,
        *,
        model: ModelName = "URG-04LX",
    ) -> None:
        self.walls, self.path = arrays.segments(walls, "walls"), arrays.poses(path, "path")
        if not len(self.path):
            raise ValueError("path must hold at least one pose, (k, 3), got none")
        self.model, self._made = model, MODELS[model]
        chosen = self._made.sensor if sensor is None else sensor
        self.sensor = arrays.instance(chosen, "sensor", Sensor)
        most = self._made.steps - self._made.first
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
        """Millimetres of all steps, `(769,)` of a URG-04LX."""
        pose, still = self.pose(turn)[None], OdometryNoise().ideal()
        (scan,) = simulate(self.walls, pose, sensor=self.sensor, rng=self.rng, odometry_noise=still)
        met = np.rint(1000 * scan.ranges)
        ranges = np.where(met >= LOWEST, met, self._made.near)
        steps = np.full(self._made.steps, self._made.unmeasured)
        measured = slice(self._made.first, self._made.first + len(met))
        steps[measured] = np.where(np.isposinf(met), self._made.nothing, ranges)
        return steps


def furnished_room(model: ModelName = "URG-04LX") -> Room:
    """A room of 6 m by 4 m with a cupboard and a pillar, driven through, 2 cm a turn.

    That is 0.2 m/s with a URG-04LX, and 0.8 m/s with a UST-10LX.
    """
    pillar, cupboard = box(0.4, 0.4, (4.2, 1.4, 0.3)), box(0.5, 1.2, (0.25, 2.6, 0))
    walls = np.concatenate([rectangular_room(6, 4), pillar, cupboard])
    way = [(1.2, 1.0), (3.2, 1.0), (3.2, 2.8), (5.0, 2.8)]
    return Room(walls, drive(way, step=0.02, turn=np.radians(3)), model=model)
