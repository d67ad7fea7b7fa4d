"""Open exercises: predict, break, decide, and a log of one's own."""

from ._open import Challenge, Prediction
from .decision import Decision
from .own_log import OwnLog

__all__ = ["Challenge", "Decision", "OwnLog", "Prediction"]
