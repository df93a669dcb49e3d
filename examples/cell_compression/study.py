"""Fig. 4 of the paper: force against reduction of a cell between two plates, and of elastic balls, by two methods."""

import matplotlib.pyplot as plt
import numpy as np

from study_tools import Case, number, percent, resolution, table

TITLE = "A cell between two plates (Fig. 4)"
NUCLEI = ["0.382", "0.618"]
DURATIONS = ["100us", "200us", "400us", "800us"]
ELASTIC = [[("body", "homogeneous"), ("nucleus", "0.382")]] + [[("body", "core-shell"), ("nucleus", n)] for n in NUCLEI]
# Slow enough that the vibrations of a soft shell, which the facets excite as they touch one by one, do not show.
SPEED = {"homogeneous": [("duration", "400us")], "core-shell": [("duration", "1600us"), ("ramp", "0.3")]}
EXPLICIT = [[*o, *SPEED[dict(o)["body"]]] for o in ELASTIC]
MESHES = [resolution(r) for r in (0.6, 0.8, 1.0)]
SWEEPS = [
    ("static", "cell_compression", [("method", "static"), ("resolution", resolution(1.0)), ("samples", "25")], ELASTIC),
    ("explicit", "cell_compression", [("resolution", resolution(1.0))], EXPLICIT),
    ("cell", "cell_compression", [("body", "cell"), ("resolution", resolution(1.0))],
     [[("nucleus", n), ("duration", d)] for n in NUCLEI for d in DURATIONS]),
    ("meshes", "cell_compression", [("nucleus", "0.382")],
     [[("body", "core-shell"), ("method", "static"), ("samples", "25"), ("resolution", r)] for r in MESHES]
     + [[("body", "cell"), ("duration", "200us"), ("resolution", r)] for r in MESHES]),
]
REDUCTIONS = [0.1, 0.2, 0.3, 0.4, 0.49]


def force(case, reduction, window=0.0):
    """N, linear between the lines; with a window, the mean over reduction ± window, which takes off vibrations."""
    if case.history is None or len(case.history["reduction"]) < 2 or reduction > case.history["reduction"].max():
        return float("nan")
    at = np.linspace(reduction - window, min(reduction + window, case.history["reduction"].max()), 21)
    return float(np.mean(np.interp(at, case.history["reduction"], case.history["force"])))


def at_rest(forces):
    """Extrapolated to zero rate from the two slowest runs, linear in the rate."""
    return 2.0 * forces[-1] - forces[-2]


def label(options):
    o = dict(options)
    return o["body"] if o["body"] == "homogeneous" else f"{o['body']}, nucleus {o['nucleus']} R"


def report(folder):
    static = {label(o): Case(folder / "static", o) for o in ELASTIC}
    explicit = {label(o): Case(folder / "explicit", o) for o in EXPLICIT}
    cells = {(n, d): Case(folder / "cell", [("nucleus", n), ("duration", d)]) for n in NUCLEI for d in DURATIONS}
    text = "![Force against reduction](cell_compression/compression.png)\n\n"
    text += ("Elastic balls: force on a plate (nN) by equilibria, and the difference of an explicit run of 400 µs (core-shell: 1600 µs; mean "
             "over ±0.01 of the reduction):\n\n")

    def compared(name, r):
        if np.isnan(force(static[name], r)):
            return "–"
        difference = percent(force(explicit[name], r, 0.01), force(static[name], r, 0.01))
        return f"{number(force(static[name], r) * 1e9, 4)} ({difference:+.1f} %)"

    rows = [[name, *(compared(name, r) for r in REDUCTIONS)] for name in static]
    text += table(["reduction", *(f"{r:g}" for r in REDUCTIONS)], rows)
    text += ("\nThe cell: force on a plate (nN) at several durations of the motion, and extrapolated to infinitely slow motion "
             "(linear in the rate, from the two slowest):\n\n")
    rows = []
    for n in NUCLEI:
        for d in DURATIONS:
            rows.append([f"nucleus {n} R, {d.replace('us', ' µs')}", *(number(force(cells[n, d], r, 0.02) * 1e9, 3) for r in REDUCTIONS)])
        rows.append([f"nucleus {n} R, at rest",
                     *(number(at_rest([force(cells[n, d], r, 0.02) * 1e9 for d in DURATIONS]), 2) for r in REDUCTIONS)])
    text += table(["reduction", *(f"{r:g}" for r in REDUCTIONS)], rows)
    text += "\nResolution: force (nN) at reductions 0.3 and 0.49 (nucleus 0.382 R):\n\n"
    rows = []
    for name, options in (("core-shell, static", [("body", "core-shell"), ("method", "static"), ("samples", "25")]),
                          ("cell, 200 µs", [("body", "cell"), ("duration", "200us")])):
        runs = [Case(folder / "meshes", [*options, ("resolution", r)]) for r in MESHES]
        rows.append([name, *(" / ".join(number(force(run, r, 0.01) * 1e9, 4) for r in (0.3, 0.49)) for run in runs)])
    text += table(["", *(f"resolution {r}" for r in MESHES)], rows)

    figure, axes = plt.subplots(1, 2, figsize=(8.6, 3.6), layout="constrained")
    for k, name in enumerate(static):
        for cases, style in ((static, dict(color=f"C{k}", label=name)), (explicit, dict(color=f"C{k}", linestyle=":"))):
            history = cases[name].history
            if history is not None:
                axes[0].plot(history["reduction"], history["force"] * 1e9, **style)
    axes[0].set(xlabel="reduction of the height", ylabel="force (nN)", title="elastic balls: equilibria (dotted: explicit)")
    for k, n in enumerate(NUCLEI):
        for d, width in zip(DURATIONS, (0.6, 0.9, 1.2, 1.6)):
            history = cells[n, d].history
            if history is not None:
                axes[1].plot(history["reduction"], history["force"] * 1e9, color=f"C{k}", linewidth=width,
                             label=f"nucleus {n} R" if d == DURATIONS[-1] else None)
    axes[1].set(xlabel="reduction of the height", title="cell in 100, 200, 400, 800 µs (thicker: slower)")
    for axis in axes:
        axis.legend(loc="upper left")
        axis.set_ylim(bottom=0.0)
    return text, {"compression": figure}
