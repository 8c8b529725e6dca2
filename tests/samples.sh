#!/usr/bin/env bash
# Writes the sample reports again, by the program that cargo builds, with one date for all.
set -euo pipefail
cd "$(dirname "$0")/.."
cargo build --quiet
target=$(cargo metadata --format-version 1 --no-deps | sed -n 's/.*"target_directory":"\([^"]*\)".*/\1/p')
export SOURCE_DATE_EPOCH=1796083200
sample() {
    local train=$1
    shift
    "$target/debug/trainsafe" analyze "trains/$train.toml" --out "reports/samples/$train" "$@" >/dev/null
}
sample mixed-manifest-train
sample hauled-train-on-a-grade --map
sample paper-figure-4 --format md,html
sample paper-figure-4-damped
sample unit-train-emergency
sample shunting-european-rake
sample mixed-manifest-brakes
# These compare run times: a release build, on a machine that does nothing else.
cargo build --quiet --release
for train in paper-figure-4 mixed-manifest-train shunting-european-rake; do
    "$target/release/trainsafe" accuracy "trains/$train.toml" --out "reports/samples/accuracy/$train" >/dev/null
done
