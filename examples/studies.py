#!/usr/bin/python3
"""Runs the studies of the paper's figures and claims, and writes one page of their results.

/usr/bin/python3 examples/studies.py [--only NAME] [--out FOLDER] [--publish]

A study is the file study.py in a folder of examples/: NAME, SWEEPS and report(folder). Started again, it goes on where it
was; a run that fails is reported in the page and stops no other. --publish puts page and figures into examples/.
"""

import argparse
import importlib.util
import os
import pathlib
import signal
import sys

sys.dont_write_bytecode = True
HERE = pathlib.Path(__file__).resolve().parent
sys.path[:0] = [str(HERE / "common"), str(HERE / "sweep")]
import study_tools
from sweep import InputError, sweep

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

STUDIES = ["bar_hysteresis", "cell_compression", "spreading_uniform", "spreading_axisymmetric", "spreading_graded", "wavy_front",
           "durotaxis", "spreading_slow"]  # in the order of the page
HEAD = """# What the studies gave

Written by `/usr/bin/python3 examples/studies.py --publish` from the files of its runs, {count} runs of {minutes:.0f} processor
minutes. Every study has its folder, with its question, its commands and the comparison with the paper
(X. Zeng and S. Li, *Soft Matter* 2012, **8**, 5765). Where a result depends on a parameter that the paper does not give, the page of
[spreading_uniform](spreading_uniform/README.md) says which and why.

| what the paper shows | here | |
|---|---|---|
| loops of a bar that close to a line at low frequency (Fig. 3) | reproduced, without inertia | the loss is the exact one; the loops of the figure need about a hundred times the viscosity of cytosol |
| a cell between plates (Fig. 4) | computed, in part | the gel carries what its surface and its viscosity hold: at rest a few nN; runs with the large nucleus end where the gel over it is squeezed out |
| 1. the stress in the nucleus depends on the stiffness of the substrate | yes, by a few per cent, early, on elastic substrates | by 0.1 to 0.3 % with the printed viscous constants; it saturates with stiffness |
| 2. so does the spreading area | yes, early, on elastic substrates; no size can be given | the change differs between meshes by more than itself; 0.3 % and less with the printed constants |
| 3. the front becomes wavy | not with the small active stress of the paper (−1 Pa): those waves are the mesh's | with −1 kPa and a director that varies in space: 4 to 5 % of the radius, the same waves on turned and finer meshes |
| 4. the cell goes to the stiff side (Figs. 11, 12) | no | the front leads on either side in turn, by less than 1 % of its radius; the centre of mass moves by a few nm, to the soft side |
| the axisymmetric model (Fig. 10) | reproduced | its spreading area is that in three dimensions, between the finest of both within 4.5 % (printed) and 5.3 % (elastic) from 1 µs on, 2 % from 2 µs on; no waves, by construction |
| open in the paper: stability at a realistic contractile stress | runs of 4.5 µs come to their end up to −5 kPa; the particles keep their order up to −1 kPa, nearly up to −2 kPa | with the viscosity of cytosol the gel is drawn out within R √(ρ/&#124;ζ&#124;), whatever mesh, time step and bonds; more viscosity helps |
| beyond the paper: bonds that hold in the tangential direction | up to −2 kPa the cell goes to the soft side, by 3 to 9 nm in 4.5 µs | the substrate gives way further there; the spreading cell pushes it outward, and does not pull |
| beyond the paper: minutes, at 10 Pa s | the cell spreads within seconds to a minute, and stays for ten | adhesion alone rests at the area of theory; bonds of 1 pN/nm wet the substrate, as far as the mesh lets them, R ~ t^¼; stiffness decides little; −1 kPa tears a gel apart that has no elasticity |
"""


def load(name):
    spec = importlib.util.spec_from_file_location(f"study_{name}", HERE / name / "study.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def failures(runs):
    failed = [run for run in runs if run.status == "failed"]
    if not failed:
        return ""
    lines = [f"- `{' '.join(run.arguments)}`: {run.message}" for run in failed]
    return "\nRuns that failed:\n\n" + "\n".join(lines) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--only", action="append", choices=STUDIES, help="only this study; may be given several times")
    parser.add_argument("--build", type=pathlib.Path, default=HERE.parent / "build" / "release" / "examples",
                        help="folder of the programs (default: that of the preset release)")
    parser.add_argument("--out", type=pathlib.Path, default=HERE.parent / "out" / "studies", help="folder of all runs")
    parser.add_argument("--jobs", type=int, default=max(1, os.cpu_count() or 1), help="runs at a time, one thread each")
    parser.add_argument("--scale", type=float, default=1.0, help="of all resolutions; 0.3 tries everything in a minute")
    parser.add_argument("--publish", action="store_true", help="write page and figures into examples/")
    parser.add_argument("--retry", action="store_true", help="run again what failed before")
    given = parser.parse_args()
    signal.signal(signal.SIGTERM, signal.default_int_handler)  # ends the runs as Ctrl-C does
    if given.publish and (given.only or given.scale != 1.0):
        raise InputError("--publish needs all studies at their own resolutions: no --only, no --scale.")
    if not 0.0 < given.scale <= 10.0 or given.jobs < 1:
        raise InputError("--scale must be positive and at most 10, --jobs at least 1.")
    study_tools.scale = given.scale
    page, count, seconds = "", 0, 0.0
    for name in given.only or STUDIES:
        study = load(name)
        folder = given.out / name
        all_runs = []
        for part, program, fixed, combinations in study.SWEEPS:
            print(f"{name}/{part}:", flush=True)
            all_runs += sweep(str(given.build / program), str(folder / part), combinations, fixed, given.jobs, 1,
                              given.retry, lambda line: print(f"  {line}", flush=True))
        count += len(all_runs)
        seconds += sum(run.seconds for run in all_runs)
        text, figures = study.report(folder)
        target = (HERE if given.publish else given.out) / name
        for figure_name, figure in figures.items():
            figure.savefig(target / f"{figure_name}.png")
            plt.close(figure)
        page += f"\n## {study.TITLE}\n\n[Study and commands]({name}/README.md)\n\n{text.strip()}\n{failures(all_runs)}"
    target = HERE if given.publish else given.out
    (target / "RESULTS.md").write_text(HEAD.format(count=count, minutes=seconds / 60) + page, encoding="utf-8")
    print(f"Wrote {target / 'RESULTS.md'}")


if __name__ == "__main__":
    try:
        main()
    except InputError as error:
        print(f"studies.py: {error}", file=sys.stderr)
        sys.exit(2)
    except KeyboardInterrupt:
        print("studies.py: interrupted; started again, it goes on with what is not done.", file=sys.stderr)
        sys.exit(130)
