"""Fig. 3 of the paper: loops of stress against strain of a bar of the gel, and what it loses in a cycle."""

import matplotlib.pyplot as plt
import numpy as np

from study_tools import KPA, Case, number, percent, table

TITLE = "Loops of a bar of the gel (Fig. 3)"
VISCOSITY = ["3mPa.s", "0.3Pa.s"]
FREQUENCY = ["1kHz", "10kHz", "100kHz", "1MHz", "10MHz"]
UNIFORM = [[("viscosity", v), ("frequency", f)] for v in VISCOSITY for f in FREQUENCY]
INERTIAL = [[("bulk-modulus", k), ("frequency", f)]
            for k, f in (("0.68MPa", "1kHz"), ("0.68MPa", "10kHz"), ("2.2GPa", "100kHz"), ("2.2GPa", "1MHz"))]
SWEEPS = [
    ("uniform", "bar_hysteresis", [("method", "uniform"), ("cells", "20")], UNIFORM),
    ("inertial", "bar_hysteresis", [("method", "inertial"), ("cells", "100"), ("cycles", "6")], INERTIAL),
]


def hertz(text):
    return float(text[:-3]) * {"k": 1e3, "M": 1e6}[text[-3]]


def spelled(text):
    return text.replace(".s", " s").replace("mPa", " mPa").replace("MPa", " MPa").replace("GPa", " GPa").replace("0.3Pa", "0.3 Pa").replace(
        "kHz", " kHz").replace("MHz", " MHz")


def report(folder):
    uniform = {tuple(dict(o).values()): Case(folder / "uniform", o) for o in UNIFORM}
    inertial = {tuple(dict(o).values()): Case(folder / "inertial", o) for o in INERTIAL}
    text = "![Loops, losses](bar_hysteresis/loops.png)\n\n"
    text += ("The loss in a cycle, per reference volume, of the bar that stretches uniformly (no inertia), K = 0.68 MPa; exactly "
             "4πμω (1 − √(1 − e²)), e = 0.25; and how far the loop opens, the largest viscous stress over the largest stress:\n\n")
    rows = []
    for (v, f), case in uniform.items():
        s = case.summary
        e, omega = 0.25, 2.0 * np.pi * hertz(f)
        viscous = 2.0 * (0.003 if v == VISCOSITY[0] else 0.3) * omega * e / np.sqrt(1.0 - e * e)
        rows.append([spelled(v), spelled(f), number(s.get("loss", np.nan), 6), number(s.get("uniform_loss", np.nan), 6),
                     f"{percent(s.get('loss', np.nan), s.get('uniform_loss', np.nan)):+.4f} %",
                     f"{100.0 * viscous / s.get('peak_stress', np.nan):.2g} %"])
    text += table(["μ", "f", "loss, Pa", "exact, Pa", "difference", "opening"], rows)
    text += ("\nWith inertia, the ends alone being held (μ = 3 mPa s), where the end is slower than 0.3 c: what the sixth cycle "
             "dissipates, free vibrations that the start has left included:\n\n")
    rows = []
    for (k, f), case in inertial.items():
        s = case.summary
        rows.append([spelled(k), spelled(f), f"{s.get('end_speed_over_wave_speed', np.nan):.3f}", number(s.get("dissipated", np.nan), 4),
                     f"{percent(s.get('dissipated', np.nan), s.get('uniform_loss', np.nan)):+.1f} %"])
    text += table(["K", "f", "largest end speed over c", "dissipated, Pa", "against the uniform bar"], rows)

    figure, axes = plt.subplots(1, 4, figsize=(11.5, 2.9), layout="constrained")
    for axis, v in zip(axes, VISCOSITY):
        for f in ("1kHz", "100kHz", "1MHz"):
            history = uniform[v, f].history
            if history is not None:
                axis.plot(history["strain"], history["stress"] * KPA, label=spelled(f))
        axis.set(xlabel="strain u/L", ylabel="Cauchy stress (kPa)", title=f"uniform, K = 0.68 MPa, μ = {spelled(v)}")
        axis.legend()
    for (k, f), case in inertial.items():
        if k == "2.2GPa" and case.history is not None:
            axes[2].plot(case.history["strain"], case.history["end_stress"] * 1e-6, label=spelled(f))
    axes[2].set(xlabel="strain u/L", ylabel="stress at the moved end (MPa)", title="with inertia, K = 2.2 GPa")
    axes[2].legend()
    for v, mark in zip(VISCOSITY, "os"):
        axes[3].loglog([hertz(f) for f in FREQUENCY], [uniform[v, f].summary.get("loss", np.nan) for f in FREQUENCY], mark, markersize=4,
                       label=f"uniform, {spelled(v)}")
        axes[3].loglog([hertz(f) for f in FREQUENCY], [uniform[v, f].summary.get("uniform_loss", np.nan) for f in FREQUENCY], "k-",
                       linewidth=0.8)
    axes[3].loglog([hertz(f) for _, f in inertial], [case.summary.get("dissipated", np.nan) for case in inertial.values()], "x",
                   label="with inertia, 3 mPa s")
    axes[3].set(xlabel="frequency (Hz)", ylabel="loss in a cycle (Pa)", title="lines: exact")
    axes[3].legend(fontsize=7)
    return text, {"loops": figure}
