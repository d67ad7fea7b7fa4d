"""Inputs that fool the methods of the open exercises: for who teaches."""

#: Open exercise -> an expression for its answer, after `import numpy as np`.
INPUTS = {
    "break_reader": "[8.19, 8.2, 2.0, 3.0]",
    # A level wall of 2 m that passes near the origin, with 8 mm of noise.
    "break_line": "np.stack([np.linspace(2, 4, 41), 0.001 + 0.008 * (-1.0) ** np.arange(41)], 1)",
    # A wall of 6 m outside of the room.
    "break_quality": "[[(0, 0), (4, 0)], [(4, 0), (4, 3)], [(4, 3), (0, 3)], [(0, 3), (0, 0)], "
    "[(10, 10), (16, 10)]]",
    # Two walls without an end in sight.
    "break_matching": "[[(-15, -1), (15, -1)], [(-15, 1), (15, 1)]]",
    # Bars of 1 cm with gaps of 4 cm before a wall, and two places.
    "break_cells": "([*([(x, 1), (x + 0.01, 1)] for x in np.arange(-2, 2, 0.05)), "
    "[(-8, 4), (8, 4)]], [(0, 0), (0.5, 0)])",
    "break_fusion": "[[(0, 0), (3, 0)], [(0.5, 0.07), (2, 0.07)]]",
    "break_basic_order": (
        "[7, 1, 5, 2, 11, 14, 4, 19, 13, 3, 12, 8, 16, 15, 10, 0, 6, 18, 17, 9, 20]"
    ),
    "decide_map": '{"A": "keep", "B": "doubled", "C": "spread", "D": "tape"}',
    "decide_way": '{"K": "wall", "L": "long", "M": "keep", "N": "unknown"}',
    "break_icp": "[0.1, -0.57, -0.18]",
    # A bit that falls in one character and rises in the next.
    "break_sum": "(np.where(np.arange(63) == 1, 0x41, 0x40), "
    "np.where(np.arange(63) == 0, 0x41, 0x40))",
}
