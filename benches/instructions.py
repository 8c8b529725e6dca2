#!/usr/bin/env python3
"""Instructions that solving takes, counted by valgrind, against the figures of benches/instructions.txt: status 1 if one is over by 3 %.

    benches/instructions.py [--program PATH] [--write]

Needs examples/time_analyze as `CARGO_INCREMENTAL=0 cargo test` builds it (profile dev). Counts depend on the compiler, the profile and the widest
vector unit, not on the machine's load; valgrind has AVX2 at most. What cannot be compared is said to be NOT CHECKED, with status 0.
--write takes this machine's counts as the figures.
"""
import argparse
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

from peer import HERE, train_file

FIGURES = HERE / "instructions.txt"
MOST = 1.03
# The function whose calls are counted, with all that it calls.
COUNTED = "trainsafe::solve::plan::run_all"
CASES = [
    ("equal", 1001, [], "1000"),
    ("mixed", 301, ["--mixed"], "300"),
    ("each", 105, ["--mixed"], "[35, 70, 104]"),
    ("stiff", 101, ["--mixed", "--stiff"], "100"),
]


def count(program, train, out):
    """Instructions of solving a train file; a text where valgrind could not run it."""
    command = ["valgrind", "--tool=callgrind", f"--callgrind-out-file={out}", f"--toggle-collect={COUNTED}"]
    one = {**os.environ, "RAYON_NUM_THREADS": "1"}
    run = subprocess.run([*command, program, train, "1"], capture_output=True, text=True, env=one)
    if "unhandled instruction" in run.stderr:
        return "valgrind does not know an instruction of this build"
    found = re.search(r"Collected : (\d+)", run.stderr)
    if run.returncode != 0 or found is None:
        sys.exit(run.stderr)
    return int(found[1]) or sys.exit(f"no call of {COUNTED} was seen: it may be inlined")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", type=pathlib.Path, default=HERE.parent / "target/debug/examples/time_analyze")
    parser.add_argument("--write", action="store_true")
    asked = parser.parse_args()
    rustc = subprocess.run(["rustc", "--version"], check=True, capture_output=True, text=True).stdout.strip()
    head = f"{rustc}, profile dev, AVX2"
    known = FIGURES.read_text().splitlines() if FIGURES.exists() else [""]
    flags = pathlib.Path("/proc/cpuinfo")
    why = None
    if shutil.which("valgrind") is None:
        why = "there is no valgrind"
    elif not flags.exists() or not {"avx2", "fma"} <= set(flags.read_text().split()):
        why = "this machine has no AVX2"
    elif known[0] != head and not asked.write:
        why = f"the figures are of {known[0]}, this is {head}"
    counts = {}
    with tempfile.TemporaryDirectory() as folder:
        for name, vehicles, kind, coupler in CASES if why is None else []:
            train = pathlib.Path(folder) / f"{name}.toml"
            train.write_text(train_file(vehicles, kind, coupler))
            counts[name] = count(asked.program, train, pathlib.Path(folder) / "out")
            if isinstance(counts[name], str):
                why = counts[name]
                break
    if why is not None:
        print(f"NOT CHECKED: no instruction was counted: {why}")
        return 0
    figures = dict(line.split() for line in known[1:])
    if asked.write:
        FIGURES.write_text("\n".join([head, *(f"{name} {counts[name]}" for name in counts)]) + "\n")
    over = False
    for name, counted in counts.items():
        share = counted / int(figures[name]) if name in figures else 1.0
        over |= share > MOST
        print(f"{name:8}{counted:15,}  {share:.4f} of the figure")
    return 0 if asked.write else int(over)


if __name__ == "__main__":
    sys.exit(main())
