#!/usr/bin/env python3
"""trainsafe and a NumPy program side by side: the same trains, in turn, in the same minutes.

    benches/peer.py [--rounds N] [--program PATH] [--only WORD]

Needs numpy and scipy. Times are computing alone, without start, imports and reading; each is the median of N rounds, in
which both programs run one after the other. --program takes another peer that is called and answers as
benches/numpy_modal.py does: `PROGRAM VEHICLES [--mixed] [--stiff] --break K`, `seconds S ... utilisation U`.
"""
import argparse
import math
import pathlib
import re
import statistics
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
CASES = [
    ("equal", 1001, [], "1000"),
    ("mixed", 1001, ["--mixed"], "1000"),
    ("each", 105, ["--mixed"], "each"),
    ("stiff", 101, ["--mixed", "--stiff"], "100"),
]


def train_file(vehicles, flags, coupler):
    """The consist of numpy_modal.py as a train file."""
    mixed, stiff = "--mixed" in flags, "--stiff" in flags

    def mass(v):
        return 100e3 * (1 + (0.6 * math.sin(1.7 * v * v) if mixed else 0))

    def stiffness(i):
        plain = 20e6 * (1 + (0.4 * math.cos(2.3 * i * i) if mixed else 0))
        return plain * (1e4 if stiff and i % 10 == 5 else 1)

    lines = ['name = "generated"', "[coupler]", 'stiffness = "20 MN/m"', 'rated_load = "1 MN"']
    if mixed:
        for v in range(1, vehicles + 1):
            lines += ["[[vehicle]]", f'mass = "{mass(v)!r} kg"'] + ["held = true"] * (v == 1)
        for i in range(1, vehicles):
            lines += ["[[coupler_override]]", f"at = [{i}]", f'stiffness = "{stiffness(i)!r} N/m"']
    else:
        lines += ["[[vehicle]]", 'mass = "100 t"', "held = true"]
        lines += ["[[vehicle]]", f"count = {vehicles - 1}", 'mass = "100 t"']
    which = '"each"' if coupler == "each" else coupler
    lines += ["[load]", 'uniform = "0.8 MN"', "[[scenario]]", 'name = "break"', 'kind = "break"', f"coupler = {which}"]
    return "\n".join(lines) + "\n"


def answer(command):
    """Seconds, utilisation and bound (None where there is none) that a program prints."""
    text = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    found = dict(re.findall(r"(seconds|utilisation|bound)\s+(\S+)", text))
    return float(found["seconds"]), float(found["utilisation"]), found.get("bound")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--program", type=pathlib.Path, default=HERE / "numpy_modal.py")
    parser.add_argument("--only", default="", help="cases whose name holds this word")
    asked = parser.parse_args()
    build = ["cargo", "build", "--release", "--quiet", "--example", "time_analyze", "--message-format=json"]
    said = subprocess.run(build, check=True, stdout=subprocess.PIPE, text=True, cwd=HERE.parent).stdout
    ours = re.findall(r'"executable":"([^"]*time_analyze[^"]*)"', said)[-1]
    print(f"{'case':8}{'peer, s':>12}{'ours, s':>12}{'ratio':>9}{'peer is off by':>16}{'our bound':>11}")
    with tempfile.TemporaryDirectory() as folder:
        for name, vehicles, flags, coupler in (c for c in CASES if asked.only in c[0]):
            path = pathlib.Path(folder) / f"{name}.toml"
            path.write_text(train_file(vehicles, flags, coupler))
            rounds = []
            for _ in range(asked.rounds):
                peer = answer([sys.executable, asked.program, str(vehicles), *flags, "--break", coupler])
                rounds.append((peer, answer([ours, str(path), "5"])))
            peer_s, ours_s = (statistics.median(r[k][0] for r in rounds) for k in (0, 1))
            (_, peer_use, _), (_, our_use, bound) = rounds[-1]
            off = abs(peer_use - our_use)
            print(f"{name:8}{peer_s:12.4f}{ours_s:12.6f}{peer_s / ours_s:9.1f}{off:16.1e}{bound:>11}", flush=True)


if __name__ == "__main__":
    sys.exit(main())
