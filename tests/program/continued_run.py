"""What the tests of the programs share: a run that a signal ends, and the comparison of a continued run with the whole one."""

import json
import os
import subprocess
import time

ENVIRONMENT = dict(os.environ, OMP_WAIT_POLICY="passive", LC_ALL="C")


def notes(process, sent):
    """Whether the process has a handler of this signal."""
    try:
        with open(f"/proc/{process.pid}/status") as status:
            caught = next((line for line in status if line.startswith("SigCgt:")), "SigCgt: 0")
    except FileNotFoundError:
        return False
    return int(caught.split()[1], 16) >> (sent - 1) & 1 == 1


def interrupt(test, program, sent, lines, *arguments):
    """Runs the program in the test's folder, with `--out FOLDER` as the last arguments, and ends it by a signal as soon as its history
    has so many lines and the program notes the signal (it opens the history before: until its first step a signal just ends it)."""
    out = test.folder / arguments[-1]
    with subprocess.Popen([program, *map(str, arguments)], cwd=test.folder, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True,
                          env=ENVIRONMENT) as process:
        history = out / "history.csv"
        while not (history.exists() and history.read_bytes().count(b"\n") >= lines and notes(process, sent)):
            test.assertIsNone(process.poll(), "the run ended before it could be interrupted")
            time.sleep(0.005)
        process.send_signal(sent)
        error = process.communicate(timeout=120)[1]
    test.assertEqual(process.returncode, 128 + sent, error)
    test.assertEqual(error, f"{os.path.basename(program)}: ended by {sent.name}.\n")
    if (out / "summary.json").exists():
        test.assertFalse(json.loads((out / "summary.json").read_text())["completed"])


def assert_same(test, one, two, *names):
    """These files of two runs, and all frames, are the same to the byte."""
    for name in (*names, "fields.pvd"):
        test.assertEqual((test.folder / one / name).read_bytes(), (test.folder / two / name).read_bytes(), name)
    test.assertEqual(set(os.listdir(test.folder / one / "fields")), set(os.listdir(test.folder / two / "fields")))
    for name in os.listdir(test.folder / one / "fields"):
        test.assertEqual((test.folder / one / "fields" / name).read_bytes(), (test.folder / two / "fields" / name).read_bytes(), name)
