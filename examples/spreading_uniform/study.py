"""Claims 1 and 2 of the paper: do spreading area and stress in the nucleus depend on the stiffness of the substrate?"""

import numpy as np
import matplotlib.pyplot as plt

from spreading_pictures import colorbar, draw_cut, draw_scene, evenly, scale, view
from study_tools import KPA, UM, US, Case, number, percent, resolution, table
from vtu_reader import Grid, read_series

TITLE = "Does the stiffness of the substrate matter? (Figs. 5 to 9, claims 1 and 2)"
PRESETS = ["elastic", "viscous/10", "printed"]
STIFFNESS = {p: ["0.5", "1", "2", "5", "10", "20", "50"] for p in PRESETS}
RESOLUTIONS = [resolution(r) for r in (0.5, 0.7, 1.0, 1.4)]
LADDER = [[("preset", p), ("stiffness", s)] for p in PRESETS for s in STIFFNESS[p]]
MESHES = [[("resolution", r), ("preset", p), ("stiffness", s)]
          for r in RESOLUTIONS for p in ("elastic", "printed") for s in ("2", "10")]
THIRD = [("preset", "printed"), ("stiffness", "10")]  # substrate III, in time
SWEEPS = [
    ("ladder", "spreading_uniform", [("resolution", resolution(1)), ("end-time", "4.5us"), ("frames", "3")], LADDER),
    ("meshes", "spreading_uniform", [("end-time", "2us"), ("frames", "1")], MESHES),
    ("sequence", "spreading_uniform", [("resolution", resolution(1)), ("end-time", "4.5us"), ("frames", "9")], [THIRD]),
]
SUBSTRATES = {"2": "I", "5": "II", "10": "III"}
TIMES = [1e-6, 2e-6, 3e-6, 4.5e-6]
QUANTITIES = [("spread_area", UM**2, "spreading area", "µm²"),
              ("nucleus_effective_stress_mean", KPA, "mean effective stress in the nucleus", "kPa")]


def ladder_figure(ladder):
    figure, axes = plt.subplots(2, 3, figsize=(9.0, 5.0), sharex=True, sharey="row", layout="constrained")
    for row, (name, _, _, _), label in zip(axes, QUANTITIES, ("area", "stress in the nucleus")):
        for axis, preset in zip(row, PRESETS):
            for time in TIMES:
                ten = ladder[preset, "10"].at(name, time)
                axis.plot([float(s) for s in STIFFNESS[preset]],
                          [percent(ladder[preset, s].at(name, time), ten) for s in STIFFNESS[preset]], "o-", markersize=3,
                          label=f"{time * US:g} µs")
            axis.set_xscale("log")
        row[0].set_ylabel(f"{label}: difference\nfrom stiffness 10 (%)")
    for axis, preset in zip(axes[0], PRESETS):
        axis.set_title(preset)
    axes[0, 0].legend()
    for axis in axes[1]:
        axis.set_xlabel("stiffness (of the base substrate)")
    return figure


def frames(case):
    """The frames of a run: (time, cell, substrate); none where it did not come to its end."""
    if not case.completed:
        return []
    return [(time, Grid(parts["cell"]), Grid(parts["substrate"])) for time, parts in read_series(f"{case.folder}/fields.pvd")]


def contours_figure(ladder):
    """Figs. 6 and 8: effective stress of the cells on the three substrates at one time, on the surface and in a cut."""
    shown = {s: next((f for f in frames(ladder["elastic", s]) if abs(f[0] - 3e-6) < 1e-9), None) for s in SUBSTRATES}
    shown = {s: frame for s, frame in shown.items() if frame}
    figure = plt.figure(figsize=(9.2, 4.9), layout="constrained", dpi=88)
    if not shown:
        return figure
    grid = figure.add_gridspec(2, 3)
    inside = scale(*(cell for _, cell, _ in shown.values()))
    outside = scale(*(cell for _, cell, _ in shown.values()), on_surface=True)
    above, below = [], []
    for k, (s, (time, cell, substrate)) in enumerate(shown.items()):
        above.append(figure.add_subplot(grid[0, k], projection="3d"))
        view(above[-1])
        draw_scene(above[-1], cell, substrate, outside, zoom=1.5, ground=8.5, arrows=0, bar=False)
        above[-1].set_title(f"substrate {SUBSTRATES[s]}, {time * US:g} µs", loc="left")
        below.append(figure.add_subplot(grid[1, k]))
        draw_cut(below[-1], cell, substrate, inside)
        below[-1].set_title("", loc="left")
    colorbar(figure, outside, above, label="on the surface (kPa)", shrink=0.8)
    colorbar(figure, inside, below, label="inside (kPa)", shrink=0.8)
    return figure


def sequence_figure(case):
    """Fig. 9: the cell in time, with its director."""
    shown = evenly([frame for frame in frames(case) if frame[0] > 0.4e-6], 6)
    figure = plt.figure(figsize=(9.2, 4.9), layout="constrained", dpi=78)
    if not shown:
        return figure
    norm = scale(*(cell for _, cell, _ in shown), on_surface=True)
    axes = []
    for k, (time, cell, substrate) in enumerate(shown):
        axes.append(figure.add_subplot(2, 3, k + 1, projection="3d"))
        view(axes[-1])
        draw_scene(axes[-1], cell, substrate, norm, zoom=1.5, ground=8.5, arrows=130, bar=False)
        axes[-1].set_title(f"{time * US:.3g} µs", loc="left")
    colorbar(figure, norm, axes, label="effective stress on the surface (kPa)", shrink=0.8)
    return figure


def report(folder):
    ladder = {(p, s): Case(folder / "ladder", [("preset", p), ("stiffness", s)]) for p in PRESETS for s in STIFFNESS[p]}
    text = "![Area and stress against stiffness](spreading_uniform/stiffness.png)\n\n"
    for name, unit, label, unit_name in QUANTITIES:
        text += f"**{label.capitalize()}**, {unit_name}, at stiffness 2 / 5 / 10 (substrates I, II, III), and the change from I to III:\n\n"
        rows = []
        for time in TIMES:
            row = [f"{time * US:g} µs"]
            for p in PRESETS:
                values = [ladder[p, s].at(name, time) * unit for s in ("2", "5", "10")]
                row.append(" / ".join(number(v, 5) for v in values) + f" ({percent(values[2], values[0]):+.2f} %)")
            rows.append(row)
        text += table(["time", *PRESETS], rows) + "\n"
    text += ("**Meshes**: the change from stiffness 2 to stiffness 10 on one mesh, at four resolutions, and the spread of the "
             "values themselves between the meshes (largest over smallest), at 2 µs:\n\n")
    rows = []
    for name, _, label, _ in QUANTITIES:
        for p in ("elastic", "printed"):
            value = {(r, s): Case(folder / "meshes", [("resolution", r), ("preset", p), ("stiffness", s)]).at(name, 2e-6)
                     for r in RESOLUTIONS for s in ("2", "10")}
            changes = [percent(value[r, "10"], value[r, "2"]) for r in RESOLUTIONS]
            stiff = [value[r, "10"] for r in RESOLUTIONS]
            rows.append([f"{label}, {p}", *(f"{c:+.2f} %" for c in changes), f"{percent(np.nanmax(stiff), np.nanmin(stiff)):.1f} %"])
    text += table(["", *(f"resolution {r}" for r in RESOLUTIONS), "spread between meshes"], rows)
    text += ("\n**The three cells** on elastic substrates I, II and III, at one time: effective stress on the surface and inside "
             "(Figs. 6 and 8):\n\n![Stress contours of three cells](spreading_uniform/contours.png)\n\n"
             "**In time**, substrate III with the printed constants; arrows: director (Fig. 9):\n\n"
             "![Time sequence with directors](spreading_uniform/sequence.png)\n")
    return text, {"stiffness": ladder_figure(ladder), "contours": contours_figure(ladder),
                  "sequence": sequence_figure(Case(folder / "sequence", THIRD))}
