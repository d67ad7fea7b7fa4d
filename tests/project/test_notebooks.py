"""Chapters are clean: every rule of `chapter_rules` on every chapter."""

import json

import chapter_rules as rules
import pytest
from chapter_rules import CHAPTERS, ROOT


def read(path):
    return json.loads(path.read_text(encoding="utf-8"))


@pytest.mark.parametrize("path", CHAPTERS, ids=lambda path: path.stem.partition("_")[0])
def test_chapter(path):
    assert [f"{rule.__name__}: {said}" for rule in rules.RULES for said in rule(read(path))] == []


def test_every_chapter_is_linked():
    """Catches a chapter that no reader finds."""
    names = {path.name for path in CHAPTERS}
    readme, syllabus = (
        rules.links((ROOT / n).read_text()) for n in ("README.md", "notebooks/SYLLABUS.md")
    )
    assert {f"notebooks/{name}" for name in names} <= set(readme) and names <= set(syllabus)
    assert "SYLLABUS.md" in rules.links(rules.markdown(read(CHAPTERS[0])))


@pytest.mark.parametrize("name", ["README.md", "environment.md", "data/malaga/README.md",
                                  "notebooks/SYLLABUS.md", "notebooks/INSTRUCTOR.md"])  # fmt: skip
def test_links_of_the_other_texts_resolve(name):
    here = ROOT / name
    assert [t for t in rules.links(here.read_text()) if not (here.parent / t).exists()] == []
