"""A viscous cell over minutes, by implicit steps: against explicit ones, on three substrates, with viscosity and activity."""

import numpy as np
import matplotlib.pyplot as plt

from study_tools import UM, Case, number, percent, resolution, table

TITLE = "Minutes: a viscous cell by implicit steps"
# The paper's cell, to compare the steps: spreading_axisymmetric takes explicit ones.
PAPER = [("end-time", "4.5us"), ("activity", "0Pa"), ("director", "radial"), ("frames", "2"), ("samples", "90"), ("resolution", resolution(1.0))]
EXPLICIT = [[("preset", "printed"), ("stiffness", "10")], [("preset", "elastic"), ("stiffness", "2")]]
IMPLICIT = [[("preset", "printed"), ("elasticity", "819.72kPa")], [("preset", "elastic"), ("elasticity", "163.944kPa")]]
AS_THERE = [("contact-refinement", "1"), ("bonds-on", "cell"), ("contact-points", "2"), ("update-at", "0"), ("tethers", "off"), ("viscosity", "3mPa.s"),
            ("fluid-hourglass-viscosity", "2.5e-5Pa.s"), ("surface-smoothing", "0"), ("van-der-waals", "1e6")]
SLOW = [("min-time-step", "1ps"), ("frames", "4"), ("samples", "600"), ("tolerance", "3e-4")]
COARSE = [*SLOW, ("resolution", resolution(1.0))]
WEAK = [("tether-stiffness", "0.043mN/m")]
ALONE = [("tethers", "off"), ("van-der-waals", "0")]
BONDS = {"tethers": [], "weak tethers": WEAK, "adhesion alone": ALONE}
# Ten minutes.
MINUTES = {**{f"{e}, {bonds}": [("elasticity", e), *BONDS[bonds]] for bonds in ("tethers", "weak tethers") for e in ("1kPa", "10kPa", "100kPa")},
           "10kPa, adhesion alone": ALONE}
VISCOSITIES = ["10Pa.s", "100Pa.s"]
ACTIVITIES = ["-1kPa", "-20Pa", "-1Pa"]
RESOLUTIONS = [1.0, 1.5, 2.0]
MESHES = [[*BONDS[bonds], ("resolution", resolution(r))] for bonds in BONDS for r in RESOLUTIONS]
FINEST = [("resolution", resolution(3.0)), ("contact-refinement", "2.4")]
# Other ways to count the bonds.
CELL = [("bonds-on", "cell"), ("contact-points", "2")]
WAYS = {"on the substrate": [], "on the substrate, updates at 1.25": [("update-at", "1.25")], "on the substrate, particles are matter": [("redistribute", "0")],
        "on the cell": [*CELL, ("bond-area", "mobile")], "on the cell, per reference area": CELL}
# Area with a gap below the range of bonds, 100 nm, of a drop of 5 µm on a rigid plane.
DROP_AREA = 21.7e-12       # drop_area(100e-9)
DROP_AREA_WEAK = 47.8e-12  # drop_area(100e-9, tethers=300e12 * 0.043e-3 / 1.1)
SWEEPS = [
    ("explicit", "spreading_axisymmetric", PAPER, EXPLICIT),
    ("implicit", "spreading_slow", [*PAPER, *AS_THERE], IMPLICIT),
    ("minutes", "spreading_slow", [*COARSE, ("end-time", "600s")], list(MINUTES.values())),
    ("mesh", "spreading_slow", [*SLOW, ("end-time", "60s")], MESHES),
    ("finest", "spreading_slow", [*(o for o in SLOW if o[0] != "samples"), ("samples", "100"), ("end-time", "10s")], [FINEST]),
    ("ways", "spreading_slow", [*COARSE, ("end-time", "60s"), *ALONE], list(WAYS.values())),
    ("soft", "spreading_slow", [*COARSE, ("end-time", "60s"), ("elasticity", "1kPa")], list(WAYS.values())),
    ("viscosity", "spreading_slow", [*COARSE, ("end-time", "600s"), ("fluid-hourglass-viscosity", "10Pa.s")], [[("viscosity", v)] for v in VISCOSITIES[1:]]),
    ("activity", "spreading_slow", [("end-time", "60s"), ("min-time-step", "1ps"), ("frames", "2"), ("samples", "120"), ("tolerance", "3e-4"), ("resolution", resolution(1.0))],
     [[("activity", a)] for a in ACTIVITIES]),
]


def drop_area(reach, tension=72e-6, work=12e-6, radius=5e-6, tethers=0.0, rest=100e-9, capture=150e-9):
    """Area, m², with a gap below `reach` of a drop that bonds of this range, and tethers of a stiffness per area (N/m³) that are bound below the
    capture distance, hold on a rigid plane. Its shape has
    γ(z) (dψ/ds + sin ψ/r) − γ'(z) cos ψ = p, γ = σ₀ + Φ(z), and above the bonds is a sphere: r σ₀ sin ψ = p r²/2. Inside the contact the
    gap leaves that of the pressure like a Bessel function, from which the integration starts at a radius r₀."""
    def energy(z):
        stored = 0.5 * tethers * ((z - rest) ** 2 - (capture - rest) ** 2) if z < capture else 0.0
        return work * ((reach / z) ** 4 - 2.0 * (reach / z) ** 2) + stored

    def slope(z):
        return 4.0 * work / reach * ((reach / z) ** 3 - (reach / z) ** 5) + (tethers * (z - rest) if z < capture else 0.0)

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


def areas(case, times):
    return [number(case.at("spread_area", t) * UM**2, 4) for t in times]


def mesh_row(name, case):
    return [name, *areas(case, (1.0, 5.0, 20.0, 60.0)), number(exponent(case, 0.1, 1.0), 2), number(exponent(case, 1.0, 10.0), 2),
            number(case.summary.get("wall_seconds", float("nan")), 3)]


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

    times = (1.0, 5.0, 20.0, 60.0, 120.0, 300.0, 600.0)
    heads = ["1 s", "5 s", "20 s", "1 min", "2 min", "5 min", "10 min"]
    cases = {name: Case(folder / "minutes", options) for name, options in MINUTES.items()}
    rows = []
    for name, case in cases.items():
        late = None if case.history is None else case.history["spread_area"][case.history["time"] >= 60.0] * UM**2
        span = "–" if late is None or len(late) < 2 else f"{late.min():.3g} to {late.max():.3g}"
        rows.append([name if case.completed else f"{name}: {early_end(case)}", *areas(case, times), span, number(exponent(case, 1.0, 20.0), 2),
                     number(case.summary.get("steps", float("nan")), 5), number(case.summary.get("reference_updates", float("nan")), 5),
                     number(case.summary.get("refused_updates", float("nan")), 5), number(case.summary.get("wall_seconds", float("nan")) / 10.0, 3)])
    text += "**Ten minutes**, 10 Pa s, no active stress: spreading area, µm², and its range after the first minute; exponent of the contact radius in time; updates of the reference; seconds of the processor per minute:\n\n"
    text += table(["", *heads, "after 1 min", "1 to 20 s", "steps", "updates", "refused", "s per minute"], rows) + "\n"

    rows = []
    for bonds in BONDS:
        for r in RESOLUTIONS:
            rows.append(mesh_row(f"{bonds}, resolution {r:g}", Case(folder / "mesh", [*BONDS[bonds], ("resolution", resolution(r))])))
    rows.insert(len(RESOLUTIONS), mesh_row("tethers, resolution 3, facets finer", Case(folder / "finest", FINEST)))
    text += f"**Meshes**, on 10 kPa. Drops whose bonds have their range rest at {DROP_AREA * UM**2:.1f} µm² (adhesion alone) and {DROP_AREA_WEAK * UM**2:.1f} µm² (weak tethers); with tethers there is no rest, they wet the substrate. Exponents of the contact radius in time, seconds of the processor:\n\n"
    text += table(["", "1 s", "5 s", "20 s", "1 min", "0.1 to 1 s", "1 to 10 s", "s"], rows) + "\n"

    rows = []
    for name, options in WAYS.items():
        alone, soft = Case(folder / "ways", options), Case(folder / "soft", options)
        rows.append([name, *(text for case in (alone, soft) for text in (*areas(case, (5.0, 20.0, 60.0)), "" if case.completed else early_end(case)))])
    text += "**Where bonds are counted**: adhesion alone on 10 kPa, and tethers on 1 kPa; area, µm²:\n\n"
    text += table(["", "alone, 5 s", "20 s", "1 min", "", "1 kPa, 5 s", "20 s", "1 min", ""], rows) + "\n"

    rows = []
    for v in VISCOSITIES:
        case = cases["10kPa, tethers"] if v == VISCOSITIES[0] else Case(folder / "viscosity", [("viscosity", v)])
        cases[v] = case
        rows.append([v.replace(".", " "), *areas(case, times), number(exponent(case, 1.0, 20.0), 2), number(case.summary.get("steps", float("nan")), 5)])
    text += "**Viscosity**, on 10 kPa with tethers:\n\n" + table(["", *heads, "1 s to 20 s", "steps"], rows) + "\n"
    rows = []
    for a in ACTIVITIES:
        case = Case(folder / "activity", [("activity", a)])
        rows.append([a, "60 s" if case.completed else early_end(case), number(2.0 * 10.0 / abs(float(a.replace("kPa", "e3").replace("Pa", ""))), 2)])
    text += "**Active stress** at 10 Pa s, and 2μ/|ζ|, s, the time in which it draws the gel out by its own length:\n\n" + table(["ζ", "", "2μ/abs(ζ)"], rows)
    return text, {"slow": draw(folder, cases)}


def draw(folder, cases):
    figure, (left, right) = plt.subplots(1, 2, figsize=(9.2, 3.6), layout="constrained", dpi=85)
    for k, name in enumerate(MINUTES):
        history = cases[name].history
        if history is not None:
            style = "-" if name.endswith("a, tethers") else "--" if name.endswith("weak tethers") else ":"
            left.semilogx(history["time"][1:], history["spread_area"][1:] * UM**2, style, color=f"C{k % 3}", label=name)
    left.axhline(DROP_AREA * UM**2, color="0.5", linewidth=0.8)
    left.text(1.1, DROP_AREA * UM**2 - 2.2, "drop, adhesion alone", color="0.4", fontsize=8)
    left.set(xlabel="time (s)", ylabel="spreading area (µm²)", xlim=(1.0, 600.0), ylim=(0.0, 45.0))
    for k, r in enumerate(RESOLUTIONS):
        for style, bonds in zip(("-", "--", ":"), BONDS):
            history = Case(folder / "mesh", [*BONDS[bonds], ("resolution", resolution(r))]).history
            if history is not None:
                right.loglog(history["time"][1:], history["contact_radius"][1:] * UM, style, color=f"C{k}", label=f"resolution {r:g}" if style == "-" else None)
    for case, color, label in ((Case(folder / "finest", FINEST), "C4", "resolution 3"), (cases[VISCOSITIES[1]], "C3", "100 Pa s")):
        history = case.history
        if history is None:
            continue
        right.loglog(history["time"][1:], history["contact_radius"][1:] * UM, "-", color=color, label=label)
    time = np.array([0.3, 20.0])
    right.loglog(time, 1.2 * time**0.25, color="0.6", linewidth=0.8)
    right.text(3.0, 1.35, "t^¼", color="0.4", fontsize=8)
    right.set(xlabel="time (s)", ylabel="contact radius (µm)", xlim=(0.1, 60.0))
    left.legend(fontsize=6.5, loc="lower right")
    right.legend(fontsize=7, loc="lower right")
    return figure
