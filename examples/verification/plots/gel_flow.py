"""Shear flows of the gel that start from rest, and their convergence."""
import numpy as np

SIZE = 3


def draw(folder, axes):
    convergence = axes[2]
    for flow, axis, colour in (("Couette", axes[0], "tab:blue"), ("Poiseuille", axes[1], "tab:orange")):
        data = np.genfromtxt(folder / f"gel_flow_{flow}_profile.csv", delimiter=",", names=True)
        for number, time in enumerate(np.unique(data["time_s"])):
            now = np.sort(data[data["time_s"] == time], order="y_m")
            axis.plot(now["exact_m_per_s"], 1e6 * now["y_m"], "k-", lw=0.8)
            axis.plot(now["u_m_per_s"], 1e6 * now["y_m"], "o", ms=4, color=f"C{number}",
                      label=f"{1e6 * time:.1f} µs")
        axis.set(xlabel="velocity (m/s)", ylabel="height (µm)", title=f"{flow} from rest; lines: exact")
        axis.legend(fontsize="small")
        data = np.genfromtxt(folder / f"gel_flow_{flow}_convergence.csv", delimiter=",", names=True)
        convergence.loglog(data["cells"], data["error"], "o-", color=colour, label=flow)
        convergence.loglog(data["cells"], data["error_stabilised"], "s--", color=colour, label=f"{flow}, stabilised")
    cells = data["cells"]
    convergence.loglog(cells, 2 * data["error"][0] * (cells[0] / cells) ** 2, "k:", label="second order")
    convergence.set(xlabel="cells over the height", ylabel="rms error over the largest speed", title="convergence")
    convergence.set_xticks(cells, [f"{n:.0f}" for n in cells])
    convergence.minorticks_off()
    convergence.legend(fontsize="small")
