"""How `make lab` starts quietly, and saves notebooks: a panel as its picture.

A panel lives in its kernel. Opened without that kernel, Lab would say "model not found" in place of
the panel, though its picture is stored beside it: Lab takes the panel, which ranks higher. So the
panel is left out of the file. The page that saves keeps it, and its controls go on.
"""

import warnings
from typing import Any

VIEW = "application/vnd.jupyter.widget-view+json"


def keep_pictures(model: dict[str, Any], **given: Any) -> None:
    """Leave out, in place, of a notebook that is saved, each widget that has a picture."""
    if model["type"] == "notebook":
        for cell in model["content"]["cells"]:
            for output in cell.get("outputs", ()):
                if "image/png" in output.get("data", ()):
                    output["data"].pop(VIEW, None)


c = get_config()  # type: ignore[name-defined]  # noqa: F821
c.FileContentsManager.pre_save_hook = keep_pictures
# traitlets sets a hook twice, and the second time Jupyter warns that it replaces the first.
warnings.filterwarnings("ignore", r"Overriding existing pre_save_hook \(keep_pictures\)")
# As an extension of the server, Voila sets the token in a way that Jupyter warns of. It is needed
# nowhere here: `make app` starts Voila as a program.
c.ServerApp.jpserver_extensions = {"voila.server_extension": False}
