"""Logs of CARMEN and of the programs of its family: GMapping, DP-SLAM, Wean Hall, Player."""

from ._carmen import (
    parse_robotlaser,
)
