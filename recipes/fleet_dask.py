#!/usr/bin/env python3
"""Runs `trainsafe fleet` on a Dask cluster whose workers share a folder, by the Python package alone.

    fleet_dask.py SCHEDULER OUT WORKERS PATH...     such as: fleet_dask.py tcp://head:8786 reports/yard 64 trains/

SCHEDULER is the address of a running Dask scheduler. Every Dask worker needs the Python package of trainsafe and the same folders
under the same names. WORKERS is how many tasks take part at most; each takes the next cases that nobody has until none is left. A task
whose Dask worker dies is given to another, and what it had is done by whoever is there.
"""
import subprocess
import sys

from distributed import Client, as_completed


def work(out, paths):
    """Takes part in the run; 3 means that some trains could not be read, which the merged errors.csv tells."""
    command = [sys.executable, "-m", "trainsafe", "fleet", *paths, "--out", out, "--work", "--threads", "1"]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode not in (0, 3):
        raise RuntimeError(done.stderr)


def main():
    scheduler, out, count, *paths = sys.argv[1:]
    with Client(scheduler) as client:
        tasks = [client.submit(work, out, paths, pure=False, retries=3) for _ in range(int(count))]
        for number, done in enumerate(as_completed(tasks), 1):
            done.result()
            print(f"{number} of {count} tasks have ended", file=sys.stderr)
    return subprocess.run([sys.executable, "-m", "trainsafe", "fleet", "--merge", "--out", out]).returncode


if __name__ == "__main__":
    sys.exit(main())
