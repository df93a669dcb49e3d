"""The program durotaxis: its options, what tethers change, that without them it is spreading_graded, and runs that are continued.

    python3 durotaxis.py DUROTAXIS SPREADING_GRADED [name of a test ...]
"""

import numpy as np

from spreading_program import SpreadingProgram, main

NEAR = ["--gap=1nm", "--resolution=0.4", "--end-time=1us", "--frames=2", "--samples=10", "--threads=1", "--preset=elastic", "--activity=-1kPa"]
REACH = "--capture-distance=150nm"  # facets of so coarse a ball stay away from the substrate
ADDED = ["bonds_plus_x", "bonds_minus_x", "pull_plus_x", "pull_minus_x", "bond_tension", "bond_force_y", "speed_max"]


class Durotaxis(SpreadingProgram):
    common = NEAR

    def test_without_tethers_it_is_spreading_graded(self):
        self.run_program("off", "--tethers=off")
        self.run_program("graded", program=1)
        off, graded = self.history("off"), self.history("graded")
        self.assertEqual(list(off), [*graded, *ADDED])
        for name in graded:
            np.testing.assert_array_equal(off[name], graded[name], err_msg=name)
        for name in ADDED[:-1]:
            self.assertFalse(off[name].any(), name)
        self.assertGreater(off["speed_max"][-1], 0.0)

    def test_bonds_hold_the_cell(self):
        for name, arguments in {"off": ["--tethers=off"], "mean": [], "dense": ["--tether-density=3e15"], "single": ["--tethers=stochastic"],
                                "other": ["--tethers=stochastic", "--tether-seed=2"]}.items():
            self.run_program(name, REACH, *arguments)
        runs = {name: self.history(name) for name in ("off", "mean", "dense", "single", "other")}
        bonds = {name: run["bonds_plus_x"][-1] + run["bonds_minus_x"][-1] for name, run in runs.items()}
        self.assertGreater(bonds["mean"], 100.0)
        self.assertGreater(bonds["dense"], 5.0 * bonds["mean"])
        # Single bonds are whole ones, about as many as in the mean field, and other ones for another seed.
        self.assertEqual(bonds["single"], round(bonds["single"]))
        self.assertLess(abs(bonds["single"] / bonds["mean"] - 1.0), 0.25)
        self.assertFalse(np.array_equal(runs["single"]["com_x"], runs["other"]["com_x"]))
        # They change how it spreads, and pull on the substrate.
        self.assertNotEqual(runs["dense"]["contact_radius"][-1], runs["off"]["contact_radius"][-1])
        for name in ("pull_plus_x", "pull_minus_x", "bond_tension"):
            self.assertNotEqual(runs["mean"][name][-1], 0.0)
            self.assertEqual(runs["off"][name][-1], 0.0)
        self.assertLess(runs["dense"]["energy_error"][-1], 0.05)

    def test_a_continued_run_has_the_same_bits(self):
        single = ["--tethers=stochastic", REACH]
        self.run_program("whole", *single)
        self.check_continued(5, *single)

    def test_bad_input(self):
        self.check_refused((["--tethers=some"], "is not one of off, mean, stochastic"), (["--slip-force=0pN"], "--slip-force = 0 N is not allowed"),
                           (["--tether-density=-1"], "--tether-density"), (["--off-rate=1s"], "--off-rate"),
                           (["--rate-factor=0"], "--rate-factor = 0 is not allowed"))


if __name__ == "__main__":
    main()
