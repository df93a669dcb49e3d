"""The program cell_compression: equilibria against slow dynamics, files, bad input.

    python3 cell_compression.py PROGRAM [name of a test ...]
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
SMALL = ["--resolution", "0.4", "--frames", "2", "--threads", "1"]


class Compression(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="cell_compression_"))
        self.addCleanup(shutil.rmtree, self.folder, True)

    def run_program(self, out, *arguments, status=0):
        if "--reduction" not in arguments:
            arguments = ("--reduction", "0.3", *arguments)
        result = subprocess.run([PROGRAM, *SMALL, *arguments, "--out", str(self.folder / out)], capture_output=True,
                                text=True, timeout=300, env=dict(os.environ, OMP_WAIT_POLICY="passive"))
        self.assertEqual(result.returncode, status, result.stdout + result.stderr)
        return result

    def history(self, out):
        with open(self.folder / out / "history.csv", newline="") as file:
            rows = list(csv.DictReader(file))
        return {name: [float(row[name]) for row in rows] for name in rows[0]}

    def mean_force(self, out, first, last):
        """Between two reductions: the force of a run vibrates, as particle after particle touches."""
        history = self.history(out)
        r, f = history["reduction"], history["force"]

        def at(x):
            k = next(k for k in range(len(r)) if r[k + 1] >= x)
            return f[k] + (f[k + 1] - f[k]) * (x - r[k]) / (r[k + 1] - r[k])

        return sum(at(first + (last - first) * k / 200) for k in range(201)) / 201

    def test_equilibria_and_slow_dynamics_agree(self):
        self.run_program("static", "--body", "homogeneous", "--method", "static", "--samples", "15")
        self.run_program("slow", "--body", "homogeneous", "--duration", "200us")
        history = self.history("static")
        self.assertEqual(list(history)[:2], ["reduction", "force"])
        self.assertEqual(history["force"], sorted(history["force"]))
        self.assertEqual(history["force"][0], 0.0)
        for first, last in ((0.1, 0.2), (0.2, 0.29)):
            self.assertAlmostEqual(self.mean_force("slow", first, last) / self.mean_force("static", first, last), 1.0, delta=0.02)
        # The work of the plates is the energy of the ball: of both plates, over the reduction of the diameter.
        r, f = history["reduction"], history["force"]
        work = sum(0.5 * (f[k] + f[k + 1]) * (r[k + 1] - r[k]) * 10e-6 for k in range(len(r) - 1))
        self.assertAlmostEqual(work / history["strain_energy"][-1], 1.0, delta=0.02)
        for out, frames in (("static", 3), ("slow", 3)):
            self.assertEqual(sorted(os.listdir(self.folder / out)),
                             ["checkpoint.h5", "fields", "fields.pvd", "history.csv", "parameters.toml", "summary.json"])
            self.assertEqual(len(os.listdir(self.folder / out / "fields")), frames)
            summary = json.loads((self.folder / out / "summary.json").read_text())
            self.assertTrue(summary["completed"])
            self.assertEqual(summary["force"], self.history(out)["force"][-1])

    def test_a_softer_shell_and_a_gel_carry_less(self):
        self.run_program("whole", "--body", "homogeneous", "--method", "static", "--samples", "10")
        self.run_program("shell", "--body", "core-shell", "--method", "static", "--samples", "10")
        self.run_program("cell", "--body", "cell", "--duration", "200us")
        whole, shell, cell = (self.mean_force(out, 0.2, 0.29) for out in ("whole", "shell", "cell"))
        self.assertLess(shell, 0.3 * whole)
        self.assertGreater(shell, whole / 9.0)
        self.assertLess(cell, shell)
        self.assertGreater(cell, 0.0)

    def check_continued(self, expected, refused, *run):
        """Ended twice and continued on other threads it is the whole run."""
        self.run_program("whole", *run)
        lines = (self.folder / "whole" / "history.csv").read_bytes().count(b"\n")
        small = [*SMALL, "--reduction", "0.3", *run]
        continued_run.interrupt(self, PROGRAM, signal.SIGTERM, lines // 4, *small, "--out", "parts")
        shutil.copy(self.folder / "parts" / "checkpoint.h5", self.folder / "early.h5")
        restart = ["--restart", "parts/checkpoint.h5", "--threads"]
        continued_run.interrupt(self, PROGRAM, signal.SIGINT, lines // 2, *restart, "2", "--out", "parts")
        result = subprocess.run([PROGRAM, *restart, "1", "--out", "parts"], cwd=self.folder, capture_output=True, text=True, timeout=300,
                                env=continued_run.ENVIRONMENT)
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        self.assertRegex(result.stdout, expected)
        continued_run.assert_same(self, "whole", "parts", "history.csv")
        summaries = [json.loads((self.folder / out / "summary.json").read_text()) for out in ("whole", "parts")]
        for summary in summaries:
            del summary["wall_seconds"]
        self.assertEqual(*summaries)
        # From the first place again, over the lines and frames that are there by now.
        subprocess.run([PROGRAM, "--restart", "early.h5", "--threads", "2", "--out", "parts"], cwd=self.folder, check=True,
                       stdout=subprocess.DEVNULL, timeout=300, env=continued_run.ENVIRONMENT)
        continued_run.assert_same(self, "whole", "parts", "history.csv")
        # The plates move as they did.
        for option, value in refused:
            result = subprocess.run([PROGRAM, *restart, "1", f"--{option}", value, "--out", "new"], cwd=self.folder, capture_output=True,
                                    text=True, timeout=300, env=continued_run.ENVIRONMENT)
            self.assertEqual((result.returncode, result.stderr), (
                2, f'cell_compression: The saved state is of another simulation: "plates/{option}" differs.\n'))
        self.assertFalse((self.folder / "new").exists())

    def test_dynamics_that_are_ended_and_continued_are_the_whole_run(self):
        self.check_continued(r"going on from t = \S+ s, step \d+", [("duration", "1ms"), ("reduction", "0.4"), ("ramp", "0.2")],
                             "--body", "cell", "--duration", "50us", "--samples", "50")

    def test_equilibria_that_are_ended_and_continued_are_the_whole_run(self):
        self.check_continued(r"going on behind equilibrium \d+ of 20", [("samples", "10"), ("reduction", "0.4")],
                             "--body", "core-shell", "--method", "static", "--samples", "20")

    def test_bad_input(self):
        for arguments, says in (
            (["--body", "cell", "--method", "static"], "a fluid gel carries no shear at rest"),
            (["--nucleus", "1.2"], "--nucleus = 1.2 is not allowed"),
            (["--reduction", "0.95"], "--reduction = 0.95 is not allowed"),
            (["--body", "core_shell"], "did you mean core-shell?"),
        ):
            result = self.run_program("refused", *arguments, status=2)
            self.assertIn(says, result.stderr)
            self.assertEqual(len(result.stderr.strip().splitlines()), 1)
        self.assertFalse((self.folder / "refused").exists())


if __name__ == "__main__":
    PROGRAM = os.path.abspath(sys.argv.pop(1))
    unittest.main()
