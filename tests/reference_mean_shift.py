"""Mean shift as ALGORITHMS states it, literally: every centre and every piece at every step.

Scalars, lists and double loops in metres and radians, nothing shared with the package. As there,
terms beyond three deviations are left out (ties at three are in), and a piece perpendicular to a
centre turns it neither way.
"""

import math

from reference import SAME, axial, line_angle, segment_length

TIE = 1e-9


def cut(segments, sigma):
    """Pieces as (middle x, middle y, angle, owner, end points)."""
    pieces = []
    for owner, (p, q) in enumerate(segments):
        if segment_length((p, q)) < SAME:
            continue
        count = max(math.ceil(segment_length((p, q)) / sigma - 1e-9), 1)
        for k in range(count):
            ends = [
                [(1 - t) * p[c] + t * q[c] for c in (0, 1)] for t in (k / count, (k + 1) / count)
            ]
            x, y = ((ends[0][c] + ends[1][c]) / 2 for c in (0, 1))
            pieces.append((x, y, line_angle((p, q)), owner, ends))
    return pieces


def turn(piece_angle, centre_angle):
    """Axial difference, and the same with perpendicular lines at 0."""
    difference = axial(piece_angle, centre_angle)
    return difference, 0.0 if abs(difference) >= math.pi / 2 * (1 - TIE) else difference


def common_directions(pieces, sigma, bandwidth):
    """Phase 1: where the centres, as (x, y, angle), come to rest."""
    centres = [piece[:3] for piece in pieces]
    while True:
        moved, largest = [], 0.0
        for x, y, a in centres:
            total, sums = 0.0, [0.0, 0.0, 0.0]
            for px, py, pa, *_ in pieces:
                difference, pull = turn(pa, a)
                d = math.sqrt((px - x) ** 2 + (py - y) ** 2 + (difference / bandwidth) ** 2)
                if d <= 3 * sigma * (1 + TIE):
                    w = math.exp(-d * d / (2 * sigma * sigma))
                    total += w
                    sums = [sums[0] + w * (px - x), sums[1] + w * (py - y), sums[2] + w * pull]
            dx, dy, da = (value / total for value in sums)
            moved.append((x + dx, y + dy, a + da))
            largest = max(largest, math.sqrt(dx * dx + dy * dy + (da / bandwidth) ** 2))
        centres = moved
        if largest <= sigma / 200:
            return centres


def collinear(middles, theta, sigma):
    """Phase 2 in one cluster: where the middles come to rest, in metres."""
    sx, sy = 2 * sigma, sigma / 10
    centres = middles
    while True:
        moved, largest = [], 0.0
        for x, y in centres:
            total, sums = 0.0, [0.0, 0.0]
            for px, py in middles:
                square = stretched(px - x, py - y, theta, sx, sy)
                if math.sqrt(square / 2) <= 3 * (1 + TIE):
                    w = math.exp(-square / 4)
                    total += w
                    sums = [sums[0] + w * (px - x), sums[1] + w * (py - y)]
            dx, dy = sums[0] / total, sums[1] / total
            moved.append((x + dx, y + dy))
            largest = max(largest, math.sqrt(stretched(dx, dy, theta, sx, sy)))
        centres = moved
        if largest <= 1 / 200:
            return centres


def stretched(dx, dy, theta, sx, sy):
    """du^2 / sx^2 + dv^2 / sy^2, u along theta and v across."""
    du = dx * math.cos(theta) + dy * math.sin(theta)
    dv = dy * math.cos(theta) - dx * math.sin(theta)
    return du * du / (sx * sx) + dv * dv / (sy * sy)


def chains(count, near):
    """Connected sets of 0 to count - 1, by lowest member, each ascending."""
    left, found = set(range(count)), []
    while left:
        todo = [min(left)]
        left.discard(todo[0])
        chain = []
        while todo:
            i = todo.pop()
            chain.append(i)
            new = [j for j in left if near(i, j)]
            left.difference_update(new)
            todo += new
        found.append(sorted(chain))
    return found


def intervals(low, high):
    """Groups of indices whose intervals overlap or are at most 1e-9 apart."""
    touch = lambda i, j: low[i] <= high[j] + SAME and low[j] <= high[i] + SAME  # noqa: E731
    return chains(len(low), touch)


def mean_shift(segments, sigma, bandwidth):
    """Outputs by their lowest piece, and the output with the longest share of each input."""
    pieces = cut(segments, sigma)
    centres = common_directions(pieces, sigma, bandwidth)

    def alike(i, j):
        (x, y, a), (u, v, b) = centres[i], centres[j]
        return math.sqrt((x - u) ** 2 + (y - v) ** 2 + (axial(a, b) / bandwidth) ** 2) < 2 * sigma

    found = []
    for cluster in chains(len(pieces), alike):
        s = sum(math.sin(2 * centres[i][2]) for i in cluster)
        c = sum(math.cos(2 * centres[i][2]) for i in cluster)
        theta = math.atan2(s, c) / 2
        found += lines(pieces, cluster, theta, sigma)
    found.sort(key=lambda entry: min(entry[0]))
    return [entry[1] for entry in found], shares(pieces, found, len(segments))


def lines(pieces, cluster, theta, sigma):
    """Phase 2 and the union of intervals: (members, segment) of each output of a cluster."""
    ended = collinear([pieces[i][:2] for i in cluster], theta, sigma)
    d = (math.cos(theta), math.sin(theta))

    def near(i, j):
        dx, dy = ended[i][0] - ended[j][0], ended[i][1] - ended[j][1]
        return stretched(dx, dy, theta, 2 * sigma, sigma / 10) < 1

    found = []
    for chain in chains(len(cluster), near):
        base = [sum(ended[i][c] for i in chain) / len(chain) for c in (0, 1)]
        spans = []
        for i in chain:
            ends = pieces[cluster[i]][4]
            spans.append(sorted((e[0] - base[0]) * d[0] + (e[1] - base[1]) * d[1] for e in ends))
        for part in intervals([s[0] for s in spans], [s[1] for s in spans]):
            reach = min(spans[k][0] for k in part), max(spans[k][1] for k in part)
            segment = [[base[0] + w * d[0], base[1] + w * d[1]] for w in reach]
            found.append(([cluster[chain[k]] for k in part], segment))
    return found


def shares(pieces, found, count):
    """For each input the output that holds most of its length, the first of equals; else -1."""
    parents = []
    for owner in range(count):
        held = [sum(pieces[i][3] == owner for i in members) for members, _ in found]
        parents.append(held.index(max(held)) if held and max(held) > 0 else -1)
    return parents
