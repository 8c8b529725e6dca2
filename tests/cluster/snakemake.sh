#!/bin/bash
# The recipe for Snakemake for real: three workers, one killed, nothing lost.
#
#     python3 -m venv venv && venv/bin/pip install snakemake
#     SNAKEMAKE=venv/bin/snakemake TRAINSAFE=target/release/trainsafe tests/cluster/snakemake.sh
set -eu
snakemake=$(realpath -s "$(command -v "${SNAKEMAKE:-snakemake}")")
# shellcheck source=tests/cluster/common.sh
. "$(dirname "$0")/common.sh"
"$snakemake" --snakefile "$here/recipes/Snakefile" --cores 3 --retries 2 \
    --config trains=trains out=parts workers=3 trainsafe="$TRAINSAFE" > snakemake.log 2>&1 &
run=$!
await $((all / 4))
kill -9 "$(pgrep -f "^([^ ]*python[^ ]* )?$TRAINSAFE fleet trains --out parts --work" | head -1)"
echo "killed a worker with $(parts) parts done"
wait $run || { cat snakemake.log; exit 1; }
diff -r whole parts
echo "three workers, one killed: the bytes of one run ($cases cases)"
