"""`python -m segmap`: what it warms is all that compiles, and chapter 01 then waits for nothing."""

import gc
import subprocess
import sys

import numpy as np
import pytest
from makefile import ROOT
from programs import program

from segmap import warm
from segmap.arrays import Array
from segmap.compiled import Compiled, compiled

main = program("segmap")


def tuples(kind):
    """The named tuples in a type of numba: the cache asks for these by name."""
    inside = set().union(*map(tuples, kind.types)) if hasattr(kind, "types") else set()
    own = getattr(kind, "instance_class", None) if hasattr(kind, "fields") else None
    return inside | ({f"{own.__module__}.{own.__qualname__}"} if own else set())


def test_every_kernel_has_a_case_and_knows_its_named_tuples():
    """Catches a new loop that nobody warms, and whose first call is then slow; one that takes a
    named tuple that its annotations do not say: it ends when the tuple's module has moved; and a
    bar that stands still, or runs ahead, while loops are compiled."""
    for name in warm.cases():
        warm.run_case(name)
    kernels = [k for k in gc.get_objects() if type(k) is Compiled]
    ours = [k for k in kernels if k.plain.__module__.startswith("segmap.")]
    told = warm.loops(warm.cases().values())  # of so many a bar tells how many are compiled
    assert told <= {*ours} and len(told) > 0.97 * len(ours)  # few are named by a table alone
    cold = {k.plain.__qualname__ for k in ours if k._fast is None and k._inner is None}
    assert len(ours) > 100 and not cold
    for kernel in ours:
        for machine in filter(None, (kernel._fast, kernel._inner)):
            taken = [tuples(kind) for signature in machine.signatures for kind in signature]
            assert set().union(*taken) <= {name for name, _ in kernel._parts()}, kernel.plain


#: Prints for which arguments loops were compiled, or loaded, that none of the cases needed.
BEYOND = """
import gc
from benchmarks.compiling import cells
from segmap import load, warm
from segmap.compiled import Compiled
from segmap_app.page import Workbench

def taken():
    loops = [k for k in gc.get_objects() if type(k) is Compiled and hasattr(k._fast, "signatures")]
    return {f"{k.plain.__qualname__}{s}" for k in loops for s in k._fast.signatures}

def page():
    made = Workbench(load("room"))
    made.run()
    made.wait()
    for switch in made.layers["free space"], made.rooms.switch:
        switch.value = True
        made.wait()
    assert len(made.canvas.free) and "rooms of" in made.rooms.editor.state["words"]

def beyond(cases, calls):
    for name in cases:
        warm.run_case(name)
    known = taken()
    for call in calls:
        call()
    return sorted(taken() - known)
"""


@pytest.mark.parametrize(
    "asked", ["beyond(warm.FIRST, cells('01'))", "beyond(warm.cases(), [page])"]
)
def test_what_is_warm_serves_chapter_01_and_the_page(asked):
    """Catches a signature that only real maps have: lists read-only, cut, or in another order; a
    chapter 01 that waits behind `make lab`; a floor plan whose first click compiles."""
    code = f"import sys\n{BEYOND}\nprint({asked}, file=sys.stderr)"
    done = subprocess.run([sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True)
    assert done.stderr.splitlines()[-1] == "[]"


def test_warming_tells_what_it_compiles(capfd):
    """Catches `--first` that compiles all, or nothing."""
    assert main(["warm", "--first"]) == 0
    first, last = capfd.readouterr().out.splitlines()
    assert "loops of chapter 01 on " in first and last.startswith("Done in")


@compiled
def write(a: Array) -> None:
    a[0] = 1.0


@compiled
def hand_back(a: Array) -> Array:
    return a


@compiled
def get_one(a: Array) -> float:
    return hand_back(a)[0]


def test_who_holds_an_array_is_counted_where_one_is_handed_back():
    """Catches memory that is lost, or freed while somebody holds it."""
    assert [kernel._counts() for kernel in (write, hand_back, get_one)] == [False, True, True]
    given = np.zeros(3)
    for _ in range(9):
        kept = [kernel(given) for kernel in (write, hand_back, get_one)]
    assert sys.getrefcount(given) == 3
    del kept
    assert sys.getrefcount(given) == 2
