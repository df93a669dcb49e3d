"""Errors of manufactured equilibria over the spacing."""
import csv
import pathlib

SIZE = 2


def draw(folder, axes):
    for path in sorted(pathlib.Path(folder).glob("statics_*.csv")):
        if path.stem == "statics_newton":
            continue
        with open(path) as file:
            rows = list(csv.DictReader(file))
        name = path.stem.removeprefix("statics_").replace("_", " ")
        for axis, column in zip(axes, ("displacement", "gradient")):
            axis.loglog([float(r["spacing [m]"]) for r in rows], [float(r[column]) for r in rows], ".-", label=name)
    for axis, column in zip(axes, ("displacement", "displacement gradient")):
        axis.set_xlabel("spacing (m)")
        axis.set_ylabel(f"relative error of the {column}, L2")
    axes[0].legend(fontsize=6)
