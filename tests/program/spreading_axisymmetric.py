"""The program spreading_axisymmetric: its results, what it refuses, its picture, and the program in three dimensions.

    python3 spreading_axisymmetric.py SPREADING_AXISYMMETRIC SPREADING_UNIFORM [name of a test ...]
"""

import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "examples" / "common"))
from vtu_reader import QUAD, Grid, read_history

PROGRAMS = []


class Axisymmetric(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="spreading_axisymmetric_"))
        self.addCleanup(shutil.rmtree, self.folder, True)

    def run_program(self, out, *arguments, program=0, status=0):
        threads = [] if any(a.startswith("--threads") for a in arguments) else ["--threads=1"]
        result = subprocess.run([PROGRAMS[program], *threads, *arguments, f"--out={self.folder / out}"], capture_output=True,
                                text=True, timeout=300, env=dict(os.environ, OMP_WAIT_POLICY="passive"))
        self.assertEqual(result.returncode, status, result.stderr)
        return result

    def history(self, out):
        return read_history(self.folder / out / "history.csv")

    def test_spreads_as_the_body_in_three_dimensions_does(self):
        near = ["--gap=20nm", "--resolution=0.5", "--end-time=1us", "--frames=2", "--samples=20", "--activity=0", "--preset=elastic"]
        self.run_program("section", *near)
        self.run_program("body", *near, program=1)
        section, body = self.history("section"), self.history("body")
        self.assertEqual(list(section), list(body))
        self.assertGreater(section["spread_area"][-1], 5e-12)
        self.assertLess(abs(section["com_z"][-1] - body["com_z"][-1]), 0.02e-6)
        for name in ("external_work", "kinetic_energy"):
            self.assertLess(abs(section[name][-1] / body[name][-1] - 1.0), 0.05, name)
        # The front encloses the area, and pockets that do not touch.
        enclosed = section["contact_radius"][-5:] ** 2 * np.pi
        self.assertTrue(np.all(section["spread_area"][-5:] <= enclosed * (1 + 1e-12)))
        self.assertTrue(np.all(section["spread_area"][-5:] > 0.7 * enclosed))
        for name in ("com_x", "com_y", "momentum_x", "front_modulation"):
            self.assertFalse(np.any(section[name]), name)
        self.assertLess(section["energy_error"][-1], 0.02)

        summary = json.loads((self.folder / "section" / "summary.json").read_text())
        self.assertTrue(summary["completed"])
        frame = Grid(str(self.folder / "section" / "fields" / "cell_0002.vtu"))
        self.assertEqual(len(frame.cells(QUAD)), len(frame.connectivity[frame.offsets[frame.types == QUAD] - 1]))
        self.assertEqual(frame.points[:, 0].min(), 0.0)

        picture = self.folder / "picture.png"
        subprocess.run([sys.executable, ROOT / "examples" / "spreading_axisymmetric" / "plot.py", self.folder / "section", "--compare",
                        self.folder / "body", "--output", picture], check=True, capture_output=True)
        self.assertGreater(picture.stat().st_size, 10000)

    def test_what_is_not_axisymmetric_is_refused(self):
        for option, words in (("--director=random", "it is not axisymmetric"), ("--turn=30deg", "cannot be turned")):
            error = self.run_program("none", option, status=2).stderr
            self.assertEqual(len(error.strip().splitlines()), 1, error)
            self.assertIn(words, error)
            self.assertFalse((self.folder / "none").exists())

    def test_threads_do_not_change_a_bit(self):
        short = ["--gap=20nm", "--resolution=0.5", "--end-time=0.1us", "--frames=1", "--samples=5", "--director=uniform", "--activity=-1kPa"]
        self.run_program("one", *short)
        self.run_program("two", *short, "--threads=2")
        self.assertEqual((self.folder / "one" / "history.csv").read_bytes(), (self.folder / "two" / "history.csv").read_bytes())


if __name__ == "__main__":
    PROGRAMS = sys.argv[1:3]
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]], verbosity=2)
