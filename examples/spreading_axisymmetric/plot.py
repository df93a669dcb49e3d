#!/usr/bin/python3
"""Draws a run of spreading_axisymmetric: frames with the director, spreading area against time.

/usr/bin/python3 plot.py FOLDER [--compare FOLDER] [--output FILE.png]      (to compare with: a run in three dimensions)
"""

import argparse
import os
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "common"))
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

from plot_program import run
from spreading_pictures import draw_sections
from vtu_reader import read_history, read_series

UM, US = 1e6, 1e6  # from SI to the units of the figure


def main():
    parser = argparse.ArgumentParser(description="Draws a run of spreading_axisymmetric.")
    parser.add_argument("folder")
    parser.add_argument("--compare", help="folder of a run of spreading_uniform")
    parser.add_argument("--output", help="default: FOLDER/axisymmetric.png")
    arguments = parser.parse_args()
    frames = read_series(os.path.join(arguments.folder, "fields.pvd"))
    if len(frames) < 2:
        raise ValueError(f"{arguments.folder} has no frame after the first one.")
    runs = [("meridian section", read_history(os.path.join(arguments.folder, "history.csv")))]
    if arguments.compare:
        runs.append(("three dimensions", read_history(os.path.join(arguments.compare, "history.csv"))))
    figure = plt.figure(figsize=(9.2, 7.0), layout="constrained")
    grid = figure.add_gridspec(3, 3, height_ratios=[1.0, 1.0, 1.35])
    draw_sections(figure, grid, frames[1:])
    area, radius = figure.add_subplot(grid[2, :2]), figure.add_subplot(grid[2, 2])
    for label, history in runs:
        area.plot(history["time"] * US, history["spread_area"] * UM**2, label=label)
        radius.plot(history["time"] * US, history["contact_radius"] * UM)
    area.set(xlabel="time (µs)", ylabel="spreading area (µm²)")
    radius.set(xlabel="time (µs)", ylabel="radius of the front (µm)")
    for axis in (area, radius):
        axis.set_ylim(bottom=0.0)
        axis.spines[["top", "right"]].set_visible(False)
        axis.grid(alpha=0.25)
    area.legend(frameon=False)
    output = arguments.output or os.path.join(arguments.folder, "axisymmetric.png")
    figure.savefig(output, dpi=110, facecolor="white")
    print(f"Wrote {output}")


if __name__ == "__main__":
    run(main)
