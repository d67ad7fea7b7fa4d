"""Panels to play with in a notebook: a few controls bound to one drawing each.

They show their still picture where no kernel runs. Set a control from Python and read a text:
`panel.tolerance.value = 0.06; panel.count.value`.
"""

from __future__ import annotations

from ._base import Panel, player, slider, text
from ._compare import ComparePanel
from ._live import LivePanel
from ._quadtree import QuadtreePanel
from ._scan import ScanPanel
from .controls import control

__all__ = [
    "ComparePanel", "LivePanel", "Panel", "QuadtreePanel", "ScanPanel", "control",
    "player", "slider", "text",
]  # fmt: skip
