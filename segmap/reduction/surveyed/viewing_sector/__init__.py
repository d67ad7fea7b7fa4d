"""The viewing sector (A 2.7.5): each scan confirms, hides or removes what the map has there."""

from ._viewing_sector import viewing_sector

__all__ = ["viewing_sector"]
