"""Pull-off against Tabor's number, the rigid sphere, and Hertz's law against the spacing."""
import csv
import os

SIZE = 3


def read(folder, name):
    with open(os.path.join(folder, name), newline="") as file:
        rows = list(csv.DictReader(file))
    return {key: [float(row[key]) for row in rows] for key in rows[0]}


def draw(folder, axes):
    sphere, pull_off, hertz = axes
    t = read(folder, "adhesion_derjaguin.csv")
    sphere.plot(t["gap_over_range"], [1e9 * f for f in t["exact"]], "k-", label="exact")
    sphere.plot(t["gap_over_range"], [1e9 * f for f in t["derjaguin"]], "k:", label="Derjaguin")
    sphere.plot(t["gap_over_range"], [1e9 * f for f in t["force"]], "o", ms=4, label="Tactoid")
    sphere.set(xlabel="gap / range", ylabel="force on the plate, nN", ylim=(-4, 8), title="Rigid sphere, R = 400 ranges")
    t = read(folder, "adhesion_pull_off.csv")
    pull_off.semilogx(t["tabor"], t["half_space"], "k-", label="half-space, same law")
    pull_off.semilogx(t["tabor"], t["pull_over_pi_R_W"], "o", label="Tactoid")
    for level, name in ((2.0, "DMT"), (1.5, "JKR")):
        pull_off.axhline(level, color="gray", lw=0.8, ls="--")
        pull_off.text(0.02, level - 0.03, name, color="gray")
    pull_off.set(xlabel="Tabor's number", ylabel="pull-off force / (π R W)", ylim=(1.3, 2.1), title="Pull-off of an elastic ball")
    t = read(folder, "adhesion_hertz.csv")
    hertz.plot(t["spacing_over_contact_radius"], t["force_over_hertz"], "o-", label="Tactoid")
    hertz.axhline(1.0052, color="k", lw=0.8, label="whole ball, theory")
    hertz.set(xlabel="spacing / contact radius", ylabel="force / Hertz's", xlim=(0, None), title="Indentation 0.05 %")
    for axis in axes:
        axis.legend(frameon=False)
