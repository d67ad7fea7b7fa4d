"""How scans, maps and reductions show themselves in a notebook."""

import base64
import importlib
from typing import Any


class Pictured:
    """Gives an object its picture in a notebook, beside its `repr`.

    The picture is drawn by `segmap.plotting`, looked up only when a notebook asks, so that the
    lower rooms never import matplotlib. Like every picture in a notebook file it is base64 text.
    """

    def _repr_mimebundle_(self, include: Any = None, exclude: Any = None) -> dict[str, Any]:
        plotting = importlib.import_module("segmap.plotting")
        picture = base64.b64encode(plotting.thumbnail(self)).decode("ascii")
        return {"text/plain": repr(self), "image/png": picture}
