"""Open exercises of judgement: some are kept, and each of the others is refused by a reason that
holds.

What is right stands nowhere in what a student gets, only a seal of it: a digest, by which an answer
is recognised.
"""

from __future__ import annotations

from dataclasses import dataclass
from hashlib import sha256
from typing import Any

from .._exercise import Check
from ._open import Open

#: What a student writes of the one that is taken.
KEPT = "keep"
#: So many digits of a digest are a seal.
SEAL_DIGITS = 8


@dataclass(frozen=True, repr=False, eq=False)
class Decision(Open):
    """Call it with a dictionary: each name with "keep", or with the witness that refuses it.

    Examples
    --------
    >>> fruit = Decision("decide_fruit(answer): may it be eaten, or what is against it",
    ...                  ("apple", "stone"), "d6baa7bc f4233494")
    >>> fruit.seal("stone", "hard")
    'f4233494'
    >>> fruit({"apple": "keep", "stone": "hard"})
    passed
    >>> fruit({"apple": "keep", "stone": "red"})
    not yet: stone: 'red' does not speak against it
    >>> fruit({"apple": "hard", "stone": "keep"})
    not yet: stone is not the one to keep

    A handout has a case of its own: `noted` says whether an answer is whole, and no more.

    >>> fruit.noted({"apple": "keep", "stone": "red"})
    passed: noted; it is judged when it is handed in
    """

    task: str
    names: tuple[str, ...]
    #: The seals of all that is right: of "keep", and of each witness that speaks against a name.
    seals: str
    #: Written when it is done.
    praise: str = ""
    #: How many are kept.
    keeps: int = 1

    def seal(self, name: str, word: str) -> str:
        """The seal of one answer."""
        return sha256(f"{self.name} {name} {word}".encode()).hexdigest()[:SEAL_DIGITS]

    def __call__(self, decision: Any, seals: str = "") -> Check:
        """Whether the right one is kept, and each other refused by what speaks against it."""
        if not (noted := self.noted(decision)):
            return noted
        words, right = _words(decision), (seals or self.seals).split()
        wrong = [name for name in self.names if self.seal(name, words[name]) not in right]
        if bad := [name for name in wrong if words[name] == KEPT]:
            return self._check(f"{', '.join(bad)} is not the one to keep")
        against = [f"{name}: {words[name]!r} does not speak against it" for name in wrong]
        return self._check("; ".join(against), self.praise)

    def noted(self, decision: Any) -> Check:
        """Whether each is named, and as many are kept as are wanted. Says nothing of right ones."""
        words = _words(decision)
        if not words:
            return self._check(f"decide first; the task is {self.task}")
        if set(words) != set(self.names):
            return self._check(f"name each of {', '.join(self.names)}, with 'keep' or a witness")
        chosen = [name for name, word in words.items() if word == KEPT]
        if len(chosen) != self.keeps:
            many = "one" if self.keeps == 1 else str(self.keeps)
            return self._check(
                f"keep {many}, and refuse the others by a witness each; kept: {chosen}"
            )
        return self._check("", "noted; it is judged when it is handed in")


def _words(decision: Any) -> dict[str, str]:
    pairs = decision.items() if isinstance(decision, dict) else ()
    return {str(name): str(word) for name, word in pairs if word not in (None, ...)}


decide_map = Decision(
    "decide_map(answer): a dictionary with each of the maps A to D of a floor: 'keep' for the one "
    "that you would hand over, and for each other the witness that refuses it: 'verdict', "
    "'doubled' or 'tape'",
    ("A", "B", "C", "D"),
    "04abb1db 871a1686 89ca25c9 bd772afe c094b7d2 e24521f4",
    praise="Each map was refused by another witness, and one by the tape alone, which no "
    "computation replaces: what is inside a log cannot know its unit",
)
