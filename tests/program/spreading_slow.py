"""The program spreading_slow: against explicit steps, runs that are continued, bad input.

    python3 spreading_slow.py SPREADING_SLOW SPREADING_AXISYMMETRIC [name of a test ...]
"""

import json
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import unittest

import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "examples" / "common"))
from continued_run import ENVIRONMENT, assert_same, interrupt
from vtu_reader import read_history

PROGRAMS = []
SMALL = ["--resolution=0.6", "--frames=2", "--samples=10", "--threads=1"]


class SpreadingSlow(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="spreading_slow_"))
        self.addCleanup(shutil.rmtree, self.folder, True)

    def run_program(self, out, *arguments, program=0, status=0):
        result = subprocess.run([PROGRAMS[program], *SMALL, *arguments, f"--out={self.folder / out}"], capture_output=True, text=True,
                                timeout=300, env=ENVIRONMENT)
        self.assertEqual(result.returncode, status, result.stderr)
        return result

    def test_implicit_steps_give_the_area_of_explicit_ones(self):
        paper = ["--preset=printed", "--end-time=2us"]
        self.run_program("implicit", *paper, "--elasticity=819.72kPa", "--viscosity=3mPa.s", "--van-der-waals=1e6", "--tethers=off")
        self.run_program("explicit", *paper, "--stiffness=10", program=1)
        implicit, explicit = (read_history(self.folder / name / "history.csv") for name in ("implicit", "explicit"))
        np.testing.assert_array_equal(implicit["time"], explicit["time"])
        self.assertGreater(explicit["spread_area"][-1], 1e-11)
        np.testing.assert_allclose(implicit["spread_area"], explicit["spread_area"], rtol=0.01, atol=1e-13)
        np.testing.assert_allclose(implicit["com_z"], explicit["com_z"], rtol=1e-4)
        steps = [json.loads((self.folder / name / "summary.json").read_text())["steps"] for name in ("implicit", "explicit")]
        self.assertLess(3 * steps[0], steps[1])

    def test_seconds_and_a_continued_run(self):
        slow = ["--viscosity=10Pa.s", "--end-time=2s"]
        self.run_program("whole", *slow)
        summary = json.loads((self.folder / "whole" / "summary.json").read_text())
        self.assertTrue(summary["completed"])
        self.assertGreater(summary["spread_area"], 1e-12)
        self.assertLess(summary["steps"], 2000)
        self.assertGreater(summary["newton_iterations"], summary["steps"] - 1)
        interrupt(self, PROGRAMS[0], signal.SIGTERM, 4, *SMALL, *slow, "--out", "cut")
        result = subprocess.run([PROGRAMS[0], f"--restart={self.folder / 'cut' / 'checkpoint.h5'}", "--threads=2"], cwd=self.folder,
                                capture_output=True, text=True, timeout=300, env=ENVIRONMENT)
        self.assertEqual(result.returncode, 0, result.stderr)
        assert_same(self, "whole", "cut", "history.csv", "front.csv")

    def test_a_run_that_breaks_down_says_why_and_keeps_its_state(self):
        # Nothing resists this stress but viscosity.
        result = self.run_program("torn", "--activity=-100kPa", "--end-time=10s", status=3)
        self.assertRegex(result.stderr, r"^spreading_slow: (ImplicitDynamics found no step|The steps) at t = \d\S* s.*\n$")
        self.assertFalse(json.loads((self.folder / "torn" / "summary.json").read_text())["completed"])

    def test_bad_input(self):
        for arguments, sentence in [(["--tolerance=0"], "--tolerance = 0 is not allowed"), (["--director=random"], "it is not axisymmetric"),
                                    (["--elasticity=-1kPa"], "--elasticity"), (["--max-time-step=-1s"], "--max-time-step = -1 s is not allowed"),
                                    (["--tolerance=2"], "--tolerance = 2 is not allowed")]:
            result = self.run_program("refused", *arguments, status=2)
            self.assertIn(sentence, result.stderr)
            self.assertFalse((self.folder / "refused").exists())


if __name__ == "__main__":
    PROGRAMS = [os.path.abspath(sys.argv.pop(1)), os.path.abspath(sys.argv.pop(1))]
    unittest.main()
