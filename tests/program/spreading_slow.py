"""The program spreading_slow: against explicit steps, runs that are continued, bad input.

    python3 spreading_slow.py SPREADING_SLOW SPREADING_AXISYMMETRIC [name of a test ...]
"""

import json

import numpy as np

from spreading_program import SpreadingProgram, main

SMALL = ["--resolution=0.6", "--frames=2", "--samples=10", "--threads=1"]


class SpreadingSlow(SpreadingProgram):
    common = SMALL

    def summary(self, out):
        return json.loads((self.folder / out / "summary.json").read_text())

    def test_implicit_steps_give_the_area_of_explicit_ones(self):
        paper = ["--preset=printed", "--end-time=2us"]
        self.run_program("implicit", *paper, "--elasticity=819.72kPa", "--viscosity=3mPa.s", "--van-der-waals=1e6", "--tethers=off",
                         "--fluid-hourglass-viscosity=2.5e-5Pa.s", "--surface-smoothing=0", "--update-at=0", "--bonds-on=cell", "--contact-points=2",
                         "--contact-refinement=1")
        self.run_program("explicit", *paper, "--stiffness=10", program=1)
        implicit, explicit = self.history("implicit"), self.history("explicit")
        np.testing.assert_array_equal(implicit["time"], explicit["time"])
        self.assertGreater(explicit["spread_area"][-1], 1e-11)
        np.testing.assert_allclose(implicit["spread_area"], explicit["spread_area"], rtol=0.01, atol=1e-13)
        np.testing.assert_allclose(implicit["com_z"], explicit["com_z"], rtol=1e-4)
        self.assertLess(3 * self.summary("implicit")["steps"], self.summary("explicit")["steps"])

    def test_seconds_and_a_continued_run(self):
        slow = ["--viscosity=10Pa.s", "--end-time=2s"]
        self.run_program("whole", *slow)
        summary = self.summary("whole")
        self.assertTrue(summary["completed"])
        self.assertGreater(summary["spread_area"], 1e-12)
        self.assertLess(summary["steps"], 2000)
        self.assertGreater(summary["newton_iterations"], summary["steps"] - 1)
        self.check_continued(4, *slow)

    def test_a_soft_substrate_is_drawn_up(self):
        # Around the contact it is hollow: points of the cell that rested there would stop Newton's method.
        self.run_program("soft", "--elasticity=1kPa", "--end-time=2s")
        self.run_program("stiff", "--elasticity=1MPa", "--end-time=2s")
        soft, stiff = self.summary("soft"), self.summary("stiff")
        self.assertTrue(soft["completed"])
        self.assertLess(soft["steps"], 1500)
        self.assertGreater(soft["spread_area"], stiff["spread_area"])

    def test_a_run_that_breaks_down_says_why_and_keeps_its_state(self):
        # Nothing resists this stress but viscosity.
        result = self.run_program("torn", "--activity=-100kPa", "--end-time=10s", status=3)
        self.assertRegex(result.stderr, r"^spreading_slow: (ImplicitDynamics found no step|The steps) at t = \d\S* s.*\n$")
        self.assertFalse(self.summary("torn")["completed"])

    def test_bad_input(self):
        self.check_refused((["--tolerance=0"], "--tolerance = 0 is not allowed"), (["--director=random"], "it is not axisymmetric"),
                           (["--elasticity=-1kPa"], "--elasticity"), (["--max-time-step=-1s"], "--max-time-step = -1 s is not allowed"),
                           (["--contact-refinement=3"], "--contact-refinement = 3 is not allowed"), (["--bonds-on=both"], "--bonds-on"),
                           (["--tolerance=2"], "--tolerance = 2 is not allowed"))


if __name__ == "__main__":
    main()
