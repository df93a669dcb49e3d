#!/usr/bin/python3
"""Draws the result of spreading_graded: the cell from above at several times, on its substrate; the front on both sides.

/usr/bin/python3 plot.py FOLDER [--output FILE.png]
"""

import argparse
import os
import sys
import tomllib

import numpy as np

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "common"))
from plot_program import run
from spreading_pictures import draw_from_above, views_from_above
from vtu_reader import read_history, read_series

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

UM, US = 1e6, 1e6  # from SI to the units of the figure


def main():
    parser = argparse.ArgumentParser(description="Draws the result of spreading_graded.")
    parser.add_argument("folder")
    parser.add_argument("--output", help="default: FOLDER/graded.png")
    given = parser.parse_args()
    with open(os.path.join(given.folder, "parameters.toml"), "rb") as file:
        parameters = tomllib.load(file)
    soft, stiff = parameters["soft"], parameters["stiff"]
    frames = read_series(os.path.join(given.folder, "fields.pvd"))
    history = read_history(os.path.join(given.folder, "history.csv"))
    chosen = [frames[k] for k in sorted({round(f * (len(frames) - 1)) for f in (0.25, 0.5, 0.75, 1.0)})]
    views, half = views_from_above(chosen)
    norm = matplotlib.colors.Normalize(0.0, max(np.percentile(stress, 99) for _, _, stress in views))

    plt.rcParams.update({"font.size": 9})
    figure, axes = plt.subplots(1, len(views) + 1, figsize=(2.6 * len(views) + 3.4, 3.1), layout="constrained",
                                width_ratios=[1.0] * len(views) + [1.3])
    for axis, (time, corners, stress) in zip(axes, views):
        draw_from_above(axis, corners, stress, norm, soft, stiff, half)
        axis.set(title=f"{time * US:.3g} µs")
    axes[0].set_ylabel("y (µm)")
    figure.colorbar(matplotlib.cm.ScalarMappable(norm, "viridis"), ax=axes[len(views) - 1], label="effective stress (kPa)")
    time = history["time"] * US
    axes[-1].plot(time, history["front_minus_x"] * UM, label="stiff side")
    axes[-1].plot(time, history["front_plus_x"] * UM, label="soft side")
    axes[-1].set(xlabel="time (µs)", ylabel="distance of the front (µm)")
    axes[-1].legend(frameon=False)
    axes[-1].grid(alpha=0.25)
    output = given.output or os.path.join(given.folder, "graded.png")
    figure.savefig(output, dpi=110)
    print(f"Wrote {output}")


if __name__ == "__main__":
    run(main)
