"""Bags of ROS 1 and ROS 2."""

from segmap.readers.text import Binary, Parts

from ._bags import read, read_bag
from ._files import kind_of, recordings

__all__ = ["BAG", "kind_of", "read", "read_bag", "recordings"]

BAG = Binary("ROS bag", kind_of, read, Parts(recordings, read_bag))
