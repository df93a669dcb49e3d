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
from vtu_reader import Grid, read_history, read_series

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from matplotlib.collections import PolyCollection

UM, KPA, US = 1e6, 1e-3, 1e6  # from SI to the units of the figure


def draw_substrate(axes, soft, stiff, half):
    """The factor on the constants, by the angle from +x."""
    x, y = np.meshgrid(np.linspace(-half, half, 201), np.linspace(-half, half, 201))
    factor = soft + (stiff - soft) * np.abs(np.arctan2(y, x)) / np.pi
    return axes.imshow(factor, extent=(-half, half, -half, half), origin="lower", cmap="Greys", vmin=0.0,
                       vmax=1.6 * max(soft, stiff), interpolation="bilinear")


def seen_from_above(cell):
    """Facets that face up, the lowest first: corners (n, 4, 2), µm, and effective stress (n), kPa."""
    facets = cell.surface()
    corners = cell.points[facets] * UM
    up = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])[:, 2] > 0.0
    order = np.argsort(corners[up][:, :, 2].mean(axis=1))
    stress = np.nan_to_num(cell.point_data["effective_stress"])[facets].mean(axis=1)[up] * KPA
    return corners[up][order][:, :, :2], stress[order]


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
    views = [(time, *seen_from_above(Grid(parts["cell"]))) for time, parts in chosen]
    half = 1.15 * max(np.abs(corners).max() for _, corners, _ in views)
    norm = matplotlib.colors.Normalize(0.0, max(np.percentile(stress, 99) for _, _, stress in views))

    plt.rcParams.update({"font.size": 9})
    figure, axes = plt.subplots(1, len(views) + 1, figsize=(2.6 * len(views) + 3.4, 3.1), layout="constrained",
                                width_ratios=[1.0] * len(views) + [1.3])
    for axis, (time, corners, stress) in zip(axes, views):
        draw_substrate(axis, soft, stiff, half)
        axis.add_collection(PolyCollection(corners, facecolors=plt.get_cmap("viridis")(norm(stress)), edgecolors=(0, 0, 0, 0.15),
                                           linewidths=0.2))
        axis.set(title=f"{time * US:.3g} µs", xlabel="x (µm): stiff ← → soft", aspect="equal")
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
