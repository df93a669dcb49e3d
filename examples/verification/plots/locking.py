"""Deflection of the nearly incompressible cantilever over the resolution."""
import csv
import pathlib

SIZE = 1


def draw(folder, axes):
    with open(pathlib.Path(folder) / "locking_deflection.csv") as file:
        rows = list(csv.DictReader(file))
    across = [float(r["cells across"]) for r in rows]
    axes[0].plot(across, [float(r["deflection [m]"]) for r in rows], "o-", label="NodalCentroids")
    axes[0].axhline(float(rows[0]["reference [m]"]), color="black", lw=1, label="mixed finite elements")
    axes[0].set_xlabel("cells across the section")
    axes[0].set_ylabel("deflection of the tip (m)")
    axes[0].legend()
