"""What is chosen on the workbench as a session, by the names of the options of `segmap map`."""

from __future__ import annotations

import inspect
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import ipywidgets as W
from traitlets import TraitError

from ... import readers
from ...arrays import declared
from ...readers import Session, read_session
from ...scans import Log
from ._choices import NONE, Choices

#: What is chosen, and how the options of its thresholds begin.
BEGIN = {"align": "align_", "extract": "extract_", "method": "", "second": "second_"}


def session_of(choices: Choices, log: Log, runs: Sequence[Mapping[str, Any]]) -> Session:
    """A session of all that is chosen, with the runs so far; of a second method too."""
    settings: dict[str, Any] = {}
    for kind, begin in BEGIN.items():
        if (call := getattr(choices, kind).call()) is None:
            continue
        settings[kind] = call.name
        said, usual = declared(call.function), inspect.signature(call.function).parameters
        for name, value in call.thresholds.items():
            if value != usual[name].default:
                number = isinstance(value, float)
                settings[begin + name] = float(f"{said[name].read(value):.6g}") if number else value
    if choices.least.value:
        settings["filter"] = choices.least.value
    if choices.people.value:
        settings["seen_through"] = choices.people.value
    if not choices.deskew.value:
        settings["no_deskew"] = True
    return Session(log, settings, runs, choices.edits.value())


def restore(choices: Choices, session: Session) -> None:
    """Choose what a session says, and the defaults of all else.

    Raises
    ------
    ValueError
        Where it says what cannot be chosen here.
    """
    held = session.settings
    try:
        for kind, begin in BEGIN.items():
            choice = getattr(choices, kind)
            choice.begin(held.get(kind, NONE if kind == "second" else choice.value))
            for name, made in choice.controls.items():
                value = held.get(begin + name, made.value)
                if hasattr(made, "max"):  # of a slider, which may end below
                    made.max = max(made.max, value)
                made.value = str(value) if isinstance(made, W.Text) else value
        choices.edits.restore(session.edits)
        choices.people.value = held.get("seen_through", 0.0)
        choices.least.value = held.get("filter", 0.0)
        choices.deskew.value = "no_deskew" not in held
    except (TraitError, TypeError, KeyError) as fault:
        raise ValueError(f"the session cannot be chosen here: {fault}") from fault


def read(path: Path) -> Log | Session:
    """A log, or a session by the end of its name."""
    ours = path.suffix.lower() == ".segmap"
    return read_session(path) if ours else readers.read(path, on_error="skip")
