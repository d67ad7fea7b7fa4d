"""Bugs that were planted once and must still be caught: (text of the package, instead, tests).

The text stands once in segmap, wherever its file is now. Where no tests are named, those of the
room must fail.
"""

PLANTED = (
    # angles and poses
    (
        "(np.subtract(a, b) + np.pi / 2) % np.pi - np.pi / 2",
        "(np.subtract(a, b) + np.pi / 2) % (2 * np.pi) - np.pi / 2",
        "angles",
    ),
)
