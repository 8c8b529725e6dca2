#!/bin/bash
# Runs `trainsafe fleet` with GNU parallel, on this machine or on machines that share a folder:
#
#     recipes/fleet_parallel.sh 8 reports/yard trains/
#     PARALLEL="--sshlogin node1,node2 --workdir ." recipes/fleet_parallel.sh 8 reports/yard trains/
#
# 8 workers, of one thread each. More may be started by hand elsewhere while the run goes on: trainsafe fleet trains/ --out
# reports/yard --work. A worker that is killed is started again; what it had another does. Trains that cannot be read (status 3) are
# told in the merged errors.csv.
set -u
count=$1
out=$2
shift 2
trainsafe=${TRAINSAFE:-trainsafe}
command=$(printf '%q ' "$trainsafe" fleet "$@" --out "$out" --work --threads 1)
# The number of the worker, which parallel puts at the end, means nothing to it.
seq "$count" | parallel --jobs "$count" --retries 3 "$command 2>&1 || [ \$? -eq 3 ] || exit 1; : {}"
exec "$trainsafe" fleet --merge --out "$out"
