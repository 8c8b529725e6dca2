#!/bin/bash
# The Dask recipe for real: a scheduler and three workers on loopback, one of them killed half way, nothing lost.
#
#     python3 -m venv venv && venv/bin/pip install "dask[distributed]"
#     PYTHON=venv/bin/python TRAINSAFE=target/release/trainsafe tests/cluster/dask.sh
set -eu
here=$(cd "$(dirname "$0")/../.." && pwd)
python=$(command -v "${PYTHON:-python3}")
TRAINSAFE=$(realpath "${TRAINSAFE:-$here/target/release/trainsafe}")
export TRAINSAFE RAYON_NUM_THREADS=1
work=$(mktemp -d)
started=()
tidy() {
    for pid in "${started[@]}"; do kill -9 "$pid" 2>/dev/null || true; done
    rm -rf "$work"
}
trap tidy EXIT
cd "$work"
python3 "$here/tests/scale/make_fleet.py" trains "${TRAINS:-60}"
"$TRAINSAFE" fleet trains --out whole > /dev/null 2>&1

port=${PORT:-18786}
"$python" -m distributed.cli.dask_scheduler --host 127.0.0.1 --port "$port" --no-dashboard > scheduler.log 2>&1 &
started+=($!)
for i in 1 2 3; do
    "$python" -m distributed.cli.dask_worker "tcp://127.0.0.1:$port" --no-nanny --no-dashboard --nthreads 1 \
        --local-directory "$work/worker-$i" > "worker-$i.log" 2>&1 &
    worker=$!
    started+=("$worker")
done
"$python" "$here/recipes/fleet_dask.py" "tcp://127.0.0.1:$port" parts 12 trains > merge.log 2> shares.log &
run=$!
until [ "$(grep -c "is done" shares.log)" -ge 4 ]; do
    kill -0 $run || { cat shares.log scheduler.log; exit 1; }
    sleep 0.1
done
kill -9 "$worker"
echo "killed a worker with $(grep -c "is done" shares.log) of 12 shares done"
wait $run || { cat shares.log; exit 1; }
diff -r whole parts
echo "12 shares on three workers, one killed: the bytes of one run ($(($(wc -l < whole/fleet.csv) - 1)) cases)"
