"""A URG-04LX that is not there: SCIP 1.1 and 2.0 behind a pseudo-terminal, faults on demand.

`python -m segmap.emulator` starts one and prints its device.
"""

from ._emulator import Emulator, Replay, Room, furnished_room
from ._unit import Unit

__all__ = ["Emulator", "Replay", "Room", "Unit", "furnished_room"]
