"""Bodies of revolution: errors of a thick sphere and of a ball's frequencies, force of a ball between plates."""
import csv
import pathlib

SIZE = 3


def draw(folder, axes):
    def read(name):
        with open(pathlib.Path(folder) / f"revolution_{name}.csv") as file:
            return [{key: float(value) for key, value in row.items()} for row in csv.DictReader(file)]

    sphere = read("sphere")
    axes[0].loglog([r["cells_through"] for r in sphere], [r["error"] for r in sphere], "o-")
    axes[0].set_xlabel("cells through the shell")
    axes[0].set_ylabel("error of the displacement in L2")
    ball = read("ball")
    for degree in (2, 3):
        axes[1].loglog([r["core_cells"] for r in ball], [1.0 - r[f"eta_{degree}"] / r[f"exact_{degree}"] for r in ball], "o-",
                       label=f"l = {degree}")
    axes[1].set_xlabel("cells across the core")
    axes[1].set_ylabel("frequency below Lamb's (relative)")
    axes[1].legend()
    plates = read("plates")
    for name in ("section", "body"):
        axes[2].plot([r["resolution"] for r in plates], [r[f"{name} [N]"] * 1e9 for r in plates], "o-", label=name)
    axes[2].set_xlabel("resolution")
    axes[2].set_ylabel("force on a plate (nN)")
    axes[2].legend()
