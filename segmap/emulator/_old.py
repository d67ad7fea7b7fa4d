"""SCIP 1.1, as the sensor speaks it after power-up: no check sums, one character of status."""

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from ..hokuyo import encode, encode_reply_1

VERSION = (
    "VEND:Hokuyo Automatic Co.,Ltd.",
    "PROD:SOKUIKI Sensor URG-04LX",
    "FIRM:3.1.04,07/08/02(20-4095[mm],240[deg],44-725[step],600[rpm])",
    "PROT:00003,(SCIP 1.0)",
    "SERI:H0000000",
)


class Turning(Protocol):
    """What the old protocol needs of the unit."""

    laser: bool
    old: "OldProtocol | None"

    def turn(self) -> int:
        """Number of the last finished turn."""

    def world(self, turn: int, /) -> NDArray[np.int64]:
        """Millimetres of all steps."""


class OldProtocol:
    """Answers in SCIP 1.1, until it is asked to switch.

    Parameters
    ----------
    unit : Turning
    switches : bool
        Whether its firmware knows SCIP 2.0.
    """

    def __init__(self, unit: Turning, switches: bool) -> None:
        self.unit, self.switches = unit, switches
        unit.laser = True

    def answer(self, text: str) -> bytes:
        """The reply to a request."""
        if text == "SCIP2.0" and self.switches:
            self.unit.old, self.unit.laser = None, False
            return encode_reply_1(text, "0")
        if text == "V":
            return encode_reply_1(text, "0", [line.encode("ascii") for line in VERSION])
        if text in ("L0", "L1"):
            already = self.unit.laser == (text == "L1")
            self.unit.laser = text == "L1"
            return encode_reply_1(text, "E" if already else "0")
        if len(text) == 9 and text[0] == "G" and text[1:].isdigit():
            return self._scan(text)
        return encode_reply_1(text, "E")

    def _scan(self, text: str) -> bytes:
        first, last, cluster = int(text[1:4]), int(text[4:7]), max(int(text[7:]), 1)
        if not first <= last <= 768:
            return encode_reply_1(text, "E")
        met = self.unit.world(max(self.unit.turn(), 0))[first : last + 1 : cluster]
        data = encode(np.minimum(met, 4095), 2)
        return encode_reply_1(text, "0", [data[i : i + 64] for i in range(0, len(data), 64)])
