"""Hokuyo sensors on a serial port or Ethernet: their protocol SCIP, a driver, a recorder.

`segmap sensor list`, `info` and `record` do the same from a terminal.
"""

from ._host import Newest
from ._protocol import SensorError, checksum, decode, encode, parse_scan
from ._record import record
from ._sensor import UrgSensor

__all__ = [
    "Newest", "SensorError", "UrgSensor", "checksum", "decode", "encode", "parse_scan", "record",
]  # fmt: skip
