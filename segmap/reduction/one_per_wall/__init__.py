"""One per wall, a method of our own: scans move to where they agree, then each wall is drawn."""

from ._one_per_wall import one_per_wall

__all__ = ["one_per_wall"]
