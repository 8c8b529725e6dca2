#!/usr/bin/env python3
"""The rows of couplers are read by DuckDB while the run goes on, and at its end they are those of the run: needs duckdb.

    TRAINSAFE=target/release/trainsafe tests/cluster/couplers.py        a build with --features parquet
"""
import os
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import duckdb

root = Path(__file__).resolve().parents[2]
program = str(Path(os.environ.get("TRAINSAFE", root / "target/release/trainsafe")).resolve())
# The query that the README shows.
readme = (root / "README.md").read_text()
query = readme.split("```sql\n")[1].split("```")[0].replace("reports/yard", "out")

with tempfile.TemporaryDirectory() as work:
    os.chdir(work)
    size = [os.environ.get("TRAINS", "40"), "--most", os.environ.get("VEHICLES", "240")]
    subprocess.run([sys.executable, root / "tests/scale/make_fleet.py", "trains", *size], check=True)
    command = [program, "fleet", "trains", "--out", "out", "--couplers", "-q", "--work"]
    workers = [subprocess.Popen([*command, "--threads", "1"]) for _ in range(2)]
    seen = []
    while any(worker.poll() is None for worker in workers):
        if list(Path("out").glob("couplers/*.parquet")):
            worst = duckdb.sql(query).fetchall()
            seen.append(duckdb.sql("SELECT count(*) FROM 'out/couplers/*.parquet'").fetchall()[0][0])
            assert worst, "the query finds nothing"
        time.sleep(0.2)
    assert all(worker.returncode == 0 for worker in workers)
    subprocess.run([program, "fleet", "--merge", "--out", "out", "--format", "csv,parquet", "-q"], check=True)
    rows = duckdb.sql("SELECT count(*) FROM 'out/couplers/*.parquet'").fetchall()[0][0]
    assert len(set(seen)) > 2 and seen == sorted(seen) and seen[0] < rows, f"not read while the run went on: {seen} of {rows}"
    couplers = duckdb.sql("SELECT sum(vehicles - 1) FROM 'out/fleet.parquet' WHERE kind = 'break'").fetchall()[0][0]
    cases = duckdb.sql("SELECT count(*) FROM 'out/fleet.parquet'").fetchall()[0][0]
    # A coupler that breaks has no force any more.
    assert rows == couplers - cases, f"{rows} rows of couplers, {couplers} couplers in {cases} cases"
    differing = duckdb.sql(
        """SELECT count(*) FROM (SELECT file, scenario, broken_coupler, max(utilisation) AS most FROM 'out/couplers/*.parquet'
        GROUP BY ALL) JOIN 'out/fleet.parquet' USING (file, scenario, broken_coupler) WHERE most != utilisation"""
    ).fetchall()[0][0]
    assert differing == 0, f"{differing} cases have another worst coupler"
    subprocess.run([program, "fleet", "trains", "--out", "whole", "--couplers", "--format", "csv,parquet", "-q"], check=True)
    assert subprocess.run(["diff", "-r", "whole", "out"]).returncode == 0
    print(f"{rows} rows of couplers in {cases} cases, read {len(seen)} times while two workers wrote them; the bytes of one run")
