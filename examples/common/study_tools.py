"""What the studies share: histories of runs, values at a time, tables in Markdown, the look of the figures."""

import os

import numpy as np
import matplotlib.pyplot as plt

from sweep import folder_name, read_json
from vtu_reader import read_history

UM, KPA, US = 1e6, 1e-3, 1e6  # from SI to the units of the figures

plt.rcParams.update({"font.size": 9, "axes.titlesize": 9, "axes.spines.top": False, "axes.spines.right": False,
                     "axes.grid": True, "grid.alpha": 0.25, "legend.frameon": False, "legend.fontsize": 8,
                     "lines.linewidth": 1.4})


scale = 1.0  # of all resolutions: studies.py --scale


def resolution(value):
    """The option's text."""
    return f"{value * scale:g}"


class Case:
    """What one run of a sweep left: `history` and `front` (columns by name; None if it never began), `summary`, `completed`."""

    def __init__(self, folder, options):
        self.folder = os.path.join(folder, folder_name(options))
        self.completed = read_json(os.path.join(self.folder, "run.json")).get("status") == "done"
        self.summary = read_json(os.path.join(self.folder, "summary.json"))
        self.history = self._columns("history.csv")
        self.front = self._columns("front.csv")

    def _columns(self, name):
        path = os.path.join(self.folder, name)
        return read_history(path) if os.path.exists(path) else None

    def at(self, name, time, table="history"):
        """The column at a time, s, linear between the lines; nan where the run did not come so far."""
        columns = getattr(self, table)
        if columns is None or len(columns["time"]) == 0 or time > columns["time"][-1] * (1 + 1e-9):
            return float("nan")
        return float(np.interp(time, columns["time"], columns[name]))

    def outline(self, time):
        """The front at a time, m: points (x, y), closed."""
        angle = np.linspace(0.0, 2.0 * np.pi, 361)
        line = int(np.argmin(np.abs(self.front["time"] - time)))
        r = 1.0 + sum(self.front[f"mode_{m}"][line] * np.cos(m * angle - self.front[f"phase_{m}"][line]) for m in range(1, 17))
        r *= self.front["radius"][line]
        return self.front["center_x"][line] + r * np.cos(angle), self.front["center_y"][line] + r * np.sin(angle)


def percent(value, of):
    """How much larger a value is than another, %; nan where that is zero."""
    return 100.0 * (value / of - 1.0) if of else float("nan")


def number(value, digits=3):
    return "–" if value is None or np.isnan(value) else f"{value:.{digits}g}"


def table(head, rows):
    """A table in Markdown; entries are texts or numbers."""
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    for row in rows:
        lines.append("| " + " | ".join(entry if isinstance(entry, str) else number(entry) for entry in row) + " |")
    return "\n".join(lines) + "\n"
