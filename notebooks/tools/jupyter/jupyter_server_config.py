"""How `make lab` starts: quietly, with the file browser folded; it saves a panel as its picture.

A panel lives in its kernel. Opened without that kernel, Lab would say "model not found" in place of
the panel, though its picture is stored beside it: Lab takes the panel, which ranks higher. So the
panel is left out of the file. The page that saves keeps it, and its controls go on.
"""

import json
import warnings
from typing import Any

from jupyterlab.commands import get_workspaces_dir
from jupyterlab_server.workspaces_handler import WorkspacesManager

VIEW = "application/vnd.jupyter.widget-view+json"

#: Where Lab keeps what was open, under the name of the first window, and how it is laid out then.
WINDOW = "default"
FOLDED = {"layout-restorer:data": {"main": {}, "left": {"collapsed": True, "widgets": []}}}


def fold_file_browser() -> None:
    """Lay Lab out with a folded file browser where it has not been opened before.

    A panel then has the width of a small screen to itself.
    """
    windows = WorkspacesManager(get_workspaces_dir())
    if not windows.load(WINDOW)["data"]:
        windows.save(WINDOW, json.dumps({"data": FOLDED, "metadata": {"id": WINDOW}}))


def keep_pictures(model: dict[str, Any], **given: Any) -> None:
    """Leave out, in place, of a notebook that is saved, each widget that has a picture."""
    if model["type"] == "notebook":
        for cell in model["content"]["cells"]:
            for output in cell.get("outputs", ()):
                if "image/png" in output.get("data", ()):
                    output["data"].pop(VIEW, None)


fold_file_browser()
c = get_config()  # type: ignore[name-defined]  # noqa: F821
c.FileContentsManager.pre_save_hook = keep_pictures
# traitlets sets a hook twice, and the second time Jupyter warns that it replaces the first.
warnings.filterwarnings("ignore", r"Overriding existing pre_save_hook \(keep_pictures\)")
# As an extension of the server, Voila sets the token in a way that Jupyter warns of. It is needed
# nowhere here: `make app` starts Voila as a program.
c.ServerApp.jpserver_extensions = {"voila.server_extension": False}
