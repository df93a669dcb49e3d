"""The program spreading_uniform as its users meet it: files, options, bad input, a run that breaks.

    python3 spreading_uniform.py PROGRAM [name of a test ...]
"""

import csv
import json
import math
import os
import pathlib
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import unittest
import xml.etree.ElementTree as xml

import h5py

import continued_run

PROGRAM = ""
COLUMNS = (
    "time dt spread_area contact_radius front_modulation nucleus_effective_stress_mean nucleus_effective_stress_max "
    "cell_effective_stress_max com_x com_y com_z contact_x contact_y kinetic_energy strain_energy adhesion_energy "
    "surface_energy dissipated_energy external_work energy_error momentum_x momentum_y momentum_z"
).split()
SUMMARY = "steps wall_seconds particles_cell particles_substrate pairs ns_per_pair threads version".split()
SMALL = ["--resolution", "0.3", "--end-time", "0.05us", "--frames", "2", "--samples", "5", "--threads", "1"]


def run(*arguments, folder=None):
    environment = dict(os.environ, OMP_WAIT_POLICY="passive", LC_ALL="C")
    return subprocess.run(
        [PROGRAM, *map(str, arguments)], cwd=folder, env=environment, capture_output=True, text=True, timeout=300
    )


def read_history(path):
    with open(path, newline="") as file:
        rows = list(csv.reader(file))
    return rows[0], [[float(value) for value in row] for row in rows[1:]]


class Case(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="spreading_uniform_"))
        self.addCleanup(shutil.rmtree, self.folder, True)

    def succeed(self, *arguments):
        result = run(*arguments, folder=self.folder)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(result.stderr, "")
        return result

    def check_frames(self, out):
        """Every file that fields.pvd names is there and whole, and all that is there is named. Returns the times."""
        times = []
        named = set()
        for data_set in xml.parse(out / "fields.pvd").getroot().iter("DataSet"):
            times.append(float(data_set.get("timestep")))
            named.add(data_set.get("file"))
            content = (out / data_set.get("file")).read_bytes()
            self.assertTrue(content.startswith(b"<?xml"))
            self.assertTrue(content.endswith(b"</VTKFile>\n"))
            for array in (b"displacement", b"velocity", b"effective_stress", b"pressure", b'"J"', b"region"):
                self.assertIn(array, content)
            if "cell" in data_set.get("file"):
                self.assertIn(b'"director"', content)
                self.assertIn(b'"gap"', content)
        self.assertEqual({"fields/" + name for name in os.listdir(out / "fields")}, named)
        return times


class Results(Case):
    def test_files_columns_and_keys(self):
        result = self.succeed(*SMALL, "--out", "new/folder")
        self.assertNotIn("\r", result.stdout)
        out = self.folder / "new/folder"
        self.assertEqual(
            sorted(os.listdir(out)), ["checkpoint.h5", "fields", "fields.pvd", "front.csv", "history.csv", "parameters.toml", "summary.json"]
        )
        head, rows = read_history(out / "history.csv")
        self.assertEqual(head[: len(COLUMNS)], COLUMNS)
        self.assertEqual(len(rows), 6)
        for k, row in enumerate(rows):
            self.assertEqual(len(row), len(head))
            self.assertTrue(all(map(math.isfinite, row)))
            self.assertAlmostEqual(row[0], k * 0.01e-6, delta=1e-18)
        self.assertEqual(rows[-1][0], 5e-8)
        last = dict(zip(head, rows[-1]))
        self.assertLess(last["momentum_z"], 0.0)  # it is drawn to the substrate
        self.assertGreater(last["kinetic_energy"], 0.0)
        self.assertGreater(last["nucleus_effective_stress_max"], last["nucleus_effective_stress_mean"])
        self.assertLess(last["energy_error"], 0.02)
        # The balance, from the columns, is the one that energy_error reports.
        energies = "kinetic_energy strain_energy adhesion_energy surface_energy dissipated_energy".split()
        first = dict(zip(head, rows[0]))
        defect = sum(last[name] - first[name] for name in energies) - last["external_work"]
        scale = max(abs(last["external_work"]), last["kinetic_energy"])
        self.assertLess(abs(abs(defect) / scale / last["energy_error"] - 1.0), 0.05)

        summary = json.loads((out / "summary.json").read_text())
        self.assertEqual(list(summary)[: len(COLUMNS)], COLUMNS)
        for name in COLUMNS:
            self.assertEqual(summary[name], last[name])
        for name in SUMMARY:
            self.assertIn(name, summary)
        self.assertEqual((summary["particles_cell"], summary["particles_substrate"]), (176, 579))
        self.assertEqual(summary["threads"], 1)
        self.assertGreaterEqual(summary["steps"], 5)
        self.assertGreater(summary["ns_per_pair"], 0.0)
        self.assertTrue(summary["completed"])
        times = self.check_frames(out)
        self.assertEqual(len(times), 6)  # two bodies at three times
        self.assertAlmostEqual(sorted(set(times))[1], 0.025e-6, delta=1e-17)

    def test_parameters_reproduce_the_run(self):
        unusual = ["--preset", "viscous/10", "--stiffness", "2.7", "--seed", "5", "--gap", "0.1um", "--density", "1.1g/cm3",
                   "--no-anchoring", "--van-der-waals", "3e6", "--nucleus", "0.45"]
        self.succeed(*SMALL, *unusual, "--out", "a")
        self.succeed("--config", "a/parameters.toml", "--out", "b")
        first, second = self.folder / "a", self.folder / "b"
        self.assertEqual((first / "history.csv").read_bytes(), (second / "history.csv").read_bytes())
        self.assertEqual(
            (first / "parameters.toml").read_text().replace('out = "a"', 'out = "b"'),
            (second / "parameters.toml").read_text(),
        )
        for name in os.listdir(first / "fields"):
            self.assertEqual((first / "fields" / name).read_bytes(), (second / "fields" / name).read_bytes())
        # They matter, and the command line wins over the file.
        self.succeed("--config", "a/parameters.toml", "--seed", "6", "--out", "c")
        self.assertNotEqual((first / "history.csv").read_bytes(), (self.folder / "c/history.csv").read_bytes())
        self.assertIn("seed = 6", (self.folder / "c/parameters.toml").read_text())

    def test_threads_change_no_bit(self):
        # Near enough to touch, so that contact takes part.
        near = ["--gap", "1nm", "--resolution", "0.4", "--end-time", "0.1us", "--frames", "1", "--samples", "5"]
        self.succeed(*near, "--threads", "1", "--out", "one")
        self.succeed(*near, "--threads", "2", "--out", "two")
        one, two = self.folder / "one", self.folder / "two"
        self.assertEqual((one / "history.csv").read_bytes(), (two / "history.csv").read_bytes())
        head, rows = read_history(one / "history.csv")
        self.assertGreater(rows[-1][head.index("spread_area")], 0.0)
        for name in os.listdir(one / "fields"):
            self.assertEqual((one / "fields" / name).read_bytes(), (two / "fields" / name).read_bytes())

    def test_a_heavier_substrate_takes_fewer_steps_and_says_so(self):
        near = ["--gap", "1nm", "--resolution", "0.4", "--end-time", "0.2us", "--frames", "1", "--samples", "5", "--threads", "1"]
        light = self.succeed(*near, "--out", "light")
        heavy = self.succeed(*near, "--substrate-mass-scaling", "4", "--out", "heavy")
        dense = self.succeed(*near, "--substrate-density", "4000", "--out", "dense")
        self.assertNotIn("mass scaling", light.stdout + dense.stdout)
        self.assertIn("the substrate is 4 times as heavy as it is, its waves are 2 times as slow", heavy.stdout)
        light, heavy, dense = (json.loads((self.folder / name / "summary.json").read_text()) for name in ("light", "heavy", "dense"))
        self.assertNotIn("substrate_mass_scaling", light)
        self.assertEqual(heavy["substrate_mass_scaling"], 4.0)
        self.assertLess(abs(light["steps"] / heavy["steps"] - 2.0), 0.2)
        for name in ("spread_area", "kinetic_energy", "momentum_z", "steps"):  # it is mass, and nothing else
            self.assertEqual(heavy[name], dense[name], name)

    def test_bodies_take_steps_of_their_own(self):
        near = ["--gap", "1nm", "--resolution", "0.4", "--end-time", "0.2us", "--frames", "1", "--samples", "5", "--threads", "1"]
        self.succeed(*near, "--out", "plain")
        self.succeed(*near, "--subcycling", "4", "--out", "own")
        self.succeed("--config", "own/parameters.toml", "--threads", "2", "--out", "again")
        self.assertIn("subcycling = 4\n", (self.folder / "again/parameters.toml").read_text())
        for name in ("history.csv", "front.csv"):
            self.assertEqual((self.folder / "own" / name).read_bytes(), (self.folder / "again" / name).read_bytes())
        plain, own = (json.loads((self.folder / name / "summary.json").read_text()) for name in ("plain", "own"))
        self.assertNotIn("small_steps", plain)
        self.assertEqual(own["steps_substrate"], own["small_steps"])
        self.assertGreaterEqual(own["small_steps"], 2 * own["steps_cell"])
        self.assertLess(own["steps"], own["small_steps"])
        self.assertLess(own["energy_error"], 2.0 * plain["energy_error"] + 1e-3)
        for name in ("spread_area", "nucleus_effective_stress_mean", "dissipated_energy", "momentum_z"):
            self.assertLess(abs(own[name] / plain[name] - 1.0), 0.03, name)

    def test_a_second_run_replaces_the_first(self):
        self.succeed(*SMALL, "--out", "a")
        before = (self.folder / "a/history.csv").read_bytes()
        (self.folder / "a/fields/note.txt").write_text("not a frame")
        fewer = [*SMALL[:4], "--frames", "1", *SMALL[6:]]
        self.succeed(*fewer, "--stiffness", "3", "--out", "a")
        self.assertNotEqual(before, (self.folder / "a/history.csv").read_bytes())
        (self.folder / "a/fields/note.txt").unlink()  # it is still there
        self.assertEqual(len(self.check_frames(self.folder / "a")), 4)

    def test_help_and_info(self):
        text = self.succeed("--help").stdout
        for option in ("stiffness", "end-time", "out", "resolution", "nucleus", "threads", "frames", "config", "info",
                       "density", "substrate-density", "support", "time-step", "preset"):
            self.assertIn("--" + option, text)
        self.assertEqual(self.succeed("-h").stdout, text)
        info = self.succeed("--info").stdout
        for name in ("Tactoid", "Eigen", "nanoflann", "fmt", "CLI11", "toml++", "compiler", "threads"):
            self.assertIn(name, info)
        self.assertEqual(os.listdir(self.folder), [])


class BadInput(Case):
    """Exit status 2, one line that says what is wrong, and nothing written."""

    def refuse(self, *arguments, says=()):
        before = sorted(os.listdir(self.folder))
        if not any(str(a).startswith("--out") for a in arguments):
            arguments = (*arguments, "--out", "new/results")
        result = run(*arguments, folder=self.folder)
        with self.subTest(" ".join(map(str, arguments))):
            self.assertEqual(result.returncode, 2, result.stdout + result.stderr)
            self.assertEqual(result.stdout, "")
            self.assertTrue(result.stderr.startswith("spreading_uniform: "), result.stderr)
            self.assertTrue(result.stderr.endswith("\n"))
            self.assertEqual(result.stderr.count("\n"), 1, result.stderr)
            for part in says:
                self.assertIn(part, result.stderr)
            self.assertEqual(sorted(os.listdir(self.folder)), before)

    def test_numbers_out_of_range(self):
        for option, value, shown, allowed in (
            ("density", "-5", "-5 kg/m3", "positive"),
            ("substrate-density", "0", "0", "positive"),
            ("support", "0.9", "0.9", "between 1.2 and 4"),
            ("nucleus", "1.2", "1.2", "above 0 and below 1"),
            ("nucleus", "0", "0", "above 0 and below 1"),
            ("resolution", "0", "0", "between 0.2 and 10"),
            ("resolution", "1e9", "1000000000", "between 0.2 and 10"),
            ("end-time", "0", "0", "positive"),
            ("end-time", "-5us", "-5 us", "positive"),
            ("viscosity", "-1", "-1 Pa.s", "zero or positive"),
            ("safety", "1.5", "1.5", "between 0.01 and 1"),
            ("subcycling", "0", "0", "between 1 and 64"),
            ("substrate-mass-scaling", "0.5", "0.5", "between 1 and"),
            ("threads", "0", "0", "between 1 and 1024"),
            ("frames", "-1", "-1", "between 1 and"),
        ):
            self.refuse(f"--{option}={value}", says=[f"--{option} = {shown}", allowed])
            if not value.startswith("-"):
                self.refuse(f"--{option}", value, says=[f"--{option} = {shown}", allowed])

    def test_time_step_above_the_stable_one(self):
        self.refuse("--resolution", "0.3", "--time-step", "1us", says=["time_step = 1e-06 s", "stable step"])
        self.refuse("--resolution", "0.3", "--time-step", "1s", says=["time_step = 1 s", "stable step"])

    def test_ratio_of_steps(self):
        self.refuse("--subcycling", "3", says=["max_ratio = 3", "1, 2, 4, 8 or another power of two"])

    def test_no_numbers(self):
        self.refuse("--end-time", "5 parsecs", says=["--end-time", '"5 parsecs"', "parsecs", "ms, us, ns"])
        self.refuse("--gap", "5us", says=["--gap", '"5us"', "um"])
        for value in ("nan", "inf", "-inf", "1e999", "ten", "5 5", "0x10", "1,5"):
            self.refuse(f"--stiffness={value}", says=["--stiffness", f'"{value}"'])
            self.refuse(f"--end-time={value}", says=["--end-time", f'"{value}"'])
        for option in ("--stiffness", "--end-time", "--frames", "--preset", "--out"):
            self.refuse(option, "", says=[option, "empty"], *([] if option == "--out" else ["--out", "x"]))
            self.refuse(option + "=", says=[option, "needs a value"])
        self.refuse("--out", "x", "--stiffness", says=["--stiffness needs a value"])
        self.refuse("--frames", "2.5", says=["--frames", '"2.5"', "whole number"])
        self.refuse("--seed", "-1", says=["--seed", '"-1"'])

    def test_unknown_names(self):
        self.refuse("--stifness", "2", says=["--stifness", "did you mean --stiffness?"])
        self.refuse("--colour", "red", says=["--colour", "--help"])
        self.refuse("--stiffness", "2", "--stiffness", "3", says=["--stiffness", "twice"])
        self.refuse("5us", says=['"5us"'])
        self.refuse("--preset", "elastick", says=["--preset", '"elastick"', "printed, viscous/10, elastic"])
        self.refuse("--director", "up", says=["--director", '"up"', "random, uniform, radial"])

    def test_configuration_files(self):
        for text, says in (
            ("stifness = 2\n", ['"stifness"', "did you mean stiffness?"]),
            ("density = -1\n", ["density = -1 kg/m3", "positive"]),
            ('end-time = "5 parsecs"\n', ["end-time", '"5 parsecs"']),
            ("stiffness = nan\n", ["stiffness", "finite"]),
            ("stiffness =\n", ["line 1"]),
            ("stiffness = 2\nstiffness = 3\n", ["line 2", "stiffness"]),
            ("[cell]\nstiffness = 2\n", ['"cell"', "section"]),
            ("stiffness = [2, 5]\n", ['"stiffness"', "array"]),
            ("anchoring = 1\n", ["anchoring", "true or false"]),
            ("preset = 3\n", ["preset", "quotes"]),
        ):
            (self.folder / "case.toml").write_text(text)
            self.refuse("--config", "case.toml", says=["case.toml", *says])
        (self.folder / "case.toml").write_bytes(b"stiffness = \xff\xfe\x00\n")
        self.refuse("--config", "case.toml", says=["case.toml"])
        self.refuse("--config", "missing.toml", says=['"missing.toml"', "No such file"])
        self.refuse("--config", self.folder, says=["directory"])
        self.refuse("--config", "", says=["--config", "empty"])

    def test_output_folders_that_cannot_be(self):
        (self.folder / "file").write_text("mine")
        small = ["--resolution", "0.3", "--end-time", "1ns"]
        for out in ("file", "file/below"):
            self.refuse(*small, "--out", out, says=[f'"{out}"', "irectory"])
        self.refuse(*small, "--out", "/proc/results", says=['"/proc/results"', "No such file"])
        self.assertEqual((self.folder / "file").read_text(), "mine")
        if os.geteuid() != 0:  # for root everything is writable
            (self.folder / "locked").mkdir(mode=0o555)
            self.refuse(*small, "--out", "locked/results", says=['"locked/results"', "denied"])
            self.refuse(*small, "--out", "locked", says=['"locked"', "denied"])


class Restart(Case):
    RUN = ["--gap", "1nm", "--resolution", "0.4", "--end-time", "0.5us", "--frames", "5", "--samples", "50", "--preset", "elastic"]

    def interrupt(self, sent, lines, *arguments):
        continued_run.interrupt(self, PROGRAM, sent, lines, *arguments)
        self.assertFalse(json.loads((self.folder / arguments[-1] / "summary.json").read_text())["completed"])
        self.check_frames(self.folder / arguments[-1])

    def assert_same(self, one, two):
        continued_run.assert_same(self, one, two, "history.csv", "front.csv")

    def test_a_run_that_is_ended_twice_and_continued_is_the_whole_run(self):
        self.succeed(*self.RUN, "--threads", "1", "--out", "whole")
        self.interrupt(signal.SIGTERM, 10, *self.RUN, "--threads", "1", "--out", "parts")
        shutil.copytree(self.folder / "parts", self.folder / "again")
        early = "again/checkpoint.h5"
        said = self.succeed("--restart", "parts/checkpoint.h5", "--threads", "2").stdout
        self.assertRegex(said, r"going on from t = \S+ s, step \d+")
        self.assert_same("whole", "parts")
        # Ended and continued twice; and elsewhere, where only the rest is.
        shutil.copy(self.folder / early, self.folder / "early.h5")
        self.interrupt(signal.SIGINT, 30, "--restart", early, "--threads", "1", "--out", "again")
        self.succeed("--restart", early, "--threads", "1", "--out", "again")
        self.assert_same("whole", "again")
        # Once more from the first place, over what is there by now.
        self.succeed("--restart", "early.h5", "--out", "again")
        self.assert_same("whole", "again")
        self.succeed("--restart", "early.h5", "--out", "elsewhere")
        whole, rest = (read_history(self.folder / out / "history.csv")[1] for out in ("whole", "elsewhere"))
        self.assertLess(len(rest), len(whole))
        self.assertEqual(rest, whole[-len(rest):])
        # A finished run goes on, too: with the same end nothing is added, and it can go further, where old and new events are the
        # same but for round-off.
        before = {name: (self.folder / "whole" / name).read_bytes() for name in ("history.csv", "fields.pvd")}
        self.succeed("--restart", "whole/checkpoint.h5")
        for name, content in before.items():
            self.assertEqual((self.folder / "whole" / name).read_bytes(), content, name)
        self.succeed("--restart", "whole/checkpoint.h5", "--end-time", "1us", "--frames", "20", "--samples", "20")
        times = [row[0] for row in read_history(self.folder / "whole/history.csv")[1]]
        self.assertEqual(times, sorted(set(times)))
        self.assertAlmostEqual(times[-1], 1e-6, delta=1e-15)
        self.check_frames(self.folder / "whole")

    def test_the_checkpoint_is_read_by_python(self):
        self.succeed(*SMALL, "--out", "out")
        with h5py.File(self.folder / "out" / "checkpoint.h5") as file:
            self.assertEqual(file.attrs["parameters"].decode(), (self.folder / "out" / "parameters.toml").read_text())
            cell = file["simulation/body_0"]
            self.assertEqual(cell["displacement"].shape, cell["reference"].shape)
            self.assertEqual(cell["displacement"].attrs["unit"], b"m")
            self.assertAlmostEqual(file["simulation/time"][()], 0.05e-6)

    def test_what_cannot_be_continued_is_refused(self):
        self.succeed(*SMALL, "--out", "out")
        checkpoint = self.folder / "out" / "checkpoint.h5"
        content = checkpoint.read_bytes()
        for name, bad, says in (("cut.h5", content[:-1000], "is a damaged checkpoint"), ("text.h5", b"nonsense", "is no checkpoint of Tactoid"),
                                ("flipped.h5", content[:5000] + b"?" + content[5001:], "is a damaged checkpoint")):
            (self.folder / name).write_bytes(bad)
            result = run("--restart", name, "--out", "new", folder=self.folder)
            self.assertEqual((result.returncode, result.stderr.count("\n")), (2, 1), result.stderr)
            self.assertIn(says, result.stderr)
        for arguments, says in ((["--restart", "none.h5"], "No such file"), (["--restart", checkpoint, "--end-time", "0.01us"], "the checkpoint is at"),
                                (["--restart", checkpoint, "--resolution", "0.4"], "is of another simulation")):
            result = run(*arguments, "--out", "new", folder=self.folder)
            self.assertEqual((result.returncode, result.stderr.count("\n")), (2, 1), result.stderr)
            self.assertIn(says, result.stderr)
        self.assertFalse((self.folder / "new").exists())

    def test_no_checkpoint_where_none_is_wanted(self):
        self.succeed(*SMALL, "--checkpoint-every", "0s", "--out", "out")
        self.assertFalse((self.folder / "out" / "checkpoint.h5").exists())


class FullDisc(Case):
    """One sentence, and everything that was written before is whole."""

    RUN = ["--gap", "1nm", "--resolution", "0.3", "--end-time", "0.1us", "--frames", "25", "--samples", "200", "--threads", "1"]

    def check_failed(self, result, out, reason):
        self.assertEqual(result.returncode, 2, result.stdout + result.stderr)
        self.assertRegex(result.stderr, rf'^spreading_uniform: Cannot write "{out}/[a-z_0-9./]+": {reason}\.\n$')
        for name in ("history.csv", "front.csv"):
            self.assertTrue((self.folder / out / name).read_bytes().endswith(b"\n"))
            head, rows = read_history(self.folder / out / name)
            self.assertGreater(len(rows), 2)
            self.assertEqual({len(row) for row in rows}, {len(head)})
        named = [entry.get("file") for entry in xml.parse(self.folder / out / "fields.pvd").getroot().iter("DataSet")]
        self.assertGreater(len(named), 2)
        for name in [*named, *("fields/" + name for name in os.listdir(self.folder / out / "fields"))]:
            self.assertTrue((self.folder / out / name).read_bytes().endswith(b"</VTKFile>\n"), name)
        self.assertEqual([path for path in (self.folder / out).rglob("*.part")], [])
        self.assertFalse((self.folder / out / "summary.json").exists())

    def test_a_run_on_a_disc_that_becomes_full_ends_and_can_be_continued(self):
        disc = self.folder / "disc"
        disc.mkdir()
        mount = ["mount", "-t", "tmpfs", "-o", "size=2m", "tmpfs", str(disc)]
        if shutil.which("mount") is None or subprocess.run(mount, capture_output=True).returncode != 0:
            self.skipTest("no disc of its own can be mounted here")
        self.addCleanup(subprocess.run, ["umount", str(disc)], check=True)
        self.check_failed(run(*self.RUN, "--checkpoint-every", "1ms", "--out", "disc/out", folder=self.folder), "disc/out",
                          "No space left on device")
        # With room again it goes on, and is the run that had room from the start.
        subprocess.run(["mount", "-o", "remount,size=50m", str(disc)], check=True)
        self.succeed(*self.RUN, "--out", "whole")
        self.succeed("--restart", "disc/out/checkpoint.h5")
        continued_run.assert_same(self, "whole", "disc/out", "history.csv", "front.csv")

    def test_a_file_that_may_not_grow_ends_the_run(self):
        # The history would have 450 kB at its end; a frame has less than 100 kB.
        grown = [*self.RUN[:-4], "--samples", "1000", "--threads", "1", "--checkpoint-every", "0s"]
        result = subprocess.run([PROGRAM, *grown, "--out", "out"], cwd=self.folder, capture_output=True, text=True, timeout=300,
                                env=continued_run.ENVIRONMENT, preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (150000, 150000)))
        self.check_failed(result, "out", "File too large")
        size = (self.folder / "out" / "history.csv").stat().st_size
        self.assertTrue(149000 < size <= 150000, size)


class BrokenRun(Case):
    def test_the_last_good_state_is_written(self):
        broken = ["--resolution", "0.3", "--van-der-waals", "1e9", "--end-time", "2us", "--frames", "40", "--samples", "40"]
        result = run(*broken, "--threads", "1", "--out", "out", folder=self.folder)
        self.assertEqual(result.returncode, 3, result.stderr)
        self.assertEqual(result.stderr.count("\n"), 1)
        self.assertRegex(
            result.stderr, r'^spreading_uniform: Body "cell", particle \d+ at X = \(.*\) m, u = \(.*\) m, t = \S+ s: .*likely'
        )
        out = self.folder / "out"
        head, rows = read_history(out / "history.csv")
        self.assertEqual(head[: len(COLUMNS)], COLUMNS)
        self.assertGreater(len(rows), 2)
        times = [row[0] for row in rows]
        self.assertEqual(times, sorted(set(times)))
        for row in rows:
            self.assertTrue(all(map(math.isfinite, row)))
        said = float(result.stderr.split("t = ")[1].split(" s")[0])
        self.assertLess(times[-1], said)
        self.assertGreater(times[-1], 0.9 * said)
        summary = json.loads((out / "summary.json").read_text())
        self.assertFalse(summary["completed"])
        self.assertEqual([summary[name] for name in head], rows[-1])
        frames = self.check_frames(out)
        self.assertEqual(frames[-2:], [times[-1]] * 2)
        self.assertTrue((out / "parameters.toml").exists())


    def test_a_run_that_loses_its_energy_stops(self):
        result = run("--resolution", "0.3", "--end-time", "1us", "--max-energy-error", "1e-9", "--threads", "1", "--out", "out",
                     folder=self.folder)
        self.assertEqual(result.returncode, 3, result.stderr)
        self.assertRegex(
            result.stderr, r"^spreading_uniform: The energy balance is off by \S+ % at t = \S+ s, and --max-energy-error allows 1e-07 %"
        )
        summary = json.loads((self.folder / "out" / "summary.json").read_text())
        self.assertFalse(summary["completed"])
        self.check_frames(self.folder / "out")


if __name__ == "__main__":
    PROGRAM = os.path.abspath(sys.argv.pop(1))
    unittest.main(verbosity=2)
