"""Every method as the theses print it: plain loops over plain numbers, slow and readable.

They are the oracle of the tests, the code that chapters show, and the yardstick of the benchmarks.
Nothing here calls the fast version of what it does.
"""
