#!/usr/bin/python3
"""Draws the result of spreading_uniform: the cell on its substrate, a cut through both, the history.

/usr/bin/python3 plot.py FOLDER [--output FILE.png] [--frame N]      (N: 0, 1, …; -1 is the last one)
"""

import argparse
import os
import sys

import numpy as np

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "common"))
from plot_program import run
from vtu_reader import HEXAHEDRON, Grid, read_history, read_series

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from matplotlib.collections import PolyCollection
from mpl_toolkits.mplot3d.art3d import Poly3DCollection

UM, KPA, US = 1e6, 1e-3, 1e6  # from SI to the units of the figure
COLORS = plt.get_cmap("viridis")
GREY = np.array([0.86, 0.86, 0.88, 1.0])
VIEW = {"elev": 24.0, "azim": -62.0}
TETRAHEDRA = [[0, 1, 2, 6], [0, 2, 3, 6], [0, 3, 7, 6], [0, 7, 4, 6], [0, 4, 5, 6], [0, 5, 1, 6]]


def normals(corners):
    n = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
    return n / np.maximum(np.linalg.norm(n, axis=1, keepdims=True), 1e-300)


def view_direction():
    elevation, azimuth = np.radians(VIEW["elev"]), np.radians(VIEW["azim"])
    return np.array([np.cos(elevation) * np.cos(azimuth), np.cos(elevation) * np.sin(azimuth), np.sin(elevation)])


def lit(colors, n):
    """Colours of facets under a lamp from the upper left, behind the viewer."""
    lamp = view_direction() + np.array([-0.6, 0.1, 0.9])
    brightness = 0.55 + 0.45 * np.clip(n @ (lamp / np.linalg.norm(lamp)), 0.0, 1.0)
    return np.column_stack([colors[:, :3] * brightness[:, None], colors[:, 3]])


def stress(grid):
    return np.nan_to_num(grid.point_data["effective_stress"]) * KPA


def draw_scene(axes, cell, substrate, norm):
    x = cell.points * UM
    facets = cell.surface()
    center, extent = x.mean(axis=0), np.ptp(x, axis=0).max()
    n = normals(x[facets])
    polygons = [x[facets]]
    colors = [lit(COLORS(norm(stress(cell)[facets].mean(axis=1))), n)]
    edges = [np.tile([0.0, 0.0, 0.0, 0.12], (len(facets), 1))]
    if substrate is not None:
        y = substrate.points * UM
        ground = substrate.surface()
        up = normals(y[ground])
        top = up[:, 2] > 0.3
        polygons.append(y[ground[top]])
        colors.append(lit(np.tile(GREY, (top.sum(), 1)), up[top]))
        edges.append(np.tile([0.0, 0.0, 0.0, 0.06], (top.sum(), 1)))
    # One collection, so that the facets of both bodies are sorted by depth together.
    axes.add_collection3d(
        Poly3DCollection(np.concatenate(polygons), facecolors=np.concatenate(colors),
                         edgecolors=np.concatenate(edges), linewidths=0.3, zsort="average"))
    if "director" in cell.point_data:
        seen = n @ view_direction() > 0.15
        middle = x[facets].mean(axis=1)[seen] + 0.05 * n[seen]
        h = cell.point_data["director"][facets].mean(axis=1)[seen]
        step = max(1, len(middle) // 260)
        middle, h = middle[::step], h[::step]
        length = 0.055 * extent
        axes.quiver(*(middle - 0.5 * length * h).T, *(length * h).T, color="black", linewidth=0.8, arrow_length_ratio=0.35,
                    zorder=10)
    everything = np.concatenate([p.reshape(-1, 3) for p in polygons])
    low, high = everything.min(axis=0), everything.max(axis=0)
    axes.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), zlim=(low[2], high[2]))
    axes.set_box_aspect(high - low, zoom=1.38)
    axes.set_axis_off()
    # A scale bar on the ground, in front.
    bar = 5.0
    front = [center[0] - bar / 2, low[1], low[2] if substrate is None else everything[:, 2].min()]
    axes.plot([front[0], front[0] + bar], [front[1]] * 2, [front[2]] * 2, color="black", linewidth=3, zorder=11)
    axes.text(front[0] + bar / 2, front[1], front[2] - 0.09 * extent, f"{bar:g} µm", ha="center", va="top", zorder=11)


def cut(grid, values, plane_y):
    """The cut of the hexahedra with the plane y = plane_y: polygons (x, z) and the mean value on each."""
    hexahedra = grid.cells(HEXAHEDRON)
    y = grid.points[:, 1] - plane_y
    crossing = (y[hexahedra].min(axis=1) <= 0.0) & (y[hexahedra].max(axis=1) > 0.0)
    polygons, means = [], []
    for tetrahedron in hexahedra[crossing][:, TETRAHEDRA].reshape(-1, 4):
        inside, outside = tetrahedron[y[tetrahedron] <= 0.0], tetrahedron[y[tetrahedron] > 0.0]
        if len(inside) == 0 or len(outside) == 0:
            continue
        if len(inside) == 2:
            pairs = [(inside[0], outside[0]), (inside[0], outside[1]), (inside[1], outside[1]), (inside[1], outside[0])]
        else:
            pairs = [(a, b) for a in inside for b in outside]
        weights = [y[a] / (y[a] - y[b]) for a, b in pairs]
        polygons.append([((1 - w) * grid.points[a] + w * grid.points[b])[[0, 2]] for (a, b), w in zip(pairs, weights)])
        means.append(np.mean([(1 - w) * values[a] + w * values[b] for (a, b), w in zip(pairs, weights)]))
    return polygons, np.array(means)


def spread_out(x, chosen, distance):
    """Indices of chosen points that keep a distance in the (x, z) plane from each other, so that arrows do not overlap."""
    kept = []
    for i in np.flatnonzero(chosen):
        if all((x[i, 0] - x[j, 0]) ** 2 + (x[i, 2] - x[j, 2]) ** 2 >= distance**2 for j in kept):
            kept.append(i)
    return np.array(kept, dtype=int)


def draw_cut(axes, cell, substrate, norm):
    x = cell.points * UM
    center = x.mean(axis=0)
    plane = cell.points[:, 1].mean()
    if substrate is not None:
        polygons, _ = cut(substrate, stress(substrate), plane)
        axes.add_collection(PolyCollection([np.array(p) * UM for p in polygons], facecolors=[GREY], edgecolors=[GREY],
                                           linewidths=0.4))
    polygons, values = cut(cell, stress(cell), plane)
    colors = COLORS(norm(values))
    axes.add_collection(PolyCollection([np.array(p) * UM for p in polygons], facecolors=colors, edgecolors=colors,
                                       linewidths=0.4))
    reference_y = cell.points[:, 1] - cell.point_data["displacement"][:, 1]
    spacing = (np.prod(np.ptp(cell.points, axis=0)) / len(cell.points)) ** (1 / 3)
    near = np.abs(reference_y - reference_y.mean()) < 0.3 * spacing
    if "director" in cell.point_data:
        near = spread_out(x, near, 0.85 * spacing * UM)
        h = cell.point_data["director"][near]
        axes.quiver(x[near, 0], x[near, 2], h[:, 0], h[:, 2], pivot="mid", color="white", scale_units="xy", angles="xy",
                    scale=1.3 / (spacing * UM), width=0.0022, headwidth=3.5)
    low, high = x.min(axis=0), x.max(axis=0)
    half = 0.62 * np.ptp(x, axis=0)[:2].max()
    axes.set(xlim=(center[0] - half, center[0] + half), ylim=(low[2] - 2.2, high[2] + 0.6), xlabel="x (µm)", ylabel="z (µm)")
    axes.set_aspect("equal", adjustable="box")
    axes.set_title(f"cut at y = {plane * UM + 0.0:.1f} µm".replace("-0.0", "0.0"), loc="left", fontsize=10)


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

    shown = stress(cell)
    top = max(float(np.percentile(shown, 98.0)), 1e-9)
    norm = matplotlib.colors.Normalize(0.0, top, clip=True)

    plt.rcParams.update({"font.size": 9, "axes.titlesize": 10})
    figure = plt.figure(figsize=(13.0, 7.0))
    scene = figure.add_axes([-0.02, 0.09, 0.60, 0.90], projection="3d", computed_zorder=False)
    scene.view_init(**VIEW)
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
