#!/usr/bin/env python3
"""Workers of a fleet killed (kill -9) and added at random: the bytes are those of an undisturbed run.

    TRAINSAFE=target/release/trainsafe tests/scale/workers.py [TRAINS] [KILLS] [VEHICLES]     150, 30 and at most 240 if not given

Up to three workers of a thread each share a folder. At random moments one of them is killed, asked to stop (SIGTERM), or one is added.
When a run is done it is joined and compared, and the next begins, until there were so many kills.
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

trains, kills, vehicles = (int(a) for a in (sys.argv[1:] + ["150", "30", "240"][len(sys.argv) - 1 :]))
program = str(Path(os.environ.get("TRAINSAFE", "target/release/trainsafe")).resolve())
quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
command = [program, "fleet", "trains", "--out", "out", "--work", "--threads", "1"]


def files(folder):
    return {path.name: path.read_bytes() for path in Path(folder).iterdir()}


def done():
    return len(list(Path("out").glob("fleet-parts/0*.csv")))


with tempfile.TemporaryDirectory() as work:
    os.chdir(work)
    make_fleet.write(Path("trains"), trains, most=vehicles)
    # Every seventh is bad, so that errors are shared as well.
    for path in sorted(Path("trains").glob("*.toml"))[::7]:
        make_fleet.spoil(path, "unknown key")
    start = time.monotonic()
    assert subprocess.run([program, "fleet", "trains", "--out", "whole"], **quiet).returncode == 3
    takes = time.monotonic() - start
    whole = files("whole")
    random.seed(1)
    killed, stopped, added, runs, at = 0, 0, 0, 0, []
    while killed < kills:
        runs += 1
        workers = [subprocess.Popen(command, **quiet)]
        ended = False
        while not ended:
            time.sleep(random.uniform(0.0, 0.1) * takes)
            for worker in [w for w in workers if w.poll() is not None]:
                workers.remove(worker)
                # One that ends by itself says that every part is done.
                ended = ended or worker.returncode in (0, 3)
                assert worker.returncode in (0, 3, 143, -signal.SIGKILL, -signal.SIGTERM), f"status {worker.returncode}"
            act = random.random()
            if ended or not workers or (act < 0.5 and len(workers) < 3):
                if not ended:
                    workers.append(subprocess.Popen(command, **quiet))
                    added += 1
            elif killed < kills and act < 0.9:
                worker = random.choice(workers)
                worker.send_signal(signal.SIGKILL)
                killed += worker.wait() == -signal.SIGKILL
                at.append(done())
            elif act < 0.95:
                random.choice(workers).terminate()
                stopped += 1
        for worker in workers:
            assert worker.wait() in (0, 3, 143, -signal.SIGTERM)
        for part in Path("out").glob("fleet-parts/0*.csv"):
            text = part.read_bytes()
            assert not text or text.endswith(b"\n"), f"{part} ends within a row"
        assert subprocess.run([program, "fleet", "--merge", "--out", "out"], **quiet).returncode == 3
        assert files("out") == whole, "the bytes differ"
        print(f"run {runs}: {killed} killed, {stopped} stopped, {added} added so far; {len(whole)} files with the bytes of an undisturbed run", flush=True)
        shutil.rmtree("out")
    print(f"{killed} kills with {min(at)} to {max(at)} parts done, in {runs} runs of {takes:.1f} s undisturbed: every run ended in the same bytes")
