"""Yang's branch: relaxation after a step, storage and loss moduli."""
import numpy as np

SIZE = 2


def draw(folder, axes):
    relaxation, moduli = axes
    for invariant, colour in (("I3", "tab:blue"), ("I2", "tab:orange")):
        data = np.genfromtxt(folder / f"viscoelastic_relaxation_{invariant}.csv", delimiter=",", names=True)
        some = slice(None, None, max(1, len(data) // 20))
        relaxation.semilogy(1e6 * data["time_s"], 1e-6 * data["exact_Pa"], color=colour, lw=1)
        relaxation.semilogy(1e6 * data["time_s"][some], 1e-6 * data["branch_Pa"][some], "o", ms=4, color=colour,
                            label=f"block, $I = I_{invariant[1]}$")
        data = np.genfromtxt(folder / f"viscoelastic_moduli_{invariant}.csv", delimiter=",", names=True)
        w = np.logspace(-1.2, 1.2, 100)
        scale = 1e-6 * data["storage_exact_Pa"][0] * (1 + data["omega_A3"][0] ** 2) / data["omega_A3"][0] ** 2
        moduli.loglog(w, scale * w**2 / (1 + w**2), color=colour, lw=1)
        moduli.loglog(w, scale * w / (1 + w**2), "--", color=colour, lw=1)
        moduli.loglog(data["omega_A3"], 1e-6 * data["storage_Pa"], "o", ms=4, color=colour,
                      label=f"storage, $I_{invariant[1]}$")
        moduli.loglog(data["omega_A3"], 1e-6 * data["loss_Pa"], "^", ms=4, color=colour, label=f"loss, $I_{invariant[1]}$")
    relaxation.set(xlabel="time after the step (µs)", ylabel="traction of the branch (MPa)",
                   title=r"step strain; lines: $e^{-t/A_3}$")
    moduli.set(xlabel=r"$\omega A_3$", ylabel="shear moduli of the branch (MPa)", title="harmonic strain; lines: Maxwell")
    relaxation.legend()
    moduli.legend(fontsize="small")
