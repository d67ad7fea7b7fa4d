"""Bags of ROS 1 and ROS 2."""

from .._text import Binary
from . import _bags
from ._bags import read_bag

BAG = Binary("ROS bag", _bags.claims, _bags.read)
