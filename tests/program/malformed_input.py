"""Hundreds of malformed option lists and configuration files for the programs of the examples, generated from what --help
lists: each ends with the status 2 and one sentence, and nothing is written.

    python3 malformed_input.py PROGRAM [PROGRAM ...]
"""

import os
import pathlib
import random
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

PROGRAMS = []
LEAST = 200  # cases per program


def options_of(program):
    """(name, type, what --help says) of every option that takes a value, and the names of the flags."""
    text = subprocess.run([program, "--help"], capture_output=True, text=True, check=True).stdout
    text = re.sub(r"\n {20,}", "  ", text)  # long names push their text to the next line
    valued, flags = [], []
    for line in text.splitlines():
        found = re.match(r"  --([a-z0-9-]+)(?: (NUMBER|INTEGER|WORD|TEXT)(?:\[(.*?)\])?)?  +(.*)", line)
        if found is None:
            continue
        name, kind, unit, help_text = found.groups()
        if kind:
            valued.append((name, kind, unit or "", help_text))
        elif name not in ("info", "help") and not name.startswith("no-"):
            flags.append(name)
    return valued, flags


def outside(help_text):
    """Numbers outside of what is allowed, as --help has it."""
    between = re.search(r"between ([\d.e+-]+) and ([\d.e+-]+)", help_text)
    if between:
        return [f"{float(between[2]) * 10 + 1:.0f}", "-1"]
    if "above 0 and below 1" in help_text or "above 0 and below" in help_text:
        return ["1.5", "0", "-0.2"]
    if "zero or positive" in help_text:
        return ["-1", "-1e-30"]
    if "positive" in help_text:
        return ["0", "-1", "-0.0"]
    return []


def cases(program, random_numbers):
    """(arguments, text of a configuration file or None) that no program accepts."""
    valued, flags = options_of(program)
    for name, kind, unit, help_text in valued:
        key = f"--{name}"
        if kind in ("NUMBER", "INTEGER"):
            bad = ["ten", "nan", "-inf", "1e999", "1,5", "0x1F", "5 5", "--5", "1e", "٣", "1" * 400 + "e9"]
            bad.append("2.5" if kind == "INTEGER" else "3 parsecs")
            bad.append({"s": "3 kPa", "": "3 s"}.get(unit, "3 s"))
            for value in [*random_numbers.sample(bad, 4), *outside(help_text)]:
                yield [f"{key}={value}"], None
            for value in random_numbers.sample(['"ten"', "[1, 2]", "{ a = 1 }", "1979-05-27", "true", "", "1 2", '"', "nan", "inf", "1e999"], 3):
                yield [], f"{name} = {value}\n"
            yield [], f"{name} = 1\n{name} = 1\n"
        elif kind == "WORD":
            word = re.search(r"one of (\w+)", help_text)[1]
            for value in (word + "x", word.upper(), "", "7"):
                yield [key, value], None
            yield [], f"{name} = {word}\n"
            yield [], f"{name} = 7\n"
        else:
            yield [key, ""], None
            yield [], f"{name} = 7\n"
            yield [], f'{name} = "a\\u0000b"\n'
        yield [key, "1", key, "1"], None
        yield [key], None
        yield ["--" + name[:-1] + "qq", "1"], None
        yield [os.fsencode(key + "=") + b"\xff\xfe1"], None
    for name in flags:
        yield [f"--{name}", f"--no-{name}"], None
        yield [f"--{name}=maybe"], None
        yield [], f"{name} = 1\n"
        yield [], f'{name} = "true"\n'
    yield ["word"], None
    yield ["-x"], None
    yield ["--"], None
    yield ["--config"], None
    yield ["--config", ""], None
    yield ["--config", "none.toml"], None
    for text in ("[section]\n", "= 1\n", "a\n", "\x00", "unknown-key = 1\n", "'''", "#\n" * 10000 + "?", "[[x]]\n", "a.b = 1\n"):
        yield [], text
    yield [], b"\xff\xfe\x00\x01"
    names = [name for name, *_ in valued]
    for _ in range(30):  # noise behind a good beginning
        noise = bytes(random_numbers.choices(range(1, 256), k=random_numbers.randrange(3, 40)))
        yield [], random_numbers.choice(names).encode() + b" = " + b"\xc0" + noise


class Malformed(unittest.TestCase):
    def test_every_case_is_refused_in_one_sentence(self):
        for program in PROGRAMS:
            folder = pathlib.Path(tempfile.mkdtemp(prefix="malformed_"))
            self.addCleanup(shutil.rmtree, folder, True)
            count = 0
            for arguments, config in cases(program, random.Random(7)):
                if config is not None:
                    (folder / "case.toml").write_bytes(config if isinstance(config, bytes) else config.encode())
                    arguments = ["--config", "case.toml", *arguments]
                if not any(os.fsencode(a).startswith(b"--out") for a in arguments):
                    arguments = [*arguments[:0], "--out", "new", *arguments]
                before = sorted(os.listdir(folder))
                result = subprocess.run([program, *arguments], cwd=folder, capture_output=True, timeout=60,
                                        env=dict(os.environ, OMP_NUM_THREADS="1"))
                count += 1
                with self.subTest(program=os.path.basename(program), arguments=arguments, config=config):
                    error = result.stderr.decode(errors="replace")
                    self.assertEqual(result.returncode, 2, result.stdout.decode(errors="replace")[:200] + error[:500])
                    self.assertEqual(error.count("\n"), 1, error[:500])
                    self.assertTrue(error.startswith(os.path.basename(program) + ": "), error[:500])
                    self.assertTrue(error.rstrip().endswith((".", "?")), error[:500])
                    self.assertEqual(sorted(os.listdir(folder)), before)
            self.assertGreaterEqual(count, LEAST)
            print(f"{os.path.basename(program)}: {count} cases", file=sys.stderr)


if __name__ == "__main__":
    PROGRAMS = [os.path.abspath(program) for program in sys.argv[1:]]
    unittest.main(argv=sys.argv[:1], verbosity=2)
