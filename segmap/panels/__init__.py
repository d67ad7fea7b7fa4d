"""Panels to play with in a notebook: a few controls bound to one drawing each.

They show their still picture where no kernel runs. Set a control from Python and read a text:
`panel.tolerance.value = 0.06; panel.count.value`.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ._base import Panel, player, slider, text
from ._compare import ComparePanel
from ._live import LivePanel
from ._scan import ScanPanel
from .controls import control

if TYPE_CHECKING:
    from ._plan_editor import PlanEditor

__all__ = [
    "ComparePanel", "LivePanel", "Panel", "PlanEditor", "ScanPanel", "control",
    "player", "slider", "text",
]  # fmt: skip


def __getattr__(name: str) -> Any:
    if name != "PlanEditor":
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from ._plan_editor import PlanEditor  # it alone needs anywidget and shapely

    return PlanEditor
