"""Errors of the frequencies of bars and balls by resolution."""
import csv
import pathlib

SIZE = 2


def read(path):
    with open(path) as file:
        rows = list(csv.reader(file))
    return rows[0], [[float(x) for x in row] for row in rows[1:]]


def draw(folder, axes):
    folder = pathlib.Path(folder)
    names, rows = read(folder / "vibration_bars.csv")
    for k, name in enumerate(names[1:], 1):
        axes[0].plot([row[0] for row in rows], [100 * row[k] for row in rows], "o-", markersize=3, label=name)
    axes[0].set_xlabel("cells across the bar")
    _, rows = read(folder / "vibration_ball.csv")
    rows = [row for row in rows if row[3] == row[3]][:3]
    for l in (2, 3, 4):
        axes[1].plot([row[0] for row in rows], [100 * row[l] for row in rows], "o-", markersize=3, label=f"ball, l = {l}")
    axes[1].set_xscale("log")
    axes[1].set_xlabel("particles of the ball")
    for panel in axes:
        panel.set_ylabel("error of the frequency (%)")
        panel.axhline(0, color="black", linewidth=0.5)
        panel.grid(alpha=0.3)
        panel.legend(fontsize=6)
