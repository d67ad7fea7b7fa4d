"""A control of a chapter's panel changes something, on the data that the chapter gives it.

Where a control means nothing, as a threshold of another method, it is disabled: then it is not
asked. Live panels run a sensor and are tested elsewhere.
"""

import json
import re
from pathlib import Path

import matplotlib
import matplotlib.pyplot as plt
import pytest
from chapter_rules import CHAPTERS, code_cells
from driven_panels import controls, seen

pytestmark = pytest.mark.slow

#: What makes a panel in a cell.
MADE = re.compile(r"^(\w+) = \w+\.?(?!Live)\w*Panel\((?!\)\.)", re.MULTILINE)


def loaded(path: Path) -> list[str]:
    """Sources of the code cells of a chapter."""
    notebook = json.loads(path.read_text(encoding="utf-8"))
    return [source for _, source, _ in code_cells(notebook)]


WITH_PANELS = [path for path in CHAPTERS if any(MADE.search(s) for s in loaded(path))]


def others(control) -> list:
    """Values of a control that are not the one that it shows."""
    if hasattr(control, "options"):
        given = control.options.items() if isinstance(control.options, dict) else control.options
        known = [each[1] if isinstance(each, tuple) else each for each in given]
    elif hasattr(control, "min"):
        step = getattr(control, "step", 1) or 1
        known = [control.min, control.max, control.value + step, control.value - step]
    else:
        known = [False, True] if isinstance(control.value, bool) else []
    return [value for value in known if value != control.value]


def idle(panel) -> list[str]:
    """Names of the controls that can be moved, and change neither the picture nor a text.

    Where a panel has several methods, with each of them.
    """
    chooser = getattr(panel, "by", getattr(panel, "matcher", None))
    found = []
    for choice in [None] if chooser is None else chooser.options:
        for name, control in controls(panel).items():
            panel.reset()
            if choice is not None:
                chooser.value = choice
            if control.disabled or not (values := others(control)):
                continue
            start = seen(panel)[:2]
            for value in values:
                control.value = value
                if seen(panel)[:2] != start:
                    break
            else:
                found.append(" of ".join(filter(None, (name, choice))))
    panel.reset()
    return found


@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
@pytest.mark.parametrize("path", WITH_PANELS, ids=lambda path: path.stem)
def test_every_control_of_a_chapter_s_panel_changes_something(path, monkeypatch):
    """Catches a slider that the chapter's own data never answer, and one of another method."""
    matplotlib.use("Agg")
    monkeypatch.chdir(path.parent)
    known, sources = {"__name__": "chapter"}, loaded(path)
    last = max(k for k, source in enumerate(sources) if MADE.search(source))
    for source in sources[: last + 1]:
        exec(compile(source, path.name, "exec"), known)  # a chapter of ours
        plt.close("all")
        for name in MADE.findall(source):
            assert idle(known[name]) == [], f"{name} = {known[name]!r}"
