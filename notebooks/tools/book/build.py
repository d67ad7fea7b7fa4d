"""From sources to pages; a page that cannot be made becomes one that says so."""

import io
import os
import re
import shutil
from dataclasses import dataclass, field
from pathlib import Path

from .api import PACKAGES, write_api
from .commands import write_commands
from .sources import CHAPTERS, copy_sources, write_stub, write_summaries

HERE = Path(__file__).parent
#: So many pages may fail before something else must be wrong.
MOST_FAILURES = 5


@dataclass(frozen=True)
class Book:
    """Where the pages lie, and what is wrong with them."""

    folder: Path
    complaints: list[str] = field(default_factory=list)

    @property
    def index(self) -> Path:
        """The page that is opened first."""
        return self.folder / "index.html"

    @property
    def pages(self) -> list[Path]:
        """All pages."""
        return sorted(p for p in self.folder.rglob("*.html") if "_static" not in p.parts)


def build(
    folder: Path, *, chapters: list[Path] = CHAPTERS, packages: tuple[str, ...] = PACKAGES
) -> Book:
    """Write the book into a folder; what was there before goes.

    Sources and Sphinx' own notes lie beside it while it is built. A chapter that cannot be read, or
    that Sphinx fails on, is replaced by a page that says so: the others are not lost.
    """
    work = folder.with_name(f"{folder.name}-work")
    for old in (folder, work):
        shutil.rmtree(old, ignore_errors=True)
    sources = work / "sources"
    complaints = copy_sources(sources, chapters)
    write_api(sources / "api", packages)
    write_commands(sources / "commands")
    write_summaries(sources)
    for _ in range(MOST_FAILURES):
        page, said = _run(sources, work / "pages", work / "notes")
        if page is None:
            break
        complaints.append(f"{page}: {said}")
        write_stub(sources, page, said)
    else:
        raise RuntimeError("\n".join(["the book cannot be built:", *complaints]))
    complaints += [line for line in said.splitlines() if line.strip()]
    shutil.move(work / "pages", folder)
    shutil.rmtree(work)
    return Book(folder, complaints)


def _run(sources: Path, folder: Path, notes: Path) -> tuple[str | None, str]:
    """Run Sphinx: the page on which it failed or None, and what it said."""
    from sphinx.application import Sphinx

    os.environ.pop("SOURCE_DATE_EPOCH", None)
    warnings, at = io.StringIO(), {"page": ""}
    own = {"html_static_path": [str(HERE / "static"), str(sources / "_static")]}
    app = Sphinx(
        sources, HERE, folder, notes, "html", own, status=None, warning=warnings, parallel=1
    )
    app.connect("source-read", lambda app, page, source: at.update(page=page))
    app.connect("doctree-resolved", lambda app, tree, page: at.update(page=page))
    try:
        app.build()
    except Exception as problem:
        if not at["page"]:
            raise
        return at["page"], f"{type(problem).__name__}: {problem}"
    return None, _plain(warnings.getvalue(), sources)


def _plain(text: str, sources: Path) -> str:
    """Warnings without colours, with the places of the originals."""
    return re.sub(r"\x1b\[[\d;]*m", "", text).replace(f"{sources}{os.sep}", "")
