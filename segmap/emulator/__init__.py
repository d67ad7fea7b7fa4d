"""An emulated URG-04LX: SCIP 1.1 and 2.0 behind a pseudo-terminal, with faults on demand.

`python -m segmap.emulator` starts one and prints its device.
"""

from ._emulator import Emulator, Replay, Room, furnished_room
from ._unit import Unit

__all__ = ["Emulator", "Replay", "Room", "Unit", "furnished_room"]
