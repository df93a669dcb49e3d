#!/usr/bin/env python3
"""Compares two result files of the benchmarks.

    build/release/benchmarks/step_benchmark --benchmark_out=before.json --benchmark_repetitions=5
    python3 benchmarks/compare.py before.json after.json
    python3 benchmarks/compare.py --against bare_sweep after.json      # ratios within one file

For every benchmark that both files have: the medians of the repetitions, their ratio (below 1: the second is faster), and in
brackets the least and largest ratio that single repetitions allow. A ratio is worth something where its brackets leave out 1,
and both files come from one machine that did nothing else.
"""
import argparse
import json
import statistics
import sys


def fail(sentence):
    sys.exit(f"compare.py: {sentence}")


def read(path, counter):
    """Samples of each benchmark: `counter`, or the time on the clock where it has none, ns."""
    try:
        with open(path, encoding="utf-8") as file:
            runs = json.load(file)["benchmarks"]
    except OSError as error:
        fail(f"{path}: {error.strerror}.")
    except (ValueError, KeyError, TypeError):
        fail(f"{path} is no result file of a benchmark (give --benchmark_out=FILE to the program, its format is JSON).")
    unit = {"ns": 1.0, "us": 1e3, "ms": 1e6, "s": 1e9}
    samples = {}
    for run in runs:
        if run.get("run_type", "iteration") == "iteration" and not run.get("error_occurred"):
            value = run.get(counter, run["real_time"] * unit[run["time_unit"]])
            samples.setdefault(run["run_name"], []).append(value)
    if not samples:
        fail(f"{path} has no repetition in it: run the benchmark without --benchmark_report_aggregates_only.")
    return samples


def row(name, first, second):
    ratio = statistics.median(second) / statistics.median(first)
    least, largest = min(second) / max(first), max(second) / min(first)
    return f"{name:60} {statistics.median(first):12.4g} {statistics.median(second):12.4g} {ratio:8.3f}  [{least:.3f}, {largest:.3f}]"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("files", nargs="+", metavar="FILE", help="two result files; with --against one")
    parser.add_argument("--counter", default="ns_per_pair", help="what is compared, where a benchmark has it (default: %(default)s)")
    parser.add_argument("--against", metavar="NAME", help="the benchmark of the same file and arguments that the others are compared with")
    options = parser.parse_args()
    if len(options.files) != (1 if options.against else 2):
        fail("give two result files, or one and --against.")
    print(f"{'':60} {'first':>12} {'second':>12} {'ratio':>8}  [least, largest]")
    if options.against:
        samples = read(options.files[0], options.counter)
        references = {name.partition("/")[2]: values for name, values in samples.items() if name.partition("/")[0] == options.against}
        if not references:
            fail(f"{options.files[0]} has no benchmark {options.against}; it has {', '.join(sorted(samples))}.")
        for name, values in samples.items():
            # What has no size of its own is compared with the smallest block, of about as many particles.
            arguments = name[name.find("edge:"):] if "edge:" in name else "edge:27/" + name.partition("/")[2]
            if name.partition("/")[0] != options.against and arguments in references:
                print(row(name, references[arguments], values))
        return
    first, second = (read(path, options.counter) for path in options.files)
    common = [name for name in first if name in second]
    if not common:
        fail("the files have no benchmark in common.")
    for name in common:
        print(row(name, first[name], second[name]))
    for name in sorted(set(first) ^ set(second)):
        print(f"{name:60} only in {options.files[0] if name in first else options.files[1]}")


if __name__ == "__main__":
    main()
