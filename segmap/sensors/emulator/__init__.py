"""An emulated URG-04LX, LD19 or RPLidar A1 behind a pseudo-terminal."""

from ._emulator import Emulator
from ._spinning import SpinningEmulator
from ._unit import Unit
from ._worlds import Room, furnished_room

__all__ = ["Emulator", "Room", "SpinningEmulator", "Unit", "furnished_room"]
