"""Convergence of the Ginzburg-Landau wall."""
import numpy as np

SIZE = 1


def draw(folder, axes):
    data = np.genfromtxt(folder / "director_wall.csv", delimiter=",", names=True)
    axis = np.atleast_1d(axes)[0]
    spacings = 0.1 * data["cells"]
    axis.loglog(spacings, data["profile_error"], "o-", label=r"profile, $\tanh(x/\sqrt{2}\epsilon_d)$")
    axis.loglog(spacings, data["energy_error"], "s-", label=r"energy, $2\sqrt{2}/(3\epsilon_d)$")
    axis.loglog(spacings, data["profile_error"][0] * (spacings[0] / spacings) ** 2, "k:", label="second order")
    axis.set(xlabel=r"spacings per core size $\epsilon_d$", ylabel="error", title="Ginzburg–Landau wall")
    axis.set_xticks(spacings, [f"{n:.0f}" for n in spacings])
    axis.minorticks_off()
    axis.legend()
