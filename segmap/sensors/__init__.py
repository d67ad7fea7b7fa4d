"""Lasers on a serial port or Ethernet: Hokuyo's by their protocol SCIP, low-cost ones by `lds2d`.

From a terminal `segmap live` lists ports and models, and records what one measures.
"""

from ._host import Newest
from ._port import ports
from ._protocol import SensorError, checksum, decode, encode, parse_scan
from ._sensor import UrgSensor
from ._spinning import SpinningLaser, spinning_models

__all__ = [
    "Newest", "SensorError", "SpinningLaser", "UrgSensor", "checksum", "decode", "encode",
    "parse_scan", "ports", "spinning_models",
]  # fmt: skip
