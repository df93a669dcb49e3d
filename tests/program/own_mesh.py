"""The program own_mesh with meshes and points that the test writes; files that are refused.

    python3 own_mesh.py PROGRAM [name of a test ...]
"""

import base64
import csv
import json
import os
import pathlib
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import unittest
import zlib

import continued_run

PROGRAM = ""


def block(n, second="cytoplasm"):
    """MSH 4.1: a cube of n^3 hexahedra of side 1, its lower half the nucleus."""
    m, lines = n + 1, ["$MeshFormat", "4.1 0 8", "$EndMeshFormat", "$PhysicalNames", "2", '3 1 "nucleus"', f'3 2 "{second}"',
                       "$EndPhysicalNames", "$Entities", "0 0 0 2", "1 0 0 0 1 1 1 1 1 0", "2 0 0 0 1 1 1 1 2 0", "$EndEntities"]
    lines += ["$Nodes", f"1 {m**3} 1 {m**3}", f"3 1 0 {m**3}", *map(str, range(1, m**3 + 1))]
    lines += [f"{i / n} {j / n} {k / n}" for k in range(m) for j in range(m) for i in range(m)]
    lines += ["$EndNodes", "$Elements", f"2 {n**3} 1 {n**3}"]
    tag = 0
    for entity, layers in ((1, range(n // 2)), (2, range(n // 2, n))):
        lines.append(f"3 {entity} 5 {len(layers) * n * n}")
        for k in layers:
            for j in range(n):
                for i in range(n):
                    tag += 1
                    corner = [1 + i + a + m * (j + b + m * (k + c)) for c in (0, 1) for a, b in ((0, 0), (1, 0), (1, 1), (0, 1))]
                    lines.append(" ".join(map(str, [tag, *corner])))
    return "\n".join([*lines, "$EndElements", ""])


def grid(n, compressor="vtkZLibDataCompressor"):
    """VTU as ParaView writes it, appended, compressed and in base64: the same cube."""
    m, appended = n + 1, []

    def array(kind, attributes, form, values):
        data = struct.pack(f"<{len(values)}{form}", *values)
        blocks = [data[k : k + 1000] for k in range(0, len(data), 1000)]
        packed = [zlib.compress(block) for block in blocks]
        head = struct.pack(f"<{3 + len(packed)}I", len(blocks), 1000, len(data) % 1000, *map(len, packed))
        offset = sum(map(len, appended))
        appended.append((base64.b64encode(head) + base64.b64encode(b"".join(packed))).decode())
        return f'<DataArray type="{kind}" {attributes} format="appended" offset="{offset}"/>\n'

    points = [c / n for k in range(m) for j in range(m) for i in range(m) for c in (i, j, k)]
    cells = [i + a + m * (j + b + m * (k + c)) for k in range(n) for j in range(n) for i in range(n)
             for c in (0, 1) for a, b in ((0, 0), (1, 0), (1, 1), (0, 1))]
    text = (f'<VTKFile type="UnstructuredGrid" byte_order="LittleEndian" compressor="{compressor}"><UnstructuredGrid>\n'
            f'<Piece NumberOfPoints="{m**3}" NumberOfCells="{n**3}"><Points>\n')
    text += array("Float64", 'Name="Points" NumberOfComponents="3"', "d", points) + "</Points><Cells>\n"
    text += array("Int64", 'Name="connectivity"', "q", cells)
    text += array("Int64", 'Name="offsets"', "q", range(8, 8 * n**3 + 8, 8))
    text += array("UInt8", 'Name="types"', "B", [12] * n**3) + "</Cells><CellData>\n"
    text += array("Int32", 'Name="part"', "i", [7 if c < n**3 // 2 else 9 for c in range(n**3)])
    return (text + '</CellData></Piece></UnstructuredGrid><AppendedData encoding="base64">\n_' + "".join(appended) +
            "\n</AppendedData></VTKFile>\n")


def table(n):
    """CSV: the nodes of the same cube."""
    rows = [f"{i / n};{j / n};{k / n};{'nucleus' if 2 * k < n else 'cytoplasm'}" for k in range(n + 1) for j in range(n + 1) for i in range(n + 1)]
    return "\n".join(["# points of a cell", "x;y;z;region", *rows, ""])


class OwnMesh(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="own_mesh_"))
        self.addCleanup(shutil.rmtree, self.folder, True)

    def run_program(self, text, *arguments, status=0, name="body.msh"):
        (self.folder / name).write_text(text)
        for option, value in (("--threads", "1"), ("--out", "out")):
            arguments = arguments if option in arguments else (*arguments, option, value)
        result = subprocess.run([PROGRAM, "--mesh", name, *arguments], cwd=self.folder,
                                capture_output=True, text=True, timeout=300, env=dict(os.environ, OMP_WAIT_POLICY="passive"))
        self.assertEqual(result.returncode, status, result.stdout + result.stderr)
        return result

    def test_a_block_falls_and_comes_back(self):
        result = self.run_program(block(4), "--scale", "5um", "--speed", "0.05m/s", "--end-time", "12us", "--frames", "2")
        self.assertIn("125 particles, 64 cells, 96 facets, volume 1.25e-16 m^3", result.stdout)
        with open(self.folder / "out" / "history.csv", newline="") as file:
            rows = [{name: float(value) for name, value in row.items()} for row in csv.DictReader(file)]
        self.assertGreater(max(row["force"] for row in rows), 0.0)
        self.assertLess(rows[-1]["energy_error"], 0.01)
        self.assertEqual(len(os.listdir(self.folder / "out" / "fields")), 3)
        summary = json.loads((self.folder / "out" / "summary.json").read_text())
        self.assertEqual({name: summary[name] for name in rows[-1]}, rows[-1])
        self.assertEqual((summary["particles"], summary["threads"], summary["completed"]), (125, 1, True))
        self.assertGreater(summary["steps"], 0)
        self.assertGreater(summary["wall_seconds"], 0.0)

    def test_a_run_that_is_ended_and_continued_is_the_whole_run(self):
        fall = ["--mesh", "body.msh", "--scale", "5um", "--speed", "0.05m/s", "--end-time", "12us", "--frames", "6"]
        self.run_program(block(8), *fall[2:], "--out", "whole")
        continued_run.interrupt(self, PROGRAM, signal.SIGTERM, 40, *fall, "--threads", "1", "--out", "parts")
        shutil.copy(self.folder / "parts" / "checkpoint.h5", self.folder / "early.h5")
        continued_run.interrupt(self, PROGRAM, signal.SIGINT, 90, "--restart", "parts/checkpoint.h5", "--threads", "1", "--out", "parts")
        self.run_program(block(8), "--restart", "parts/checkpoint.h5", "--threads", "2", "--out", "parts")
        continued_run.assert_same(self, "whole", "parts", "history.csv")
        # Its summary is that of the whole run, whatever it took.
        whole, parts = (json.loads((self.folder / out / "summary.json").read_text()) for out in ("whole", "parts"))
        for name in ("wall_seconds", "threads"):
            del whole[name], parts[name]
        self.assertEqual(whole, parts)
        # From the first place again, over the lines and frames that are there by now.
        self.run_program(block(8), "--restart", "early.h5", "--threads", "1", "--out", "parts")
        continued_run.assert_same(self, "whole", "parts", "history.csv")
        result = self.run_program(block(8), "--restart", "parts/checkpoint.h5", "--end-time", "1us", "--out", "new", status=2)
        self.assertEqual(result.stderr, "own_mesh: --end-time = 1e-06 s is not allowed: the checkpoint is at 1.2e-05 s.\n")
        result = self.run_program(block(4), "--restart", "parts/checkpoint.h5", "--out", "new", status=2)
        self.assertIn("is of another simulation", result.stderr)
        self.assertFalse((self.folder / "new").exists())

    def test_a_grid_of_vtk_is_the_same_block(self):
        short = ("--scale", "5um", "--end-time", "10ns", "--frames", "1")
        result = self.run_program(grid(4), "--region-array", "part", "--nucleus-region", "7", "--cytoplasm-region", "9", *short, name="body.vtu")
        self.assertIn("125 particles, 64 cells, 96 facets, volume 1.25e-16 m^3", result.stdout)

    def test_points_become_a_block(self):
        result = self.run_program(table(3), "--scale", "5um", "--end-time", "10ns", "--frames", "1", name="body.csv")
        self.assertIn("volume 1.25e-16 m^3", result.stdout)

    def test_bad_meshes_are_refused(self):
        for text, says in (
            (block(4, "shell"), 'region "shell" of the cloud has no material'),
            (block(4).replace("4.1 0 8", "2.2 0 8"), "MSH version 2.2 is not read"),
            (block(4)[:900], "body.msh"),
        ):
            self.is_refused(says, self.run_program(text, status=2))

    def test_bad_grids_and_tables_are_refused(self):
        damaged = grid(4)
        at = damaged.index("\n_") + 60
        damaged = damaged[:at] + "AAAAAAAA" + damaged[at + 8 :]
        for name, text, says, *arguments in (
            ("body.vtu", grid(4), 'has no cell array "kind"; its cell arrays: "part"', "--region-array", "kind"),
            ("body.vtu", grid(4), 'region "body" of the cloud has no material'),
            ("body.vtu", damaged, 'array "Points": its compressed data are damaged'),
            ("body.vtu", grid(4, "vtkLZ4DataCompressor"), 'data compressed by "vtkLZ4DataCompressor" are not read'),
            ("body.csv", table(3).replace("nucleus", "shell"), 'region "shell" of the cloud has no material'),
            ("body.csv", table(3).replace("0.0;0.0;0.0", "0.0;;0.0"), 'line 3: y = "" is no number'),
            ("body.csv", table(3), "the points enclose no volume", "--alpha", "0.3"),
            ("body.stl", "solid\n", "its name must end with .msh, .vtu or .csv"),
        ):
            self.is_refused(says, self.run_program(text, *arguments, status=2, name=name))

    def is_refused(self, says, result):
        self.assertIn(says, result.stderr)
        self.assertEqual(len(result.stderr.strip().splitlines()), 1)
        self.assertFalse((self.folder / "out").exists())


if __name__ == "__main__":
    PROGRAM = os.path.abspath(sys.argv.pop(1))
    unittest.main()
