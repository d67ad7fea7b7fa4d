"""Logs of CARMEN and of the programs of its family: GMapping, DP-SLAM, Wean Hall, Player."""

from ._carmen import Carmen, parse_robotlaser
from ._family import DpSlam, GMapping, WeanHall
from ._player import Player

__all__ = [
    "CARMEN_FORMATS", "Carmen", "DpSlam", "GMapping", "Player", "WeanHall", "parse_robotlaser",
]  # fmt: skip

#: Of formats that claim as many lines the first is taken.
CARMEN_FORMATS = (Carmen, GMapping, Player, DpSlam, WeanHall)
