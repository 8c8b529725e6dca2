#!/usr/bin/env python3
"""Runs `trainsafe fleet` on a Dask cluster whose workers share a folder.

    fleet_dask.py SCHEDULER OUT SHARES PATH...     such as: fleet_dask.py tcp://head:8786 reports/yard 64 trains/

SCHEDULER is the address of a running Dask scheduler. Every worker needs trainsafe on its PATH (or in TRAINSAFE) and the same
folders under the same names. A share whose worker dies is given to another, which computes what is missing of it.
"""
import os
import subprocess
import sys

from distributed import Client, as_completed

TRAINSAFE = os.environ.get("TRAINSAFE", "trainsafe")


def share(index, count, out, paths):
    """Computes one share; 3 means that some trains could not be read, which the merged errors.csv tells."""
    command = [TRAINSAFE, "fleet", *paths, "--out", out, "--shard", f"{index}/{count}"]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode not in (0, 3):
        raise RuntimeError(f"share {index} of {count}: {done.stderr}")
    return index


def main():
    scheduler, out, count, *paths = sys.argv[1:]
    with Client(scheduler) as client:
        shares = [client.submit(share, i, int(count), out, paths, pure=False, retries=3) for i in range(1, int(count) + 1)]
        for number, done in enumerate(as_completed(shares), 1):
            print(f"share {done.result()} is done, {number} of {count}", file=sys.stderr)
    return subprocess.run([TRAINSAFE, "fleet", "--merge", "--out", out]).returncode


if __name__ == "__main__":
    sys.exit(main())
