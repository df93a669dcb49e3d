"""Claim 3 of the paper: does the adhesion front become wavy, and is it the mesh or the physics?"""

import numpy as np
import matplotlib.pyplot as plt

from study_tools import UM, US, Case, resolution, table

TITLE = "Does the front become wavy? (Figs. 9 and 12, claim 3)"


def case(activity="-1Pa", director="random", seed="1", turn="0deg", mesh=1.0):
    return [("activity", activity), ("director", director), ("seed", seed), ("turn", turn), ("resolution", resolution(mesh))]


CASES = [
    case("0Pa", "uniform"), case("0Pa", "uniform", turn="30deg"), case("0Pa", "uniform", mesh=0.7),
    case("0Pa", "uniform", mesh=1.4),
    case("-1Pa"), case("-1Pa", turn="30deg"),
    case("-1kPa"), case("-1kPa", seed="2"), case("-1kPa", "uniform"), case("-1kPa", turn="30deg"),
    case("-1kPa", mesh=0.7), case("-1kPa", mesh=1.4),
    case("-5kPa"), case("-5kPa", "uniform"),
]
SWEEPS = [("front", "spreading_uniform", [("stiffness", "10"), ("end-time", "4.5us"), ("frames", "3")], CASES)]
TIME = 4.5e-6
MODES = range(2, 17)


def spelled(activity):
    return "ζ = " + activity.replace("-", "−").replace("kPa", " kPa").replace("0Pa", "0").replace("1Pa", "1 Pa")


def label(options):
    o = dict(options)
    text = f"{spelled(o['activity'])}, {o['director']}"
    if o["director"] == "random":
        text += f" {o['seed']}"
    if o["turn"] != "0deg":
        text += f", meshes turned {o['turn'][:-3]}°"
    if o["resolution"] != resolution(1):
        text += f", resolution {o['resolution']}"
    return text


def spectrum(run, time=TIME):
    """Complex amplitudes of the modes, over the radius."""
    if run.front is None or np.isnan(run.at("radius", time, "front")):
        return np.full(len(MODES), np.nan + 0j)
    line = int(np.argmin(np.abs(run.front["time"] - time)))
    return np.array([run.front[f"mode_{m}"][line] * np.exp(1j * run.front[f"phase_{m}"][line]) for m in MODES])


def likeness(a, b, angle=0.0):
    """Correlation of two fronts' waves, the second turned by an angle: 1 the same, 0 nothing in common."""
    turned = b * np.exp(1j * np.array(MODES) * angle)
    return float(np.real(np.vdot(a, turned)) / (np.linalg.norm(a) * np.linalg.norm(turned)))


def report(folder):
    runs = {label(options): Case(folder / "front", options) for options in CASES}
    spectra = {name: spectrum(run) for name, run in runs.items()}
    rows = []
    for name, run in runs.items():
        amplitudes = np.abs(spectra[name])
        if np.isnan(amplitudes).any():
            rows.append([name, "–", "–", "–"])
            continue
        order = np.argsort(-amplitudes)[:3]
        share = np.sum(amplitudes[[m - 2 for m in (4, 8, 12, 16)]] ** 2) / np.sum(amplitudes**2)
        rows.append([name, f"{100.0 * run.at('front_modulation', TIME):.2f} %",
                     ", ".join(f"{MODES[k]} ({100.0 * amplitudes[k]:.2f} %)" for k in order), f"{100.0 * share:.0f} %"])
    text = "![Fronts and spectra](wavy_front/wavy_front.png)\n\n"
    text += (f"Root mean square of the waves of the front over its radius at {TIME * US:g} µs, the three largest modes, and the share of "
             "the modes 4, 8, 12, 16, which the four-fold meshes can make:\n\n")
    text += table(["", "modulation", "largest modes", "modes of the mesh"], rows)
    text += ("\n**Mesh or physics?** Correlation of the waves of two runs: of one director field on meshes turned by 30°, as they lie "
             "(a pattern of the physics stays: 1) and turned along (a pattern of the mesh turns: 1); of two meshes; of two "
             "director fields:\n\n")

    def pair(a, b, angle=0.0):
        return f"{likeness(spectra[label(a)], spectra[label(b)], angle):+.2f}"

    third = np.pi / 6.0
    rows = [[spelled(z), pair(case(z, d), case(z, d, turn="30deg")),
             pair(case(z, d, turn="30deg"), case(z, d), third), *others]
            for z, d, others in (("0Pa", "uniform", [pair(case("0Pa", "uniform"), case("0Pa", "uniform", mesh=1.4)), ""]),
                                 ("-1Pa", "random", ["", ""]),
                                 ("-1kPa", "random", [pair(case("-1kPa"), case("-1kPa", mesh=1.4)),
                                                      pair(case("-1kPa"), case("-1kPa", seed="2"))]))]
    text += table(["", "turned meshes, as they lie", "turned meshes, turned along", "resolutions 1 and 1.4", "two director fields"], rows)

    figure, axes = plt.subplots(1, 3, figsize=(10.0, 3.3), layout="constrained")
    shown = [case("-1Pa"), case("-1kPa"), case("-1kPa", "uniform"), case("-5kPa")]
    for options in shown:
        run = runs[label(options)]
        if run.front is None:
            continue
        if not np.isnan(run.at("radius", TIME, "front")):
            x, y = run.outline(TIME)
            axes[0].plot(x * UM, y * UM, label=label(options))
            axes[1].plot(MODES, 100.0 * np.abs(spectra[label(options)]), "o-", markersize=3)
        grown = run.history["spread_area"] > 5e-12
        axes[2].plot(run.history["time"][grown] * US, 100.0 * run.history["front_modulation"][grown], label=label(options))
    axes[0].set(aspect="equal", xlabel="x (µm)", ylabel="y (µm)", title=f"front at {TIME * US:g} µs")
    axes[1].set(xlabel="mode m", ylabel="amplitude over radius (%)", yscale="log", ylim=(1e-2, 100.0), title="spectrum")
    axes[2].set(xlabel="time (µs)", ylabel="modulation (%)", title="waves of the front")
    axes[2].legend(fontsize=7)
    return text, {"wavy_front": figure}
