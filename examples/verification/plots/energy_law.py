"""Energies of a compressible gel with its director in motion, and the defect of the energy law."""
import numpy as np

SIZE = 2


def draw(folder, axes):
    data = np.genfromtxt(folder / "energy_law_history.csv", delimiter=",", names=True)
    time = 1e6 * data["time_s"]
    for column, label in (("kinetic", "kinetic"), ("compression", "compression"), ("director", "director"),
                          ("dissipated", "dissipated")):
        axes[0].plot(time, 1e9 * data[f"{column}_J_per_m"], label=label)
    axes[0].set(xlabel="time (µs)", ylabel="energy (nJ/m)", title="energies")
    axes[0].legend()
    axes[1].plot(time, data["defect_J_per_m"] / data["dissipated_J_per_m"][-1])
    axes[1].set(xlabel="time (µs)", ylabel="defect over the dissipated", title="energy less all works, finest step")
