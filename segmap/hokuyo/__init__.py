"""The Hokuyo URG-04LX over a serial port: its protocol SCIP 1.1 and 2.0 as pure functions."""

from ._coding import SensorError, checksum, decode, encode

__all__ = ["SensorError", "checksum", "decode", "encode"]
