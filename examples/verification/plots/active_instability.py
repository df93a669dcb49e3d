"""Growth rates of the spontaneous flow of a contractile channel."""
import numpy as np

SIZE = 2


def draw(folder, axes):
    for axis, walls, title in ((axes[0], "free", "one wall free of shear"), (axes[1], "no_slip", "two no-slip walls")):
        for name, marker in (("corotational", "o"), ("convected", "x")):
            data = np.genfromtxt(folder / f"active_instability_{name}_{walls}.csv", delimiter=",", names=True)
            for cells, colour in zip(np.unique(data["cells"]), ("tab:gray", "tab:blue")):
                now = data[(data["cells"] == cells) & (data["stabilised"] == 0)]
                axis.plot(now["activity"], 1e-3 * now["rate_per_s"], marker, color=colour, ms=6,
                          label=f"{name}, {cells:.0f} cells")
        now = np.sort(data, order="activity")
        axis.plot(now["activity"], 1e-3 * now["stokes_rate_per_s"], "k-", lw=0.8, label="Stokes limit")
        axis.axhline(0, color="k", lw=0.4)
        axis.set(xlabel=r"$\zeta/\zeta_c$", ylabel="growth rate (1/ms)", title=title)
        axis.legend(fontsize="small")
