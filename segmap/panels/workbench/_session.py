"""What is chosen on the workbench as a session, by the names of the options of `segmap map`."""

from __future__ import annotations

from pathlib import Path

import ipywidgets as W
from traitlets import TraitError

from ... import readers
from ..._recipe import BEGIN
from ...readers import Session, read_session
from ...scans import Log
from ._choices import Choices


def restore(choices: Choices, session: Session) -> None:
    """Choose what a session says, and the defaults of all else.

    Raises
    ------
    ValueError
        Where it says what cannot be chosen here.
    """
    held = {**choices.usual, **session.settings}
    try:
        for kind, begin in BEGIN.items():
            choice = getattr(choices, kind)
            choice.begin(held[kind])
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
