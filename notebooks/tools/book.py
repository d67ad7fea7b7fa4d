"""The chapters as linked web pages under build/book, readable without a network: `make book`.

Every chapter is run afresh. Pictures are embedded, formulas become MathML (which browsers draw
themselves), and no page loads a script, a style or a font from anywhere.
"""

import base64
import html
import re
import shutil
import sys
from pathlib import Path
from typing import Any

import nbformat
from jinja2 import pass_context
from latex2mathml.converter import convert
from nbconvert import HTMLExporter
from nbconvert.filters.markdown_mistune import IPythonRenderer, MarkdownWithMath
from pygments.formatters import HtmlFormatter
from refresh import VIEW, execute, tidy

ROOT = Path(__file__).resolve().parents[2]
STYLE = """
body { max-width: 52rem; margin: 2rem auto; padding: 0 1rem; line-height: 1.5;
  font-family: system-ui, sans-serif; color: #222; background: #fff; }
img { max-width: 100%; } table { border-collapse: collapse; }
td, th { padding: .2rem .6rem; border-bottom: 1px solid #ccc; text-align: left; }
.prompt { display: none; } .code_cell { margin: 1rem 0; } .output_area { margin: .4rem 0; }
.highlight, .md pre { background: #f5f5f5; border-left: 3px solid #bbb; padding: .1rem .8rem; }
pre { overflow-x: auto; font-size: .9rem; }
.anchor-link { color: #bbb; text-decoration: none; margin-left: .3rem; }
math[display="block"] { margin: 1rem 0; }
"""
PAGE = """<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{title}</title><style>{style}</style></head>
<body>{above}<main>{body}</main>{above}</body></html>
"""


def formula(body: str, display: str = "inline") -> str:
    """A LaTeX formula as MathML, with the names that the converter does not know."""
    known = re.sub(r"\\operatorname\*?\{", r"\\mathrm{", body.strip())
    return convert(re.sub(r"\\arg(?![a-z])", r"\\mathrm{arg}", known), display=display)


class Renderer(IPythonRenderer):
    """Markdown to HTML with formulas as MathML and pictures as data."""

    def block_math(self, body: str) -> str:
        """A formula on its own line."""
        return formula(body, "block")

    def inline_math(self, body: str) -> str:
        """A formula within a line."""
        return formula(body)

    def latex_environment(self, name: str, body: str) -> str:
        """A formula given as an environment, such as `align`."""
        return formula(f"\\begin{{{name}}}{body}\\end{{{name}}}", "block")

    def image(self, text: str, url: str, title: str | None = None) -> str:
        """A picture beside the text's own file, put into the page."""
        data = base64.b64encode((Path(self.path) / url).read_bytes()).decode()
        return f'<img src="data:image/png;base64,{data}" alt="{html.escape(text)}">'


class Exporter(HTMLExporter):
    """nbconvert's exporter, with our Markdown."""

    @pass_context
    def markdown2html(self, context: Any, source: str) -> str:
        """HTML of a Markdown cell."""
        return markdown(source, Path(context["resources"]["metadata"]["path"]))


def markdown(text: str, folder: Path) -> str:
    """HTML of a Markdown text that lies in a folder."""
    renderer = Renderer(escape=False, path=str(folder), anchor_link_text="#")
    return linked(MarkdownWithMath(renderer=renderer).render(text))


def linked(page: str) -> str:
    """The same page with its links to other pages of the book led there."""
    page = re.sub(r'href="(?:[^":]*/)?(\w+)/README\.md', r'href="\1.html', page)
    page = re.sub(r'href="(?:\.\./)*README\.md', 'href="index.html', page)
    return re.sub(r'href="(?:[^":]*/)?([\w-]+)\.(?:ipynb|md)(#[^"]*)?"', r'href="\1.html\2"', page)


def chapter(path: Path) -> str:
    """HTML of a chapter, run afresh."""
    notebook = tidy(execute(nbformat.read(path, as_version=4), path.parent))
    for cell in notebook.cells:
        for output in cell.get("outputs", []):
            output.get("data", {}).pop(VIEW, None)  # without a kernel: the static twin
    where = {"metadata": {"path": str(path.parent)}}
    return linked(Exporter(template_name="basic").from_notebook_node(notebook, where)[0])


def page(body: str, *, style: str, above: str = "") -> str:
    """A whole page around a body; its title is the first heading."""
    heading = re.search(r"<h1[^>]*>(.*?)(?:<a |</h1>)", body, re.DOTALL)
    title = re.sub(r"<[^>]+>", "", heading.group(1)) if heading else "segmap"
    return PAGE.format(title=title.strip(), style=style, above=above, body=body)


def build(folder: Path, chapters: list[Path]) -> list[Path]:
    """Write the book into a folder: an index, which is the README, and a page a chapter."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    style = STYLE + HtmlFormatter().get_style_defs(".highlight")
    texts = {"index" if p.stem == "README" else p.stem: p for p in sorted(ROOT.glob("*.md"))}
    texts |= {p.parent.name: p for p in sorted((ROOT / "data").glob("*/README.md"))}
    pages = {n: markdown(p.read_text(encoding="utf-8"), p.parent) for n, p in texts.items()}
    for path in chapters:
        pages[path.stem] = chapter(path)
    for name, body in pages.items():
        above = '<nav><a href="index.html">All chapters</a></nav>' if name != "index" else ""
        (folder / f"{name}.html").write_text(page(body, style=style, above=above), "utf-8")
    return [folder / f"{name}.html" for name in pages]


def main() -> int:
    """Build the book of all chapters."""
    chapters = sorted((ROOT / "notebooks").glob("*.ipynb"))
    pages: list[Any] = build(ROOT / "build/book", chapters)
    print(f"{len(pages)} pages, from {pages[0].relative_to(ROOT)}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
