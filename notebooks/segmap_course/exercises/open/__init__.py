"""Open exercises, with more than one right answer: predict, break, and a log of one's own."""

from ._open import Challenge, Prediction
from .own_log import OwnLog

__all__ = ["Challenge", "OwnLog", "Prediction"]
