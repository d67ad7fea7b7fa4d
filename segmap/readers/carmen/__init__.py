"""Logs of CARMEN and of the programs of its family: GMapping, DP-SLAM, Wean Hall."""

from ._carmen import Carmen, parse_robotlaser
from ._family import DpSlam, GMapping, WeanHall

__all__ = ["CARMEN_FORMATS", "Carmen", "DpSlam", "GMapping", "WeanHall", "parse_robotlaser"]

#: Of formats that claim as many lines the first is taken.
CARMEN_FORMATS = (Carmen, GMapping, DpSlam, WeanHall)
