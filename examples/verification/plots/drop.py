"""Oscillation of a drop of low viscosity, relaxation of a viscous one, against the exact normal modes."""
import csv
import glob
import os

SIZE = 2


def read(path):
    with open(path, newline="") as file:
        rows = list(csv.DictReader(file))
    return {key: [float(row[key]) for row in rows] for key in rows[0]}


def draw(folder, axes):
    for axis, kind, scale, unit in ((axes[0], "oscillation", 1e3, "ms"), (axes[1], "relaxation", 1e6, "µs")):
        for path in sorted(glob.glob(os.path.join(folder, f"drop_{kind}_*.csv"))):
            t = read(path)
            name, modulus = os.path.basename(path)[:-4].split("_")[2:]
            axis.plot([scale * x for x in t["time"]], [100 * x for x in t["elongation"]], label=f"{name}, stabilisation {modulus} Pa")
            if name == "variational" and (kind == "oscillation" or modulus == "5"):
                axis.plot([scale * x for x in t["time"]], [100 * x for x in t["theory"]], "k:", label="normal mode, exact")
        axis.set(xlabel=f"time, {unit}", ylabel="elongation, %")
        axis.legend(frameon=False, fontsize=7)
    axes[0].set_title("n = 2 oscillation, Oh = 0.0019")
    axes[1].set_title("overdamped n = 2 mode, Oh = 5")
