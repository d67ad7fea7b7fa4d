"""How CPU time grows: of each reduction with the map, and with the looks at each wall; of each
alignment with the scans.

The exponents are those of the tables in `docs/known_limits.md`; `build/records/costs.png` draws
them log-log. `python -m benchmarks costs` takes some fifteen minutes.
"""

import time
from collections.abc import Callable, Iterator

import matplotlib as mpl
import matplotlib.pyplot as plt

from segmap import METHODS, alignment

from .bench_growth import power, visits
from .bench_length import city_log
from .measure import RECORDS, Row, missing, workloads

#: Segments of buildings whose walls are seen 20 times ...
SIZES = [5_000, 10_000, 20_000, 40_000, 80_000]
#: ... and for what would take minutes.
SHORT_SIZES = [2_500, 5_000, 10_000, 20_000]
#: Scans of cities in which half of the way is known.
SCANS = [500, 2_000, 8_000, 20_000]
#: What takes the poses as they are.
GIVEN = ("odometry", "ground_truth")
#: Looks at each of 200 walls.
LOOKS = [25, 50, 100, 200]
SLOW = ("fusion_online", "fuzzy_clustering")
#: Exponents on 30 November 2026, before near segments were looked up: with the map, with looks.
BEFORE = {
    "polyline": (1.95, None),
    "uncertain_parameters": (1.65, None),
    "weighted_line_fitting": (1.81, 1.62),
    "fuzzy_set": (2.14, 2.10),
}


def rows() -> Iterator[Row]:
    made = workloads()
    if made is None:
        yield from missing("costs")
        return
    panels: list[dict[str, dict[int, float]]] = [{}, {}, {}]
    for name in (name for name, method in METHODS.items() if not method.needs_sensors):
        sizes = SHORT_SIZES if name in SLOW else SIZES
        maps = {n: visits(made, n, 20) for n in sizes}, {k: visits(made, 200 * k, k) for k in LOOKS}
        METHODS[name](maps[0][sizes[0]])  # compiles it
        curves = [{n: cpu_seconds(METHODS[name], m) for n, m in ms.items()} for ms in maps]
        panels[0][name], panels[1][name] = curves
        yield row(name, *map(exponent, curves))
    logs = {n: city_log(n) for n in SCANS}
    for name in (name for name in alignment.METHODS if name not in GIVEN):
        method = alignment.METHODS[name]
        method(logs[SCANS[0]][:50])  # compiles it
        curve = panels[2][name] = {n: cpu_seconds(method, log) for n, log in logs.items()}
        took = f"{1e3 * curve[SCANS[-1]] / SCANS[-1]:.2f} ms a scan of {SCANS[-1]}"
        yield Row(f"alignment, {name}", f"scans^{exponent(curve):.2f}, {took}", "n^1.3")
    draw(panels)


def exponent(curve: dict[int, float]) -> float:
    return power(list(curve), list(curve.values()))


def cpu_seconds(method: Callable, map) -> float:
    start = time.process_time()
    method(map)
    return time.process_time() - start


def row(name: str, by_size: float, by_looks: float) -> Row:
    """Both exponents, and each as a ratio to what it was where that is known."""
    words = [f"n^{by_size:.2f}", f"looks^{by_looks:.2f}"]
    for k, (now, before) in enumerate(zip((by_size, by_looks), BEFORE.get(name, ()), strict=False)):
        if before is not None:
            words[k] += f" (before {before:.2f}: {now / before:.2f})"
    return Row(name, ", ".join(words), "n^1.3")


def draw(panels: list[dict[str, dict[int, float]]]) -> None:
    """One line a method, log-log: over the segments, the looks at each wall, and the scans."""
    mpl.use("Agg")
    fig, axes = plt.subplots(1, 3, figsize=(15, 7), layout="constrained", sharey=True)
    words = "segments", "looks at each of 200 walls", "scans"
    for ax, what, curves in zip(axes, words, panels, strict=True):
        for i, (name, curve) in enumerate(curves.items()):
            ax.loglog(*zip(*curve.items(), strict=True), ("o-", "s--")[i // 10], ms=4, label=name)
        ax.set(xlabel=what)
        ax.xaxis.set_minor_formatter("")
        ax.grid(alpha=0.3, which="both")
        ax.legend(fontsize=8)
    axes[0].set(ylabel="CPU time [s]")
    fig.savefig(RECORDS / "costs.png", dpi=110)
    plt.close(fig)
