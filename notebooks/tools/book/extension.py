"""What Sphinx cannot do by itself: formulas without scripts, code that folds, sections' names."""

import html
import re
from typing import Any

from docutils import nodes
from latex2mathml.converter import convert
from sphinx.application import Sphinx
from sphinx.util import logging

from .citations import with_links

logger = logging.getLogger(__name__)
#: A cell with more lines is folded when a page is opened.
LONG = 8


def setup(app: Sphinx) -> dict[str, bool]:
    """Tell Sphinx of it."""
    from myst_nb.sphinx_ import HideCodeCellNode

    app.add_html_math_renderer("mathml", (_inline, None), (_block, None))
    app.add_node(HideCodeCellNode, override=True, html=(_open, _close))
    app.connect("autodoc-process-docstring", _tidy_docstring)
    app.connect("autodoc-skip-member", _skip_member)
    app.connect("doctree-resolved", _link_names)
    return {"parallel_read_safe": True, "parallel_write_safe": True}


def slug(title: str) -> str:
    """The name of a section in links: without its number, as a repository's page names it."""
    words = re.sub(r"^\d\d(?:\.\d+)+ ", "", title).strip().lower()
    return re.sub(r"[^\w\- ]", "", words).replace(" ", "-")


def formula(body: str, display: str = "inline") -> str:
    """A LaTeX formula as MathML, with the names that the converter does not know."""
    known = re.sub(r"\\operatorname\*?\{", r"\\mathrm{", body.strip())
    return convert(re.sub(r"\\arg(?![a-z])", r"\\mathrm{arg}", known), display=display)


def _shown(node: nodes.Element, display: str) -> str:
    """A formula as MathML; where it cannot be, it is told and stands as it was written."""
    try:
        shown = formula(node.astext(), display)
    except Exception as problem:  # whatever the converter makes of it
        shown = f"<code>{html.escape(node.astext())}</code>"
        logger.warning("formula %r: %r", node.astext(), problem, location=node)
    if "\\" in re.sub(r"<code>.*", "", shown):
        logger.warning("formula with an unknown name: %s", node.astext(), location=node)
    return shown


def _inline(self: Any, node: nodes.math) -> None:
    self.body.append(_shown(node, "inline"))
    raise nodes.SkipNode


def _block(self: Any, node: nodes.math_block) -> None:
    self.body.append(f'<div class="formula">{_shown(node, "block")}</div>')
    raise nodes.SkipNode


def _open(self: Any, node: nodes.Element) -> None:
    if "below-input" in node["classes"]:  # the output of a cell that answers a prediction
        self.body.append('<details class="reveal"><summary>Show the answer</summary>\n')
        return
    lines = node.astext().count("\n") + 1
    unfolded = "" if lines > LONG else " open"
    counted = "1 line" if lines == 1 else f"{lines} lines"
    self.body.append(f'<details class="code-fold"{unfolded}><summary>')
    self.body.append(f"<span>code, {counted}</span></summary>\n")


def _close(self: Any, node: nodes.Element) -> None:
    self.body.append("</details>\n")


def _link_names(app: Sphinx, tree: nodes.document, page: str) -> None:
    """`least_cost(...)` in a chapter leads to its entry, where one public name is meant."""
    if not page.startswith("notebooks/"):
        return
    entries = app.env.get_domain("py").objects  # type: ignore[attr-defined]
    known = by_short_name(entries)
    for node in list(tree.findall(nodes.literal)):
        name = re.sub(r"\(.*\)$", "", node.astext()).removeprefix("segmap.")
        if (full := known.get(name)) and not isinstance(node.parent, nodes.reference):
            place = app.builder.get_relative_uri(page, entries[full].docname)
            link = nodes.reference("", "", internal=True, refuri=f"{place}#{full}")
            node.replace_self(link)
            link += node


def by_short_name(entries: Any) -> dict[str, str]:
    """`reduction.fusion` and `fusion` -> `segmap.reduction.fusion`, unless two packages have one.

    The chapters call the course `course`.
    """
    full = [
        n for n in entries if re.fullmatch(r"segmap\.\w+\.\w+|segmap_course(\.literal)?\.\w+", n)
    ]
    known = {re.sub(r"^segmap\.|^segmap_course\.(?=literal)|^segmap_(?=c)", "", n): n for n in full}
    outer = [n for n in full if not n.startswith(("segmap_course.", "segmap.arrays."))]
    short: dict[str, list[str]] = {}
    for name in outer:
        short.setdefault(name.rpartition(".")[2], []).append(name)
    return known | {key: names[0] for key, names in short.items() if len(names) == 1}


def _skip_member(app: Sphinx, what: str, name: str, obj: Any, skip: bool, options: Any) -> Any:
    """The fields of a tuple are in its docstring: Python's own words for them say nothing."""
    return True if (obj.__doc__ or "").startswith("Alias for field number") else None


def _tidy_docstring(
    app: Sphinx, what: str, name: str, obj: Any, options: Any, lines: list[str]
) -> None:
    """Citations are linked; `.name` is an attribute of any class, and no link."""
    quoted = re.compile(r"(?:``[^`]*``|`[^`]*`)")
    text = quoted.sub(lambda m: re.sub(r"^`(\..*)`$", r"``\1``", m.group()), "\n".join(lines))
    lines[:] = text.splitlines()
    lines[:] = [line if ">>>" in line else with_links(line, _reference) for line in lines]


def _reference(words: str, label: str) -> str:
    return f":ref:`{words} <{label}>`"
