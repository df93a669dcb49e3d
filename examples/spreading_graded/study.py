"""Claim 4 of the paper: does a cell on a substrate of varying stiffness go to the stiff side?"""

import numpy as np
import matplotlib.pyplot as plt

from study_tools import UM, US, Case, resolution, table

TITLE = "Does the cell go to the stiff side? (Figs. 11 and 12, claim 4)"
CASES = [[("preset", p), ("activity", "-1Pa")] for p in ("printed", "viscous/10", "elastic")]
CASES += [[("preset", "elastic"), ("activity", a)] for a in ("-1kPa", "-5kPa")]
FIXED = [("resolution", resolution(1)), ("end-time", "4.5us"), ("frames", "3")]
SWEEPS = [
    ("graded", "spreading_graded", FIXED, CASES),
    ("uniform", "spreading_uniform", [("stiffness", "6"), *FIXED], CASES),  # the mean of 2 and 10
]
TIME = 4.5e-6
TIMES = np.linspace(0.8e-6, TIME, 75)


def label(options):
    return f"{dict(options)['preset']}, ζ = {dict(options)['activity'].replace('-', '−').replace('Pa', ' Pa').replace('k Pa', ' kPa')}"


def displaced(case, control, time=TIME):
    """What grading changes, positive to the stiff side (−x): (front, centroid of contact, centre of mass), m."""
    front = 0.5 * ((case.at("front_minus_x", time) - case.at("front_plus_x", time))
                   - (control.at("front_minus_x", time) - control.at("front_plus_x", time)))
    return (front, -(case.at("contact_x", time) - control.at("contact_x", time)),
            -(case.at("com_x", time) - control.at("com_x", time)))


def report(folder):
    pairs = [(options, Case(folder / "graded", options), Case(folder / "uniform", options)) for options in CASES]
    rows = []
    for options, graded, uniform in pairs:
        front, contact, mass = displaced(graded, uniform)
        earlier = [(displaced(graded, uniform, t)[0], t) for t in TIMES if graded.at("spread_area", t) > 0.0]
        most = max(earlier, key=lambda pair: abs(pair[0])) if earlier else (float("nan"), float("nan"))
        radius = graded.at("contact_radius", TIME)
        rows.append([label(options), f"{graded.at('front_minus_x', TIME) * UM:.4f}", f"{graded.at('front_plus_x', TIME) * UM:.4f}",
                     f"{front * 1e9:+.1f} nm ({100.0 * front / radius:+.2f} %)", f"{most[0] * 1e9:+.0f} nm at {most[1] * US:.2g} µs", f"{contact * 1e9:+.1f} nm", f"{mass * 1e9:+.2f} nm"])
    text = "![Fronts and displacements](spreading_graded/graded.png)\n\n"
    text += (f"At {TIME * US:g} µs; displacements to the stiff side, against the uniform substrate of the mean stiffness (which takes "
             "away what the director and the mesh do alone):\n\n")
    text += table(["", "front on the stiff side, µm", "on the soft side, µm", "front displaced", "most at any time", "centroid of contact displaced",
                   "centre of mass displaced"], rows)
    figure, axes = plt.subplots(1, 3, figsize=(10.0, 3.3), layout="constrained")
    options, graded, uniform = pairs[2]
    for time in (1e-6, 1.5e-6, 2e-6, 3e-6, 4.5e-6):
        if graded.front is None or np.isnan(graded.at("contact_radius", time)):
            continue
        x, y = graded.outline(time)
        axes[0].plot(x * UM, y * UM, label=f"{time * US:g} µs")
    axes[0].set(aspect="equal", xlabel="x (µm): stiff ← → soft", ylabel="y (µm)", title=f"front, {label(options)}")
    axes[0].legend(loc="center", fontsize=7)
    for options, graded, uniform in pairs:
        if graded.history is None or uniform.history is None:
            continue
        times = graded.history["time"][graded.history["spread_area"] > 0.0]
        moved = np.array([displaced(graded, uniform, t) for t in times])
        if len(moved) == 0:
            continue
        axes[1].plot(times * US, moved[:, 0] * 1e9, label=label(options))
        axes[2].plot(times * US, moved[:, 2] * 1e9)
    axes[1].set(xlabel="time (µs)", ylabel="front displaced to the stiff side (nm)")
    axes[2].set(xlabel="time (µs)", ylabel="centre of mass displaced to the stiff side (nm)")
    axes[1].legend(fontsize=7)
    return text, {"graded": figure}
