"""A viscous cell over minutes, by implicit steps: against explicit ones, on three substrates, with viscosity and activity."""

import numpy as np
import matplotlib.pyplot as plt

from study_tools import UM, Case, number, percent, resolution, table

TITLE = "Minutes: a viscous cell by implicit steps"
# The paper's cell, to compare the steps: spreading_axisymmetric takes explicit ones.
PAPER = [("end-time", "4.5us"), ("activity", "0Pa"), ("director", "radial"), ("frames", "2"), ("samples", "90"), ("resolution", resolution(1.0))]
EXPLICIT = [[("preset", "printed"), ("stiffness", "10")], [("preset", "elastic"), ("stiffness", "2")]]
IMPLICIT = [[("preset", "printed"), ("elasticity", "819.72kPa")], [("preset", "elastic"), ("elasticity", "163.944kPa")]]
SLOW = [("activity", "0Pa"), ("min-time-step", "1ps"), ("frames", "4"), ("samples", "240"), ("tolerance", "3e-4")]
COARSE = [*SLOW, ("resolution", resolution(1.0))]
ELASTICITIES = ["10kPa", "1kPa", "100kPa"]
STICKING = {"tethers": [], "no tethers": [("tethers", "off")]}
SUBSTRATES = [*((e, "tethers") for e in ELASTICITIES), ("10kPa", "no tethers")]
VISCOSITIES = ["10Pa.s", "100Pa.s"]
ACTIVITIES = ["-1kPa", "-20Pa", "-1Pa"]
CHECKS = {"stretch 1.25": [("update-at", "1.25"), ("resolution", resolution(1.0))], "never": [("update-at", "0"), ("resolution", resolution(1.0))],
          "finer": [("resolution", resolution(1.5))]}
BONDS_ALONE = [[("resolution", resolution(r))] for r in (1.0, 1.5)]
# Ten minutes: bonds of a fluid surface, particles redistributed.
FLUID = [("bond-area", "mobile"), ("redistribute", "1")]
ALONE = [("tethers", "off"), ("van-der-waals", "0")]
MINUTES = {
    "adhesion alone": [*ALONE, ("end-time", "600s"), ("resolution", resolution(1.0))],
    "adhesion alone, stretch 1.25": [*ALONE, ("update-at", "1.25"), ("end-time", "600s"), ("resolution", resolution(1.0))],
    "adhesion alone, finer": [*ALONE, ("end-time", "60s"), ("resolution", resolution(1.5))],
    "10 kPa, tethers": [("end-time", "600s"), ("resolution", resolution(1.0))],
    "100 kPa, tethers": [("elasticity", "100kPa"), ("end-time", "600s"), ("resolution", resolution(1.0))],
    "1 kPa, tethers": [("elasticity", "1kPa"), ("end-time", "600s"), ("resolution", resolution(1.0))],
    "10 kPa, tethers, stretch 1.25": [("update-at", "1.25"), ("end-time", "600s"), ("resolution", resolution(1.0))],
    "10 kPa, tethers, 4 points per facet": [("contact-points", "4"), ("end-time", "600s"), ("resolution", resolution(1.0))],
    "10 kPa, tethers, finer": [("end-time", "60s"), ("resolution", resolution(1.5))],
}
# Area with a gap below the range of bonds, 100 nm, of a drop of 5 µm on a rigid plane: drop_area(100e-9).
DROP_AREA = 21.7e-12
# An angle of contact of arccos(W/σ − 1), 146 degrees with 12 µJ/m² and 72 µN/m, on a cell of 5 µm.
YOUNG_AREA = 24.3e-12
SWEEPS = [
    ("explicit", "spreading_axisymmetric", PAPER, EXPLICIT),
    ("implicit", "spreading_slow", [*PAPER, ("viscosity", "3mPa.s"), ("fluid-hourglass-viscosity", "2.5e-5Pa.s"), ("surface-smoothing", "0"), ("update-at", "0"),
                                    ("van-der-waals", "1e6"), ("tethers", "off")], IMPLICIT),
    ("substrate", "spreading_slow", [*COARSE, ("end-time", "120s")], [[("elasticity", e), *STICKING[s]] for e, s in SUBSTRATES]),
    ("activity", "spreading_slow", [("end-time", "60s"), ("min-time-step", "1ps"), ("frames", "2"), ("samples", "120"), ("tolerance", "3e-4"), ("resolution", resolution(1.0))],
     [[("activity", a)] for a in ACTIVITIES]),
    ("check", "spreading_slow", [*SLOW, ("end-time", "60s")], list(CHECKS.values())),
    ("bonds", "spreading_slow", [*SLOW, ("end-time", "20s"), ("tethers", "off"), ("van-der-waals", "0")], BONDS_ALONE),
    ("minutes", "spreading_slow", [*SLOW, *FLUID], list(MINUTES.values())),
    ("viscosity", "spreading_slow", [*COARSE, ("end-time", "120s"), ("fluid-hourglass-viscosity", "10Pa.s")], [[("viscosity", v)] for v in VISCOSITIES[1:]]),
]


def drop_area(reach, tension=72e-6, work=12e-6, radius=5e-6):
    """Area, m², with a gap below `reach` of a drop that bonds of this range hold on a rigid plane. Its shape has
    γ(z) (dψ/ds + sin ψ/r) − γ'(z) cos ψ = p, γ = σ₀ + Φ(z), and above the bonds is a sphere: r σ₀ sin ψ = p r²/2. Inside the contact the
    gap leaves that of the pressure like a Bessel function, from which the integration starts at a radius r₀."""
    def energy(z):
        return work * ((reach / z) ** 4 - 2.0 * (reach / z) ** 2)

    def slope(z):
        return 4.0 * work / reach * ((reach / z) ** 3 - (reach / z) ** 5)

    def shape(p, r):
        low, high = 0.5 * reach, reach  # the gap at which bonds carry the pressure
        for _ in range(80):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if -slope(middle) > p else (low, middle)
        curvature = (slope(high * (1 + 1e-5)) - slope(high * (1 - 1e-5))) / (2e-5 * high)
        length = np.sqrt((tension + energy(high)) / curvature)
        y = np.array([r, high + 1e-4 * reach, 1e-4 * reach / length * (1.0 - 0.5 * length / r), 0.0])  # r, z, ψ, volume
        edge = None

        def rate(y):
            r, z, psi, _ = y
            s, c = np.sin(psi), np.cos(psi)
            return np.array([c, s, (p + slope(z) * c) / (tension + energy(z)) - s / r, np.pi * r * r * s])

        while y[1] < 20.0 * reach and y[2] < np.pi:
            h = reach / 40.0 if y[1] < 3.0 * reach else reach / 8.0
            a = rate(y)
            b = rate(y + 0.5 * h * a)
            c = rate(y + 0.5 * h * b)
            y = y + h / 6.0 * (a + 2.0 * b + 2.0 * c + rate(y + h * c))
            if edge is None and y[1] > reach:
                edge = y[0]
        excess = y[0] * tension * np.sin(y[2]) - 0.5 * p * y[0] ** 2
        sphere = 2.0 * tension / p
        height = sphere * (1.0 + np.cos(y[2]))
        return excess, edge, y[3] + np.pi * height**2 * (sphere - height / 3.0)

    pressure = 2.0 * tension / radius
    for _ in range(4):
        low, high = 0.2 * radius, 0.8 * radius  # of r₀: more contact pulls more
        sign = shape(pressure, low)[0] > 0.0
        for _ in range(24):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if (shape(pressure, middle)[0] > 0.0) == sign else (low, middle)
        _, edge, volume = shape(pressure, low)
        pressure *= (volume / (4.0 / 3.0 * np.pi * radius**3)) ** (1.0 / 3.0)
    return np.pi * edge**2


def exponent(case, first, last):
    """Of R ~ t^n between two times, s, by least squares over the logarithms."""
    if case.history is None:
        return float("nan")
    t, r = case.history["time"], case.history["contact_radius"]
    chosen = (t >= first) & (t <= last) & (r > 0.0)
    if np.count_nonzero(chosen) < 3:
        return float("nan")
    return float(np.polyfit(np.log(t[chosen]), np.log(r[chosen]), 1)[0])


def early_end(case):
    """When a run that was not completed came to its end."""
    last = case.history["time"][-1] if case.history is not None and len(case.history["time"]) else float("nan")
    return f"ends at {last:.3g} s"


def report(folder):
    text = "![Contact radius against time](spreading_slow/slow.png)\n\n"
    pairs = [(Case(folder / "explicit", e), Case(folder / "implicit", i)) for e, i in zip(EXPLICIT, IMPLICIT)]
    rows = []
    for e, (one, other) in zip(EXPLICIT, pairs):
        largest = max((abs(percent(other.at("spread_area", t), one.at("spread_area", t))) for t in np.linspace(1e-6, 4.5e-6, 71)), default=float("nan"))
        rows.append([", ".join(v for _, v in e), number(one.summary.get("steps", float("nan")), 5), number(other.summary.get("steps", float("nan")), 5),
                     number(one.at("spread_area", 4.5e-6) * UM**2, 5), number(other.at("spread_area", 4.5e-6) * UM**2, 5), f"{largest:.2f} %"])
    text += "**The paper's cell**, explicit against implicit steps, spreading area, µm²:\n\n"
    text += table(["", "explicit steps", "implicit steps", "explicit, 4.5 µs", "implicit, 4.5 µs", "largest difference from 1 µs on"], rows) + "\n"

    rows = []
    cases = {}
    for e, what in SUBSTRATES:
        case = cases[e, what] = Case(folder / "substrate", [("elasticity", e), *STICKING[what]])
        rows.append([f"{e}, {what}", *(number(case.at("spread_area", t) * UM**2, 4) for t in (1.0, 5.0, 20.0, 60.0, 120.0)),
                     number(exponent(case, 1.0, 20.0), 2), number(case.summary.get("steps", float("nan")), 5),
                     number(case.summary.get("wall_seconds", float("nan")) / 2.0, 3)])
    text += "**Spreading area**, µm², 10 Pa s, no active stress; exponents of the contact radius in time; seconds of the processor per minute:\n\n"
    text += table(["", "1 s", "5 s", "20 s", "1 min", "2 min", "1 s to 20 s", "steps", "s per minute"], rows) + "\n"
    rows = []
    for v in VISCOSITIES:
        case = cases["10kPa", "tethers"] if v == VISCOSITIES[0] else Case(folder / "viscosity", [("viscosity", v)])
        cases[v] = case
        rows.append([v.replace(".", " "), *(number(case.at("spread_area", t) * UM**2, 4) for t in (1.0, 5.0, 20.0, 60.0, 120.0)), number(exponent(case, 1.0, 20.0), 2),
                     number(case.summary.get("steps", float("nan")), 5)])
    text += "**Viscosity**, on 10 kPa with tethers:\n\n" + table(["", "1 s", "5 s", "20 s", "1 min", "2 min", "1 s to 20 s", "steps"], rows) + "\n"
    rows = []
    for a in ACTIVITIES:
        case = Case(folder / "activity", [("activity", a)])
        rows.append([a, "60 s" if case.completed else early_end(case), number(2.0 * 10.0 / abs(float(a.replace("kPa", "e3").replace("Pa", ""))), 2)])
    text += "**Active stress** at 10 Pa s, and 2μ/|ζ|, s, the time in which it draws the gel out by its own length:\n\n" + table(["ζ", "", "2μ/abs(ζ)"], rows) + "\n"
    rows = [["as above", *(number(cases["10kPa", "tethers"].at("spread_area", t) * UM**2, 4) for t in (1.0, 5.0, 30.0, 60.0)), ""]]
    for name, options in CHECKS.items():
        case = Case(folder / "check", options)
        rows.append([name, *(number(case.at("spread_area", t) * UM**2, 4) for t in (1.0, 5.0, 30.0, 60.0)), "" if case.completed else early_end(case)])
    text += "**Numerics**, on 10 kPa with tethers: area, µm², with a reference that is updated at a stretch of 1.5, of 1.25, or never, and on a finer mesh:\n\n"
    text += table(["", "1 s", "5 s", "30 s", "1 min", ""], rows) + "\n"
    rows = [[f"resolution {dict(options)['resolution']}", *(number(Case(folder / "bonds", options).at("spread_area", t) * UM**2, 4) for t in (5.0, 10.0, 20.0))] for options in BONDS_ALONE]
    rows.append(["Young's equation", "", "", number(YOUNG_AREA * UM**2, 4)])
    text += "**Adhesion alone** (no tethers, no van der Waals force): area, µm², against that of a drop with the contact angle of Young's equation:\n\n"
    text += table(["", "5 s", "10 s", "20 s"], rows)
    cases.update({name: Case(folder / "minutes", options) for name, options in MINUTES.items()})
    return text + "\n" + minutes(cases), {"slow": draw(cases), "minutes": draw_minutes(cases)}


def minutes(cases):
    """Ten minutes with redistributed particles: area at times, the range that it keeps from 60 s on, what updates took."""
    rows = []
    for name in MINUTES:
        case = cases[name]
        late = None if case.history is None else case.history["spread_area"][case.history["time"] >= 60.0] * UM**2
        span = "–" if late is None or len(late) < 2 else f"{late.min():.3g} to {late.max():.3g}"
        rows.append([name if case.completed else f"{name}: {early_end(case)}", *(number(case.at("spread_area", t) * UM**2, 4) for t in (5.0, 20.0, 60.0, 120.0, 300.0, 600.0)), span,
                     number(case.summary.get("reference_updates", float("nan")), 5), number(case.summary.get("refused_updates", float("nan")), 5),
                     number(case.summary.get("wall_seconds", float("nan")), 3)])
    text = "![Area over ten minutes](spreading_slow/minutes.png)\n\n"
    text += f"**Ten minutes**, with `--bond-area mobile --redistribute 1`: area, µm² (a drop whose bonds have their range: {DROP_AREA * UM**2:.1f}); its range after the first minute; updates, refused ones, seconds of the processor:\n\n"
    return text + table(["", "5 s", "20 s", "1 min", "2 min", "5 min", "10 min", "after 1 min", "updates", "refused", "s"], rows)


def draw_minutes(cases):
    figure, axes = plt.subplots(1, 2, figsize=(9.2, 3.4), layout="constrained", dpi=85, sharey=True)
    for k, name in enumerate(MINUTES):
        history = cases[name].history
        alone = name.startswith("adhesion")
        if history is not None and len(history["time"]) > 1:
            axes[0 if alone else 1].semilogx(history["time"][1:], history["spread_area"][1:] * UM**2, color=f"C{k if alone else k - 3}",
                                            label=name.replace("adhesion alone, ", "").replace(", tethers", ""))
    axes[0].axhline(DROP_AREA * UM**2, color="0.5", linewidth=0.8)
    axes[0].text(1.05, DROP_AREA * UM**2 + 0.6, "drop, by theory", color="0.4", fontsize=8)
    axes[0].set(title="adhesion alone", ylabel="spreading area (µm²)", ylim=(0.0, 45.0))
    axes[1].set(title="with tethers")
    for axis in axes:
        axis.set(xlabel="time (s)", xlim=(1.0, 600.0))
        axis.legend(fontsize=7, loc="lower right")
    return figure


def draw(cases):
    figure, (left, right) = plt.subplots(1, 2, figsize=(9.2, 3.6), layout="constrained", dpi=85)
    for k, (e, what) in enumerate(SUBSTRATES):
        history = cases[e, what].history
        if history is not None:
            left.loglog(history["time"][1:], history["contact_radius"][1:] * UM, "--" if what == "no tethers" else "-", color=f"C{k}", label=f"{e}, {what}")
    for k, v in enumerate(VISCOSITIES):
        history = cases[v].history
        if history is not None:
            right.loglog(history["time"][1:], history["contact_radius"][1:] * UM, color=f"C{k + 4}", label=v.replace(".", " "))
    for axis in (left, right):
        time = np.array([1.0, 20.0])
        axis.loglog(time, 1.8 * (time / 1.0) ** 0.25, color="0.6", linewidth=0.8)
        axis.text(4.0, 2.2, "t^¼", color="0.4", fontsize=8)
        axis.set(xlabel="time (s)", ylabel="contact radius (µm)", xlim=(0.4, 150.0))
        axis.legend(fontsize=7)
    left.set_title("10 Pa s, three substrates")
    right.set_title("10 kPa, tethers, two viscosities")
    return figure
