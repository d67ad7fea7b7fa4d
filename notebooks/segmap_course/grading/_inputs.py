"""Inputs that fool the methods of the open exercises: for who teaches."""

#: Open exercise -> an expression for its answer, after `import numpy as np`.
INPUTS = {
    "break_reader": "[8.19, 8.2, 2.0, 3.0]",
    # Bars of 1 cm with gaps of 4 cm before a wall, and two places.
    "break_cells": "([*([(x, 1), (x + 0.01, 1)] for x in np.arange(-2, 2, 0.05)), "
    "[(-8, 4), (8, 4)]], [(0, 0), (0.5, 0)])",
    "decide_map": '{"A": "keep", "B": "doubled", "C": "verdict", "D": "tape"}',
    "decide_way": '{"K": "long", "L": "unknown", "M": "keep", "N": "wall"}',
    "break_icp": "[0.1, -0.57, -0.18]",
}
