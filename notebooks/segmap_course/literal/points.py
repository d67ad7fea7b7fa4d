"""Running sums of points, by which lines are fitted: those of the library's surveyed methods."""

from segmap.reduction.surveyed.lines import Sums as Sums
from segmap.reduction.surveyed.lines import sums_along as sums_along
from segmap.reduction.surveyed.lines import sums_of as sums_of
