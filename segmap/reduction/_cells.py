"""Grid cells as slots of a hash table, for loops that look for neighbours."""

from .._compiled import compiled


@compiled
def slot_of(column: int, row: int, slots: int) -> int:
    """Slot of the cell in a column and row of a grid, of `slots`, a power of two; some share one.

    Bounding the grid is not needed: a segment a kilometre away takes no memory. Cells of a column
    lie side by side, so that loops over rows inside columns find neighbours in the same cache line.
    """
    return (column * 73856093 + row) & (slots - 1)
