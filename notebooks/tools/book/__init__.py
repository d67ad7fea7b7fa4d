"""The book: chapters, texts and API pages as web pages that need no network, made by Sphinx.

`sources` copies what is read and adapts the copies, `api` writes a page a package and `commands`
one a command, `conf.py` and `extension` tell Sphinx how it looks, and `build` runs it. No chapter
is run: what the book shows are the stored outputs, and for panels the pictures that
`panel_pictures.py` stored.
"""

from .build import Book, build
from .sources import Chapter, read_chapter

__all__ = ["Book", "Chapter", "build", "read_chapter"]
