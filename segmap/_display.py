"""How scans, maps and reductions show themselves in a notebook."""

from __future__ import annotations

import base64
from functools import singledispatch
from typing import Any


class Pictured:
    """Gives an object its picture in a notebook, beside its `repr`.

    The picture comes from the function that is registered for its type in `picture`. Like every
    picture in a notebook file it is base64 text.
    """

    def _repr_mimebundle_(self, include: Any = None, exclude: Any = None) -> dict[str, Any]:
        png = base64.b64encode(picture(self)).decode("ascii")
        return {"text/plain": repr(self), "image/png": png}


@singledispatch
def picture(value: object) -> bytes:
    """A small PNG of an object.

    `segmap.plotting` registers a function for each type that it can draw; `segmap` registers one
    for all `Pictured` objects that first imports `segmap.plotting`. This room knows neither.
    """
    raise TypeError(f"no drawing is registered for {type(value).__name__}")
