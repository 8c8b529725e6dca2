#!/usr/bin/env bash
# The HTML reports and the page of `trainsafe serve` in a real browser: needs cargo, node with npm, and Chromium, which it installs where it may.
set -euo pipefail
cd "$(dirname "$0")"

installed() { command -v "$1" >/dev/null; }
install() {
    local root=()
    [ "$(id -u)" = 0 ] || root=(sudo -n)
    "${root[@]}" apt-get update -qq && DEBIAN_FRONTEND=noninteractive "${root[@]}" apt-get install -y -qq --no-install-recommends "$@" >/dev/null
}

missing=()
installed node && installed npm || missing+=(nodejs npm)
installed chromium || [ -n "${CHROMIUM:-}" ] || missing+=(chromium fonts-dejavu-core)
if [ ${#missing[@]} -gt 0 ] && ! { installed apt-get && install "${missing[@]}"; }; then
    echo "NOT TESTED IN A BROWSER: ${missing[*]} cannot be installed here; install them by hand and run $0" >&2
    exit 0
fi

cargo build --quiet --features "${FEATURES:-serve}"
target=$(cargo metadata --format-version 1 --no-deps | sed -n 's/.*"target_directory":"\([^"]*\)".*/\1/p')
npm ci --no-audit --no-fund --silent
TRAINSAFE="$target/debug/trainsafe" node --test --test-timeout=600000 report.test.js serve.test.js
