"""What the figures to drag share: a module, a state, and a still picture of it."""

from __future__ import annotations

import base64
import json
from pathlib import Path
from typing import Any

import anywidget
import matplotlib.pyplot as plt
from matplotlib.axes import Axes

from segmap.plotting import axes_or_new, figure_png

#: Under this type the output of a cell holds the name of the module and the state, which the book
#: needs: the state is one text, so that nbval compares it.
FIGURE_MIME = "application/vnd.segmap.figure+json"
_FOLDER = Path(__file__).parent


def module_text(name: str) -> str:
    """The ES module of a figure: what all of them share, then its own."""
    return "".join((_FOLDER / f"{file}.js").read_text("utf-8") for file in ("drag", name))


class DragFigure(anywidget.AnyWidget):
    """A figure whose parts are dragged by mouse, finger or arrow keys, in Lab and in the book.

    A subclass names its `module`, a file beside this one, as `_esm = module_text(module)`; its
    state are the traits with `sync=True`, made of numbers, texts and lists: directions as angles,
    since a rounded normal is no unit vector. It draws its still picture in `draw(ax)`, and its
    `__repr__` says what the figure measures. Its module measures the same: both are compared on
    ten states by `tests/course/form/test_figures.py`, to 1e-9.

    With a kernel each trait follows what is dragged (`figure.pose`); without one, in the book, the
    state moves by itself.
    """

    #: Name of the ES module, without `.js`.
    module: str

    def state(self) -> dict[str, Any]:
        """What the module is given: every trait of the subclass by its name."""
        every = set(self.trait_names(sync=True)) - set(anywidget.AnyWidget.class_traits(sync=True))
        return {name: getattr(self, name) for name in sorted(every) if name[0] != "_"}

    def draw(self, ax: Axes) -> None:
        """Draw the still picture."""
        raise NotImplementedError

    def _repr_mimebundle_(self, **kwargs: Any) -> tuple[dict[str, Any], dict[str, Any]]:
        bundle, metadata = super()._repr_mimebundle_(**kwargs) or ({}, {})
        ax = axes_or_new(None)
        self.draw(ax)
        figure = ax.get_figure(root=True)
        assert figure is not None
        width, height = (round(inches * figure.dpi) for inches in figure.get_size_inches())
        png = base64.b64encode(figure_png(figure, finer=2)).decode()
        plt.close(figure)
        state = json.dumps(self.state(), separators=(",", ":"))
        shown: dict[str, Any] = {"text/plain": repr(self), "image/png": png}
        shown[FIGURE_MIME] = {"module": self.module, "state": state}
        return bundle | shown, metadata | {"image/png": {"width": width, "height": height}}
