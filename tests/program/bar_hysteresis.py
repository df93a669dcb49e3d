"""The program bar_hysteresis: its loss against the exact one, files, bad input.

    python3 bar_hysteresis.py PROGRAM [name of a test ...]
"""

import csv
import json
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import unittest

import continued_run

PROGRAM = ""


class Bar(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="bar_hysteresis_"))
        self.addCleanup(shutil.rmtree, self.folder, True)

    def run_program(self, *arguments, status=0):
        if "--out" not in arguments:
            arguments = (*arguments, "--out", "out")
        result = subprocess.run([PROGRAM, *arguments], cwd=self.folder, capture_output=True, text=True, timeout=300,
                                env=dict(os.environ, OMP_WAIT_POLICY="passive"))
        self.assertEqual(result.returncode, status, result.stdout + result.stderr)
        return result

    def summary(self, out="out"):
        return json.loads((self.folder / out / "summary.json").read_text())

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
                         ["checkpoint.h5", "fields", "fields.pvd", "history.csv", "parameters.toml", "summary.json"])
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

    def test_a_run_that_is_ended_and_continued_is_the_whole_run(self):
        motion = ["--frequency", "100kHz", "--cells", "200", "--frames", "8", "--method", "inertial"]
        self.run_program(*motion, "--out", "whole")
        whole = self.summary("whole")
        # In the cycles before the recorded one (the history has its head only), and in that one.
        continued_run.interrupt(self, PROGRAM, signal.SIGTERM, 1, *motion, "--out", "parts")
        self.assertEqual((self.folder / "parts" / "history.csv").read_bytes().count(b"\n"), 1)
        continued_run.interrupt(self, PROGRAM, signal.SIGINT, 100, "--restart", "parts/checkpoint.h5", "--out", "parts")
        self.assertNotIn("loss", self.summary("parts"))
        shutil.copy(self.folder / "parts" / "checkpoint.h5", self.folder / "middle.h5")
        said = self.run_program("--restart", "parts/checkpoint.h5", "--threads", "2", "--out", "parts").stdout
        self.assertRegex(said, r"going on from t = \S+ s, step \d+")
        continued_run.assert_same(self, "whole", "parts", "history.csv")
        parts = self.summary("parts")
        self.assertEqual({**whole, "threads": 2}, parts)
        # From the middle of the recorded cycle again, over the lines and frames that are there by now.
        self.run_program("--restart", "middle.h5", "--threads", "2", "--out", "parts")
        continued_run.assert_same(self, "whole", "parts", "history.csv")
        self.assertEqual(self.summary("parts"), parts)
        # A finished run goes on to the same end.
        self.run_program("--restart", "parts/checkpoint.h5", "--threads", "2", "--out", "parts")
        continued_run.assert_same(self, "whole", "parts", "history.csv")
        self.assertEqual(self.summary("parts"), parts)
        # Another motion is another run.
        for option, value in (("cycles", "5"), ("frequency", "1MHz"), ("amplitude", "10um")):
            result = self.run_program("--restart", "parts/checkpoint.h5", f"--{option}", value, "--out", "new", status=2)
            self.assertEqual(result.stderr, f'bar_hysteresis: The saved state is of another simulation: "motion/{option}" differs.\n')
        self.assertFalse((self.folder / "new").exists())

    def test_no_checkpoint_where_none_is_wanted(self):
        self.run_program("--frequency", "10MHz", "--cells", "10", "--checkpoint-every", "0s")
        self.assertFalse((self.folder / "out" / "checkpoint.h5").exists())

    def test_bad_input(self):
        result = self.run_program("--amplitude", "100um", status=2)
        self.assertIn("--amplitude = 0.0001 m is not allowed: it must be below the length of the bar, 0.0001 m.", result.stderr)
        result = self.run_program("--method", "unifrom", status=2)
        self.assertIn("did you mean uniform?", result.stderr)
        self.assertFalse((self.folder / "out").exists())


if __name__ == "__main__":
    PROGRAM = os.path.abspath(sys.argv.pop(1))
    unittest.main()
