"""The quadtree of B 4 written as the prose says it: one dictionary of leaves, no tricks."""

import math


class Literal:
    """Leaves `(x, y, side)` in cells from the first corner -> `[vis, occ]`."""

    def __init__(self, cells, largest):
        self.x = self.y = 0
        self.side, self.largest = cells, largest
        half = cells // 2
        self.leaves = {(x, y, half): [0, 0] for x in (0, half) for y in (0, half)}

    def holds(self, x, y):
        return self.x <= x < self.x + self.side and self.y <= y < self.y + self.side

    def grow(self, x, y):
        while not self.holds(x, y):
            assert self.side < self.largest
            s = self.side
            to_x = self.x - s if x < self.x else self.x
            to_y = self.y - s if y < self.y else self.y
            for qx in (to_x, to_x + s):
                for qy in (to_y, to_y + s):
                    if (qx, qy) != (self.x, self.y):
                        self.leaves[(qx, qy, s)] = [0, 0]
            self.x, self.y, self.side = to_x, to_y, 2 * s

    def leaf(self, x, y):
        side = self.side
        while side >= 1:
            key = (self.x + (x - self.x) // side * side, self.y + (y - self.y) // side * side, side)
            if key in self.leaves:
                return key
            side //= 2
        raise AssertionError("no leaf")

    def split(self, x, y):
        while (key := self.leaf(x, y))[2] > 1:
            del self.leaves[key]
            half = key[2] // 2
            for qx in (key[0], key[0] + half):
                for qy in (key[1], key[1] + half):
                    self.leaves[(qx, qy, half)] = [1, 0]

    def insert(self, sensor, ends, free=()):
        for cell in [sensor, *ends, *free]:
            self.grow(*cell)
        for end in ends:
            self.split(*end)
        for end in ends:
            counts = self.leaves[self.leaf(*end)]
            counts[0] += counts[1] > 0
            counts[1] += 1
        for end in ends:
            around = {(end[0] + i, end[1] + j) for i in (-1, 0, 1) for j in (-1, 0, 1)}
            self.cross([cell for cell in bresenham(sensor, end) if cell not in around])
        for end in free:
            self.cross(bresenham(sensor, end))

    def cross(self, cells):
        for key in {self.leaf(*cell) for cell in cells}:
            self.leaves[key][0] += 1


def bresenham(start, end):
    """Cells of a ray, by the loop of B 4.4.1."""
    (x0, y0), (x1, y1) = start, end
    steep = abs(y1 - y0) > abs(x1 - x0)
    if steep:
        x0, y0, x1, y1 = y0, x0, y1, x1
    if x1 < x0:
        x0, y0, x1, y1 = x1, y1, x0, y0
    dx, dy, y, found = x1 - x0, abs(y1 - y0), y0, []
    error = -(dx // 2)
    for x in range(x0, x1 + 1):
        found.append((y, x) if steep else (x, y))
        error += dy
        if error > 0:
            y += 1 if y1 > y0 else -1
            error -= dx
    return found


def cell(x, corner, resolution):
    return math.floor((x - corner) / resolution)
