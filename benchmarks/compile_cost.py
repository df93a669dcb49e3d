#!/usr/bin/env python3
"""What the library costs to compile: time of the processor and peak memory of the compiler, on one core.

    python3 benchmarks/compile_cost.py [--compiler g++] [--standard c++20] [--repetitions 3]

The smallest complete program (examples/minimal, -O2), and a file that includes one room and nothing else, against a file that
includes what the library depends on (Eigen, nanoflann, fmt): the room over its dependencies. As headers only
(tactoid::tactoid); with what needs no type of the user's compiled elsewhere (tactoid::compiled), and with that as a precompiled
header, too (tactoid::precompiled). The least of the repetitions counts, which other programs disturb least.
"""
import argparse
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
DEPENDENCIES = "#include <Eigen/Dense>\n#include <Eigen/Sparse>\n#include <fmt/format.h>\n#include <nanoflann.hpp>\n"


def cost(command):
    """Seconds of the processor and megabytes at the peak of one compilation."""
    child = os.fork()
    if child == 0:  # a process of its own: the peak of its children is that of this compilation
        result = subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, check=False)
        if result.returncode != 0:
            sys.stderr.write(result.stderr.decode(errors="replace")[:2000])
        os._exit(0 if result.returncode == 0 else 1)
    _, status, usage = os.wait4(child, 0)
    if status != 0:
        sys.exit(f"compile_cost.py: {' '.join(command)} failed.")
    return usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--compiler", default="g++")
    parser.add_argument("--standard", default="c++20")
    parser.add_argument("--repetitions", type=int, default=3)
    parser.add_argument("--eigen", default="/usr/include/eigen3", help="folder of Eigen (default: %(default)s)")
    options = parser.parse_args()
    if shutil.which(options.compiler) is None:
        sys.exit(f"compile_cost.py: there is no compiler {options.compiler}.")
    if options.repetitions < 1:
        sys.exit("compile_cost.py: --repetitions must be at least 1.")
    with tempfile.TemporaryDirectory() as folder:
        compiler = [options.compiler, f"-std={options.standard}", "-fopenmp", f"-I{ROOT / 'include'}", "-isystem", options.eigen]
        base = compiler + ["-c", "-o", os.path.join(folder, "out.o")]

        def least(source, *flags):
            if not isinstance(source, pathlib.Path):
                path = pathlib.Path(folder, "room.cpp")
                path.write_text(source, encoding="utf-8")
                source = path
            runs = [cost(base + list(flags) + [str(source)]) for _ in range(options.repetitions)]
            return min(run[0] for run in runs), max(run[1] for run in runs)

        compiled = "-DTACTOID_COMPILED"

        def report(name, run, note=""):
            print(f"{name:34} {run[0]:7.1f} {run[1]:7.0f} {note}", flush=True)

        print(f"{'':34} {'s':>7} {'MB':>7}")
        minimal = ROOT / "examples" / "minimal" / "main.cpp"
        report("examples/minimal, -O2: headers", least(minimal, "-O2"))
        report("... compiled", least(minimal, "-O2", compiled))
        header = pathlib.Path(folder, "precompiled.hpp")
        header.write_text("#include <tactoid/tactoid.hpp>\n", encoding="utf-8")
        precompiled = str(header) + (".pch" if "clang" in options.compiler else ".gch")
        once = cost(compiler + ["-O2", compiled, "-x", "c++-header", str(header), "-o", precompiled])
        report("... compiled, and precompiled", least(minimal, "-O2", compiled, "-include", str(header)))
        report("the precompiled header, once", once)
        reference = least(DEPENDENCIES, "-O2")
        report("the dependencies", reference)
        rooms = {path.parent.name for path in (ROOT / "include" / "tactoid").glob("*/all.hpp")}
        for room in sorted(rooms - {"mpi"}):  # which needs another compiler
            for mode, flags in (("headers", []), ("compiled", [compiled])):
                run = least(f"#include <tactoid/{room}/all.hpp>\n", "-O2", *flags)
                report(f"{room}/all.hpp, {mode}", run, f"{run[0] / reference[0]:6.2f} of the dependencies")


if __name__ == "__main__":
    main()
