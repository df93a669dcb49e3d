"""The ball that bounces in the adhesive potential: height and energy error."""
import csv
import pathlib

SIZE = 2


def draw(folder, axes):
    with open(pathlib.Path(folder) / "bouncing_height.csv") as file:
        rows = [[float(x) for x in row] for row in list(csv.reader(file))[1:]]
    time = [1e6 * row[0] for row in rows]
    axes[0].plot(time, [1e6 * row[1] for row in rows], linewidth=0.8)
    axes[0].set_ylabel("centre of the ball (µm)")
    axes[1].plot(time, [row[2] for row in rows], linewidth=0.8)
    axes[1].set_ylabel("energy error over kinetic energy at start")
    for panel in axes:
        panel.set_xlabel("time (µs)")
        panel.grid(alpha=0.3)
