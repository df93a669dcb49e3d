"""Errors of interpolation over the spacing."""
import csv
import pathlib

SIZE = 2


def draw(folder, axes):
    for path in sorted(pathlib.Path(folder).glob("kernel_*.csv")):
        with open(path) as file:
            rows = list(csv.DictReader(file))
        name = path.stem.removeprefix("kernel_").replace("_", " ")
        for axis, column in zip(axes, ("L2", "H1")):
            axis.loglog([float(r["spacing [m]"]) for r in rows], [float(r[column]) for r in rows], ".-", label=name)
    for axis, column in zip(axes, ("L2", "H1 seminorm")):
        axis.set_xlabel("spacing (m)")
        axis.set_ylabel(f"relative error, {column}")
    axes[0].legend(fontsize=6)
