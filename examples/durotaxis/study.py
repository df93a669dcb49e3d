"""Does a contractile cell that bonds hold go to the stiff side? How large may the active stress be?"""

import os

import numpy as np
import matplotlib.pyplot as plt

from study_tools import US, Case, number, resolution, table
from vtu_reader import HEXAHEDRON, Grid, read_series

TITLE = "Does a contractile cell that bonds hold go to the stiff side?"
TIME, TOUCH, LATE = 4.5e-6, 0.75e-6, 3.0e-6  # end, first bonds, when most of the cell is down, s
MESH = 0.6
FIXED = [("end-time", "4.5us"), ("samples", "90"), ("checkpoint-every", "0s")]
FLOOR = "0.2ns"  # of the time step, 1/37 of the first stable one: below it a run stops
RATE_FACTOR, VISCOSITY, RADIUS, DENSITY = 1e7, 3e-3, 5e-6, 1000.0  # of the program: on the rates; μ, Pa s; R, m; ρ, kg/m³
GRADED, REVERSED, UNIFORM = ("2", "10"), ("10", "2"), ("6", "6")  # factors on the sides +x and −x; 6 is the mean


def case(activity, tethers="mean", sides=GRADED, **more):
    """Options of a run: those of all runs first, then what is particular."""
    options = {"activity": activity, "tethers": tethers, "soft": sides[0], "stiff": sides[1], "resolution": resolution(MESH)}
    return list({**options, **{name.replace("_", "-"): value for name, value in more.items()}}.items())


def pair(*arguments, sides=GRADED, **more):
    """The same cell on the substrate and on the reversed one."""
    return [case(*arguments, sides=sides, **more), case(*arguments, sides=sides[::-1], **more)]


def mesh(factor):
    return {"resolution": resolution(factor)}


ACTIVITIES = ["0Pa", "-1kPa", "-5kPa"]
MAIN = [(activity, tethers) for activity in ACTIVITIES for tethers in ("off", "mean")]
# What one parameter changes at ζ = −1 kPa, with tethers.
CHANGES = [
    ("as above", {}),
    ("k_off 0.01 /s", {"off_rate": "0.01Hz"}), ("k_off 10 /s", {"off_rate": "10Hz"}),
    ("F_b 2 pN", {"slip_force": "2pN"}), ("F_b 30 pN", {"slip_force": "30pN"}),
    ("κ 5 pN/nm", {"tether_stiffness": "5e-3N/m"}),
    ("catch and slip", {"off_rate": "4.2e-4Hz", "slip_force": "5.38pN", "catch_rate": "56Hz", "catch_force": "5.38pN"}),
    ("stochastic", {"tethers": "stochastic"}),
    ("factors 0.2 to 1", {"sides": ("0.2", "1")}), ("factors 0.2 to 1, no tethers", {"sides": ("0.2", "1"), "tethers": "off"}),
    ("factors 0.2 to 1, 1000 /µm²", {"sides": ("0.2", "1"), "tether_density": "1000e12"}), ("G 3·10⁵ N/kg", {"van_der_waals": "3e5N/kg"}),
    ("safety 0.4", {"safety": "0.4"}),
]
FIELDS = [("random 1", {}), ("random 2", {"seed": "2"}), ("random 3", {"seed": "3"}),
          ("uniform, along the gradient", {"director": "uniform"}), ("radial", {"director": "radial"})]
MAP_ACTIVITIES = ["0Pa", "-1kPa", "-2kPa", "-5kPa"]
MAP_DENSITIES = ["0", "30", "100", "300", "1000"]  # /µm²
LADDER = ["-1kPa", "-2kPa", "-5kPa", "-10kPa", "-20kPa", "-50kPa"]
BREAKING = [  # what might move the end of a run at the activity BROKEN
    ("as above", {}), ("safety 0.2", {"safety": "0.2", "min_time_step": "0.05ns"}),
    ("resolution 0.8", {**mesh(0.8), "min_time_step": "0.15ns"}), ("stabilisation 500 Pa", {"fluid_hourglass": "500Pa"}),
    ("viscosity 30 mPa s", {"viscosity": "30mPa.s"}), ("viscosity 0.3 Pa s", {"viscosity": "0.3Pa.s"}),
    ("director uniform", {"director": "uniform"}),
]
BROKEN = "-20kPa"
MESHES = [0.6, 0.8, 1.0]
SOFTER = ("0.2", "1")
MESH_CASES = [("0Pa", "off", GRADED), ("0Pa", "mean", GRADED), ("-1kPa", "mean", GRADED), ("0Pa", "off", SOFTER), ("0Pa", "mean", SOFTER)]


def change(given, activity="-1kPa"):
    """The pair of runs of one entry of the lists."""
    given = dict(given)
    return pair(activity, given.pop("tethers", "mean"), sides=given.pop("sides", GRADED), **given)


def dense(activity, density):
    """The pair of runs of one point of the map."""
    if density == "0":
        return pair(activity, "off")
    return pair(activity, "mean", **({} if density == "300" else {"tether_density": f"{density}e12"}))


def on_mesh(activity, tethers, sides, factor):
    """The pair of runs on one mesh; one run where nothing but the substrate breaks the symmetry: then the other one is its mirror image."""
    both = pair(activity, tethers, sides=sides, **mesh(factor))
    return both[:1] if activity == "0Pa" else both


def rung(activity, tethers="mean", **given):
    """A run of the ladder."""
    return case(activity, tethers, **{"min_time_step": FLOOR, **given})


def without_repetition(lists):
    unique = []
    for options in lists:
        if options not in unique:
            unique.append(options)
    return unique


RUNS = without_repetition(
    [options for activity, tethers in MAIN for options in (*pair(activity, tethers), case(activity, tethers, UNIFORM))]
    + [options for _, given in FIELDS for options in change(given)]
    + [case("-1kPa", "mean", UNIFORM, director="uniform")]
    + [options for activity in MAP_ACTIVITIES for density in MAP_DENSITIES for options in dense(activity, density)]
    + [options for _, given in CHANGES for options in change(given)])
LADDER_RUNS = without_repetition([rung(activity) for activity in LADDER] + [rung(activity, "off") for activity in ("-5kPa", "-10kPa")]
                                 + [rung(BROKEN, **given) for _, given in BREAKING])
MESH_RUNS = [options for factor in MESHES for activity, tethers, sides in MESH_CASES for options in on_mesh(activity, tethers, sides, factor)
             if options not in RUNS]
SWEEPS = [("runs", "durotaxis", [*FIXED, ("min-time-step", FLOOR), ("frames", "1")], RUNS),
          ("meshes", "durotaxis", [*FIXED, ("min-time-step", FLOOR), ("frames", "1")], MESH_RUNS),
          ("ladder", "durotaxis", [*FIXED, ("frames", "18")], LADDER_RUNS)]
NM = 1e9
CORNERS = np.array([[-1, -1, -1], [1, -1, -1], [1, 1, -1], [-1, 1, -1], [-1, -1, 1], [1, -1, 1], [1, 1, 1], [-1, 1, 1]]) / 8.0


def spelled(activity):
    return "ζ = " + activity.replace("-", "−").replace("kPa", " kPa").replace("0Pa", "0")


def label(activity, tethers):
    return f"{spelled(activity)}, {'no tethers' if tethers == 'off' else 'tethers'}"


class Pair:
    """The same cell on the substrate and on the reversed one: half the difference is what the gradient does, positive to the stiff side; half
    the sum is what director and mesh do."""

    def __init__(self, folder, runs, part="runs"):
        self.runs = [Case(folder / part, options) for options in runs]

    def toward(self, name, time=TIME):
        if len(self.runs) == 1:  # the mirror image
            return -self.runs[0].at(name, time)
        return -0.5 * (self.runs[0].at(name, time) - self.runs[1].at(name, time))

    def drift(self, name, time=TIME):
        return -0.5 * (self.runs[0].at(name, time) + self.runs[1].at(name, time))

    def speed(self, begin=LATE, end=TIME):
        return (self.toward("com_x", end) - self.toward("com_x", begin)) / (end - begin)

    def at(self, name, time=TIME):
        return self.runs[0].at(name, time)


def signed(value, digits=1):
    if np.isnan(value):
        return "–"
    return f"{value:+.{digits}f}".replace("-", "−") if round(value, digits) else "0"


def inverted(frame):
    """Share of the cell's hexahedra, whose corners are particles, that are turned inside out."""
    grid = Grid(frame)
    cells, here = grid.cells(HEXAHEDRON), grid.points
    edges = [np.einsum("eka,kb->eab", x[cells], CORNERS) for x in (here - grid.point_data["displacement"], here)]
    return float(np.mean(np.linalg.det(edges[1]) / np.linalg.det(edges[0]) <= 0.0))


def orders(run):
    """Times, s, and the share of cells that are inverted, of the frames of a run."""
    path = os.path.join(run.folder, "fields.pvd")
    if not os.path.exists(path):
        return np.array([]), np.array([])
    frames = [(time, inverted(parts["cell"])) for time, parts in read_series(path)]
    return np.array([time for time, _ in frames]), np.array([share for _, share in frames])


def pull(pairing):
    return f"{signed(pairing.at('pull_plus_x') * NM)} / {signed(pairing.at('pull_minus_x') * NM)}"


def fastest(run):
    return max(run.history["speed_max"]) if run.history is not None else float("nan")


def main_table(folder):
    rows = []
    for activity, tethers in MAIN:
        both, uniform = Pair(folder, pair(activity, tethers)), Case(folder / "runs", case(activity, tethers, UNIFORM))
        speed = both.speed()
        rows.append([label(activity, tethers), signed(both.toward("com_x") * NM), signed(both.toward("contact_x") * NM), signed(speed * 1e3, 2),
                     signed(speed / RATE_FACTOR * NM * 60.0), signed(both.drift("com_x") * NM),
                     f"{signed(-uniform.at('com_x', TIME) * NM)} / {signed(uniform.at('com_y', TIME) * NM)}",
                     number(both.at("bonds_plus_x") + both.at("bonds_minus_x")), pull(both), number(fastest(both.runs[0])),
                     number(100.0 * both.at("energy_error"), 2)])
    return table(["", "centre of mass to the stiff side, nm", "centroid of contact, nm", "speed from 3 µs on, mm/s", "with time as the rates, nm/min",
                  "drift of director and mesh, nm", "on the uniform substrate, −x / y, nm", "bonds", "pull inward on the substrate, soft / stiff side, nN",
                  "largest speed, m/s", "energy error, %"], rows)


def changes_table(folder):
    rows = []
    for name, given in [*((f"director {name}", given) for name, given in FIELDS), *CHANGES[1:]]:
        both = Pair(folder, change(given))
        rows.append([name, signed(both.toward("com_x") * NM), signed(both.toward("contact_x") * NM), signed(both.drift("com_x") * NM),
                     number(both.at("bonds_plus_x") + both.at("bonds_minus_x")), number(both.at("bond_tension") * 1e12), pull(both)])
    return table(["", "centre of mass to the stiff side, nm", "centroid of contact, nm", "drift of director and mesh, nm", "bonds", "tension of a bond, pN",
                  "pull inward, soft / stiff side, nN"], rows)


def mesh_table(folder):
    rows = []
    for factor in MESHES:
        row = [f"resolution {factor:g}"]
        for given in MESH_CASES:
            runs = on_mesh(*given, factor)
            both = Pair(folder, runs, "runs" if runs[0] in RUNS else "meshes")
            row.append(f"{signed(both.toward('com_x') * NM)} nm, {signed(both.speed() * 1e3)} mm/s")
        rows.append(row)
    return table(["", *(f"{label(activity, tethers)}, {sides[0]} to {sides[1]}" for activity, tethers, sides in MESH_CASES)], rows)


def ladder_table(folder):
    rows, lines = [], []
    entries = [(label(activity, "mean"), rung(activity), activity, VISCOSITY) for activity in LADDER]
    entries += [(label(activity, "off"), rung(activity, "off"), activity, VISCOSITY) for activity in ("-5kPa", "-10kPa")]
    viscosities = {"30mPa.s": 0.03, "0.3Pa.s": 0.3}
    entries += [(f"{spelled(BROKEN)}, {name}", rung(BROKEN, **given), BROKEN, viscosities.get(given.get("viscosity"), VISCOSITY))
                for name, given in BREAKING[1:]]
    for name, options, activity, viscosity in entries:
        run = Case(folder / "ladder", options)
        times, shares = orders(run)
        stress = 1e3 * abs(float(activity.removesuffix("kPa")))
        viscous, inertial = 2.0 * viscosity / stress, RADIUS * np.sqrt(DENSITY / stress)
        natural = max(viscous, inertial)
        end = run.history["time"][-1] if run.history is not None and len(run.history["time"]) else np.nan
        first = times[shares > 0.0][0] if np.any(shares > 0.0) else np.nan
        early = np.interp(1e-6, times, shares) if len(times) and times[-1] >= 0.999e-6 else np.nan
        rows.append([name, number(viscous * US, 2), number(inertial * US, 2),
                     "–" if np.isnan(end) else f"{'reaches' if run.completed else 'stops at'} {number(end * US)} µs",
                     "none" if np.isnan(first) and len(times) else f"{number(first * US, 2)} µs", number(first / natural, 2), number(100.0 * early, 2),
                     number(100.0 * shares[-1], 2) if len(shares) else "–", number(fastest(run))])
        lines.append((name, times, shares, natural))
    return table(["", "2μ/&#124;ζ&#124;, µs", "R √(ρ/&#124;ζ&#124;), µs", "the run", "first cell inverted at", "over the longer time",
                  "inverted at 1 µs, %", "at its end, %", "largest speed, m/s"], rows), lines


def draw_map(axes, folder):
    speeds, texts = np.full((len(MAP_ACTIVITIES), len(MAP_DENSITIES)), np.nan), {}
    for i, activity in enumerate(MAP_ACTIVITIES):
        for j, density in enumerate(MAP_DENSITIES):
            both = Pair(folder, dense(activity, density))
            speeds[i, j] = both.toward("com_x") / (TIME - TOUCH) * 1e3
            texts[i, j] = signed(both.toward("com_x") * NM, 0)
    largest = max(np.nanmax(np.abs(speeds)), 1e-3) if np.any(np.isfinite(speeds)) else 1.0
    image = axes.imshow(speeds, cmap="RdBu", vmin=-largest, vmax=largest, origin="lower", aspect="auto")
    for (i, j), text in texts.items():
        strong = abs(speeds[i, j]) > 0.6 * largest
        axes.text(j, i, text, ha="center", va="center", color="white" if strong else "black", fontsize=8)
    axes.set(xticks=range(len(MAP_DENSITIES)), xticklabels=["none", *MAP_DENSITIES[1:]], yticks=range(len(MAP_ACTIVITIES)),
             yticklabels=[a.replace("-", "−").replace("kPa", "").replace("Pa", "") for a in MAP_ACTIVITIES],
             xlabel="receptors per µm²", ylabel="ζ (kPa)",
             title="to the stiff side: mean speed (mm/s); displacement (nm)")
    axes.grid(False)
    return image


def report(folder):
    figure, axes = plt.subplots(2, 2, figsize=(11.0, 7.4), layout="constrained")
    times = np.linspace(TOUCH, TIME, 76)
    for (activity, tethers), color in zip(MAIN, ["C0", "C0", "C1", "C1", "C3", "C3"]):
        both = Pair(folder, pair(activity, tethers))
        moved = [both.toward("com_x", t) * NM for t in times]
        axes[0, 0].plot(times * US, moved, "--" if tethers == "off" else "-", color=color, label=label(activity, tethers))
    axes[0, 0].axhline(0.0, color="black", linewidth=0.6)
    axes[0, 0].set(xlabel="time (µs)", ylabel="centre of mass to the stiff side (nm)",
                   title="what the gradient does")
    axes[0, 0].legend(fontsize=7)
    figure.colorbar(draw_map(axes[0, 1], folder), cax=axes[0, 1].inset_axes([1.03, 0.0, 0.04, 1.0]))
    names = [*((f"director {name}", given) for name, given in FIELDS), *CHANGES[1:]]
    pairs = [Pair(folder, change(given)) for _, given in names]
    rows = np.arange(len(names))[::-1]
    axes[1, 0].barh(rows + 0.2, [both.toward("com_x") * NM for both in pairs], 0.4, label="the gradient's doing")
    axes[1, 0].barh(rows - 0.2, [both.drift("com_x") * NM for both in pairs], 0.4, color="0.75", label="director's and mesh's")
    axes[1, 0].axvline(0.0, color="black", linewidth=0.6)
    axes[1, 0].set(yticks=rows, yticklabels=[name for name, _ in names], xlabel="centre of mass to the stiff side at 4.5 µs (nm)",
                   title="ζ = −1 kPa, tethers")
    axes[1, 0].tick_params(axis="y", labelsize=7)
    axes[1, 0].legend(fontsize=7)
    limits, lines = ladder_table(folder)
    for number_of, (name, at, shares, natural) in enumerate(lines):
        rung_of_ladder, color = number_of < len(LADDER), plt.get_cmap("tab20")(number_of)
        axes[1, 1].plot(at / natural, 100.0 * shares, "-" if rung_of_ladder else "--", color=color, marker=".", label=name,
                        linewidth=1.4 if rung_of_ladder else 1.0)
    axes[1, 1].set(xlabel="time over the longer of 2μ/|ζ| and R √(ρ/|ζ|)", ylabel="cells that are inverted (%)",
                   title="how long a contractile gel keeps its order")
    axes[1, 1].legend(fontsize=6, loc="center left", bbox_to_anchor=(1.0, 0.5))
    text = "![Displacements, map, parameters, order of the particles](durotaxis/durotaxis.png)\n\n"
    text += (f"At {TIME * US:g} µs, factors 2 (soft, +x) to 10 (stiff, −x), elastic substrate, resolution {MESH:g}; half the difference of a run and the one "
             "on the reversed substrate, positive to the stiff side:\n\n")
    text += main_table(folder) + "\n**One parameter changed**, ζ = −1 kPa with tethers:\n\n" + changes_table(folder)
    text += "\n**Meshes**: displacement to the stiff side, and speed from 3 µs on:\n\n" + mesh_table(folder)
    text += "\n**How large may the active stress be?** A run stops where its step falls below 0.2 ns, 1/37 of the first one:\n\n" + limits
    return text, {"durotaxis": figure}
