"""An emulated URG-04LX or UST-10LX behind a pseudo-terminal or a TCP port, with faults."""

from ._emulator import Emulator
from ._spinning import SpinningEmulator
from ._unit import Unit
from ._worlds import Room, furnished_room

__all__ = ["Emulator", "Room", "SpinningEmulator", "Unit", "furnished_room"]
