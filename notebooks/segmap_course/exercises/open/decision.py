"""Open exercises of judgement: some are kept, and each of the others is refused by a reason that
holds."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from ..._unknown_building import plan_reasons, reasons, three_plans, unknown_building
from .._exercise import Check
from ._open import Open

#: What a student writes of the one that is taken.
KEPT = "keep"


@dataclass(frozen=True, repr=False, eq=False)
class Decision(Open):
    """Call it with a dictionary: each name with "keep", or with the witness that refuses it.

    Examples
    --------
    >>> fruit = Decision("decide_fruit(answer): which may be eaten, and what is against the other",
    ...                  lambda: {"apple": set(), "stone": {"hard", "grey"}})
    >>> fruit({"apple": "keep", "stone": "grey"})
    passed
    >>> fruit({"apple": "keep", "stone": "red"})
    not yet: stone: 'red' does not speak against it
    >>> fruit({"apple": "grey", "stone": "keep"})
    not yet: stone is not the one to keep
    """

    task: str
    #: Name -> the witnesses that speak against it; none against the one to keep.
    judge: Callable[[], Mapping[str, set[str]]]
    #: Written when it is done.
    praise: str = ""
    #: How many are kept.
    keeps: int = 1

    def __call__(self, decision: Any) -> Check:
        """Whether the right one is kept, and each other refused by what speaks against it."""
        known, pairs = self.judge(), decision.items() if isinstance(decision, dict) else ()
        given = {str(name): str(said) for name, said in pairs if said not in (None, ...)}
        if not given:
            return self._check(f"decide first; the task is {self.task}")
        if set(given) != set(known):
            return self._check(f"name each of {', '.join(known)}, with 'keep' or with a witness")
        kept = [name for name, answer in given.items() if answer == KEPT]
        if len(kept) != self.keeps:
            many = "one" if self.keeps == 1 else str(self.keeps)
            said = f"keep {many}, and refuse the others by a witness each; kept: {kept}"
            return self._check(said)
        if bad := [name for name in kept if known[name]]:
            return self._check(f"{', '.join(bad)} is not the one to keep")
        wrong = [name for name in known if name not in kept and given[name] not in known[name]]
        against = [f"{name}: {given[name]!r} does not speak against it" for name in wrong]
        return self._check("; ".join(against), self.praise)


def _maps() -> dict[str, set[str]]:
    case = unknown_building()
    return {name: reasons(case, name) for name in case.maps}


decide_map = Decision(
    "decide_map(answer): a dictionary with each of the maps A to D: 'keep' for the one that you "
    "would hand over, and for each other the witness that refuses it: 'verdict', 'spread', "
    "'doubled' or 'tape'",
    _maps,
    praise="Each map was refused by another witness, and C by one that no computation replaces: "
    "what is inside a log cannot know its unit",
)

decide_plan = Decision(
    "decide_plan(answer): a dictionary with each of the plans P, Q and R: 'keep' for the one that "
    "you would hand over, and for each other the witness that refuses it: 'circle', 'tape' or "
    "'shut'",
    lambda: {name: plan_reasons(name) for name in three_plans()},
    praise="A doorway that is wider than the room behind it is seen in the plan itself; a wrong "
    "unit is seen by the tape alone",
)
