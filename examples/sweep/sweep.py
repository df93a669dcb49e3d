#!/usr/bin/python3
"""Many runs of one program: a grid or a list of options, several runs at a time, one table and figures of the results.

python3 sweep.py PROGRAM --out FOLDER --grid stiffness=2,5,10 --grid preset=printed,elastic --set end-time=2us
python3 sweep.py PROGRAM --out FOLDER --list runs.csv --plot spread_area --plot nucleus_effective_stress_mean

Every run has its folder in FOLDER, named after its options. Started again, the sweep goes on: what is done stays.
See README.md beside this file.
"""

import argparse
import csv
import itertools
import json
import os
import re
import signal
import subprocess
import sys
import threading
import time
from concurrent.futures import ThreadPoolExecutor, as_completed

RESERVED = {"out", "threads", "config", "help", "info"}


class InputError(Exception):
    """What the user can mend: one sentence."""


def split_option(text, option):
    key, equals, value = text.partition("=")
    key = key.strip().lstrip("-")
    if not equals or not key:
        raise InputError(f'{option} "{text}" is not of the form key=value.')
    if key in RESERVED:
        raise InputError(f'{option} "{text}": {key} is set by the sweep itself.')
    return key, value.strip()


def read_grid(texts):
    """Lists of (key, value): every combination, the first key varying slowest."""
    axes = []
    for text in texts:
        key, values = split_option(text, "--grid")
        if key in (name for name, _ in axes):
            raise InputError(f"--grid: {key} is given twice.")
        values = [value.strip() for value in values.split(",")]
        if not all(values):
            raise InputError(f'--grid "{text}" has an empty value.')
        if len(set(values)) < len(values):
            raise InputError(f'--grid "{text}" has a value twice.')
        axes.append((key, values))
    return [list(zip([key for key, _ in axes], values)) for values in itertools.product(*(v for _, v in axes))]


def read_list(path):
    """One run per line of a CSV file whose head has the keys; an empty field leaves the key at its default."""
    try:
        with open(path, newline="", encoding="utf-8") as file:
            rows = [row for row in csv.reader(file) if any(field.strip() for field in row)]
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"--list: cannot read {path}: {error}.") from error
    if len(rows) < 2:
        raise InputError(f"--list: {path} needs a head with the keys and at least one run.")
    keys = [key.strip().lstrip("-") for key in rows[0]]
    if not all(keys) or len(set(keys)) < len(keys) or RESERVED & set(keys):
        raise InputError(f"--list: the head of {path} has an empty, repeated or reserved key: {', '.join(keys)}.")
    for number, row in enumerate(rows[1:], 2):
        if len(row) != len(keys):
            raise InputError(f"--list: line {number} of {path} has {len(row)} fields, its head has {len(keys)}.")
    return [[(key, value.strip()) for key, value in zip(keys, row) if value.strip()] for row in rows[1:]]


def folder_name(options):
    text = ",".join(f"{key}={value}" for key, value in options) or "defaults"
    return re.sub(r"[^A-Za-z0-9.,=+_-]", "_", text)


class Run:
    """One run of the program: its options, its folder, and what came out."""

    def __init__(self, program, out, options, fixed, threads):
        self.options = options
        self.folder = os.path.join(out, folder_name(options))
        # What decides the results; the number of threads does not.
        self.arguments = [os.path.basename(program), *(f"--{key}={value}" for key, value in [*fixed, *options])]
        self.command = [program, *self.arguments[1:], f"--out={self.folder}", f"--threads={threads}"]
        self.status, self.message, self.seconds = "waiting", "", 0.0

    def name(self):
        return os.path.basename(self.folder)

    def record_path(self):
        return os.path.join(self.folder, "run.json")

    def load(self, retry):
        """Takes over what an earlier sweep did with the same options."""
        record = read_json(self.record_path())
        if record.get("arguments") != self.arguments:
            return
        if record.get("status") == "done" and self.summary():
            self.status, self.seconds = "done", record.get("seconds", 0.0)
        elif record.get("status") == "failed" and not retry:
            self.status, self.message, self.seconds = "failed", record.get("message", ""), record.get("seconds", 0.0)

    def summary(self):
        return read_json(os.path.join(self.folder, "summary.json"))

    def start(self):
        os.makedirs(self.folder, exist_ok=True)
        for name in ("run.json", "summary.json"):  # of a run with other options, or of one that was cut off
            path = os.path.join(self.folder, name)
            if os.path.exists(path):
                os.remove(path)
        log = open(os.path.join(self.folder, "run.log"), "w", encoding="utf-8")
        # A session of its own: Ctrl-C reaches the sweep, which ends its runs.
        return subprocess.Popen(self.command, stdout=log, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL,
                                start_new_session=True, env={"OMP_WAIT_POLICY": "passive", **os.environ})

    def finish(self, code, seconds):
        self.seconds = seconds
        self.status = "done" if code == 0 and self.summary() else "failed"
        if self.status == "failed":
            with open(os.path.join(self.folder, "run.log"), encoding="utf-8", errors="replace") as file:
                lines = [line.strip() for line in file if line.strip()]
            self.message = f"exit status {code}: {lines[-1] if lines else 'no output'}"
        write_whole(self.record_path(), json.dumps(
            {"arguments": self.arguments, "status": self.status, "message": self.message, "seconds": seconds}, indent=2))


def read_json(path):
    try:
        with open(path, encoding="utf-8") as file:
            content = json.load(file)
    except (OSError, ValueError):
        return {}
    return content if isinstance(content, dict) else {}


def write_whole(path, text):
    """Writes a file that is there whole or not at all."""
    with open(path + ".part", "w", encoding="utf-8", newline="") as file:
        file.write(text)
    os.replace(path + ".part", path)


def write_table(runs, path):
    """One line per run: its options, its status, and what its summary.json has."""
    keys = list(dict.fromkeys(key for run in runs for key, _ in run.options))
    summaries = [run.summary() if run.status in ("done", "failed") else {} for run in runs]
    names = [name for name in dict.fromkeys(name for summary in summaries for name in summary) if name not in keys]
    lines = [[*keys, "status", "message", *names]]
    for run, summary in zip(runs, summaries):
        options = dict(run.options)
        lines.append([*(options.get(key, "") for key in keys), run.status, run.message,
                      *(summary.get(name, "") for name in names)])
    with open(path + ".part", "w", encoding="utf-8", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows(lines)
    os.replace(path + ".part", path)


def leading_number(text):
    match = re.match(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?", text)
    return float(match.group()) if match else None


def plot(runs, quantity, path):
    """The quantity against the first key that varies, one line for each combination of the others."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    done = [run for run in runs if run.status == "done" and isinstance(run.summary().get(quantity), (int, float))]
    if not done:
        raise InputError(f"--plot {quantity}: no run that came to its end has this in its summary.json.")
    values = {key: {dict(run.options).get(key) for run in runs} for run in runs for key, _ in run.options}
    varied = [key for key in values if len(values[key]) > 1] or list(values)[:1]
    key = varied[0] if varied else "run"
    lines = {}
    for run in done:
        options = dict(run.options)
        label = ", ".join(f"{name} {options.get(name, 'default')}" for name in varied[1:])
        lines.setdefault(label, []).append((options.get(key, "default"), run.summary()[quantity]))
    figure, axes = plt.subplots(figsize=(5.2, 3.6), constrained_layout=True)
    numbers = all(leading_number(x) is not None for points in lines.values() for x, _ in points)
    for label, points in lines.items():
        if numbers:
            points = sorted((leading_number(x), y) for x, y in points)
        axes.plot([x for x, _ in points], [y for _, y in points], "o-", markersize=4, label=label)
    units = {re.sub(r"^[\d.eE+-]+", "", x) for points in lines.values() for x, _ in points} if numbers else {""}
    axes.set(xlabel=f"{key} ({units.pop()})" if len(units) == 1 and units != {""} else key,
             ylabel=quantity.replace("_", " ") + " (SI)")
    if numbers and min(x for line in axes.lines for x in line.get_xdata()) > 0.0:
        axes.set_xscale("log")
    if any(lines):
        axes.legend(fontsize=8, frameon=False)
    axes.grid(alpha=0.25)
    figure.savefig(path, dpi=120)
    plt.close(figure)


def sweep(program, out, combinations, fixed=(), jobs=1, threads=None, retry=False, report=print):
    """Runs what is not done yet, `jobs` at a time. Returns the runs, in the order given; none is fatal to the others.

    `combinations`: a list of options ((key, value), ...) per run; `fixed`: options of all runs. KeyboardInterrupt ends
    the runs that are under way and leaves the finished ones.
    """
    if not os.access(program, os.X_OK) or os.path.isdir(program):
        raise InputError(f"{program} is not a program that can be run; build it first (cmake --build --preset release).")
    program = os.path.abspath(program)
    threads = threads or max(1, (os.cpu_count() or 1) // jobs)
    try:
        os.makedirs(out, exist_ok=True)
    except OSError as error:
        raise InputError(f"--out: cannot make the folder {out}: {error.strerror}.") from error
    runs = [Run(program, out, options, list(fixed), threads) for options in combinations]
    names = [run.name() for run in runs]
    for name in names:
        if names.count(name) > 1:
            raise InputError(f"Two runs have the same options (or folder): {name}.")
    for run in runs:
        run.load(retry)
    waiting = [run for run in runs if run.status == "waiting"]
    report(f"{len(runs)} runs, {len(runs) - len(waiting)} already there; {jobs} at a time, {threads} threads each")
    stop = threading.Event()
    table = os.path.join(out, "sweep.csv")

    def execute(run):
        if stop.is_set():
            return run
        begin = time.monotonic()
        process = run.start()
        while process.poll() is None:
            if stop.wait(0.05):
                os.killpg(process.pid, signal.SIGTERM)
                process.wait()
                return run
        run.finish(process.returncode, time.monotonic() - begin)
        return run

    with ThreadPoolExecutor(jobs) as pool:
        tasks = [pool.submit(execute, run) for run in waiting]
        try:
            for count, task in enumerate(as_completed(tasks), 1):
                run = task.result()
                write_table(runs, table)
                report(f"{count}/{len(waiting)} {run.name()}: {run.status} after {run.seconds:.1f} s"
                       + (f" ({run.message})" if run.message else ""))
        except KeyboardInterrupt:
            stop.set()
            raise
        finally:
            stop.set()
    write_table(runs, table)
    return runs


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("program", help="the program, for example build/release/examples/spreading_uniform")
    parser.add_argument("--out", required=True, help="folder of all runs")
    what = parser.add_mutually_exclusive_group(required=True)
    what.add_argument("--grid", action="append", metavar="KEY=V1,V2,...", help="values of one option; several: all pairs")
    what.add_argument("--list", metavar="FILE.csv", help="a table with an option per column and a run per line")
    parser.add_argument("--set", action="append", default=[], metavar="KEY=VALUE", help="an option of all runs")
    parser.add_argument("--jobs", type=int, default=1, help="runs at a time (default: 1, with all threads)")
    parser.add_argument("--threads", type=int, help="threads of each run (default: processors over jobs)")
    parser.add_argument("--plot", action="append", default=[], metavar="NAME", help="a value of summary.json to draw")
    parser.add_argument("--retry", action="store_true", help="run again what failed before")
    given = parser.parse_args(arguments)
    signal.signal(signal.SIGTERM, signal.default_int_handler)  # ends the runs as Ctrl-C does
    try:
        for name in ("jobs", "threads"):
            if getattr(given, name) is not None and getattr(given, name) < 1:
                raise InputError(f"--{name} = {getattr(given, name)} is not allowed: it must be at least 1.")
        fixed = [split_option(text, "--set") for text in given.set]
        combinations = read_list(given.list) if given.list else read_grid(given.grid)
        twice = {key for key, _ in fixed} & {key for options in combinations for key, _ in options}
        if twice or len({key for key, _ in fixed}) < len(fixed):
            raise InputError(f"--set: {', '.join(sorted(twice)) or 'a key'} is given twice.")
        runs = sweep(given.program, given.out, combinations, fixed, given.jobs, given.threads, given.retry,
                     lambda line: print(line, flush=True))
        for quantity in given.plot:
            path = os.path.join(given.out, re.sub(r"[^A-Za-z0-9_-]", "_", quantity) + ".png")
            plot(runs, quantity, path)
            print(f"Wrote {path}")
    except InputError as error:
        print(f"sweep.py: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("sweep.py: interrupted; started again, it goes on with what is not done.", file=sys.stderr)
        return 130
    failed = [run for run in runs if run.status == "failed"]
    print(f"{len(runs) - len(failed)} runs done, {len(failed)} failed; table in {os.path.join(given.out, 'sweep.csv')}")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
