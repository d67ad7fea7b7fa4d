"""Fusion of a map, with its tolerance on a slider."""

from matplotlib.figure import Figure

from ..metrics import grade_quality, grade_reduction, quality, reduction_rate
from ..panels import Panel, slider, text
from ..plotting import draw_before_after
from ..reduction import Reduction, fusion
from ..segments import SegmentMap


class FusionPanel(Panel):
    """A map and its fusion: how much is gained and what it costs, for each tolerance (A 4.4).

    Parameters
    ----------
    map : SegmentMap
    tolerance : float, metres
        Half-width of the strip, at first.

    Attributes
    ----------
    tolerance : slider, metres
    count, rate, quality : labels
    reduction : Reduction
        What is drawn.

    Examples
    --------
    >>> panel = FusionPanel(SegmentMap([[(0, 0), (1, 0)], [(0, 0.1), (1, 0.1)]]))
    >>> panel.count.value
    '2 of 2 segments left'
    >>> panel.tolerance.value = 0.06
    >>> panel.count.value
    '1 of 2 segments left'
    """

    reduction: Reduction

    def __init__(self, map: SegmentMap, *, tolerance: float = 0.04) -> None:
        self.map = map
        self.tolerance = slider("tolerance", tolerance, 0.01, 0.20, 0.01)
        self.count, self.rate, self.quality = text(), text(), text()
        self._assemble(self.tolerance, self.count, (self.rate, self.quality))

    def _draw(self, figure: Figure) -> None:
        self.reduction = fusion(self.map, tolerance=self.tolerance.value)
        rate = reduction_rate(self.map, self.reduction)
        kept = quality(self.map, self.reduction)
        self.count.value = f"{len(self.reduction)} of {len(self.map)} segments left"
        self.rate.value = f"reduction {rate:.1%}: {grade_reduction(rate)}"
        self.quality.value = f"quality {kept:.1%}: {grade_quality(kept)}"
        draw_before_after(self.map, self.reduction, ax=figure.subplots())

    def __repr__(self) -> str:
        return f"FusionPanel(tolerance {self.tolerance.value:.2f} m: {self.count.value})"
