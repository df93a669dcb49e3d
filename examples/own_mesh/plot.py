#!/usr/bin/python3
"""Draws the result of own_mesh: the cell from the side at several times, and its history.

/usr/bin/python3 plot.py FOLDER [--output FILE.png]
"""

import argparse
import os
import sys

import numpy as np

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "common"))
from plot_program import run
from vtu_reader import Grid, read_history, read_series

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from matplotlib.collections import PolyCollection

UM, KPA, US, NN = 1e6, 1e-3, 1e6, 1e9  # from SI to the units of the figure


def draw_side(axes, cell, norm):
    """Facets that face −y, the farthest first, coloured by effective stress."""
    facets = cell.surface()
    corners = cell.points[facets] * UM
    front = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])[:, 1] < 0.0
    order = np.argsort(-corners[front][:, :, 1].mean(axis=1))
    stress = np.nan_to_num(cell.point_data["effective_stress"])[facets].mean(axis=1)[front] * KPA
    axes.add_collection(PolyCollection(corners[front][order][:, :, [0, 2]], facecolors=plt.get_cmap("viridis")(norm(stress[order])),
                                       edgecolors=(0, 0, 0, 0.2), linewidths=0.2))


def main():
    parser = argparse.ArgumentParser(description="Draws the result of own_mesh.")
    parser.add_argument("folder")
    parser.add_argument("--output", help="default: FOLDER/own_mesh.png")
    given = parser.parse_args()
    frames = read_series(os.path.join(given.folder, "fields.pvd"))
    history = read_history(os.path.join(given.folder, "history.csv"))
    chosen = [frames[k] for k in sorted({round(f * (len(frames) - 1)) for f in (0.0, 0.35, 0.7, 1.0)})]
    cells = [(time, Grid(parts["cell"])) for time, parts in chosen]
    top = max(np.percentile(np.nan_to_num(cell.point_data["effective_stress"]), 98) for _, cell in cells) * KPA
    norm = matplotlib.colors.Normalize(0.0, max(top, 1e-9))
    points = np.concatenate([cell.points for _, cell in cells]) * UM
    low, high = points.min(axis=0) - 0.5, points.max(axis=0) + 0.5

    plt.rcParams.update({"font.size": 9})
    figure, axes = plt.subplots(1, len(cells) + 1, figsize=(2.9 * len(cells) + 3.2, 2.7), layout="constrained")
    for axis, (time, cell) in zip(axes, cells):
        draw_side(axis, cell, norm)
        axis.set(title=f"{time * US:.3g} µs", xlabel="x (µm)", aspect="equal", xlim=(low[0], high[0]), ylim=(low[2], high[2]))
    axes[0].set_ylabel("z (µm)")
    figure.colorbar(matplotlib.cm.ScalarMappable(norm, "viridis"), ax=axes[len(cells) - 1], label="effective stress (kPa)")
    axes[-1].plot(history["time"] * US, history["force"] * NN)
    axes[-1].set(xlabel="time (µs)", ylabel="force on the plate (nN)")
    axes[-1].grid(alpha=0.25)
    output = given.output or os.path.join(given.folder, "own_mesh.png")
    figure.savefig(output, dpi=100)
    print(f"Wrote {output}")


if __name__ == "__main__":
    run(main)
