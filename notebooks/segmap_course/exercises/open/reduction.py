"""An open exercise on reduced maps: an input that fools a method."""

from __future__ import annotations

import numpy as np

from segmap.arrays import Array
from segmap.reduction import basic_online
from segmap.segments import SegmentMap

from ._open import Challenge


# ------------------------------------------------------------------------------------- Basic
def _basic_fooled(order: Array) -> str:
    if order.shape != (21,) or not np.array_equal(np.sort(order), np.arange(21)):
        raise ValueError("give each of the numbers 0 to 20 once, in the order of your choice")
    y = 0.1 * order
    shelves = np.stack([np.stack([0 * y, y], 1), np.stack([0 * y + 3, y], 1)], 1)
    count = len(basic_online(SegmentMap(shelves, np.arange(21))))
    return "" if count >= 8 else f"Basic leaves {count} segments, 8 at least are wanted"


break_basic_order = Challenge(
    "break_basic_order(order): an order, (21,), of the shelves 0 to 20 of chapter 14, 0.10 m "
    "apart, one a scan, of which Basic on-line leaves at least 8 segments; from 0 to 20 it leaves "
    "one",
    _basic_fooled,
    praise="The same segments and eight times as many left: the order is part of the result",
)
