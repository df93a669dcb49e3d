"""The program spreading_uniform on several processes: the files of one process, signals, failures, mismatched options.

    python3 mpi_spreading.py MPIRUN PROGRAM
"""

import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest

import h5py

import continued_run

MPIRUN = PROGRAM = ""
ENVIRONMENT = dict(
    continued_run.ENVIRONMENT, OMP_NUM_THREADS="1", OMPI_MCA_rmaps_base_oversubscribe="1", OMPI_ALLOW_RUN_AS_ROOT="1",
    OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1",
)
# Near enough to touch, so that contact takes part.
RUN = ["--gap", "1nm", "--resolution", "0.3", "--end-time", "0.3us", "--frames", "2", "--samples", "5", "--threads", "1"]


def one(*arguments, folder):
    return subprocess.run([PROGRAM, *arguments], cwd=folder, env=ENVIRONMENT, capture_output=True, text=True, timeout=200)


def ranks(count, *arguments, folder, more=()):
    """On so many processes; `more`: further ones, with arguments of their own."""
    command = [MPIRUN, "-n", str(count), PROGRAM, *arguments]
    if more:
        command += [":", "-n", "1", PROGRAM, *more]
    return subprocess.run(command, cwd=folder, env=ENVIRONMENT, capture_output=True, text=True, timeout=200)


def messages(result):
    """What the program said, without mpirun's own lines."""
    return [line for line in result.stderr.splitlines() if "spreading_uniform: " in line]


class Mpi(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="mpi_spreading_"))
        self.addCleanup(shutil.rmtree, self.folder, True)

    def succeed(self, result):
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(result.stderr, "")
        return result

    def assert_same_state(self, one_file, other_file, same_options=True):
        """Every number of two checkpoints; the files differ by when they were written."""
        with h5py.File(self.folder / one_file) as a, h5py.File(self.folder / other_file) as b:
            names = []
            a.visititems(lambda name, item: names.append(name) if isinstance(item, h5py.Dataset) else None)
            self.assertGreater(len(names), 50)
            for name in names:
                self.assertEqual(a[name][()].tobytes(), b[name][()].tobytes(), name)
            if same_options:
                self.assertEqual(dict(a.attrs), dict(b.attrs))

    def test_the_same_files_as_one_process(self):
        for folder in ("one", "two", "three"):
            (self.folder / folder).mkdir()
        alone = self.succeed(one(*RUN, "--out", "out", folder=self.folder / "one"))
        self.assertEqual(len(alone.stdout.splitlines()), 2)
        for folder, count in (("two", 2), ("three", 3)):
            divided = self.succeed(ranks(count, *RUN, "--out", "out", folder=self.folder / folder))
            self.assertEqual(len(divided.stdout.splitlines()), 2)
            self.assertIn(f"{count} ranks of 1 threads", divided.stdout)
            self.assertEqual(sorted(os.listdir(self.folder / "one/out")), sorted(os.listdir(self.folder / folder / "out")))
            continued_run.assert_same(self, "one/out", folder + "/out", "history.csv", "front.csv", "parameters.toml")
            self.assert_same_state("one/out/checkpoint.h5", folder + "/out/checkpoint.h5")

    def test_set_up_in_parts_has_the_same_results(self):
        self.succeed(one(*RUN, "--out", "one", folder=self.folder))
        self.succeed(ranks(3, *RUN, "--set-up", "divided", "--out", "parts", folder=self.folder))
        continued_run.assert_same(self, "one", "parts", "history.csv", "front.csv")
        self.assert_same_state("one/checkpoint.h5", "parts/checkpoint.h5", same_options=False)

    def test_in_the_order_of_the_ranks_numbers_are_the_same_but_for_round_off(self):
        self.succeed(one(*RUN, "--out", "one", folder=self.folder))
        self.succeed(ranks(4, *RUN, "--sum-order", "ranks", "--out", "two", folder=self.folder))
        self.assert_close("one/checkpoint.h5", "two/checkpoint.h5")
        # And one process goes on in its own order.
        for folder in ("one", "two"):
            self.succeed(one("--restart", folder + "/checkpoint.h5", "--end-time", "0.4us", "--sum-order", "process", "--out", folder, folder=self.folder))
        self.assert_close("one/checkpoint.h5", "two/checkpoint.h5")

    def assert_close(self, one_file, other_file):
        name = "simulation/body_0/displacement"
        with h5py.File(self.folder / one_file) as a, h5py.File(self.folder / other_file) as b:
            x, y = a[name][()], b[name][()]
        self.assertLess(abs(x - y).max(), 1e-10 * abs(x).max())
        self.assertGreater(abs(x - y).max(), 0.0)

    def test_any_number_of_ranks_goes_on_where_a_signal_ended_another(self):
        self.succeed(one(*RUN, "--out", "whole", folder=self.folder))
        # To the last rank alone: all end in the same step.
        command = [MPIRUN, "-n", "3", PROGRAM, *RUN, "--out", "parts"]
        with subprocess.Popen(command, cwd=self.folder, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, env=ENVIRONMENT) as process:
            history = self.folder / "parts/history.csv"
            while not history.exists() or history.read_bytes().count(b"\n") < 3:
                self.assertIsNone(process.poll(), "the run ended before it could be interrupted")
                time.sleep(0.005)
            children = subprocess.run(["pgrep", "-P", str(process.pid)], capture_output=True, text=True).stdout.split()
            self.assertEqual(len(children), 3)
            os.kill(int(children[-1]), signal.SIGTERM)
            error = process.communicate(timeout=120)[1]
        self.assertEqual(process.returncode, 128 + signal.SIGTERM, error)
        self.assertEqual([line for line in error.splitlines() if "spreading_uniform: " in line], ["spreading_uniform: ended by SIGTERM."])
        for go_on in (lambda *arguments: ranks(2, *arguments, folder=self.folder), lambda *arguments: one(*arguments, folder=self.folder)):
            shutil.copytree(self.folder / "parts", self.folder / "again")
            self.succeed(go_on("--restart", "again/checkpoint.h5", "--out", "again"))
            continued_run.assert_same(self, "whole", "again", "history.csv", "front.csv")
            shutil.rmtree(self.folder / "again")

    def test_a_failure_of_all_is_told_once(self):
        result = ranks(3, "--resolution", "0.3", "--end-time", "1us", "--max-energy-error", "1e-9", "--threads", "1", "--out", "out", folder=self.folder)
        self.assertEqual(result.returncode, 3, result.stderr)
        self.assertEqual(len(messages(result)), 1, result.stderr)
        self.assertIn("The energy balance is off by", result.stderr)
        result = ranks(3, "--stiffness", "-1", folder=self.folder)
        self.assertEqual(result.returncode, 2, result.stderr)
        self.assertEqual(len(messages(result)), 1, result.stderr)
        self.assertIn("stiffness", messages(result)[0])

    def test_a_failure_of_one_ends_all_and_names_it(self):
        (self.folder / "file").write_text("no folder")
        start = time.monotonic()
        result = ranks(2, *RUN, "--out", "file/out", folder=self.folder)  # only the first rank writes
        self.assertLess(time.monotonic() - start, 60.0)
        self.assertEqual(result.returncode, 2, result.stderr)
        self.assertEqual(len(messages(result)), 1, result.stderr)
        self.assertTrue(messages(result)[0].startswith("rank 0: spreading_uniform: "), result.stderr)

    def test_other_options_on_one_rank_are_refused(self):
        result = ranks(2, *RUN, "--out", "out", folder=self.folder, more=[*RUN, "--out", "out", "--seed", "7"])
        self.assertEqual(result.returncode, 2, result.stderr)
        self.assertEqual(messages(result), ["spreading_uniform: Rank 2 has another set of options than rank 0: all ranks must run the same "
                                            "program with the same options."])
        self.assertFalse((self.folder / "out").exists())

    def test_help_is_printed_once(self):
        result = self.succeed(ranks(2, "--help", folder=self.folder))
        self.assertEqual(result.stdout.count("--stiffness"), 1)


if __name__ == "__main__":
    MPIRUN, PROGRAM = map(os.path.abspath, sys.argv[1:3])
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]])
