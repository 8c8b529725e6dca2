#!/bin/bash
# The Dask recipe for real: a scheduler and three workers on loopback, one of them killed half way, nothing lost.
#
#     python3 -m venv venv && venv/bin/pip install . "dask[distributed]"
#     PYTHON=venv/bin/python TRAINSAFE=venv/bin/trainsafe tests/cluster/dask.sh
set -eu
python=$(realpath -s "$(command -v "${PYTHON:-python3}")")
# shellcheck source=tests/cluster/common.sh
. "$(dirname "$0")/common.sh"

port=${PORT:-18786}
"$python" -m distributed.cli.dask_scheduler --host 127.0.0.1 --port "$port" --no-dashboard > scheduler.log 2>&1 &
started+=($!)
for i in 1 2 3; do
    "$python" -m distributed.cli.dask_worker "tcp://127.0.0.1:$port" --no-nanny --no-dashboard --nthreads 1 \
        --local-directory "$work/worker-$i" > "worker-$i.log" 2>&1 &
    worker=$!
    started+=("$worker")
done
"$python" "$here/recipes/fleet_dask.py" "tcp://127.0.0.1:$port" parts 3 trains > merge.log 2> tasks.log &
run=$!
await $((all / 4))
kill -9 "$worker" "$(pgrep -P "$worker")"
echo "killed a worker with $(parts) parts done"
wait $run || { cat tasks.log merge.log; exit 1; }
diff -r whole parts
echo "three workers, one killed: the bytes of one run ($cases cases)"
