"""Global alignment (A 2.5.1; Elseberg, Creed and Lakaemper 2010): eq. 2.3 to 2.15, mended.

A match is (i, j, u, v, w): segment u of scan i corresponds to segment v of scan j with the weight
w, `exp(-D(u, v) / (2 sigma^2))` (2.7).
"""

from __future__ import annotations

from collections.abc import Sequence

from ..lines import Segment, axial_difference, line_angle, line_of, seen_from

Match = tuple[int, int, Segment, Segment, float]
#: Two scans i and j, how far x_i should lie behind x_j, and the weight of that.
Row = tuple[int, int, float, float]


def least_squares(rows: Sequence[Row], count: int) -> list[float]:
    """The x with the least sum of `w (x_i - x_j + c)^2`, the first of them held at 0 (2.3).

    Sets up `B x = A` (2.4 to 2.6; *slip*: 2.6 lacks the minus before its first sum) and eliminates.
    """
    b = [[0.0] * count for _ in range(count)]
    a = [0.0] * count
    for i, j, c, w in rows:
        b[i][i], b[j][j] = b[i][i] + w, b[j][j] + w
        b[i][j], b[j][i] = b[i][j] - w, b[j][i] - w
        a[i], a[j] = a[i] - w * c, a[j] + w * c
    return [0.0, *eliminated([row[1:] for row in b[1:]], a[1:])]


def best_turns(matches: Sequence[Match], count: int) -> list[float]:
    """Turn of each scan, radians, that makes matched segments most parallel (2.8 to 2.11)."""
    rows = [(i, j, axial_difference(line_angle(u), line_angle(v)), w) for i, j, u, v, w in matches]
    return least_squares(rows, count)


def best_shifts(matches: Sequence[Match], count: int) -> list[tuple[float, float]]:
    """Shift of each scan, metres, that brings end points to the lines of their matches (2.12).

    Both ways: the ends of u to the line of v, and those of v to the line of u (2.13 to 2.15).
    """
    rows: tuple[list[Row], list[Row]] = ([], [])
    both = [*matches, *((j, i, v, u, w) for i, j, u, v, w in matches)]
    for i, j, u, v, w in both:
        line = line_of(v)
        for p in u:
            off = seen_from(line, p)[1]
            for axis, n in enumerate((-line[3], line[2])):
                rows[axis].append((i, j, off * n, w))
    return list(zip(*(least_squares(row, count) for row in rows), strict=True))


def eliminated(matrix: list[list[float]], right: list[float]) -> list[float]:
    """Solution of a symmetric positive system by Gaussian elimination; both are overwritten."""
    n = len(right)
    for k in range(n):
        for i in range(k + 1, n):
            factor = matrix[i][k] / matrix[k][k]
            for j in range(k, n):
                matrix[i][j] -= factor * matrix[k][j]
            right[i] -= factor * right[k]
    for k in reversed(range(n)):
        right[k] -= sum(matrix[k][j] * right[j] for j in range(k + 1, n))
        right[k] /= matrix[k][k]
    return right
