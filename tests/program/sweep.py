"""examples/sweep/sweep.py with a program that takes no time: grids, lists, failures, going on, bad input.

    python3 sweep.py [name of a test ...]
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
import time
import unittest

SWEEP = pathlib.Path(__file__).resolve().parents[2] / "examples" / "sweep" / "sweep.py"
PROGRAM = """#!{python}
import json, os, sys, time
options = dict(argument[2:].split("=", 1) for argument in sys.argv[1:])
with open(os.path.join({folder!r}, "calls"), "a") as file:
    file.write(" ".join(sys.argv[1:]) + "\\n")
if options.get("stiffness") == "-1":
    print("program: --stiffness = -1 is not allowed: it must be positive.", file=sys.stderr)
    sys.exit(2)
time.sleep(float(options.get("wait", 0)))
with open(os.path.join(options["out"], "summary.json"), "w") as file:
    json.dump({{"area": 2.0 * float(options.get("stiffness", 10)), "completed": True}}, file)
"""


class Sweep(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="sweep_"))
        self.addCleanup(shutil.rmtree, self.folder, True)
        self.program = self.folder / "program"
        self.program.write_text(PROGRAM.format(python=sys.executable, folder=str(self.folder)))
        self.program.chmod(0o755)

    def command(self, *arguments):
        return [sys.executable, str(SWEEP), str(self.program), "--out", str(self.folder / "out"), *arguments]

    def run_sweep(self, *arguments, status=0):
        result = subprocess.run(self.command(*arguments), capture_output=True, text=True, timeout=120)
        self.assertEqual(result.returncode, status, result.stdout + result.stderr)
        return result

    def refused(self, *arguments, says):
        result = self.run_sweep(*arguments, status=2)
        self.assertIn(says, result.stderr)
        self.assertEqual(len(result.stderr.strip().splitlines()), 1, result.stderr)
        self.assertEqual(self.calls(), [])

    def calls(self):
        path = self.folder / "calls"
        return path.read_text().splitlines() if path.exists() else []

    def table(self):
        with open(self.folder / "out" / "sweep.csv", newline="") as file:
            return list(csv.DictReader(file))

    def test_a_grid_is_every_combination(self):
        self.run_sweep("--grid", "stiffness=2,5,10", "--grid", "preset=viscous/10,elastic", "--set", "end-time=2us", "--jobs", "3")
        self.assertEqual(len(self.calls()), 6)
        self.assertTrue(all("--end-time=2us" in call and "--threads=1" in call for call in self.calls()))
        rows = self.table()
        self.assertEqual([(row["stiffness"], row["preset"]) for row in rows],
                         [(s, p) for s in ("2", "5", "10") for p in ("viscous/10", "elastic")])
        self.assertTrue(all(float(row["area"]) == 2.0 * float(row["stiffness"]) for row in rows))
        self.assertTrue((self.folder / "out" / "stiffness=2,preset=viscous_10" / "run.log").exists())

    def test_a_list_is_a_run_per_line(self):
        (self.folder / "runs.csv").write_text("stiffness,activity\n3,-1kPa\n4,\n")
        self.run_sweep("--list", str(self.folder / "runs.csv"))
        self.assertEqual(len(self.calls()), 2)
        self.assertIn("--activity=-1kPa", self.calls()[0])
        self.assertNotIn("--activity", self.calls()[1])
        self.assertEqual([row["area"] for row in self.table()], ["6.0", "8.0"])

    def test_what_is_done_stays(self):
        self.run_sweep("--grid", "stiffness=2,5")
        self.run_sweep("--grid", "stiffness=2,5,7")
        self.assertEqual(len(self.calls()), 3)
        self.assertEqual([row["status"] for row in self.table()], ["done"] * 3)
        self.run_sweep("--grid", "stiffness=2,5", "--set", "end-time=1us")  # other results: run again
        self.assertEqual(len(self.calls()), 5)
        (self.folder / "out" / "stiffness=2" / "summary.json").write_text("{")  # damaged
        self.run_sweep("--grid", "stiffness=2,5", "--set", "end-time=1us")
        self.assertEqual(len(self.calls()), 6)

    def test_a_failed_run_is_reported_and_not_fatal(self):
        result = self.run_sweep("--grid", "stiffness=2,-1,5", status=1)
        self.assertIn("1 failed", result.stdout)
        rows = self.table()
        self.assertEqual([row["status"] for row in rows], ["done", "failed", "done"])
        self.assertIn("exit status 2: program: --stiffness = -1 is not allowed", rows[1]["message"])
        self.run_sweep("--grid", "stiffness=2,-1,5", status=1)
        self.assertEqual(len(self.calls()), 3)
        self.run_sweep("--grid", "stiffness=2,-1,5", "--retry", status=1)
        self.assertEqual(len(self.calls()), 4)

    def test_interrupted_it_goes_on(self):
        for number in (signal.SIGINT, signal.SIGTERM):
            shutil.rmtree(self.folder / "out", True)
            (self.folder / "calls").unlink(missing_ok=True)
            arguments = ["--list", str(self.folder / "runs.csv"), "--jobs", "1"]
            (self.folder / "runs.csv").write_text("stiffness,wait\n2,0\n3,60\n4,0\n")
            process = subprocess.Popen(self.command(*arguments), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
            while len(self.calls()) < 2:
                time.sleep(0.02)
            process.send_signal(number)
            process.communicate(timeout=30)
            self.assertEqual(process.returncode, 130)
            self.assertEqual([row["status"] for row in self.table()], ["done", "waiting", "waiting"])
            (self.folder / "runs.csv").write_text("stiffness,wait\n2,0\n3,0\n4,0\n")
            self.run_sweep("--list", str(self.folder / "runs.csv"))
            self.assertEqual(len(self.calls()), 4)  # 2; 3 cut off; 3 and 4
            self.assertEqual([row["status"] for row in self.table()], ["done"] * 3)

    def test_bad_input_is_one_sentence(self):
        self.refused("--grid", "stiffness", says="is not of the form key=value")
        self.refused("--grid", "stiffness=2,,5", says="has an empty value")
        self.refused("--grid", "stiffness=2,2", says="has a value twice")
        self.refused("--grid", "stiffness=2", "--grid", "stiffness=5", says="stiffness is given twice")
        self.refused("--grid", "stiffness=2", "--set", "stiffness=5", says="stiffness is given twice")
        self.refused("--grid", "out=a,b", says="out is set by the sweep itself")
        self.refused("--grid", "stiffness=2", "--jobs", "0", says="it must be at least 1")
        self.refused("--list", str(self.folder / "none.csv"), says="cannot read")
        (self.folder / "runs.csv").write_text("stiffness,activity\n3\n")
        self.refused("--list", str(self.folder / "runs.csv"), says="line 2")
        (self.folder / "runs.csv").write_bytes(b"stiffness\n\xff\n")
        self.refused("--list", str(self.folder / "runs.csv"), says="cannot read")
        self.program.chmod(0o644)
        self.refused("--grid", "stiffness=2", says="is not a program that can be run")

    def test_a_figure_of_a_quantity(self):
        try:
            import matplotlib  # noqa: F401
        except ImportError:
            self.skipTest("matplotlib is not here")
        self.run_sweep("--grid", "stiffness=2,5", "--grid", "preset=printed,elastic", "--plot", "area")
        self.assertGreater((self.folder / "out" / "area.png").stat().st_size, 5000)
        result = self.run_sweep("--grid", "stiffness=2,5", "--plot", "volume", status=2)
        self.assertIn("--plot volume", result.stderr)


if __name__ == "__main__":
    unittest.main()
