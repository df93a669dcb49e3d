#!/usr/bin/env python3
"""Draws the cost of a step per particle against the number of particles.

    build/release/benchmarks/step_benchmark --benchmark_filter='(block|sweep).*threads:1' --benchmark_repetitions=3 --benchmark_out=sizes.json
    python3 benchmarks/plot_sizes.py sizes.json --out sizes.png
"""
import argparse
import re
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

from compare import read

STYLES = {
    "bare_sweep": ("bare sweep", "0.6", "--"),
    "bare_sweep/single": ("bare sweep, single precision", "0.6", ":"),
    "elastic_block/plain": ("step", "C0", "-"),
    "elastic_block/plain/single": ("step, single precision", "C0", ":"),
    "elastic_block/stabilized": ("stabilised step", "C1", "-"),
    "elastic_block/stabilized/single": ("stabilised step, single precision", "C1", ":"),
}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("results", help="result file of step_benchmark")
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--out", default="sizes.png")
    arguments = parser.parse_args()
    curves = {}
    for name, samples in read(arguments.results, "ns_per_particle").items():
        match = re.match(r"(.*)/edge:(\d+)/threads:(\d+)", name)
        if match and int(match[3]) == arguments.threads and match[1] in STYLES:
            curves.setdefault(match[1], []).append((int(match[2]) ** 3, min(samples)))
    if not curves:
        sys.exit(f"plot_sizes.py: {arguments.results} has no blocks with {arguments.threads} threads.")
    figure, axes = plt.subplots(figsize=(5.5, 3.6), layout="constrained")
    for name in [name for name in STYLES if name in curves]:
        label, color, line = STYLES[name]
        axes.plot(*zip(*sorted(curves[name])), line, marker="o", markersize=3, color=color, label=label)
        print(f"{label:40s}", "  ".join(f"{n}: {ns:.0f}" for n, ns in sorted(curves[name])))
    axes.set(xscale="log", ylim=(0, None), xlabel="particles", ylabel="ns per particle and step")
    axes.legend(frameon=False, fontsize=7)
    figure.savefig(arguments.out, dpi=150)


if __name__ == "__main__":
    main()
