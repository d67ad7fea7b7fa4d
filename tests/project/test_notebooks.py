"""Chapters are clean: every rule of `chapter_rules` on every chapter, and on its own breach."""

import base64
import copy
import json
import re

import chapter_rules as rules
import pytest
from chapter_rules import CHAPTERS, ROOT


def read(path):
    return json.loads(path.read_text(encoding="utf-8"))


@pytest.mark.parametrize("path", CHAPTERS, ids=lambda path: path.stem.partition("_")[0])
def test_chapter(path):
    notebook = read(path)
    own = () if rules.in_the_new_form(notebook) else rules.OLD_FORM_RULES
    broken = [
        f"{rule.__name__}: {said}" for rule in (*rules.RULES, *own) for said in rule(notebook)
    ]
    assert broken == []


def test_most_assertions_are_out_of_sight():
    """Catches chapters whose reader wades through what only guards their text."""
    assert sum(rules.assertions_in_sight(read(path)) for path in CHAPTERS) <= 350


def test_there_are_chapters_and_all_have_a_number():
    """Catches a glob that misses chapters, and a notebook that hides in a subfolder."""
    inside = {p for p in (ROOT / "notebooks").rglob("*.ipynb") if "checkpoint" not in str(p)}
    assert CHAPTERS and inside == set(CHAPTERS)
    assert all(re.match(r"\d\d_[a-z0-9_]+\.ipynb$", path.name) for path in CHAPTERS)


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


def test_readme_picture_is_the_one_of_chapter_01():
    """Catches a README that shows the map of an older version."""
    notebook = read(CHAPTERS[0])
    tagged = [c for c in notebook["cells"] if "readme-picture" in c["metadata"].get("tags", [])]
    shown = [rules.lines_of(o["data"]["image/png"]) for o in tagged[0]["outputs"]]
    stored = (ROOT / "notebooks/pictures/malaga.png").read_bytes()
    assert [base64.b64decode(picture) for picture in shown] == [stored]


# ------------------------------------------------------------------ each rule sees its breach


def markdown_cell(text):
    return {"cell_type": "markdown", "metadata": {}, "source": text}


def code_cell(source, count, *outputs):
    ran = {"execution_count": count, "outputs": list(outputs)}
    return {"cell_type": "code", "metadata": {}, "source": source} | ran


def stream(text, name="stdout"):
    return {"output_type": "stream", "name": name, "text": text}


def shown(**data):
    kinds = {"png": "image/png", "plain": "text/plain", "page": "text/html"}
    named = {kinds[kind]: value for kind, value in data.items()}
    return {"output_type": "display_data", "metadata": {}, "data": named}


GOOD = {
    "metadata": {"kernelspec": {}, "language_info": {}},
    "cells": [
        markdown_cell("# 99 A chapter\n\nIt claims this."),
        code_cell("from segmap import course, panels\n1 + 1", 1, shown(plain="2")),
        markdown_cell("## What goes wrong\n\nThis."),
        code_cell("panel = panels.ScanPanel(log)\npanel", 2, shown(plain="ScanPanel(at 0.5 m)")),
        code_cell("panel.step.value = 3\nassert panel.index.value == '3'\npanel.reset()", 3),
        markdown_cell("## Exercise\n\nWrite it."),
        code_cell("def my_wrap(angle):\n    return angle", 4),
        code_cell(
            "course.check_wrap(my_wrap)", 5, shown(plain="not yet: 3.0 s and 5 cm are apart")
        ),
        markdown_cell("## Summary\n\n[on](01_start_here.ipynb), [back](../README.md)"),
    ],
}

BREACHES = [
    ("executed_in_order", lambda c: c[3].update(execution_count=None)),
    ("executed_in_order", lambda c: c.__delitem__(slice(1, 2))),
    ("no_errors", lambda c: put(c, {"output_type": "error", "ename": "ValueError"})),
    ("no_errors", lambda c: put(c, stream("Warning: old", "stderr"))),
    ("guards_are_folded", lambda c: c[4]["metadata"].update(tags=["guard"])),
    ("guards_are_folded", lambda c: fold(c[6])),
    ("guards_are_folded", lambda c: (fold(c[4]), c[4].update(outputs=[stream("1")]))),
    ("small", lambda c: put(c, stream("x" * 200_000))),
    ("small_pictures", lambda c: put(c, shown(png=base64.b64encode(b"x" * 30_001).decode()))),
    ("large_figures", lambda c: put(c, shown(plain="<Figure size 432x216 with 1 Axes>"))),
    ("large_figures", lambda c: put(c, shown(plain="<Figure size 320.4x288 with 2 Axes>"))),
    ("words_between", lambda c: c.__setitem__(slice(5, 5), [code_cell("1", 4)] * 3)),
    ("resets_its_panel", lambda c: c[4].update(source="panel.step.value = 3\nassert panel")),
    ("steady_outputs", lambda c: put(c, shown(plain="<Thing object at 0x7f3a5c0d>"))),
    ("steady_outputs", lambda c: put(c, shown(page=["<b>/home/me", "/log.gz</b>"]))),
    ("steady_outputs", lambda c: put(c, stream(r"C:\Users\me"))),
    ("steady_outputs", lambda c: put(c, stream("on 2026-11-21"))),
    ("steady_outputs", lambda c: put(c, stream("at 10:02:33"))),
    ("steady_outputs", lambda c: put(c, stream("took 0.3 s"))),
    ("steady_outputs", lambda c: put(c, stream("14.2 ms"))),
    ("nothing_forbidden", lambda c: c[1].update(source="from segmap import *")),
    ("nothing_forbidden", lambda c: c[1].update(source="%pip install segmap")),
    ("nothing_forbidden", lambda c: c[1].update(source="!ls")),
    ("nothing_forbidden", lambda c: c[1].update(source="run(['pip', 'install', 'x'])")),
    ("nothing_forbidden", lambda c: c[1].update(source="urlopen(address)")),
    ("shadows_no_builtin", lambda c: c[1].update(source="map = build_map(log)")),
    ("shadows_no_builtin", lambda c: c[6].update(source="def my_length(map):\n    return 1")),
    (
        "shadows_no_builtin",
        lambda c: c[1].update(source="%matplotlib inline\n[len(max) for max in maps]"),
    ),
    ("shadows_no_builtin", lambda c: c[1].update(source="from tools import gone as sum")),
    ("short_plotting", lambda c: c[1].update(source="ax.plot(x)\n" * 6)),
    ("short_plotting", lambda c: c[1].update(source="y = ax.set(\n    title=t,\n)\n" * 2)),
    ("short_plotting", lambda c: c[1].update(source="for ax in row:\n    ax.plot(x)\n" * 3)),
    ("short_cells", lambda c: c[1].update(source=["x = 1\n"] * 16)),
    ("defines_nothing_twice", lambda c: c[6].update(source="def wrap(angle):\n    return angle")),
    ("links_resolve", lambda c: c[2].update(source="## What goes wrong\n[x](98_gone.ipynb)")),
    ("has_claim", lambda c: c[0].update(source="# 99 A chapter\n")),
    ("has_claim", lambda c: c[0].update(source="No title\n\nIt claims this.")),
    ("has_summary", lambda c: c.pop()),
    ("has_summary", lambda c: c[-1].update(source="## Summary\n\n[back](../README.md)")),
    ("shows_what_goes_wrong", lambda c: c[2].update(source="## What goes well")),
    ("has_exercise", lambda c: c[5].update(source="## More")),
    ("has_exercise", lambda c: c[7].update(source="course")),
    ("has_driven_panel", lambda c: c[3].update(source="panel")),
    ("has_driven_panel", lambda c: c[4].update(source="panel.step.value = 3\npanel.reset()")),
    ("has_driven_panel", lambda c: c[4].update(source="assert panel.index.value\npanel.reset()")),
]


EVERY_RULE = (*rules.RULES, *rules.OLD_FORM_RULES)


def fold(cell):
    cell["metadata"] = {"tags": ["guard"], "jupyter": {"source_hidden": True}}


def put(cells, output):
    cells[1]["outputs"].append(output)


def test_a_clean_chapter_passes():
    """Catches a rule that nothing can meet."""
    assert [rule.__name__ for rule in EVERY_RULE if rule(GOOD)] == []


@pytest.mark.parametrize(
    ("name", "breach"), BREACHES, ids=lambda value: value if isinstance(value, str) else "breach"
)
def test_a_breach_is_seen_by_its_rule_alone(name, breach):
    """Catches a rule that passes silently, and one that complains of something else."""
    notebook = copy.deepcopy(GOOD)
    breach(notebook["cells"])
    complaining = {rule.__name__ for rule in EVERY_RULE if rule(notebook)}
    assert name in complaining
    assert complaining <= {name, "executed_in_order"}


def test_every_rule_has_a_breach():
    assert rules.no_widget_state(GOOD | {"metadata": {"widgets": {}}})
    tried = {name for name, _ in BREACHES} | {"no_widget_state"}
    assert tried == {rule.__name__ for rule in EVERY_RULE}
