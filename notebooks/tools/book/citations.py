"""Who is cited: sections of the theses, and authors with a year, as links to references.md."""

import functools
import re
from collections.abc import Callable
from pathlib import Path

PAGE = Path(__file__).resolve().parents[3] / "docs" / "references.md"
#: "A 4.4.4": a section of a thesis.
SECTION = r"(?<![\w`*])(?P<thesis>[AB]) (?:\d(?:\.\d+)+|tables? \d[\d.]*)(?![\w`*])"
#: "Lu and Milios (1997": authors, and a year behind them.
AUTHORS = (
    r"(?<![\w`*])(?P<names>[A-Z][\w-]+(?:(?:, | and | & )[A-Z][\w-]+)*)(?: et al\.)?,? "
    r"\(?(?P<year>(?:19|20)\d\d)(?![\w`*])"
)
CITED = re.compile(f"{SECTION}|{AUTHORS}")


@functools.cache
def entries() -> dict[str, tuple[frozenset[str], str]]:
    """Label of each entry of the page -> its authors and its year."""
    found = re.findall(r"^\(([\w-]+)\)=\n### (.*) (\d{4})$", PAGE.read_text("utf-8"), re.MULTILINE)
    return {
        label: (_names(heading.partition(": ")[2] or heading), year)
        for label, heading, year in found
    }


def _names(text: str) -> frozenset[str]:
    return frozenset(re.findall(r"[A-Z][\w-]+", text.replace("Thesis ", "")))


def label_of(match: re.Match[str]) -> str | None:
    """The entry that is meant, or None."""
    if match["thesis"]:
        return f"thesis-{match['thesis'].lower()}"
    names, year = _names(match["names"]), match["year"]
    fits = [label for label, (known, when) in entries().items() if names <= known and year == when]
    return fits[0] if fits else None


def with_links(text: str, link: Callable[[str, str], str]) -> str:
    """A text in which each citation is what `link(words, label)` makes of it."""

    def linked(match: re.Match[str]) -> str:
        label = label_of(match)
        return match.group() if label is None else link(match.group(), label)

    return CITED.sub(linked, text)
