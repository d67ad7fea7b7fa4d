"""How scans, maps and reductions show themselves in a notebook."""

import importlib
from typing import Any


class Pictured:
    """Gives an object its picture in a notebook, beside its `repr`.

    The picture is drawn by `segmap.plotting`, looked up only when a notebook asks, so that the
    lower rooms never import matplotlib.
    """

    def _repr_mimebundle_(self, include: Any = None, exclude: Any = None) -> dict[str, Any]:
        plotting = importlib.import_module("segmap.plotting")
        return {"text/plain": repr(self), "image/png": plotting.thumbnail(self)}
