"""Open exercises of judgement: what to hand over, and numbers to predict where a method fails."""

from __future__ import annotations

import numpy as np

from ._open import Prediction
from .decision import Decision

predict_crowd = Prediction(
    "predict_crowd(guess): a scan lies rightly on the map, but a fifth of its beams end on people "
    "far from any wall; what is its fit, the geometric mean of 0.9 exp(-d^2 / 2 sigma^2) + 0.1; "
    "within 0.05",
    lambda: float(np.exp(np.log(np.repeat([0.1, 1.0], [1, 4])).mean())),
    "parts of 1",
    within=0.05,
    because="A geometric mean of four times 1 and once 0.1; the plain mean, 0.82, would hide them. "
    "Found asks for 0.85: fewer than 8 beams of 100 may end on somebody",
)

predict_survivors = Prediction(
    "predict_survivors(guess): a hundred particles of equal weight are drawn anew by a hundred "
    "random numbers, and not by a comb; how many of them are still there, on average; within 3",
    lambda: 100 * (1 - (1 - 1 / 100) ** 100),
    "particles",
    within=3,
    because="Each is missed by all hundred draws with (1 - 1/100)^100, which is nearly 1/e. Though "
    "no scan spoke against any of them a third is gone; by a comb none is",
)

decide_way = Decision(
    "decide_way(answer): a dictionary with each of the ways K to N: 'keep' for the one that a "
    "robot of 0.25 m may drive, and for each other the reason that refuses it: 'wall', 'unknown' "
    "or 'long'",
    ("K", "L", "M", "N"),
    "20a60964 431926c2 920e7511 e0024f91",
    praise="The shortest was refused first: a length is worth nothing before the way is clear",
)
