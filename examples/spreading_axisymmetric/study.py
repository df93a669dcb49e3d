"""Fig. 10 of the paper: the axisymmetric model against the one in three dimensions, at the same parameters."""

import numpy as np
import matplotlib.pyplot as plt

from spreading_pictures import draw_sections
from study_tools import KPA, UM, US, Case, number, percent, resolution, table
from vtu_reader import read_series

TITLE = "The axisymmetric model (Fig. 10)"
COMMON = [("end-time", "4.5us"), ("activity", "0Pa"), ("director", "radial"), ("frames", "9")]
PRESETS = [[("preset", "printed"), ("stiffness", "10")], [("preset", "elastic"), ("stiffness", "2")]]
SECTIONS = [resolution(r) for r in (1.0, 2.0, 4.0)]
BODIES = [resolution(r) for r in (1.0, 1.4)]
SWEEPS = [
    ("section", "spreading_axisymmetric", COMMON, [[("resolution", r), *p] for p in PRESETS for r in SECTIONS]),
    ("body", "spreading_uniform", COMMON, [[("resolution", r), *p] for p in PRESETS for r in BODIES]),
]
TIMES = [1e-6, 1.5e-6, 2e-6, 2.5e-6, 3e-6, 3.5e-6, 4e-6, 4.5e-6]


def name(options):
    o = dict(options)
    return f"{o['preset']}, stiffness {o['stiffness']}"


def largest_difference(one, other, start):
    """Of the spreading areas from a time on, %, of both signs."""
    return max(abs(percent(one.at("spread_area", t), other.at("spread_area", t))) for t in np.linspace(start, 4.5e-6, 200))


def report(folder):
    section = {(name(p), r): Case(folder / "section", [("resolution", r), *p]) for p in PRESETS for r in SECTIONS}
    body = {(name(p), r): Case(folder / "body", [("resolution", r), *p]) for p in PRESETS for r in BODIES}
    text = "![Time sequence and area](spreading_axisymmetric/axisymmetric.png)\n\n"
    for p in PRESETS:
        text += (f"**Spreading area**, µm², {name(p)}, no active stress: of sections and of bodies in three dimensions at several "
                 "resolutions, and the differences of the section from the body, both at resolution 1, and of the finest of both:\n\n")
        rows = []
        for time in TIMES:
            of_section = [section[name(p), r].at("spread_area", time) * UM**2 for r in SECTIONS]
            of_body = [body[name(p), r].at("spread_area", time) * UM**2 for r in BODIES]
            rows.append([f"{time * US:g} µs", *(number(v, 4) for v in of_section + of_body),
                         f"{percent(of_section[0], of_body[0]):+.1f} %", f"{percent(of_section[-1], of_body[-1]):+.1f} %"])
        text += table(["time", *(f"section, {r}" for r in SECTIONS), *(f"body, {r}" for r in BODIES), "both at 1", "finest"], rows) + "\n"
        largest = [largest_difference(section[name(p), SECTIONS[-1]], body[name(p), BODIES[-1]], start) for start in (1e-6, 1.5e-6, 2e-6)]
        text += "Largest difference of the finest from 1, 1.5 and 2 µs on: " + ", ".join(f"{d:.1f} %" for d in largest) + ".\n\n"
    rows = []
    for p in PRESETS:
        for r in SECTIONS:
            one = section[name(p), r]
            rows.append([f"{name(p)}, resolution {r}", *(number(one.at("nucleus_effective_stress_mean", t) * KPA, 4) for t in (2e-6, 3e-6, 4.5e-6)),
                         f"{one.summary.get('wall_seconds', float('nan')):.0f} s"])
        for r in BODIES:
            one = body[name(p), r]
            rows.append([f"{name(p)}, body, resolution {r}", *(number(one.at("nucleus_effective_stress_mean", t) * KPA, 4) for t in (2e-6, 3e-6, 4.5e-6)),
                         f"{one.summary.get('wall_seconds', float('nan')):.0f} s"])
    text += "**Mean effective stress in the nucleus**, kPa, and what a run took on one thread:\n\n"
    text += table(["", "2 µs", "3 µs", "4.5 µs", ""], rows)
    return text, {"axisymmetric": draw(section, body)}


def draw(section, body):
    figure = plt.figure(figsize=(9.2, 7.0), layout="constrained", dpi=85)
    grid = figure.add_gridspec(3, 3, height_ratios=[1.0, 1.0, 1.35])
    shown = section[name(PRESETS[0]), SECTIONS[1]]
    if shown.completed:
        draw_sections(figure, grid, [frame for frame in read_series(f"{shown.folder}/fields.pvd") if frame[0] > 0.9e-6])
    for k, p in enumerate(PRESETS):
        axis = figure.add_subplot(grid[2, k])
        for runs, levels, style, label in ((section, SECTIONS, "-", "section"), (body, BODIES, "--", "body")):
            for j, r in enumerate(levels):
                history = runs[name(p), r].history
                if history is not None:
                    axis.plot(history["time"] * US, history["spread_area"] * UM**2, style, color=f"C{j if style == '-' else 3 + j}",
                              linewidth=1.0, label=f"{label}, resolution {r}")
        axis.set(xlabel="time (µs)", ylabel="spreading area (µm²)", title=name(p))
    axis.legend(fontsize=7)
    axis = figure.add_subplot(grid[2, 2])
    for k, p in enumerate(PRESETS):
        fine, coarse = section[name(p), SECTIONS[-1]], body[name(p), BODIES[-1]]
        if fine.history is None or coarse.history is None:
            continue
        time = np.linspace(0.8e-6, 4.5e-6, 150)
        axis.plot(time * US, [percent(fine.at("spread_area", t), coarse.at("spread_area", t)) for t in time], label=name(p))
    axis.axhspan(-5.0, 5.0, color="0.93")
    axis.set(xlabel="time (µs)", ylabel="section against body, finest (%)", ylim=(-12.0, 12.0))
    axis.legend(fontsize=7)
    return figure
