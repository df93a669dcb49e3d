#!/usr/bin/python3
"""Draws the result of durotaxis: the cell from above on its substrate, where it goes, its bonds and their pull.

/usr/bin/python3 plot.py FOLDER [--output FILE.png]
"""

import argparse
import os
import sys
import tomllib

import numpy as np

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "common"))
from plot_program import run
from spreading_pictures import draw_from_above, evenly, views_from_above
from vtu_reader import read_history, read_series

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

US, NM, NN = 1e6, 1e9, 1e9  # from SI to the units of the figure


def main():
    parser = argparse.ArgumentParser(description="Draws the result of durotaxis.")
    parser.add_argument("folder")
    parser.add_argument("--output", help="default: FOLDER/durotaxis.png")
    given = parser.parse_args()
    with open(os.path.join(given.folder, "parameters.toml"), "rb") as file:
        parameters = tomllib.load(file)
    history = read_history(os.path.join(given.folder, "history.csv"))
    frames = evenly(read_series(os.path.join(given.folder, "fields.pvd"))[1:], 2)
    views, half = views_from_above(frames)
    norm = matplotlib.colors.Normalize(0.0, max(np.percentile(stress, 98) for _, _, stress in views), clip=True)

    plt.rcParams.update({"font.size": 9})
    figure, axes = plt.subplots(1, len(views) + 2, figsize=(3.1 * len(views) + 6.4, 3.1), layout="constrained")
    for axis, (time, corners, stress) in zip(axes, views):
        draw_from_above(axis, corners, stress, norm, parameters["soft"], parameters["stiff"], half)
        axis.set(title=f"{time * US:.3g} µs", ylabel="y (µm)")
    figure.colorbar(matplotlib.cm.ScalarMappable(norm, "viridis"), ax=axes[len(views) - 1], label="effective stress (kPa)")
    time = history["time"] * US
    for name, text in (("com_x", "centre of mass, x"), ("com_y", "centre of mass, y")):
        axes[-2].plot(time, history[name] * NM, label=text)
    axes[-2].set(xlabel="time (µs)", ylabel="displacement (nm)")
    for side, text in (("plus_x", "side +x"), ("minus_x", "side −x")):
        axes[-1].plot(time, history[f"pull_{side}"] * NN, label=f"pull inward, {text}")
    axes[-1].set(xlabel="time (µs)", ylabel="bonds' force on the substrate (nN)")
    for axis in axes[-2:]:
        axis.axhline(0.0, color="black", linewidth=0.6)
        axis.legend(frameon=False, fontsize=7)
        axis.grid(alpha=0.25)
    output = given.output or os.path.join(given.folder, "durotaxis.png")
    figure.savefig(output, dpi=100)
    print(f"Wrote {output}")


if __name__ == "__main__":
    run(main)
