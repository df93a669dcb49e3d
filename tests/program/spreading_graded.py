"""The program spreading_graded: the grading, and that it is spreading_uniform where the grading is none.

    python3 spreading_graded.py SPREADING_GRADED SPREADING_UNIFORM [name of a test ...]
"""

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
from vtu_reader import Grid, read_history

import continued_run

PROGRAMS = []
NEAR = ["--gap=1nm", "--resolution=0.4", "--end-time=0.2us", "--frames=1", "--samples=4", "--threads=1", "--preset=elastic"]


class Graded(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="spreading_graded_"))
        self.addCleanup(shutil.rmtree, self.folder, True)

    def run_program(self, program, out, *arguments, status=0):
        result = subprocess.run([program, *NEAR, *arguments, f"--out={self.folder / out}"], capture_output=True, text=True,
                                timeout=300, env=dict(os.environ, OMP_WAIT_POLICY="passive"))
        self.assertEqual(result.returncode, status, result.stderr)
        return result

    def run_here(self, *arguments):
        result = subprocess.run([PROGRAMS[0], *arguments], cwd=self.folder, capture_output=True, text=True, timeout=300,
                                env=continued_run.ENVIRONMENT)
        self.assertEqual(result.returncode, 0, result.stderr)

    def history(self, out):
        return read_history(self.folder / out / "history.csv")

    def test_equal_sides_are_the_uniform_substrate(self):
        self.run_program(PROGRAMS[0], "graded", "--soft=5", "--stiff=5")
        self.run_program(PROGRAMS[1], "uniform", "--stiffness=5")
        graded, uniform = self.history("graded"), self.history("uniform")
        self.assertEqual(list(graded), list(uniform))
        self.assertGreater(uniform["spread_area"][-1], 0.0)
        for name in ("time", "spread_area", "contact_radius", "com_z", "kinetic_energy", "strain_energy", "front_plus_x"):
            np.testing.assert_allclose(graded[name], uniform[name], rtol=1e-6, err_msg=name)

    def test_the_side_at_minus_x_is_the_stiff_one(self):
        self.run_program(PROGRAMS[0], "graded", "--soft=2", "--stiff=200")
        substrate = Grid(self.folder / "graded" / "fields" / "substrate_0001.vtu")
        moved = np.linalg.norm(substrate.point_data["displacement"], axis=1)
        x = substrate.points[:, 0]
        soft, stiff = moved[x > 1e-6].mean(), moved[x < -1e-6].mean()
        self.assertGreater(soft, 2.0 * stiff)  # the factor is 53 on the mean there, and 149 here

    def test_a_run_that_is_ended_and_continued_is_the_whole_run(self):
        near = ["--soft=2", "--stiff=50", "--gap=1nm", "--resolution=0.4", "--end-time=0.5us", "--frames=5", "--samples=50", "--preset=elastic"]
        self.run_here(*near, "--threads=1", "--out", "whole")
        continued_run.interrupt(self, PROGRAMS[0], signal.SIGTERM, 10, *near, "--threads=1", "--out", "parts")
        shutil.copy(self.folder / "parts" / "checkpoint.h5", self.folder / "early.h5")
        continued_run.interrupt(self, PROGRAMS[0], signal.SIGINT, 30, "--restart", "parts/checkpoint.h5", "--threads=1", "--out", "parts")
        for start in ("parts/checkpoint.h5", "early.h5"):  # at last from the first place, over what is there by now
            self.run_here("--restart", start, "--threads=2", "--out", "parts")
            continued_run.assert_same(self, "whole", "parts", "history.csv", "front.csv")

    def test_bad_input(self):
        result = self.run_program(PROGRAMS[0], "refused", "--soft=0", status=2)
        self.assertIn("--soft = 0 is not allowed: it must be positive.", result.stderr)
        result = self.run_program(PROGRAMS[0], "refused", "--stiffness=5", status=2)
        self.assertIn("unknown option --stiffness", result.stderr)
        self.assertFalse((self.folder / "refused").exists())


if __name__ == "__main__":
    PROGRAMS = [os.path.abspath(sys.argv.pop(1)), os.path.abspath(sys.argv.pop(1))]
    unittest.main()
