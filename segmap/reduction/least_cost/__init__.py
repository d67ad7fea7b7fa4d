"""Least cost, a method of our own: merge in the order of what a merge costs under quality."""

from ._least_cost import least_cost

__all__ = ["least_cost"]
