"""Hokuyo sensors on a serial port or Ethernet: their protocol SCIP, a driver, a recorder.

`python -m segmap.hokuyo list`, `info` and `record` do the same from a terminal.
"""

from ._host import HostClock, Newest, host_time
from ._port import Lines, Port, PortInfo, SensorGone, find_port, open_port, ports
from ._protocol import (
    ScanRequest,
    SensorError,
    checksum,
    decode,
    encode,
    encode_reply,
    encode_reply_1,
    encode_scan,
    parse_request,
    parse_scan_1,
)
from ._record import record
from ._replies import (
    Geometry,
    Measurement,
    Reply,
    explain,
    info_line,
    laser_scan,
    parse_geometry,
    parse_info,
    parse_reply,
    parse_scan,
)
from ._sensor import UrgSensor

__all__ = [
    "Geometry",
    "HostClock",
    "Lines",
    "Measurement",
    "Newest",
    "Port",
    "PortInfo",
    "Reply",
    "ScanRequest",
    "SensorError",
    "SensorGone",
    "UrgSensor",
    "checksum",
    "decode",
    "encode",
    "encode_reply",
    "encode_reply_1",
    "encode_scan",
    "explain",
    "find_port",
    "host_time",
    "info_line",
    "laser_scan",
    "open_port",
    "parse_geometry",
    "parse_info",
    "parse_reply",
    "parse_request",
    "parse_scan",
    "parse_scan_1",
    "ports",
    "record",
]
