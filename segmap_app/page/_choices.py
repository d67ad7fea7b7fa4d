"""All that can be chosen on the workbench between a log and a reduced map."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from typing import Any

import ipywidgets as W
from traitlets import TraitError

from segmap import alignment, extraction, reduction
from segmap.arrays import described
from segmap.files import as_html
from segmap.panels.controls import ENTRY, control, folded
from segmap.readers.raw_scans import COUNTERCLOCKWISE
from segmap.scans import Log

from ..call import Call, defaults, directions
from ..files import Session
from ..pipeline import BEGIN, MapChoices
from ._edits import Edits

#: A slider goes in so many steps a default ...
SLIDER_STEPS = 20
#: ... up to so many times the default.
SLIDER_DEFAULTS = 10
WRAP: Any = {"flex_flow": "row wrap", "align_items": "center"}
#: Names of the lists, one below the other.
LIST_NAME_STYLE = {"description_width": "104px"}
#: Below each list stands what the method that is chosen does.
SMALL = '<div style="line-height: 1.35; font-size: 12px; margin-left: 4px">'
#: Said of a log with a true pose for each scan, below what the alignment does.
OWN_POSES = f"{SMALL}This log has poses of its own: choose ground_truth to use them.</div>"
#: Said above the verdict of a table that does not say how its angles count.
ASSUMED_WAY = (
    f"{SMALL}assumed counter-clockwise; RPLidar, LD19 and most low-cost lasers count clockwise: "
    "tick here if the map looks mirrored, then Run</div>"
)
#: What the list of second methods says of none.
NONE = "none"

#: Name -> function, and the threshold that gets a slider, or nothing; the word for none: None.
Functions = Mapping[str, tuple[Callable[..., Any], str] | None]


class Choice:
    """A choice of one function of several, and controls of the thresholds of the chosen one.

    Each keeps its settings while another is chosen.

    Examples
    --------
    >>> from segmap.reduction import fusion
    >>> choice = Choice("method", {"none": None, "fusion": (fusion, "tolerance")}, "none")
    >>> choice.value = "fusion"
    >>> choice["tolerance"].value = 0.06
    >>> choice.call().words()
    'tolerance 0.06'
    """

    def __init__(self, name: str, functions: Functions, first: str) -> None:
        self._functions = functions
        self._made: dict[str, dict[str, Any]] = {}
        self.picker: Any = W.Dropdown(
            options=list(functions), value=first, description=name, style=LIST_NAME_STYLE
        )
        self.picker.layout.flex, self.picker.layout.min_width = "1 1 200px", "0"
        self._box = W.Box(layout=W.Layout(**WRAP))
        self.settings: Any = folded("settings", self._box, f"settings of {name}")
        self.advice = W.HTML()
        row = W.Box([self.picker, self.settings])
        self.view = W.VBox([row, self.advice, self._box])
        self.picker.observe(self._chosen, names="value")
        self._chosen()

    @property
    def value(self) -> str:
        """The name that is chosen."""
        return str(self.picker.value)

    @value.setter
    def value(self, name: str) -> None:
        self.picker.value = name

    def __getitem__(self, threshold: str) -> Any:
        """The control of a threshold of the function that is chosen."""
        return self.controls[threshold]

    @property
    def controls(self) -> dict[str, Any]:
        """Controls of the thresholds of the function that is chosen, by their names."""
        return self._made.get(self.value, {})

    def begin(self, name: str) -> None:
        """Choose a function with its defaults."""
        self._made.clear()
        self.value = name
        self._chosen()

    def call(self) -> Call | None:
        """The function with the thresholds that are not its defaults, and the one that varies."""
        if (about := self._functions[self.value]) is None:
            return None
        function, varies = about
        usual = defaults(function)
        values = {name: each.meant() for name, each in self.controls.items()}
        changed = {k: v for k, v in values.items() if k == varies or v != usual[k]}
        return Call(self.value, function, changed)

    def _chosen(self, change: Any = None) -> None:
        about = self._functions[self.value]
        if about is not None and self.value not in self._made:
            self._made[self.value] = _controls(*about)
        words = "" if about is None else described(about[0])[""].replace("`", "")
        name = self.value.removeprefix("extract_").replace("_", " ")
        self.advice.value = f"{SMALL}{as_html(f'{name}: {words}' * bool(words))}</div>"
        nothing = [] if about is None else [W.Label("no threshold")]
        self._box.children = list(self.controls.values()) or nothing
        self.settings.layout.visibility = "hidden" if about is None else "visible"


def _controls(function: Callable[..., Any], varies: str) -> dict[str, Any]:
    """Controls of the keywords that are plain values, the one that varies first, as a slider."""
    controls = {}
    for name, parameter in inspect.signature(function).parameters.items():
        if parameter.kind is parameter.KEYWORD_ONLY and (widget := control(function, name)):
            controls[name] = widget
    if varies:
        controls.pop(varies)
        first = defaults(function)[varies]
        usual = control(function, varies, first).value
        step, most = usual / SLIDER_STEPS, SLIDER_DEFAULTS * usual
        moved = control(function, varies, first, least=step, most=most, step=step)
        moved.style.description_width = ENTRY["description_width"]
        controls = {varies: moved, **controls}
    return controls


class Choices:
    """All: `people` is the share for `without_passers`, `least` the length of the filter.

    `usual` is what is chosen where nobody says anything.
    """

    def __init__(self) -> None:
        alignments = {k: (m.function, "") for k, m in alignment.METHODS.items()}
        reductions = {k: (m.function, m.varies) for k, m in reduction.METHODS.items()}
        extractions = {k: (f, "") for k, f in extraction.METHODS.items()}
        self.usual = {"align": "pose_graph", "extract": "extract_polylines"}
        self.usual |= {"method": reduction.USUAL_METHOD, "second": NONE}
        self.align = Choice("alignment", alignments, self.usual["align"])
        self.own_poses: Any = W.HTML()
        self.extract = Choice("extraction", extractions, self.usual["extract"])
        self.method = Choice("method", reductions, self.usual["method"])
        self.second = Choice("second method", {NONE: None, **reductions}, NONE)
        named: Any = {"description": "leave out below [m]", "style": ENTRY}
        words = "de-skew, where beams have times"
        self.deskew: Any = W.Checkbox(True, description=words, indent=False)
        self.keep_body: Any = W.Checkbox(False, description="keep beams that see the robot itself")
        self.clockwise: Any = W.Checkbox(False, description="the beams are counted clockwise")
        self.deskew.tooltip = "beams are carried to where the robot was when their scan began"
        self.keep_body.tooltip = "else beams that always end at the robot are left out"
        self.clockwise.tooltip = "for a laser that is mounted upside down"
        for box in (self.deskew, self.keep_body, self.clockwise):
            box.indent, box.layout.width = False, "auto"
        self.mirrored: Any = W.VBox([W.HTML(ASSUMED_WAY), self.clockwise])
        hint, style = "FROM:TO, FROM:TO", ENTRY
        self.mask: Any = W.Text(description="mask [degrees]", placeholder=hint, style=style)
        self.mask.tooltip = "directions in which the laser sees the robot, which are left out"
        hint = "X Y DEGREES, or auto"
        self.mount: Any = W.Text(description="laser [m, degrees]", placeholder=hint, style=ENTRY)
        self.mask.layout.width = self.mount.layout.width = "auto"
        self.mount.tooltip = "place and direction of the laser on the robot; auto finds them"
        self.least: Any = W.BoundedFloatText(0.0, min=0, max=100, step=0.05, **named)
        named["description"] = "seen through [share]"
        self.people: Any = W.BoundedFloatText(0.0, min=0, max=1, step=0.05, **named)
        self.people.tooltip = "0.2 leaves out people who walked through; 0 keeps all"
        self.least.tooltip = "shorter segments are left out before they are reduced"
        self.least.layout.width = self.people.layout.width = "270px"
        self.edits = Edits()

    def begin(self, log: Log) -> None:
        """Keep no edit of another map, and say whether a log has poses of its own."""
        self.edits.restore({})
        has_poses = alignment.usual_method(log) == "ground_truth"
        self.own_poses.value = OWN_POSES if has_poses else ""
        self.mirrored.layout.display = None if COUNTERCLOCKWISE in log.assumed else "none"

    def restore(self, session: Session) -> None:
        """Choose what a session says, and the defaults of all else.

        Raises
        ------
        ValueError
            Where it says what cannot be chosen here.
        """
        settings = {**self.usual, **session.settings}
        try:
            for kind, begin in BEGIN.items():
                choice = getattr(self, kind)
                choice.begin(settings[kind])
                for name, widget in choice.controls.items():
                    value = settings.get(begin + name, widget.value)
                    if hasattr(widget, "max"):  # of a slider, which may end below
                        widget.max = max(widget.max, value)
                    widget.value = str(value) if isinstance(widget, W.Text) else value
            self.edits.restore(session.edits)
            self.people.value = settings.get("seen_through", 0.0)
            self.least.value = settings.get("filter", 0.0)
            self.deskew.value = not settings.get("no_deskew", False)
            self.keep_body.value = settings.get("keep_body", False)
            self.clockwise.value = settings.get("clockwise", False)
            self.mask.value = ",".join(settings.get("mask", []))
            mount = " ".join(map(str, settings.get("mount", [])))
            place = "auto" if settings.get("mount_auto") else mount
            self.mount.value = place
        except (TraitError, TypeError, KeyError, ArithmeticError) as fault:
            raise ValueError(f"the session cannot be chosen here: {fault}") from fault

    def prepare(self) -> dict[str, Any]:
        """What is chosen for `alignment.prepared`, by the options of `segmap map`."""
        picks: dict[str, Any] = {"no_deskew": not self.deskew.value}
        picks |= {"keep_body": self.keep_body.value, "clockwise": self.clockwise.value}
        if mask := self.mask.value.replace(" ", ""):
            directions(picks.setdefault("mask", [mask]))
        text = self.mount.value.strip()
        picks["mount_auto"] = text == "auto"
        try:
            picks["mount"] = [] if text in ("", "auto") else [float(word) for word in text.split()]
            assert len(picks["mount"]) in (0, 3)
        except (ValueError, AssertionError):
            raise ValueError(f"laser must be like '0.2 0 180', or auto, got {text!r}") from None
        return {name: value for name, value in picks.items() if value}

    def recipe(self, log: str) -> MapChoices:
        """All that is chosen, for the log that an expression gives."""
        chosen = (each.call() for each in (self.align, self.extract, self.method, self.second))
        align, extract, *methods = (call for call in chosen if call is not None)
        least, prepare = float(self.least.value), self.prepare()
        seen, edits = float(self.people.value) or None, self.edits.value()
        return MapChoices(align, extract, least, methods, prepare, seen, edits, log)

    def views(self) -> dict[str, Any]:
        """Their controls, by the steps of the way."""
        laser = W.VBox([self.keep_body, self.mask, self.clockwise, self.mount])
        fold = folded("laser", laser)
        fold.layout.align_self = "flex-start"
        return {
            "Poses": W.VBox(
                [self.align.view, self.own_poses, self.deskew, fold, laser, self.mirrored]
            ),
            "Segments": W.VBox([self.extract.view, self.people, self.least]),
            "Map": W.VBox([self.method.view, self.second.view]),
        }
