#!/usr/bin/python3
"""Draws the result of spreading_uniform: the cell on its substrate, a cut through both, the history.

/usr/bin/python3 plot.py FOLDER [--output FILE.png] [--frame N]      (N: 0, 1, …; -1 is the last one)
"""

import argparse
import os
import sys

import numpy as np

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "common"))
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

from plot_program import run
from spreading_pictures import COLORS, UM, draw_cut, draw_scene, scale, view
from vtu_reader import Grid, read_history, read_series

US = 1e6  # from SI to the units of the figure


def draw_history(area_axes, energy_axes, history):
    time = history["time"] * US
    area_axes.plot(time, history["spread_area"] * UM**2, color="tab:blue")
    area_axes.set(xlabel="time (µs)", ylabel="spreading area (µm²)", xlim=(time[0], max(time[-1], time[0] + 1e-9)))
    area_axes.set_ylim(bottom=0.0)
    energies = {"kinetic_energy": "kinetic", "strain_energy": "strain", "adhesion_energy": "adhesion",
                "surface_energy": "surface", "dissipated_energy": "dissipated", "external_work": "external work"}
    present = {name: label for name, label in energies.items() if name in history}
    # Changes since the beginning: the balance is between them.
    changes = {label: history[name] - history[name][0] for name, label in present.items()}
    largest = max([np.nanmax(np.abs(change)) for change in changes.values()] + [0.0])
    unit, factor = next(((u, f) for u, f in [("nJ", 1e9), ("pJ", 1e12), ("fJ", 1e15)] if largest * f >= 1.0), ("aJ", 1e18))
    for label, change in changes.items():
        energy_axes.plot(time, change * factor, label=label, linewidth=1.2)
    energy_axes.set(xlabel="time (µs)", ylabel=f"change of energy ({unit})", xlim=area_axes.get_xlim())
    energy_axes.axhline(0.0, color="black", linewidth=0.5)
    energy_axes.legend(fontsize=7, ncol=2, frameon=False, loc="lower left", bbox_to_anchor=(-0.2, 1.0))
    for axes in (area_axes, energy_axes):
        axes.spines[["top", "right"]].set_visible(False)
        axes.grid(alpha=0.25)


def main():
    parser = argparse.ArgumentParser(description="Draws the result of spreading_uniform.")
    parser.add_argument("folder")
    parser.add_argument("--output", help="default: FOLDER/spreading.png")
    parser.add_argument("--frame", type=int, default=-1)
    parser.add_argument("--dpi", type=int, default=110)
    arguments = parser.parse_args()
    output = arguments.output or os.path.join(arguments.folder, "spreading.png")

    frames = read_series(os.path.join(arguments.folder, "fields.pvd"))
    if not -len(frames) <= arguments.frame < len(frames):
        raise ValueError(f"There is no frame {arguments.frame}: {arguments.folder} has {len(frames)}.")
    time, parts = frames[arguments.frame]
    cell = Grid(parts["cell"])
    substrate = Grid(parts["substrate"]) if "substrate" in parts else None
    history = read_history(os.path.join(arguments.folder, "history.csv"))

    norm = scale(cell)
    plt.rcParams.update({"font.size": 9, "axes.titlesize": 10})
    figure = plt.figure(figsize=(13.0, 7.0))
    scene = figure.add_axes([-0.02, 0.09, 0.60, 0.90], projection="3d")
    view(scene)
    draw_scene(scene, cell, substrate, norm)
    figure.text(0.02, 0.95, f"Cell on its substrate after {time * US:.3g} µs", fontsize=13)
    colorbar = figure.add_axes([0.12, 0.075, 0.34, 0.018])
    figure.colorbar(matplotlib.cm.ScalarMappable(norm, COLORS), cax=colorbar, orientation="horizontal", extend="max",
                    label="effective stress in the cell (kPa); arrows: director")
    draw_cut(figure.add_axes([0.605, 0.56, 0.385, 0.39]), cell, substrate, norm)
    draw_history(figure.add_axes([0.635, 0.09, 0.145, 0.31]), figure.add_axes([0.845, 0.09, 0.145, 0.31]), history)
    figure.savefig(output, dpi=arguments.dpi, facecolor="white")
    print(f"Wrote {output}")


if __name__ == "__main__":
    run(main)
