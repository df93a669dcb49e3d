"""The twisting column: shapes, and the histories of three resolutions."""
import csv
import pathlib

SIZE = 3


def read(path):
    with open(path) as file:
        rows = list(csv.reader(file))
    return rows[0], [[float(x) for x in row] for row in rows[1:]]


def draw_shapes(path, axes):
    _, rows = read(path)
    times = sorted({row[0] for row in rows})
    axes.set_aspect("equal")
    for n, time in enumerate(times):
        faces = []
        for row in rows:
            if row[0] != time:
                continue
            p = [row[1 + 3 * k:4 + 3 * k] for k in (0, 1, 3, 2)]
            # Seen along y, from a little above.
            flat = [(x + 2.6 * n, z + 0.25 * y) for x, y, z in p]
            depth = sum(y for _, y, _ in p)
            area = sum(flat[k][0] * flat[(k + 1) % 4][1] - flat[(k + 1) % 4][0] * flat[k][1] for k in range(4))
            if area > 0:
                a, b = [p[1][k] - p[0][k] for k in range(3)], [p[3][k] - p[0][k] for k in range(3)]
                normal = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
                length = sum(c * c for c in normal) ** 0.5
                light = max(0.0, (0.35 * normal[0] - 0.75 * normal[1] + 0.55 * normal[2]) / length)
                faces.append((-depth, flat, 0.35 + 0.6 * light))
        for _, flat, light in sorted(faces, key=lambda face: face[0]):
            color = (0.45 * light, 0.65 * light, light)
            axes.fill(*zip(*flat), facecolor=color, edgecolor=(0, 0, 0, 0.25), linewidth=0.2)
        axes.text(2.6 * n, -0.7, f"{1e3 * time:.0f} ms", ha="center", fontsize=7)
    axes.set_axis_off()


def draw(folder, axes):
    folder = pathlib.Path(folder)
    draw_shapes(folder / "column_shapes.csv", axes[0])
    runs = sorted(folder.glob("column_history_*.csv"), key=lambda path: int(path.stem.split("_")[-1]))
    for path in runs:
        _, rows = read(path)
        across = path.stem.split("_")[-1]
        time = [1e3 * row[0] for row in rows]
        axes[1].plot(time, [row[1] for row in rows], label=f"{across} cells across", linewidth=1)
        axes[2].plot(time, [row[2] for row in rows], label=f"{across} cells across", linewidth=1)
    axes[1].set_ylabel("height of the top (m)")
    axes[2].set_ylabel("twist of the top (rad)")
    for panel in axes[1:]:
        panel.set_xlabel("time (ms)")
        panel.legend(fontsize=7)
        panel.grid(alpha=0.3)
