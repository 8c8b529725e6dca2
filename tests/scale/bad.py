#!/usr/bin/env python3
"""A fleet in which some files are bad in many ways: every other train has its results, every bad one an error with its place.

    TRAINSAFE=target/release/trainsafe tests/scale/bad.py [TRAINS] [BAD]        1000 and 100 if not given
"""
import csv
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import make_fleet

trains, bad = (int(a) for a in (sys.argv[1:] + ["1000", "100"][len(sys.argv) - 1 :]))
program = str(Path(os.environ.get("TRAINSAFE", "target/release/trainsafe")).resolve())
with tempfile.TemporaryDirectory() as work:
    os.chdir(work)
    spoiled = make_fleet.write(Path("trains"), trains, bad=bad)
    assert len(spoiled) == bad
    run = subprocess.run([program, "fleet", "trains", "--out", "out"], capture_output=True, text=True)
    assert run.returncode == 3, f"status {run.returncode}: {run.stderr}"
    with open("out/fleet.csv", newline="") as file:
        computed = {row["file"] for row in csv.DictReader(file)}
    with open("out/errors.csv", newline="") as file:
        errors = {row["file"]: row["error"] for row in csv.DictReader(file)}
    good = {str(path) for path in Path("trains").glob("*.toml")} - set(spoiled)
    assert computed == good and len(good) == trains - bad, f"{len(computed)} trains with results"
    assert set(errors) == set(spoiled), f"{len(errors)} errors"
    wrong = 0
    for name, (way, place, words) in spoiled.items():
        told = errors[name].startswith(place) and words in errors[name]
        if place.count(":") == 2:
            column = errors[name].removeprefix(place).split(":")[0]
            told = told and column.isdigit() and int(column) > 0
        if not told:
            wrong += 1
            print(f"{way}: expected {place} and {words!r}, got: {errors[name]}", file=sys.stderr)
    print(f"{len(computed)} trains with results, {len(errors)} errors, exit status {run.returncode}")
    print("every error names its place" if wrong == 0 else f"{wrong} errors do not tell their place as they should")
    sys.exit(wrong > 0)
