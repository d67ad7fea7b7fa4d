"""Least cost, a method of our own: merge in the order of what a merge costs under quality."""

from ._fit_kernels import (
    join_sums,
)
from ._least_cost import (
    least_cost,
    reduce_to,
)
