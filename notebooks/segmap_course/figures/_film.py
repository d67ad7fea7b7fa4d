"""A few frames that play twice: an animated PNG."""

from __future__ import annotations

import base64
import io
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any

import matplotlib.pyplot as plt
from matplotlib.figure import Figure
from PIL import Image

from segmap.plotting import figure_png

#: Frames of a film, and bytes of its file, at most.
FEWEST_FRAMES, MOST_FRAMES, MOST_FILM_BYTES = 6, 12, 30_000
#: Dots in a row for each dot on the page, and colours: the first with which the film is small.
_SIZES = ((2.0, 32), (1.5, 16), (1.25, 16), (1.0, 16), (1.0, 8))


@dataclass(frozen=True)
class Film:
    """An animated PNG that plays twice and ends with its last frame, which a still page shows."""

    png: bytes = field(repr=False)
    words: str
    frames: int
    width: int
    height: int

    def __repr__(self) -> str:
        return f"Film({self.words}: {self.frames} frames)"

    def _repr_mimebundle_(self, include: Any = None, exclude: Any = None) -> tuple[Any, Any]:
        shown = {"image/png": base64.b64encode(self.png).decode(), "text/plain": repr(self)}
        return shown, {"image/png": {"width": self.width, "height": self.height}}


def film(figures: Iterable[Figure], words: str, *, seconds: float = 0.7) -> Film:
    """A film of 6 to 12 figures of one size, each shown for some seconds; pyplot's are closed.

    `words` say what moves, for readers who cannot see it. One palette serves all frames; colours
    and then dots are fewer until the file has at most 30 000 bytes. A film ends when nothing moves
    any more: tests want that each frame differs from the one before in 2 % of what is not white.

    Raises
    ------
    ValueError
        For another number of frames, figures of several sizes, and figures with too much in them.

    Examples
    --------
    >>> def frame(k):
    ...     figure = Figure(figsize=(3, 2), dpi=72)
    ...     _ = figure.subplots().plot([0, k], [0, 1])
    ...     return figure
    >>> film((frame(k) for k in range(6)), "a line turns")
    Film(a line turns: 6 frames)
    """
    pictures = []
    for figure in figures:
        pictures.append(Image.open(io.BytesIO(figure_png(figure, finer=2))).convert("RGB"))
        plt.close(figure)
    if not FEWEST_FRAMES <= len(pictures) <= MOST_FRAMES:
        raise ValueError(
            f"a film has {FEWEST_FRAMES} to {MOST_FRAMES} frames, got {len(pictures)} figures"
        )
    if len({picture.size for picture in pictures}) > 1:
        raise ValueError("the figures of a film must have one size")
    width, height = (side // 2 for side in pictures[0].size)
    for dots, colours in _SIZES:
        png = _animated(pictures, (round(dots * width), round(dots * height)), colours, seconds)
        if len(png) <= MOST_FILM_BYTES:
            return Film(png, words, len(pictures), width, height)
    raise ValueError(
        f"{len(png)} bytes are left of these figures, more than {MOST_FILM_BYTES}: "
        "draw fewer of them, or less in each"
    )


def _animated(
    pictures: list[Image.Image], size: tuple[int, int], colours: int, seconds: float
) -> bytes:
    """The file, with the last frame as its still picture, and one palette for all."""
    width, height = size
    stacked = Image.new("RGB", (width, height * len(pictures)))
    for k, picture in enumerate(pictures):
        stacked.paste(picture.resize(size, Image.Resampling.LANCZOS), (0, k * height))
    drawn = stacked.quantize(
        colours, method=Image.Quantize.MAXCOVERAGE, kmeans=1, dither=Image.Dither.NONE
    )
    frames = [drawn.crop((0, k * height, width, (k + 1) * height)) for k in range(len(pictures))]
    file = io.BytesIO()
    frames[-1].save(
        file, "PNG", save_all=True, default_image=True, append_images=frames,
        duration=round(1000 * seconds), loop=2, optimize=True,
    )  # fmt: skip
    return file.getvalue()
