"""`make book`: build the whole book under build/book, and name what is wrong with it."""

import sys
import time

from .build import build
from .sources import ROOT


def main() -> int:
    """Build; 1 where a page of the book is not as it should be."""
    begun = time.perf_counter()
    book = build(ROOT / "build" / "book")
    took = time.perf_counter() - begun
    print(f"{len(book.pages)} pages in {took:.0f} s: {book.index.relative_to(ROOT)}")
    for complaint in book.complaints:
        print(complaint, file=sys.stderr)
    return 1 if book.complaints else 0


if __name__ == "__main__":
    sys.exit(main())
