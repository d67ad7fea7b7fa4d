"""What all panels share: controls that redraw one picture and rewrite a few lines of text."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import ipywidgets as W
from matplotlib.figure import Figure

from ..plotting import figure_png
from ._view import View

#: What a browser with a kernel shows instead of the picture.
VIEW = "application/vnd.jupyter.widget-view+json"

#: Width of a picture, pixels.
PANEL_WIDTH = 480
#: Height of a picture, pixels.
PANEL_HEIGHT = 360
#: Dots an inch of a picture.
PANEL_DPI = 72
#: As wide as its cell the picture is shown, up to so many pixels, or as many as it has; and of the
#: height of the window it takes so many hundredths at most, so that panel and picture fit.
WIDEST_PICTURE, HIGHEST_PICTURE = 900, 60
#: Where there is room for both, from 800 pixels on, the controls stand beside it.
CONTROLS_FLEX = "1 1 340px"
#: The picture's part of such a row.
PICTURE_FLEX = "2 1 440px"
#: What a browser is given is finer, for screens with two dots a pixel; what a file keeps is not.
FINER = 2
#: Rows go on below where a window is narrow.
ROW = {"flex_flow": "row wrap", "max_width": "100%", "align_items": "center"}
#: What redraws nothing when its value changes.
ASIDE = (W.Label, W.Play, W.Button)
#: Letters of the longest name of a slider, at least: those of several panels then stand alike.
SLIDER_NAME_LETTERS = 18


class Panel:
    """Controls bound to one drawing, and its still picture where no kernel runs.

    A subclass makes its controls, hands them to `_assemble`, and says in `_draw` what they mean.
    Controls and texts are attributes: `panel.tolerance.value = 0.06; panel.count.value`.
    """

    picture: Any
    _view: Any

    def _assemble(self, *rows: Any, width: int = PANEL_WIDTH, height: int = PANEL_HEIGHT) -> None:
        """Lay out rows of controls and texts above the picture, and draw for the first time."""
        self._size, self._look = (width, height), View(self._paint, self.reset)
        parts = [part for row in rows for part in (row if isinstance(row, tuple) else (row,))]
        _fit_names(parts)
        boxes = [W.Box(row if isinstance(row, tuple) else (row,), layout=ROW) for row in rows]
        buttons = [W.Box(self._look.buttons, layout=ROW)] if self._paints() else []
        self.picture = W.Image(
            format="png",
            layout=W.Layout(
                width="100%",
                height="auto",
                max_width=f"min({min(WIDEST_PICTURE, FINER * width)}px, "
                f"{HIGHEST_PICTURE * width / height:.0f}vh)",
                margin="0",  # else it is wider than its box, which then scrolls
            ),
        )
        sides = [
            W.VBox(part, layout=W.Layout(flex=flex, min_width="0", max_width="100%"))
            for part, flex in ((boxes, CONTROLS_FLEX), ([self.picture, *buttons], PICTURE_FLEX))
        ]
        wrap = {"flex_flow": "row wrap", "align_items": "flex-start", "max_width": "100%"}
        self._view = W.Box(sides, layout=W.Layout(**wrap))
        self._players = [part for part in parts if isinstance(part, W.Play)]
        self._controls = [p for p in parts if hasattr(p, "value") and not isinstance(p, ASIDE)]
        self._remember()
        self._held = self._was_shown = False
        for control in self._controls:
            control.observe(self._redraw, names="value")
        self._redraw()

    def reset(self) -> None:
        """Set all controls as they were when the panel was first shown, and see the whole picture.

        A chapter's cell that moves the controls ends with it, so that the reader goes on from the
        start.
        """
        self._held = True
        try:
            for player in self._players:
                player.playing = False
            for control, value in self._at_first:
                control.value = value
        finally:
            self._held = False
        self._look.whole()
        self._redraw()

    def _remember(self) -> None:
        """Take what the controls say as the start, to which `reset` goes back."""
        self._at_first = [(control, control.value) for control in self._controls]

    def _redraw(self, change: Any = None) -> None:
        if not self._held:
            self._figure = self._look.take(self._new_figure())
            self._paint()

    def _paint(self) -> None:
        """Show the part of the drawing that is to be seen."""
        self.picture.value = figure_png(self._look.set(self._figure), finer=FINER)

    def _new_figure(self) -> Figure:
        figure = Figure(
            (self._size[0] / PANEL_DPI, self._size[1] / PANEL_DPI),
            dpi=PANEL_DPI,
            layout="constrained",
        )
        self._draw(figure)
        return figure

    def _paints(self) -> bool:
        """Whether the class draws figures; the live panel paints its picture by itself."""
        return type(self)._draw is not Panel._draw

    def _draw(self, figure: Figure) -> None:
        """Draw what the controls say, and rewrite the texts."""
        raise TypeError(f"{type(self).__name__} does not say how it draws")

    def _repr_mimebundle_(self, include: Any = None, exclude: Any = None) -> dict[str, Any]:
        """The live panel, and for readers without a kernel its picture and its text."""
        bundle: dict[str, Any] = dict(self._view._repr_mimebundle_())
        if not self._was_shown:
            self._remember()
            self._was_shown = True
        still = figure_png(self._new_figure()) if self._paints() else bytes(self.picture.value)
        return bundle | {"image/png": still, "text/plain": repr(self)}


def slider(name: str, value: float, least: float, most: float, step: float, unit: str = "m") -> Any:
    """A slider that redraws when it is released: a drawing takes longer than a movement."""
    digits = len(f"{step:.6f}".rstrip("0").split(".")[1])
    kind, form = (W.IntSlider, "d") if isinstance(step, int) else (W.FloatSlider, f".{digits}f")
    return kind(
        value=value,
        min=least,
        max=most,
        step=step,
        readout_format=form,
        description=f"{name} [{unit}]" if unit else name,
        continuous_update=False,
        layout=W.Layout(width="420px", max_width="100%"),
    )


def player(moved: Any, interval: int = 250, step: int = 1) -> Any:
    """A play button that moves an integer slider by a step every so many milliseconds."""
    play = W.Play(min=moved.min, max=moved.max, step=step, interval=interval)
    W.jslink((moved, "value"), (play, "value"))  # the browser begins with what the first one says
    return play


def text() -> Any:
    """A label as wide as the others beside it, or wider where its text is longer."""
    return W.Label(layout=W.Layout(min_width="235px", margin="2px 12px 2px 2px"))


def _fit_names(parts: Sequence[Any]) -> None:
    """Give the names of all sliders and lists of a panel the width of the longest one."""
    named = [part for part in parts if getattr(part, "description", "")]
    beside = [part for part in named if not isinstance(part, W.Checkbox | W.Button)]
    letters = max([SLIDER_NAME_LETTERS, *(1 + len(part.description) for part in beside)])
    for part in beside:
        part.style.description_width = f"{letters}ch"
        if not isinstance(part, W.ToggleButtons):
            part.layout.width = f"calc({letters}ch + 250px)"
    for box in (part for part in named if isinstance(part, W.Checkbox)):
        box.indent, box.layout.width, box.layout.margin = False, "auto", "2px 16px 2px 2px"
