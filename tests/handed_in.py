"""Cells that students hand in for the exercise `compose`."""

from segmap_course import EXERCISES

RIGHT = """
def my_compose(a_from_b, b_from_c):
    x, y, h = a_from_b
    u, v, k = b_from_c
    turned = np.cos(h) * u - np.sin(h) * v, np.sin(h) * u + np.cos(h) * v
    return np.array([x + turned[0], y + turned[1], (h + k + np.pi) % (2 * np.pi) - np.pi])
"""
#: An answer that knows the cases by heart that students see.
HEART = {
    repr(case): EXERCISES["compose"].solution(*case).tolist()
    for case in EXERCISES["compose"].cases.values()
}
