"""What all panels share: controls that redraw one picture and rewrite a few lines of text."""

from __future__ import annotations

from typing import Any

import ipywidgets as W
from matplotlib.figure import Figure

from ..plotting import figure_png

#: What a browser with a kernel shows instead of the picture.
VIEW = "application/vnd.jupyter.widget-view+json"

#: Pixels. A picture of another width than its box would be stretched and blurred.
WIDTH, HEIGHT, DPI = 480, 360, 72
#: What a browser is given is finer, for screens with two dots a pixel; what a file keeps is not.
FINER = 2


class Panel:
    """Controls bound to one drawing, and its still picture where no kernel runs.

    A subclass makes its controls, hands them to `_assemble`, and says in `_draw` what they mean.
    Controls and texts are attributes: `panel.tolerance.value = 0.06; panel.count.value`.
    """

    picture: Any
    _view: Any

    def _assemble(self, *rows: Any, width: int = WIDTH, height: int = HEIGHT) -> None:
        """Lay out rows of controls and texts above the picture, and draw for the first time."""
        self._size = width, height
        self.picture = W.Image(format="png", layout=W.Layout(width=f"{width}px"))
        boxes = [W.HBox(row) if isinstance(row, tuple) else row for row in rows]
        still = W.Layout(align_items="flex-start")
        self._view = W.VBox([*boxes, self.picture], layout=still)
        for row in rows:
            for control in row if isinstance(row, tuple) else (row,):
                if not isinstance(control, W.Label | W.Play):
                    control.observe(self._redraw, names="value")
        self._redraw()

    def _redraw(self, change: Any = None) -> None:
        self.picture.value = figure_png(self._drawn(), finer=FINER)

    def _drawn(self) -> Figure:
        figure = Figure((self._size[0] / DPI, self._size[1] / DPI), dpi=DPI, layout="constrained")
        self._draw(figure)
        return figure

    def _draw(self, figure: Figure) -> None:
        """Draw what the controls say, and rewrite the texts."""
        raise TypeError(f"{type(self).__name__} does not say how it draws")

    def _repr_mimebundle_(self, include: Any = None, exclude: Any = None) -> dict[str, Any]:
        """The live panel, and for readers without a kernel its picture and its text."""
        bundle: dict[str, Any] = dict(self._view._repr_mimebundle_())
        paints = type(self)._draw is Panel._draw  # by itself, as the live panel does
        still = bytes(self.picture.value) if paints else figure_png(self._drawn())
        return bundle | {"image/png": still, "text/plain": repr(self)}


def slider(name: str, value: float, least: float, most: float, step: float, unit: str = "m") -> Any:
    """A slider that redraws when it is released: a drawing takes longer than a movement."""
    kind, form = (W.IntSlider, "d") if isinstance(step, int) else (W.FloatSlider, _decimals(step))
    return kind(
        value=value,
        min=least,
        max=most,
        step=step,
        readout_format=form,
        description=f"{name} [{unit}]" if unit else name,
        continuous_update=False,
        layout=W.Layout(width="420px"),
        style={"description_width": "130px"},
    )


def player(moved: Any, interval: int = 250, step: int = 1) -> Any:
    """A play button that moves an integer slider by a step every so many milliseconds."""
    play = W.Play(min=moved.min, max=moved.max, step=step, interval=interval)
    W.jslink((play, "value"), (moved, "value"))
    return play


def text() -> Any:
    """A label as wide as the others beside it."""
    return W.Label(layout=W.Layout(width="235px"))


def _decimals(step: float) -> str:
    return f".{max(0, len(f'{step:.6f}'.rstrip('0').split('.')[1]))}f"
