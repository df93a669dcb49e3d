"""The series of a run in ParaView: opened without a warning, with the values that were written; the script that draws it.

    python3 paraview_series.py PROGRAM SCRIPT [name of a test ...]      exit status 77: pvpython is not installed

Where there is no display, Xvfb makes one; without Xvfb the tests that draw are left out.
"""

import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "examples" / "common"))

PROGRAM = SCRIPT = ""
RUN = ["--gap", "1nm", "--resolution", "0.4", "--end-time", "0.1us", "--frames", "4", "--samples", "4", "--threads", "1"]


def compare(folder):
    """In pvpython: every array of every frame in ParaView is what the reader of the plots finds in the files."""
    import numpy as np
    from paraview import servermanager, simple
    from paraview.vtk.util.numpy_support import vtk_to_numpy
    from vtu_reader import Grid, read_history, read_series

    series = simple.PVDReader(FileName=os.path.join(folder, "fields.pvd"))
    frames, history = read_series(os.path.join(folder, "fields.pvd")), read_history(os.path.join(folder, "history.csv"))
    assert list(series.TimestepValues) == [time for time, _ in frames] == list(history["time"]), series.TimestepValues
    arrays = 0
    for k, (time, parts) in enumerate(frames):
        series.UpdatePipeline(time)
        bodies = servermanager.Fetch(series)
        names = [bodies.GetMetaData(b).Get(bodies.NAME()) for b in range(bodies.GetNumberOfBlocks())]
        assert names == ["cell", "substrate"], names
        for b, name in enumerate(names):
            shown, file = bodies.GetBlock(b).GetBlock(0), Grid(parts[name])
            assert np.array_equal(vtk_to_numpy(shown.GetPoints().GetData()), file.points)
            assert shown.GetNumberOfCells() == len(file.types)
            there = {shown.GetPointData().GetArrayName(i) for i in range(shown.GetPointData().GetNumberOfArrays())}
            assert there == set(file.point_data), (there, set(file.point_data))
            assert there >= {"displacement", "velocity", "effective_stress", "pressure", "J", "region"}, there
            assert (there >= {"director", "gap"}) == (name == "cell"), there
            for array, values in file.point_data.items():
                assert np.array_equal(vtk_to_numpy(shown.GetPointData().GetArray(array)), values, equal_nan=True), (name, array)
                arrays += 1
            if name == "cell":
                gap = vtk_to_numpy(shown.GetPointData().GetArray("gap"))
                assert np.nanmin(gap) == history["gap_min"][k], (np.nanmin(gap), history["gap_min"][k])
    print(f"{len(frames)} times, {arrays} arrays")


def reload(state, picture):
    """In pvpython: the state file alone makes the picture."""
    from paraview.simple import GetLayouts, LoadState, SaveScreenshot

    LoadState(state)
    (layout,) = GetLayouts().values()
    SaveScreenshot(picture, layout, ImageResolution=[1560, 620])


class ParaView(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="paraview_"))
        self.addCleanup(shutil.rmtree, self.folder, True)
        subprocess.run([PROGRAM, *RUN, "--out", "out"], cwd=self.folder, check=True, stdout=subprocess.DEVNULL, timeout=300)

    def pvpython(self, *arguments, display=None):
        environment = {name: value for name, value in os.environ.items() if name != "DISPLAY"}
        environment.update({"PYTHONDONTWRITEBYTECODE": "1", "HOME": str(self.folder)}, **({"DISPLAY": display} if display else {}))
        result = subprocess.run(["pvpython", *map(str, arguments)], cwd=self.folder, env=environment, capture_output=True, text=True,
                                timeout=300)
        # What it computes it tells, too: that is no warning.
        result.complaints = [line for line in result.stderr.splitlines() if line.strip(" \x1b[0m") and "INFO|" not in line]
        return result

    def display(self):
        """Of an Xvfb of its own, which does not begin anew between two connections: the second one would find nobody."""
        if shutil.which("Xvfb") is None:
            self.skipTest("Xvfb is not installed")
        server = subprocess.Popen(["Xvfb", "-displayfd", "1", "-screen", "0", "1600x900x24", "-nolisten", "tcp", "-noreset"],
                                  stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        self.addCleanup(server.stdout.close)
        self.addCleanup(server.wait)
        self.addCleanup(server.terminate)
        return ":" + server.stdout.readline().strip()

    def test_the_series_opens_without_a_warning_and_with_its_values(self):
        result = self.pvpython(__file__, "compare", self.folder / "out")
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(result.complaints, [])
        self.assertEqual(result.stdout, "5 times, 70 arrays\n")

    def test_a_damaged_frame_is_noticed(self):
        frame = self.folder / "out" / "fields" / "cell_0002.vtu"
        frame.write_bytes(frame.read_bytes()[:-2000])
        complaints = self.pvpython(__file__, "compare", self.folder / "out").complaints
        self.assertTrue(any("ERR|" in line or "WARN|" in line for line in complaints), complaints)

    def test_the_view_is_drawn_and_its_state_draws_it_again(self):
        from matplotlib.image import imread
        import numpy as np

        display = self.display()
        result = self.pvpython(SCRIPT, "out", "--state", "view.pvsm", display=display)
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(result.complaints, [])
        self.assertEqual(result.stdout, "out/paraview.png: t = 0.1 µs, of 5 time steps\n")
        picture = imread(self.folder / "out" / "paraview.png")
        # Both views are filled: a part is white, no part is nearly all of it, and there are the colours of fields.
        for view in (picture[:, :936, :3], picture[:, 940:, :3]):
            white = (view > 0.99).all(axis=2).mean()
            self.assertTrue(0.2 < white < 0.8, white)
            self.assertGreater(len(np.unique((view * 255).astype(int).reshape(-1, 3), axis=0)), 300)
        result = self.pvpython(__file__, "reload", "view.pvsm", "again.png", display=display)
        self.assertEqual((result.returncode, result.complaints), (0, []), result.stderr)
        again = imread(self.folder / "again.png")
        self.assertEqual(again.shape, picture.shape)
        self.assertLess(np.abs(again - picture).max(axis=2).round(2).astype(bool).mean(), 0.01)
        # An earlier time is another picture.
        result = self.pvpython(SCRIPT, "out", "--time", "30ns", "--output", "early.png", display=display)
        self.assertEqual(result.stdout, "early.png: t = 0.025 µs, of 5 time steps\n")
        self.assertFalse(np.array_equal(imread(self.folder / "early.png"), picture))

    def test_what_cannot_be_drawn_is_one_sentence(self):
        def refuse(says, *arguments):
            result = self.pvpython(SCRIPT, *arguments, display=":never-reached")
            self.assertEqual((result.returncode, result.stdout, len(result.complaints)), (2, "", 1), result.stderr)
            self.assertIn(says, result.stderr)

        refuse("No such file or directory", "nowhere")
        refuse("Cannot write none/view.png: its folder is not there", "out", "--output", "none/view.png")
        (self.folder / "out" / "fields" / "substrate_0001.vtu").unlink()
        refuse("names fields/substrate_0001.vtu, which is not there", "out")
        (self.folder / "out" / "fields.pvd").write_text((self.folder / "out" / "fields.pvd").read_text().replace("substrate", "cell"))
        refuse("its bodies are cell.", "out")
        (self.folder / "out" / "fields.pvd").write_text("<VTKFile><Collection>")
        refuse("is no series of ParaView, or it is cut off: no element found", "out")


if __name__ == "__main__":
    if sys.argv[1] in ("compare", "reload"):
        globals()[sys.argv[1]](*sys.argv[2:])
    elif shutil.which("pvpython") is None:
        print("pvpython is not installed")
        sys.exit(77)
    else:
        PROGRAM, SCRIPT = map(os.path.abspath, (sys.argv.pop(1), sys.argv.pop(1)))
        unittest.main(verbosity=2)
