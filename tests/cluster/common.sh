# shellcheck shell=bash disable=SC2034,SC2164 # Read by scripts that use its names and stop at errors.
# What the scripts beside this one begin with: a fleet in a folder of its own, its results in whole/, and what tidies up.
here=$(cd "$(dirname "$0")/../.." && pwd)
TRAINSAFE=$(realpath "${TRAINSAFE:-$here/target/release/trainsafe}")
export TRAINSAFE
work=$(mktemp -d)
chmod 755 "$work"
started=()
tidy() {
    for pid in "${started[@]}"; do kill "$pid" 2>/dev/null || true; done
    sleep 1
    for pid in "${started[@]}"; do kill -9 "$pid" 2>/dev/null || true; done
    rm -rf "$work"
}
trap tidy EXIT
cd "$work"
python3 "$here/tests/scale/make_fleet.py" trains "${TRAINS:-60}" --most "${VEHICLES:-240}"
"$TRAINSAFE" fleet trains --out whole -q
cases=$(($(wc -l < whole/fleet.csv) - 1))
of_a_part=$(sed -n 's/.*"chunk_cases": \([0-9]*\).*/\1/p' whole/fleet-run.json)
all=$((cases / of_a_part))

# Parts of the run in parts/ that are done.
parts() { find parts/fleet-parts -name '0*.csv' 2>/dev/null | wc -l; }

# Waits until so many parts are done.
await() {
    until [ "$(parts)" -ge "$1" ]; do sleep 0.05; done
}
