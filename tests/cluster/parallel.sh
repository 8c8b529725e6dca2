#!/bin/bash
# The recipe for GNU parallel for real: three workers, of which two are killed one after the other, nothing lost.
# With Debian's parallel installed:
#
#     TRAINSAFE=target/release/trainsafe tests/cluster/parallel.sh
set -eu
# shellcheck source=tests/cluster/common.sh
. "$(dirname "$0")/common.sh"
"$here/recipes/fleet_parallel.sh" 3 parts trains > parallel.log 2>&1 &
run=$!
for done in $((all / 4)) $((all / 2)); do
    await "$done"
    # By its full name: the shell that parallel starts has the same words in its command.
    kill -9 "$(pgrep -f "^([^ ]*python[^ ]* )?$TRAINSAFE fleet trains --out parts --work" | head -1)"
    echo "killed a worker with $(parts) parts done"
done
wait $run || { cat parallel.log; exit 1; }
diff -r whole parts
echo "three workers, two killed: the bytes of one run ($cases cases)"
