#!/usr/bin/python3
"""Draws runs of the tutorial: the section of the last frame of the first one, and force against depth of all, with Hertz's law.

/usr/bin/python3 plot.py FOLDER... [--output FILE.png]
"""

import argparse
import os
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "common"))
from vtu_reader import Grid, read_history, read_series


def hertz(depth, modulus=1e3, poisson=0.4, radius=5e-6):
    """Force on a ball between a plate and a rigid tip of the ball's radius, in terms of the sum of both indentations."""
    stiffness = 4.0 / 3.0 * modulus / (1.0 - poisson**2)
    softness = (stiffness * np.sqrt(radius / 2.0)) ** (-2.0 / 3.0) + (stiffness * np.sqrt(radius)) ** (-2.0 / 3.0)
    return (depth / softness) ** 1.5


parser = argparse.ArgumentParser(description="Draws runs of the tutorial.")
parser.add_argument("folders", nargs="+")
parser.add_argument("--output", default="indentation.png")
given = parser.parse_args()

plt.rcParams.update({"font.size": 9})
figure, (section, curves) = plt.subplots(1, 2, figsize=(7.0, 2.9), layout="constrained")

time, parts = read_series(os.path.join(given.folders[0], "fields.pvd"))[-1]
bead = Grid(parts["bead"])
middle = np.abs(bead.points[:, 1] - bead.point_data["displacement"][:, 1]) < 1e-9  # particles of the plane Y = 0
x, z = bead.points[middle][:, [0, 2]].T * 1e6
stress = bead.point_data["effective_stress"][middle]
filled = section.tricontourf(x, z, stress, levels=np.linspace(0.0, stress.max(), 21))
section.plot(x, z, "k.", markersize=1.0)
section.set(xlabel="x (µm)", ylabel="z (µm)", aspect="equal", title=f"section after {1e6 * time:.0f} µs", xlim=(-6, 6), ylim=(-0.3, 10.3))
angle = np.linspace(-0.7, 0.7, 50)
section.plot(5.0 * np.sin(angle), 14.0 - 5.0 * np.cos(angle), "k", lw=1.0)
section.axhline(0.0, color="k", lw=1.0)
figure.colorbar(filled, ax=section, label="effective stress (Pa)", ticks=np.linspace(0.0, stress.max(), 5).round(-1))

for folder in given.folders:
    history = read_history(os.path.join(folder, "history.csv"))
    curves.plot(1e6 * history["depth"], 1e9 * history["force"], lw=1.2, label=os.path.basename(folder))
depth = np.linspace(0.0, 1e-6, 100)
curves.plot(1e6 * depth, 1e9 * hertz(depth), "k--", lw=1.0, label="Hertz, 1 kPa")
curves.set(xlabel="depth (µm)", ylabel="force on the tip (nN)", xlim=(0, 1), ylim=(0, None))
curves.grid(alpha=0.25)
curves.legend(frameon=False)
figure.savefig(given.output, dpi=120)
print(f"Wrote {given.output}")
