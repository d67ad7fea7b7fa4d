"""Two scans of a log and the ways in which the walls of one could lie on those of the other."""

import numpy as np
from matplotlib.figure import Figure

from ..alignment import Candidate, Match, angle_candidates, match_angles
from ..extraction import extract_polylines
from ..panels import Panel, slider, text
from ..plotting import ERROR, MAP, RESULT, draw_segments
from ..poses import transform
from ..scans import Log


class AnglePanel(Panel):
    """Pairs of scans, and the candidates of angle correspondence by rank (A 3.3.1).

    The walls of the first scan are black, those of the second lie as the candidate says: blue where
    it is the match, red where nobody believes it.

    Parameters
    ----------
    log : Log
        At least two scans.
    scan : int
        Index of the first scan of the pair, at first.
    apart : int
        How many scans later the second one is, at first; at most the last of the log is taken.

    Attributes
    ----------
    scan, apart, rank : sliders
        Of the pair, and of the candidate (0 is the best; at most the last there is).
    found, verdict : labels
    candidates : list of Candidate
    match : Match

    Examples
    --------
    >>> from segmap import load
    >>> panel = AnglePanel(load("room"), scan=0, apart=4)
    >>> panel.verdict.value, panel.found.value
    ('match, overlap 0.63', '1 of 5: 6.23 m match, 0.00 m hidden')
    """

    candidates: list[Candidate]
    match: Match

    def __init__(self, log: Log, *, scan: int = 0, apart: int = 1) -> None:
        if len(log) < 2:
            raise ValueError(f"log must hold at least two scans, got {len(log)}")
        self.log = log
        self.scan = slider("first scan", scan, 0, len(log) - 2, 1, "")
        self.apart = slider("scans apart", apart, 1, max(2, min(40, len(log) - 1)), 1, "")
        self.rank = slider("candidate", 0, 0, 9, 1, "")
        self.found, self.verdict = text(), text()
        self._assemble(self.scan, self.apart, self.rank, (self.found, self.verdict))

    def _draw(self, figure: Figure) -> None:
        first = self.scan.value
        second = min(first + self.apart.value, len(self.log) - 1)
        walls, others = (extract_polylines(self.log[k].points()) for k in (first, second))
        places = (self.log[first].sensor_pose[:2], self.log[second].sensor_pose[:2])
        self.candidates = angle_candidates(
            walls, others, rng=np.random.default_rng(0), viewpoints=places
        )
        self.match = match_angles(walls, others, rng=np.random.default_rng(0), viewpoints=places)
        ax = draw_segments(walls, ax=figure.subplots(), color=MAP)
        ax.set_title(f"scan {second} on scan {first}")
        found = self.match.matched
        self.verdict.value = f"match, overlap {self.match.overlap:.2f}" if found else "no match"
        self.found.value = "no candidate"
        if self.candidates:
            rank = min(self.rank.value, len(self.candidates) - 1)
            best = self.candidates[rank]
            color = RESULT if found and rank == 0 else ERROR
            draw_segments(transform(best.pose, others), ax=ax, color=color)
            self.found.value = (
                f"{rank + 1} of {len(self.candidates)}: {best.value:.2f} m match, "
                f"{best.hidden:.2f} m hidden"
            )

    def __repr__(self) -> str:
        pair = f"scans {self.scan.value} and {self.scan.value + self.apart.value}"
        return f"AnglePanel({pair}: {self.found.value}; {self.verdict.value})"
