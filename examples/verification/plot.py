#!/usr/bin/python3
"""Draws what the studies of verification wrote.

/usr/bin/python3 plot.py FOLDER [--study NAME]      one FOLDER/NAME.png per study that has a curve worth seeing
"""

import argparse
import importlib
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

HERE = pathlib.Path(__file__).resolve().parent
sys.dont_write_bytecode = True
sys.path.insert(0, str(HERE / "plots"))


def main():
    parser = argparse.ArgumentParser(description="Draws what the studies of verification wrote.")
    names = sorted(path.stem for path in (HERE / "plots").glob("*.py"))
    parser.add_argument("folder", type=pathlib.Path, help="folder of the results")
    parser.add_argument("--study", choices=names, help="only this one")
    arguments = parser.parse_args()
    if not arguments.folder.is_dir():
        parser.error(f"{arguments.folder} is no folder")
    for name in [arguments.study] if arguments.study else names:
        if not list(arguments.folder.glob(f"{name}_*.csv")):
            print(f"{name}: no tables in {arguments.folder}, nothing is drawn")
            continue
        study = importlib.import_module(name)
        figure, axes = plt.subplots(1, study.SIZE, figsize=(4.2 * study.SIZE, 3.4), squeeze=False, layout="constrained")
        study.draw(arguments.folder, list(axes[0]))
        figure.savefig(arguments.folder / f"{name}.png", dpi=120)
        plt.close(figure)
        print(f"wrote {arguments.folder / f'{name}.png'}")


if __name__ == "__main__":
    main()
