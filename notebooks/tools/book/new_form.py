"""Chapters in the new form: a field for the prediction, a folded answer, figures that are dragged.

A page that is opened from a file may load no module from another file. So the page carries the text
of each module, and `new_form.js` imports it from there.
"""

import html
import re

import segmap_course
from nbformat import NotebookNode

#: `steps_predicted = None  # steps`: the name, and the unit.
ASKED = re.compile(r"^\w+ = None *# *(.+)$", re.MULTILINE)


def adapt_cells(notebook: NotebookNode) -> None:
    """Adapt, in place, what is tagged `predict` or `reveal`, and the figures to drag."""
    modules: set[str] = set()
    for cell in notebook.cells:
        tags = cell.metadata.get("tags", [])
        if "predict" in tags:
            cell.update(cell_type="markdown", source=number_field(cell.source))
            for key in ("outputs", "execution_count"):
                cell.pop(key, None)
        if "reveal" in tags:
            cell.metadata["tags"] = [*tags, "hide-output"]
        for output in cell.get("outputs", []):
            data = output.get("data", {})
            if figure := data.get(segmap_course.FIGURE_MIME):
                name = figure["module"]
                text = "" if name in modules else module_script(name)
                modules.add(name)
                shown = f"{text}{figure_to_drag(name, figure['state'], data)}"
                output["data"] = NotebookNode({"text/html": shown})
                output["metadata"] = NotebookNode()


def number_field(source: str) -> str:
    """A field for one number, with its unit, in the place of the line that asks for it."""
    unit = html.escape("".join(ASKED.findall(source)[:1]))
    return (
        '<p class="predict"><label>Your prediction: '
        f'<input type="number" step="any" inputmode="decimal"> {unit}</label></p>'
    )


def module_script(name: str) -> str:
    """The text of a module, once a page."""
    text = segmap_course.module_text(name)
    return f'<script type="text/plain" id="figure-{name}">{text}</script>\n'


def figure_to_drag(name: str, state: str, data: NotebookNode) -> str:
    """The place of a figure; its picture stands there until the module has begun."""
    words, png = html.escape(data["text/plain"]), "".join(data["image/png"].split())
    return (
        f'<div class="drag-figure" data-module="figure-{name}" data-state="{html.escape(state)}">'
        f'<img alt="{words}" src="data:image/png;base64,{png}"></div>'
    )


def claim(notebook: NotebookNode) -> str:
    """The first paragraph of the summary of a chapter in the new form; else empty."""
    if not any("predict" in cell.metadata.get("tags", []) for cell in notebook.cells):
        return ""
    last: str = notebook.cells[-1].source
    return last.partition("\n\n")[2].partition("\n\n")[0].replace("\n", " ")
