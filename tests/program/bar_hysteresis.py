"""The program bar_hysteresis: its loss against the exact one, files, bad input.

    python3 bar_hysteresis.py PROGRAM [name of a test ...]
"""

import csv
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

PROGRAM = ""


class Bar(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="bar_hysteresis_"))
        self.addCleanup(shutil.rmtree, self.folder, True)

    def run_program(self, *arguments, status=0):
        result = subprocess.run([PROGRAM, *arguments, "--out", str(self.folder / "out")], capture_output=True, text=True,
                                timeout=300, env=dict(os.environ, OMP_WAIT_POLICY="passive"))
        self.assertEqual(result.returncode, status, result.stdout + result.stderr)
        return result

    def summary(self):
        return json.loads((self.folder / "out" / "summary.json").read_text())

    def test_the_uniform_bar_loses_what_it_must(self):
        self.run_program("--frequency", "1MHz", "--cells", "20")
        summary = self.summary()
        self.assertAlmostEqual(summary["loss"] / summary["uniform_loss"], 1.0, delta=1e-5)
        self.assertAlmostEqual(summary["dissipated"] / summary["uniform_loss"], 1.0, delta=1e-5)
        # 4 pi mu omega (1 - sqrt(1 - e^2)), worked out by hand
        self.assertAlmostEqual(summary["uniform_loss"] / 7521.62, 1.0, delta=1e-6)
        with open(self.folder / "out" / "history.csv", newline="") as file:
            rows = [{name: float(value) for name, value in row.items()} for row in csv.DictReader(file)]
        self.assertEqual(len(rows), 401)
        # The area of the recorded loop is the loss (over the strain, since P = sigma here).
        area = sum(0.5 * (a["stress"] + b["stress"]) * (b["strain"] - a["strain"]) for a, b in zip(rows, rows[1:]))
        self.assertAlmostEqual(area / summary["uniform_loss"], 1.0, delta=2e-3)
        self.assertEqual(sorted(os.listdir(self.folder / "out")),
                         ["fields", "fields.pvd", "history.csv", "parameters.toml", "summary.json"])
        self.assertEqual(len(os.listdir(self.folder / "out" / "fields")), 5)

    def test_activity_moves_the_loop_by_its_stress(self):
        means = []
        for activity in ("0Pa", "100kPa"):
            self.run_program("--frequency", "1MHz", "--cells", "20", "--activity", activity, "--left-angle", "60deg",
                             "--right-angle", "60deg", "--director-elasticity", "0N")
            means.append(self.summary()["stress"])
        # -zeta cos^2 60 degrees, at the strain 0 that ends the cycle; the director keeps its angle (no spin in a bar).
        self.assertAlmostEqual(means[1] - means[0], -25e3, delta=1.0)

    def test_slowly_moved_ends_do_as_the_uniform_bar(self):
        self.run_program("--frequency", "20kHz", "--method", "inertial", "--bulk-modulus", "200MPa", "--cells", "20")
        summary = self.summary()
        self.assertAlmostEqual(summary["dissipated"] / summary["uniform_loss"], 1.0, delta=0.01)
        self.assertLess(summary["energy_error"], 1e-4)

    def test_bad_input(self):
        result = self.run_program("--amplitude", "100um", status=2)
        self.assertIn("--amplitude = 0.0001 m is not allowed: it must be below the length of the bar, 0.0001 m.", result.stderr)
        result = self.run_program("--method", "unifrom", status=2)
        self.assertIn("did you mean uniform?", result.stderr)
        self.assertFalse((self.folder / "out").exists())


if __name__ == "__main__":
    PROGRAM = os.path.abspath(sys.argv.pop(1))
    unittest.main()
