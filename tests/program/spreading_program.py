"""What the tests of spreading programs share: runs in a folder of their own, one that is continued, input that is refused."""

import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "examples" / "common"))
from continued_run import ENVIRONMENT, assert_same, interrupt
from vtu_reader import read_history


class SpreadingProgram(unittest.TestCase):
    """A subclass says with which arguments every run begins; main() says which programs there are."""

    programs = []
    common = []

    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix=f"{type(self).__name__}_"))
        self.addCleanup(shutil.rmtree, self.folder, True)

    def run_program(self, out, *arguments, program=0, status=0):
        return self._run([self.programs[program], *self.common, *arguments, f"--out={self.folder / out}"], status)

    def history(self, out):
        return read_history(self.folder / out / "history.csv")

    def check_continued(self, lines, *arguments):
        """A run that is ended after so many lines of its history, and continued on two threads, is the run "whole" to the byte."""
        interrupt(self, self.programs[0], signal.SIGTERM, lines, *self.common, *arguments, "--out", "cut")
        self._run([self.programs[0], f"--restart={self.folder / 'cut' / 'checkpoint.h5'}", "--threads=2"], 0)
        assert_same(self, "whole", "cut", "history.csv", "front.csv")

    def check_refused(self, *cases):
        """Each case: arguments, and what the sentence says."""
        for arguments, sentence in cases:
            result = self.run_program("refused", *arguments, status=2)
            self.assertIn(sentence, result.stderr)
            self.assertFalse((self.folder / "refused").exists())

    def _run(self, command, status):
        result = subprocess.run(command, cwd=self.folder, capture_output=True, text=True, timeout=300, env=ENVIRONMENT)
        self.assertEqual(result.returncode, status, result.stderr)
        return result


def main():
    """Runs the tests of the calling script, whose first two arguments are programs."""
    SpreadingProgram.programs = [os.path.abspath(sys.argv.pop(1)), os.path.abspath(sys.argv.pop(1))]
    unittest.main()
