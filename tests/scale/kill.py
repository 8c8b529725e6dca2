#!/usr/bin/env python3
"""Runs of a fleet killed (kill -9) at random moments and resumed until they end: the bytes are those of an undisturbed run.

    TRAINSAFE=target/release/trainsafe tests/scale/kill.py [TRAINS] [KILLS]        150 and 50 if not given

Each kill comes at a moment drawn from the first half of the time that an undisturbed run takes, so that a run meets a few of
them before it ends; when it has ended, the next begins.
"""
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import make_fleet

trains, kills = (int(a) for a in (sys.argv[1:] + ["150", "50"][len(sys.argv) - 1 :]))
program = str(Path(os.environ.get("TRAINSAFE", "target/release/trainsafe")).resolve())
quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}


def files(folder):
    return {path.name: path.read_bytes() for path in Path(folder).iterdir()}


with tempfile.TemporaryDirectory() as work:
    os.chdir(work)
    make_fleet.write(Path("trains"), trains)
    # Every seventh is bad, so that errors are resumed as well.
    for path in sorted(Path("trains").glob("*.toml"))[::7]:
        make_fleet.spoil(path, "unknown key")
    start = time.monotonic()
    assert subprocess.run([program, "fleet", "trains", "--out", "whole"], **quiet).returncode == 3
    takes = time.monotonic() - start
    whole = files("whole")
    killed, runs, least, most = 0, 0, 1.0, 0.0
    random.seed(1)
    while killed < kills:
        runs += 1
        of_this_run = 0
        while True:
            run = subprocess.Popen([program, "fleet", "trains", "--out", "out", "--resume"], **quiet)
            moment = random.uniform(0.0, 0.5)
            try:
                run.wait(moment * takes if killed < kills else None)
                break
            except subprocess.TimeoutExpired:
                run.send_signal(signal.SIGKILL)
            if run.wait() != -signal.SIGKILL:
                break
            killed, of_this_run = killed + 1, of_this_run + 1
            least, most = min(least, moment), max(most, moment)
            for part in Path("out").glob("fleet-parts/*.csv"):
                text = part.read_bytes()
                assert not text or text.endswith(b"\n"), f"{part} ends within a row"
        assert run.returncode == 3, f"status {run.returncode}"
        assert files("out") == whole, "the bytes differ"
        print(f"run {runs}: killed {of_this_run} times, resumed, {len(whole)} files with the bytes of an undisturbed run", flush=True)
        shutil.rmtree("out")
    print(f"{killed} kills at {least:.1%} to {most:.1%} of a run of {takes:.1f} s: every run ended in the same bytes")
